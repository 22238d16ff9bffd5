import assert from "node:assert/strict";
import { test } from "node:test";
import { Layer, pointsOf, spacingOf } from "../../../../../services/gateway/page/src/slice.js";

const SIZE = 0.2;

/** A cloud of float32, of rows with a number for each name. */
function cloudOf(names, rows) {
  const step = 4 * names.length;
  const data = new Uint8Array(step * rows.length + 4).subarray(4); // as a message's, not at the buffer's beginning
  const view = new DataView(data.buffer, 4);
  rows.forEach((row, n) => row.forEach((number, k) => view.setFloat32(n * step + 4 * k, number, true)));
  const fields = names.map((name, k) => ({ name, offset: 4 * k, datatype: 7, count: 1 }));
  return { width: rows.length, height: 1, fields, is_bigendian: false, point_step: step, row_step: data.length, data };
}
const centerOf = (indices) => indices.map((index) => (index + 0.5) * SIZE);
const fieldOf = (cells) => cloudOf(["x", "y", "z", "intensity"],
  cells.map(([x, y, z, value]) => [...centerOf([x, y, z]), value]));
const sealedOf = (voxels) => cloudOf(["x", "y", "z", "rgb"], voxels.map((voxel) => [...centerOf(voxel), 0.5]));

test("a field's points have its values, sealed ones, whose color is not read, all the same", () => {
  const points = pointsOf(fieldOf([[0, 1, 2, -0.25], [3, 4, 5, 0.75]]), "intensity");
  assert.deepEqual([...points], [...centerOf([0, 1, 2]), -0.25, ...centerOf([3, 4, 5]), 0.75].map(Math.fround));
  assert.deepEqual([...pointsOf(sealedOf([[0, 1, 2]]))], [...centerOf([0, 1, 2]), 1].map(Math.fround));
});

test("a cloud without x, y or z has no points, nor one without the value that is asked for", () => {
  for (const missing of ["x", "y", "z"]) {
    const names = ["x", "y", "z", "intensity"].filter((name) => name !== missing);
    const cloud = cloudOf(names, [[1, 2, 3]]);
    assert.equal(pointsOf(cloud, "intensity"), null, `a field without ${missing}`);
    assert.equal(pointsOf(cloud), null, `a sealed cloud without ${missing}`);
  }
  assert.equal(pointsOf(sealedOf([[0, 0, 0]]), "intensity"), null);
});

test("an empty cloud, which has no colors either, is no mistake: its layers have no cells", () => {
  const points = pointsOf(cloudOf(["x", "y", "z"], []));
  assert.equal(points.length, 0);
  const layer = new Layer(points, SIZE, 0.5);
  assert.deepEqual([layer.width, layer.height, layer.cells, layer.z], [0, 0, 0, 0.5]);
});

test("a layer has the cells whose centers are within half a cell of its height, and no others", () => {
  const voxels = [[2, -3, 1], [4, -3, 1], [4, 0, 1], [3, -2, 0], [3, -2, 2]];
  for (const height of [0.21, 0.3, 0.39]) {
    const layer = new Layer(pointsOf(sealedOf(voxels)), SIZE, height);
    assert.equal(layer.cells, 3);
    assert.equal(layer.z, Math.fround(0.3));
    assert.deepEqual([layer.width, layer.height], [3, 4]);
    for (let j = 0; j < 4; ++j) {
      for (let i = 0; i < 3; ++i) {
        const isThere = voxels.some(([x, y, z]) => x === 2 + i && y === -3 + j && z === 1);
        assert.equal(layer.value(i, j), isThere ? 1 : NaN, `cell ${i}, ${j} at ${height} m`);
      }
    }
  }
});

test("a voxel that is sealed twice is one cell", () => {
  assert.equal(new Layer(pointsOf(sealedOf([[0, 0, 0], [0, 0, 0], [1, 0, 0]])), SIZE, 0.1).cells, 2);
});

test("sealed cells are as large as the field's, also where they are far apart themselves", () => {
  const size = spacingOf(pointsOf(fieldOf([[0, 0, 0, 0], [1, 0, 0, 0], [1, 1, 0, 0]]), "intensity"));
  assert.ok(Math.abs(size - SIZE) < 1e-6, `cells of ${size} m`);
  const layer = new Layer(pointsOf(sealedOf([[0, 0, 0], [6, 0, 0]])), size, 0.1);
  assert.deepEqual([layer.width, layer.cells], [7, 2]);
});

test("a field falls from cells of high value to those of low value, and not into a gap such as what is sealed leaves", () => {
  const cells = [];
  for (let y = 0; y < 5; ++y) for (let x = 0; x < 5; ++x) if (x !== 4 || y !== 2) cells.push([x, y, 0, -0.1 * x]);
  const layer = new Layer(pointsOf(fieldOf(cells), "intensity"), SIZE, 0.1);
  const [right, up] = layer.descent(1, 1);
  assert.ok(Math.abs(right - 1) < 1e-6 && Math.abs(up) < 1e-6);
  assert.equal(layer.descent(4, 2), null);
  assert.equal(layer.cells, 24);
});
