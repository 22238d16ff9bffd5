import assert from "node:assert/strict";
import { test } from "node:test";
import { ChunkTree, LEVELS } from "../../../../../services/gateway/page/src/chunks.js";

const FOCAL = 400; // pixels of a voxel at distance 1
/** A tree of the blocks of a floor, 8 x 8 chunks of level 0. */
function floor() {
  const tree = new ChunkTree();
  for (let y = -16; y < 16; ++y) for (let x = -16; x < 16; ++x) tree.add(x, y, 0);
  return tree;
}
/** Builds what is wanted until nothing is. Returns what is shown then, and each picture on the way. */
function settle(tree, eye, focal = FOCAL) {
  const pictures = [];
  for (let n = 0; n < 10; ++n) {
    const { shown, wanted } = tree.choose(eye, focal);
    pictures.push(shown);
    if (wanted.length === 0) return { shown, pictures };
    for (const chunk of wanted) Object.assign(chunk, { built: true, dirty: false });
  }
  throw new Error("always more is wanted");
}
/** How often each chunk of level 0 is drawn. */
function cover(tree, shown) {
  const times = new Map([...tree.at(0)].map((chunk) => [chunk, 0]));
  const count = (chunk) => (chunk.level === 0 ? times.set(chunk, times.get(chunk) + 1) : chunk.children.forEach(count));
  shown.forEach(count);
  return times;
}
const levelsOf = (shown) => new Set(shown.map(({ level }) => level));

test("From any place each part of the map is drawn once, by cells of few pixels, and by no smaller ones than needed", () => {
  const tree = floor();
  for (const eye of [[0, 0, 10], [500, 40, 30], [-60, 100, 900], [0, 0, 3000], [-130, -130, 5]]) {
    const { shown } = settle(tree, eye);
    for (const times of cover(tree, shown).values()) assert.equal(times, 1);
    for (const chunk of shown) {
      const pixels = (level) => (FOCAL * 2 ** level) / chunk.distanceTo(eye);
      if (chunk.level > 0) assert.ok(pixels(chunk.level) <= 2, `a cell of ${pixels(chunk.level)} pixels`);
      if (chunk.level + 1 < LEVELS) assert.ok(pixels(chunk.level + 1) > 0.7, "a coarser chunk would do");
    }
  }
  assert.deepEqual(levelsOf(settle(tree, [0, 0, 10]).shown), new Set([0]));
  assert.deepEqual(levelsOf(settle(tree, [0, 0, 3000]).shown), new Set([2]));
  assert.deepEqual(levelsOf(settle(tree, [0, 0, 570]).shown), new Set([1]));
});

test("On the way to another place nothing that was drawn is missing or drawn twice", () => {
  const tree = floor();
  settle(tree, [0, 0, 3000]);
  for (const eye of [[0, 0, 10], [700, 0, 10], [0, 0, 3000], [100, 100, 300], [-100, 0, 20]]) {
    for (const shown of settle(tree, eye).pictures) for (const times of cover(tree, shown).values()) assert.equal(times, 1);
  }
});

test("A camera that moves a little back and forth does not change the level", () => {
  const tree = floor();
  settle(tree, [0, 0, 3000]);
  let changes = 0;
  for (let z = 3000, before = null; z > 10; z /= 1.02) {
    const picture = (eye) => settle(tree, eye).shown.map(({ level, x, y }) => `${level} ${x} ${y}`).join();
    const here = picture([0, 0, z]);
    assert.equal(picture([0, 0, z * 1.1]), here, `at ${z}`);
    if (before !== null && here !== before) ++changes;
    before = here;
  }
  assert.ok(changes > 2);
});

test("Without a place to look from everything is drawn by voxels", () => {
  const tree = floor(), { shown } = settle(tree, null);
  assert.deepEqual(levelsOf(shown), new Set([0]));
  assert.equal(shown.length, [...tree.at(0)].length);
});

test("A new part of the map does not make what is drawn around it coarse", () => {
  const tree = new ChunkTree();
  tree.add(0, 0, 0);
  const eye = [0, 0, 20];
  const [first] = settle(tree, eye).shown;
  tree.add(4, 0, 0);
  const { shown, wanted } = tree.choose(eye, FOCAL);
  assert.deepEqual(shown, [first]);
  assert.deepEqual(wanted.map(({ level, x }) => [level, x]), [[0, 1]]);
});

test("A changed block makes those chunks of all levels dirty whose voxels or neighbors it holds", () => {
  const tree = floor();
  const around = (block) => {
    const found = [];
    tree.forEachAround(...block, ({ level, x, y, z }) => found.push([level, x, y, z].join()));
    return found.sort();
  };
  assert.deepEqual(around([1, 1, 0]), ["0,0,0,0", "1,0,0,0", "2,0,0,0"]);
  assert.deepEqual(around([3, 1, 0]), ["0,0,0,0", "0,1,0,0", "1,0,0,0", "2,0,0,0"]);
  assert.deepEqual(around([-1, 1, 0]), ["0,-1,0,0", "0,0,0,0", "1,-1,0,0", "1,0,0,0", "2,-1,0,0", "2,0,0,0"]);
});

test("What is shown and has changed is wanted; what is not shown is not", () => {
  const tree = floor(), eye = [0, 0, 10];
  settle(tree, eye);
  tree.forEachAround(1, 1, 0, (chunk) => (chunk.dirty = true));
  const { wanted } = tree.choose(eye, FOCAL);
  assert.deepEqual(wanted.map(({ level, x, y }) => [level, x, y]), [[0, 0, 0]]);
});
