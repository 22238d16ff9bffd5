import assert from "node:assert/strict";
import { test } from "node:test";
import { VoxelColors } from "../../../../../services/gateway/page/src/colors.js";

const SIZE = 0.1;
const FIELDS = ["x", "y", "z", "rgb"].map((name, n) => ({ name, offset: 4 * n, datatype: 7, count: 1 }));

/** A cloud as the mapper publishes it, of voxels [x, y, z, [r, g, b]]. */
function cloudOf(voxels, fields = FIELDS) {
  const data = new Uint8Array(16 * voxels.length + 4), shifted = data.subarray(4); // as a message's, not at the buffer's beginning
  const view = new DataView(data.buffer, 4);
  voxels.forEach(([x, y, z, [r, g, b]], n) => {
    [x, y, z].forEach((index, axis) => view.setFloat32(16 * n + 4 * axis, (index + 0.5) * SIZE, true));
    view.setUint32(16 * n + 12, (r << 16) | (g << 8) | b, true);
  });
  return { width: voxels.length, height: 1, fields, is_bigendian: false, point_step: 16, row_step: 16 * voxels.length, data: shifted };
}
const cellOf = (cells, x, y, z) => [...cells.subarray(4 * ((z * 32 + y) * 32 + x), 4 * ((z * 32 + y) * 32 + x) + 4)];
const RED = [200, 10, 20], GREEN = [30, 180, 40];

test("a chunk's cells have the colors of their voxels, and no others", () => {
  const colors = new VoxelColors();
  colors.set(cloudOf([[0, 0, 0, RED], [9, 17, 31, GREEN], [-1, -32, -33, GREEN]]), SIZE);
  assert.equal(colors.count, 3);
  const cells = colors.ofChunk(0, 0, 0);
  assert.deepEqual(cellOf(cells, 0, 0, 0), [...RED, 255]);
  assert.deepEqual(cellOf(cells, 9, 17, 31), [...GREEN, 255]);
  assert.equal(cells.filter((value, k) => k % 4 === 3 && value > 0).length, 2);
  assert.deepEqual(cellOf(colors.ofChunk(-1, -1, -2), 31, 0, 31), [...GREEN, 255]);
  assert.equal(colors.ofChunk(1, 0, 0), null);
});

test("a coarse cell has the mean of those of its voxels that have a color", () => {
  const colors = new VoxelColors();
  colors.set(cloudOf([[40, 41, 3, [100, 0, 50]], [43, 43, 3, [201, 0, 150]], [40, 40, 4, GREEN]]), SIZE);
  const cells = colors.ofChunk(0, 0, 0, 2); // cells of 4 x 4 x 1 voxels
  assert.deepEqual(cellOf(cells, 10, 10, 3), [151, 0, 100, 255]);
  assert.deepEqual(cellOf(cells, 10, 10, 4), [...GREEN, 255]);
});

test("each cloud replaces the one before it, and only blocks that differ are reported", () => {
  const colors = new VoxelColors();
  const at = (blocks) => blocks.map((block) => block.join()).sort();
  assert.deepEqual(at(colors.set(cloudOf([[0, 0, 0, RED], [8, 0, 0, RED], [-1, 0, 0, RED]]), SIZE)), ["-1,0,0", "0,0,0", "1,0,0"]);
  assert.deepEqual(at(colors.set(cloudOf([[0, 0, 0, RED], [8, 0, 0, GREEN]]), SIZE)), ["-1,0,0", "1,0,0"]);
  assert.equal(colors.count, 2);
  assert.equal(colors.ofChunk(-1, 0, 0), null);
  colors.clear();
  assert.equal(colors.ofChunk(0, 0, 0), null);
});

test("a cloud that is cut off or has no colors has no voxel beyond what it holds", () => {
  const colors = new VoxelColors();
  const cut = cloudOf([[0, 0, 0, RED], [1, 0, 0, RED]]);
  colors.set({ ...cut, data: cut.data.subarray(0, 31) }, SIZE);
  assert.equal(colors.count, 1);
  colors.set(cloudOf([[0, 0, 0, RED]], FIELDS.slice(0, 3)), SIZE);
  assert.equal(colors.count, 0);
  colors.set({ ...cut, point_step: 12 }, SIZE);
  assert.equal(colors.count, 0);
});
