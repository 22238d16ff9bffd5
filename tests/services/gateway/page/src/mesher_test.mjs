import assert from "node:assert/strict";
import { test } from "node:test";
import { FREE, OCCUPIED, Voxels, meshBorder, meshChunk } from "../../../../../services/gateway/page/src/mesher.js";

/** A map with the given voxels, [x, y, z, state], in blocks as the gateway sends them. */
function mapOf(voxels) {
  const blocks = new Map();
  for (const [x, y, z, state] of voxels) {
    const at = [x, y, z].map((c) => Math.floor(c / 8));
    const octets = blocks.get(at.join()) ?? new Uint8Array(128);
    const k = ((z & 7) * 8 + (y & 7)) * 8 + (x & 7);
    octets[k >> 2] |= state << (2 * (k & 3));
    blocks.set(at.join(), octets);
  }
  const map = new Voxels();
  for (const [at, octets] of blocks) map.setBlock(...at.split(",").map(Number), octets);
  return map;
}
const faces = (mesh) => (mesh ? mesh.index.length / 6 : 0);
/** Pseudorandom numbers in [0, 1), the same in each run [Park and Miller, 1988]. */
function random(seed) {
  return () => (seed = (seed * 48271) % 2147483647) / 2147483647;
}

test("A voxel alone has six faces, two side by side have ten", () => {
  assert.equal(faces(meshChunk(mapOf([[3, 3, 3, OCCUPIED]]), 0, 0, 0)), 6);
  assert.equal(faces(meshChunk(mapOf([[7, 3, 3, OCCUPIED], [8, 3, 3, OCCUPIED]]), 0, 0, 0)), 10);
});

test("Faces between chunks are covered from both sides", () => {
  const map = mapOf([[31, 0, 0, OCCUPIED], [32, 0, 0, OCCUPIED]]);
  assert.equal(faces(meshChunk(map, 0, 0, 0)), 5);
  assert.equal(faces(meshChunk(map, 1, 0, 0)), 5);
});

test("The border lies between free and unknown voxels only", () => {
  assert.equal(faces(meshBorder(mapOf([[3, 3, 3, FREE]]), 0, 0, 0)), 6);
  assert.equal(faces(meshBorder(mapOf([[3, 3, 3, FREE], [4, 3, 3, OCCUPIED], [3, 4, 3, FREE]]), 0, 0, 0)), 9);
  assert.equal(meshBorder(mapOf([[3, 3, 3, OCCUPIED]]), 0, 0, 0), null);
});

test("A ray finds the voxel that small steps along it find", () => {
  const next = random(5);
  const voxels = [];
  for (let n = 0; n < 3000; ++n) voxels.push([...[0, 0, 0].map(() => Math.floor(next() * 40) - 20), OCCUPIED]);
  const map = mapOf(voxels);
  let hits = 0;
  for (let n = 0; n < 300; ++n) {
    const origin = [30 * next() - 15, 30 * next() - 15, 30 * next() - 15];
    const direction = [next() - 0.5, next() - 0.5, next() - 0.5];
    const length = Math.hypot(...direction);
    const unit = direction.map((c) => c / length);
    if (map.stateAt(...origin.map(Math.floor)) === OCCUPIED) continue;
    const hit = map.cast(origin, unit, 60);
    let stepped = null;
    for (let t = 0; t < 60 && stepped === null; t += 1e-3) {
      if (map.stateAt(...origin.map((o, k) => Math.floor(o + t * unit[k]))) === OCCUPIED) stepped = t;
    }
    // Steps may miss the corner of a voxel that the ray cuts by less than a step.
    if (stepped === null) continue;
    ++hits;
    assert.ok(hit && hit.distance <= stepped + 1e-6, `ray ${n}`);
    const inside = origin.map((o, k) => Math.floor(o + hit.distance * unit[k] - hit.normal[k] * 1e-6));
    assert.equal(map.stateAt(...inside), OCCUPIED, `ray ${n}`);
  }
  assert.ok(hits > 50);
});

test("A ray passes what lies above the cut", () => {
  const map = mapOf([[0, 0, 5, OCCUPIED], [0, 0, 0, OCCUPIED]]);
  assert.equal(map.cast([0.5, 0.5, 9.5], [0, 0, -1], 20).distance, 3.5);
  assert.deepEqual(map.cast([0.5, 0.5, 9.5], [0, 0, -1], 20, 5), { distance: 8.5, normal: [0, 0, 1] });
  assert.equal(map.cast([0.5, 0.5, -3.5], [0, 0, -1], 20), null);
});
