// The strategy's field as a horizontal slice, with the lines along which it falls fastest.
import * as THREE from "three";
import { RAMP } from "./ramp.js";

const ramp = RAMP.map((each) => new THREE.Color(each));
const SPACING = 2.5; // [cells] between streamlines
const LONGEST = 400; // steps of half a cell

/** x, y, z, value of each point of a PointCloud2 with the field intensity; null if it has none. */
function pointsOf(message) {
  const offset = Object.fromEntries(message.fields.map(({ name, offset: at }) => [name, at]));
  if (["x", "y", "z", "intensity"].some((name) => offset[name] === undefined)) return null;
  const view = new DataView(message.data.buffer, message.data.byteOffset, message.data.byteLength);
  const count = Math.floor(message.data.byteLength / message.point_step);
  const points = new Float32Array(4 * count);
  for (let n = 0; n < count; ++n) {
    ["x", "y", "z", "intensity"].forEach((name, k) => {
      points[4 * n + k] = view.getFloat32(n * message.point_step + offset[name], true);
    });
  }
  return points;
}

/** The smallest distance between different values of x: the size of the field's cells. */
function spacingOf(points) {
  let least = Infinity;
  for (let n = 4; n < Math.min(points.length, 40000); n += 4) {
    const gap = Math.abs(points[n] - points[n - 4]);
    if (gap > 1e-3 && gap < least) least = gap;
  }
  return Number.isFinite(least) ? least : 0.1;
}

/** A layer of the field as a grid: value(i, j), NaN where there is none. */
class Layer {
  constructor(points, size, z) {
    let x0 = Infinity, y0 = Infinity, x1 = -Infinity, y1 = -Infinity;
    const inside = [];
    for (let n = 0; n < points.length; n += 4) {
      if (Math.abs(points[n + 2] - z) > size / 2) continue;
      inside.push(n);
      x0 = Math.min(x0, points[n]);
      x1 = Math.max(x1, points[n]);
      y0 = Math.min(y0, points[n + 1]);
      y1 = Math.max(y1, points[n + 1]);
    }
    this.size = size;
    this.x0 = x0;
    this.y0 = y0;
    this.z = inside.length > 0 ? points[inside[0] + 2] : z;
    this.width = inside.length > 0 ? Math.round((x1 - x0) / size) + 1 : 0;
    this.height = inside.length > 0 ? Math.round((y1 - y0) / size) + 1 : 0;
    this.values = new Float32Array(this.width * this.height).fill(NaN);
    for (const n of inside) {
      this.values[Math.round((points[n + 1] - y0) / size) * this.width + Math.round((points[n] - x0) / size)] = points[n + 3];
    }
  }
  value(i, j) {
    return i < 0 || j < 0 || i >= this.width || j >= this.height ? NaN : this.values[j * this.width + i];
  }
  /** Direction of steepest descent at a place in cells; null beside walls and outside. */
  descent(x, y) {
    const i = Math.round(x), j = Math.round(y), here = this.value(i, j);
    if (Number.isNaN(here)) return null;
    // No flux through walls: a neighbor without a value counts as equal.
    const or = (value) => (Number.isNaN(value) ? here : value);
    const gx = or(this.value(i + 1, j)) - or(this.value(i - 1, j)), gy = or(this.value(i, j + 1)) - or(this.value(i, j - 1));
    const length = Math.hypot(gx, gy);
    return length < 1e-7 ? null : [-gx / length, -gy / length];
  }
}

