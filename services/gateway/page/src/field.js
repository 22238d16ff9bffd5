// The strategy's field as a horizontal slice, with the lines along which it falls fastest and the dead ends left out of it.
import * as THREE from "three";
import { RAMP } from "./ramp.js";
import { Layer, pointsOf, spacingOf } from "./slice.js";

const ramp = RAMP.map((each) => new THREE.Color(each));
const SPACING = 2.5; // [cells] between streamlines
const LONGEST = 400; // steps of half a cell
const WHITE = [255, 255, 255];

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

/** A horizontal plane whose texture has a pixel for each cell of a layer. */
function makePlane() {
  const plane = new THREE.Mesh(new THREE.PlaneGeometry(1, 1),
    new THREE.MeshBasicMaterial({ transparent: true, opacity: 0.85, side: THREE.DoubleSide, depthWrite: false }));
  plane.visible = false;
  return plane;
}

/** Lays a plane over a layer. @param colorOf red, green and blue of a value, in 0 to 255 */
function lay(plane, layer, colorOf) {
  const pixels = new Uint8Array(4 * layer.values.length);
  layer.values.forEach((value, n) => {
    if (Number.isNaN(value)) return;
    pixels.set([...colorOf(value), 255], 4 * n);
  });
  plane.material.map?.dispose();
  const texture = new THREE.DataTexture(pixels, layer.width, layer.height);
  texture.colorSpace = THREE.SRGBColorSpace;
  texture.needsUpdate = true;
  plane.material.map = texture;
  plane.material.needsUpdate = true;
  plane.scale.set(layer.width * layer.size, layer.height * layer.size, 1);
  const middle = (first, cells) => first + ((cells - 1) * layer.size) / 2;
  plane.position.set(middle(layer.x0, layer.width), middle(layer.y0, layer.height), layer.z);
}

const mixed = new THREE.Color();
function rampColor(value) {
  const t = Math.min(Math.max((value + 1) / 2, 0), 0.999) * (ramp.length - 1);
  mixed.lerpColors(ramp[Math.floor(t)], ramp[Math.floor(t) + 1], t % 1).convertLinearToSRGB();
  return [mixed.r * 255, mixed.g * 255, mixed.b * 255];
}

export class FieldSlice {
  #points = null;
  #sealed = null; // points of what is sealed
  #size = 0.1;
  #height = 0; // [m] of the last cut

  constructor() {
    this.group = new THREE.Group();
    this.group.visible = false;
    this.plane = makePlane();
    this.sealedPlane = makePlane();
    this.lines = new THREE.LineSegments(new THREE.BufferGeometry(),
      new THREE.LineBasicMaterial({ transparent: true, opacity: 0.75 }));
    this.lines.frustumCulled = false;
    this.group.add(this.plane, this.sealedPlane, this.lines);
    this.layer = this.sealedLayer = null;
  }

  /** @param color of the lines; @param sealed of what is sealed */
  setTheme(color, sealed) {
    this.lines.material.color.set(color);
    this.sealedPlane.material.color.set(sealed);
  }

  /** @param message sensor_msgs/msg/PointCloud2 with x, y, z, intensity in -1 to 1 */
  set(message, height) {
    this.#points = pointsOf(message, "intensity");
    if (!this.#points) return;
    this.#size = spacingOf(this.#points);
    this.cutAt(height);
  }

  /** @param message sensor_msgs/msg/PointCloud2 with x, y, z of the cells that are sealed, which are as large as the field's */
  setSealed(message) {
    this.#sealed = pointsOf(message);
    // The gateway may pass it on before the first field, which alone says how large a cell is: it is cut with that one.
    if (!this.#sealed || !this.#points) return;
    this.#cutSealed();
  }

  clear() {
    this.#points = this.#sealed = this.layer = this.sealedLayer = null;
    this.plane.visible = this.sealedPlane.visible = this.lines.visible = false;
  }

  /** What is drawn: { cells, z [m], lines: pieces of streamlines }; null if nothing is. */
  get shown() {
    if (!this.group.visible || !this.plane.visible || !this.layer) return null;
    return { cells: this.layer.cells, z: this.layer.z, lines: (this.lines.geometry.getAttribute("position")?.count ?? 0) / 2 };
  }

  /** How many cells are drawn as sealed. */
  get sealed() {
    return this.group.visible && this.sealedPlane.visible ? this.sealedLayer.cells : 0;
  }

  /** Shows the layer of cells at a height [m]. */
  cutAt(height) {
    if (!this.#points) return;
    this.#height = height;
    this.#cutField();
    this.#cutSealed();
  }

  #cutField() {
    const layer = new Layer(this.#points, this.#size, this.#height);
    this.layer = layer;
    this.plane.visible = this.lines.visible = layer.width > 0;
    if (layer.width === 0) return;
    lay(this.plane, layer, rampColor);
    const segments = streamlines(layer);
    const position = new Float32Array((segments.length / 2) * 3);
    for (let n = 0; n < segments.length / 2; ++n) {
      const [x, y] = [segments[2 * n], segments[2 * n + 1]];
      position.set([layer.x0 + x * layer.size, layer.y0 + y * layer.size, layer.z + 0.01], 3 * n);
    }
    this.lines.geometry.dispose();
    this.lines.geometry = new THREE.BufferGeometry();
    this.lines.geometry.setAttribute("position", new THREE.BufferAttribute(position, 3));
  }

  #cutSealed() {
    const layer = this.#sealed && new Layer(this.#sealed, this.#size, this.#height);
    this.sealedLayer = layer;
    this.sealedPlane.visible = layer !== null && layer.width > 0;
    // It is white, so that the material's color is what is seen, and a change of theme needs no other texture.
    if (this.sealedPlane.visible) lay(this.sealedPlane, layer, () => WHITE);
  }
}
