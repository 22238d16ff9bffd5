import assert from "node:assert/strict";
import { test } from "node:test";
import { blocksOf, joined } from "../../../../../services/gateway/page/src/surface_blocks.js";

const numbers = (count, first) => Array.from({ length: count }, (_, n) => first + n);
/** Two blocks, of four and three vertices, with an empty one between them. */
const MESSAGE = {
  position: Int32Array.from([0, 1, 2, 3, 3, 3, -1, -4, -5]), vertices: Uint32Array.from([4, 0, 3]), triangles: Uint32Array.from([2, 0, 1]),
  points_m: Float32Array.from(numbers(21, 0)), normals: Uint8Array.from(numbers(21, 100)), colors: Uint8Array.from(numbers(21, 50)),
  views: Uint8Array.from([0, 1, 2, 3, 1, 1, 0]), faces: Uint16Array.from([0, 1, 2, 2, 1, 3, 0, 2, 1]),
};

test("Each block has its own part of the arrays, and the chunk that it lies in", () => {
  const blocks = [...blocksOf(MESSAGE)];
  assert.deepEqual(blocks.map(({ key, chunk }) => [key, chunk]), [["0,1,2", "0,0,0"], ["3,3,3", "0,0,0"], ["-1,-4,-5", "-1,-1,-2"]]);
  assert.deepEqual(blocks.map(({ views }) => [...views]), [[0, 1, 2, 3], [], [1, 1, 0]]);
  assert.deepEqual([...blocks[2].points], numbers(9, 12));
  assert.deepEqual([...blocks[2].normals], numbers(9, 112));
  assert.deepEqual([...blocks[2].colors], numbers(9, 62));
  assert.deepEqual([...blocks[2].faces], [0, 2, 1]);
});

test("Joined, each triangle has the vertices of its block", () => {
  const blocks = [...blocksOf(MESSAGE)];
  const mesh = joined([blocks[2], blocks[0]]);
  assert.deepEqual([...mesh.faces], [0, 2, 1, 3, 4, 5, 5, 4, 6]);
  assert.deepEqual([...mesh.points], [...numbers(9, 12), ...numbers(12, 0)]);
  assert.deepEqual([...mesh.views], [1, 1, 0, 0, 1, 2, 3]);
  assert.equal(joined([]).faces.length, 0);
});