/** Lines of steepest descent, evenly spaced: a place near an earlier line begins and continues none. */
function streamlines(layer) {
  const taken = new Uint8Array(Math.ceil(layer.width / SPACING + 1) * Math.ceil(layer.height / SPACING + 1));
  const row = Math.ceil(layer.width / SPACING + 1);
  const box = (x, y) => Math.floor(y / SPACING) * row + Math.floor(x / SPACING);
  const segments = [];
  const trace = (x, y, sign, own) => {
    for (let step = 0; step < LONGEST; ++step) {
      const down = layer.descent(x, y);
      if (!down) return;
      const [nx, ny] = [x + 0.5 * sign * down[0], y + 0.5 * sign * down[1]];
      if (Number.isNaN(layer.value(Math.round(nx), Math.round(ny)))) return;
      const at = box(nx, ny);
      if (taken[at] && !own.has(at)) return;
      own.add(at);
      taken[at] = 1;
      segments.push(x, y, nx, ny);
      [x, y] = [nx, ny];
    }
  };
  for (let j = 0; j < layer.height; ++j) {
    for (let i = 0; i < layer.width; ++i) {
      if (Number.isNaN(layer.value(i, j)) || taken[box(i, j)]) continue;
      const own = new Set([box(i, j)]);
      taken[box(i, j)] = 1;
      trace(i, j, 1, own);
      trace(i, j, -1, own);
    }
  }
  return segments;
}

export class FieldSlice {
  #points = null;
  #size = 0.1;

  constructor() {
    this.group = new THREE.Group();
    this.group.visible = false;
    this.plane = new THREE.Mesh(new THREE.PlaneGeometry(1, 1),
      new THREE.MeshBasicMaterial({ transparent: true, opacity: 0.85, side: THREE.DoubleSide, depthWrite: false }));
    this.lines = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ transparent: true, opacity: 0.75 }));
    this.lines.frustumCulled = false;
    this.group.add(this.plane, this.lines);
    this.layer = null;
  }

  setTheme(color) {
    this.lines.material.color.set(color);
  }

  /** @param message sensor_msgs/msg/PointCloud2 with x, y, z, intensity in -1 to 1 */
  set(message, height) {
    this.#points = pointsOf(message);
    if (!this.#points) return;
    this.#size = spacingOf(this.#points);
    this.cutAt(height);
  }

  clear() {
    this.#points = this.layer = null;
    this.plane.visible = this.lines.visible = false;
  }

  /** What is drawn: { cells, z [m], lines: pieces of streamlines }; null if nothing is. */
  get shown() {
    if (!this.group.visible || !this.plane.visible || !this.layer) return null;
    return { cells: this.layer.values.filter((value) => !Number.isNaN(value)).length, z: this.layer.z,
      lines: (this.lines.geometry.getAttribute("position")?.count ?? 0) / 2 };
  }

  /** Shows the layer of cells at a height [m]. */
  cutAt(height) {
    if (!this.#points) return;
    const layer = new Layer(this.#points, this.#size, height);
    this.layer = layer;
    this.plane.visible = this.lines.visible = layer.width > 0;
    if (layer.width === 0) return;
    const pixels = new Uint8Array(4 * layer.values.length);
    const mixed = new THREE.Color();
    layer.values.forEach((value, n) => {
      if (Number.isNaN(value)) return;
      const t = Math.min(Math.max((value + 1) / 2, 0), 0.999) * (ramp.length - 1);
      mixed.lerpColors(ramp[Math.floor(t)], ramp[Math.floor(t) + 1], t % 1).convertLinearToSRGB();
      pixels.set([mixed.r * 255, mixed.g * 255, mixed.b * 255, 255], 4 * n);
    });
    this.plane.material.map?.dispose();
    const texture = new THREE.DataTexture(pixels, layer.width, layer.height);
    texture.colorSpace = THREE.SRGBColorSpace;
    texture.needsUpdate = true;
    this.plane.material.map = texture;
    this.plane.material.needsUpdate = true;
    this.plane.scale.set(layer.width * layer.size, layer.height * layer.size, 1);
    this.plane.position.set(layer.x0 + ((layer.width - 1) * layer.size) / 2, layer.y0 + ((layer.height - 1) * layer.size) / 2, layer.z);
    const segments = streamlines(layer);
    const position = new Float32Array((segments.length / 2) * 3);
    for (let n = 0; n < segments.length / 2; ++n) {
      position.set([layer.x0 + segments[2 * n] * layer.size, layer.y0 + segments[2 * n + 1] * layer.size, layer.z + 0.01], 3 * n);
    }
    this.lines.geometry.dispose();
    this.lines.geometry = new THREE.BufferGeometry();
    this.lines.geometry.setAttribute("position", new THREE.BufferAttribute(position, 3));
  }
}
