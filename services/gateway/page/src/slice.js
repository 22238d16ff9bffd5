// A horizontal layer of cells, from the points of a cloud: of the field, and of what is sealed.

const FEW = 40000; // numbers that are searched for the cells' size

/**
 * Four numbers for each point of a PointCloud2: x, y, z [m] and its value.
 * @param named the message's field that is the value; without one each point has the value 1
 * @returns Float32Array, or null if the message lacks one of its fields
 */
export function pointsOf(message, named = null) {
  const offset = Object.fromEntries(message.fields.map(({ name, offset: at }) => [name, at]));
  const names = named === null ? ["x", "y", "z"] : ["x", "y", "z", named];
  if (names.some((name) => offset[name] === undefined)) return null;
  const view = new DataView(message.data.buffer, message.data.byteOffset, message.data.byteLength);
  const count = Math.floor(message.data.byteLength / message.point_step);
  const points = new Float32Array(4 * count).fill(1);
  for (let n = 0; n < count; ++n) {
    names.forEach((name, k) => {
      points[4 * n + k] = view.getFloat32(n * message.point_step + offset[name], true);
    });
  }
  return points;
}

/** The smallest distance between different values of x: the size of the cells. */
export function spacingOf(points) {
  let least = Infinity;
  for (let n = 4; n < Math.min(points.length, FEW); n += 4) {
    const gap = Math.abs(points[n] - points[n - 4]);
    if (gap > 1e-3 && gap < least) least = gap;
  }
  return Number.isFinite(least) ? least : 0.1;
}

/** The points at a height as a grid: value(i, j), NaN where there is none. */
export class Layer {
  /** @param points as pointsOf returns them; @param size [m] of a cell; @param z [m] the height */
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

  /** How many cells have a value. */
  get cells() {
    return this.values.reduce((count, value) => count + (Number.isNaN(value) ? 0 : 1), 0);
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
