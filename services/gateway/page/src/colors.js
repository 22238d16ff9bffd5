// The measured colors of the map's voxels, from the points that the mapper publishes, and as chunks are painted.
import { CHUNK, EDGE, blockKey } from "./mesher.js";

const FLOAT32 = 7; // sensor_msgs/msg/PointField
const BLOCK = EDGE ** 3;
const CELLS = CHUNK ** 3;
const sums = new Uint32Array(4 * CELLS); // of a chunk's cells: red, green, blue, voxels

/** @param a @param b Uint8Array of equal length, a multiple of 4, from the beginning of a buffer */
function areEqual(a, b) {
  const [p, q] = [a, b].map(({ buffer }) => new Uint32Array(buffer));
  for (let k = 0; k < p.length; ++k) if (p[k] !== q[k]) return false;
  return true;
}

/** Where x, y, z and rgb lie within a point; null if the cloud lacks one of them as float32. */
function layoutOf({ fields }) {
  const offsets = ["x", "y", "z", "rgb"].map((name) => fields.find((field) => field.name === name && field.datatype === FLOAT32)?.offset);
  return offsets.includes(undefined) ? null : offsets;
}

export class VoxelColors {
  #blocks = new Map(); // key -> { at: [x, y, z], rgba: 4 octets a voxel, x fastest; alpha 0 = no color }
  count = 0; // voxels that have a color

  clear() {
    this.#blocks.clear();
    this.count = 0;
  }

  /**
   * Takes the colors of all voxels, which replace what was known.
   * @param cloud sensor_msgs/msg/PointCloud2 of voxels' centers; one without colors has no voxel
   * @param size [m] of a voxel
   * @returns the blocks, [x, y, z], whose colors are others than before
   */
  set(cloud, size) {
    const before = this.#blocks;
    this.#blocks = new Map();
    this.count = 0;
    const layout = layoutOf(cloud), { data, width, point_step: step, is_bigendian: isBigEndian } = cloud;
    const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
    const points = layout && !isBigEndian && step >= Math.max(...layout) + 4 ? Math.min(width, Math.floor(data.byteLength / step)) : 0;
    for (let n = 0; n < points; ++n) {
      const [x, y, z] = [0, 1, 2].map((axis) => Math.floor(view.getFloat32(n * step + layout[axis], true) / size));
      const packed = n * step + layout[3]; // blue, green, red
      const block = this.#blockAt(Math.floor(x / EDGE), Math.floor(y / EDGE), Math.floor(z / EDGE));
      const to = 4 * (((z & (EDGE - 1)) * EDGE + (y & (EDGE - 1))) * EDGE + (x & (EDGE - 1)));
      if (block.rgba[to + 3] === 0) ++this.count;
      block.rgba.set([data[packed + 2], data[packed + 1], data[packed], 255], to);
    }
    const changed = [];
    for (const [key, { at, rgba }] of this.#blocks) {
      const old = before.get(key)?.rgba;
      if (!old || !areEqual(rgba, old)) changed.push(at);
    }
    for (const [key, { at }] of before) if (!this.#blocks.has(key)) changed.push(at);
    return changed;
  }
  #blockAt(x, y, z) {
    const key = blockKey(x, y, z);
    let block = this.#blocks.get(key);
    if (!block) this.#blocks.set(key, (block = { at: [x, y, z], rgba: new Uint8Array(4 * BLOCK) }));
    return block;
  }

  /**
   * The colors of a chunk's cells: the mean of the voxels in each that have one.
   * @returns Uint8Array of 4 octets a cell, x fastest, alpha 0 = no color; or null if no voxel of the chunk has one
   */
  ofChunk(cx, cy, cz, level = 0) {
    const wide = (CHUNK / EDGE) << level, tall = CHUNK / EDGE;
    let any = false;
    sums.fill(0);
    for (let bz = 0; bz < tall; ++bz) {
      for (let by = 0; by < wide; ++by) {
        for (let bx = 0; bx < wide; ++bx) {
          const rgba = this.#blocks.get(blockKey(cx * wide + bx, cy * wide + by, cz * tall + bz))?.rgba;
          if (!rgba) continue;
          any = true;
          for (let k = 0; k < BLOCK; ++k) {
            if (rgba[4 * k + 3] === 0) continue;
            const x = (bx * EDGE + (k & 7)) >> level, y = (by * EDGE + ((k >> 3) & 7)) >> level, z = bz * EDGE + (k >> 6);
            const to = 4 * ((z * CHUNK + y) * CHUNK + x);
            for (let c = 0; c < 3; ++c) sums[to + c] += rgba[4 * k + c];
            ++sums[to + 3];
          }
        }
      }
    }
    if (!any) return null;
    const cells = new Uint8Array(4 * CELLS);
    for (let to = 0; to < cells.length; to += 4) {
      const voxels = sums[to + 3];
      if (voxels === 0) continue;
      for (let c = 0; c < 3; ++c) cells[to + c] = Math.round(sums[to + c] / voxels);
      cells[to + 3] = 255;
    }
    return cells;
  }
}
