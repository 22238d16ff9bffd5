import assert from "node:assert/strict";
import { test } from "node:test";
import { FREE, OCCUPIED, UNKNOWN, Voxels, meshBorder, meshChunk } from "../../../../../services/gateway/page/src/mesher.js";

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
const LEVELS = [0, 1, 2];
const AXES = [0, 0, 1, 1, 2, 2], OUT = [1, -1, 1, -1, 1, -1]; // of faces, as meshChunk numbers them

/** The rectangles of a mesh: { face, low, high: opposite corners in voxels, openness: "x,y,z" -> 0..3, born }. */
function rectangles(mesh, [cx, cy, cz] = [0, 0, 0], level = 0) {
  return Array.from({ length: mesh?.count ?? 0 }, (_, n) => {
    const corners = [0, 1, 2, 3].map((k) => mesh.position.subarray(16 * n + 4 * k, 16 * n + 4 * k + 4));
    const inVoxels = ([x, y, z]) => [(32 * cx + x) * 2 ** level, (32 * cy + y) * 2 ** level, 32 * cz + z];
    const places = corners.map(inVoxels), face = corners[0][3] >> 4;
    const [low, high] = [Math.min, Math.max].map((pick) => [0, 1, 2].map((axis) => pick(...places.map((place) => place[axis]))));
    const [a, b, c] = places, [u, v] = [b, c].map((to) => to.map((value, k) => value - a[k]));
    const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]].map((c) => Math.sign(c) + 0);
    assert.deepEqual(normal, [0, 1, 2].map((axis) => (axis === AXES[face] ? OUT[face] : 0)), "the order of corners gives the normal");
    const sides = [0, 1, 2].filter((axis) => axis !== AXES[face]);
    corners.forEach(([, , , bits], k) => sides.forEach((axis, s) =>
      assert.equal((bits >> (2 + s)) & 1, places[k][axis] === high[axis] ? 1 : 0, "a corner knows at which end it is")));
    const openness = new Map(corners.map(([, , , bits], k) => [places[k].join(), bits & 3]));
    return { face, low, high, openness, born: mesh.born[n], order: places.map((place) => place.join()) };
  });
}

/** The unit faces of rectangles, `wide` voxels along x and y: "face x y z of the solid cell's low corner" -> rectangle. Each once. */
function unitFaces(all, wide = 1) {
  const found = new Map();
  for (const rectangle of all) {
    const { face, low, high } = rectangle, axis = AXES[face], step = [wide, wide, 1];
    const from = [...low], to = [...high];
    from[axis] = low[axis] - (OUT[face] > 0 ? step[axis] : 0);
    to[axis] = from[axis] + step[axis];
    for (let z = from[2]; z < to[2]; z += step[2]) {
      for (let y = from[1]; y < to[1]; y += step[1]) {
        for (let x = from[0]; x < to[0]; x += step[0]) {
          const key = `${face} ${x} ${y} ${z}`;
          assert.ok(!found.has(key), `${key} is covered twice`);
          found.set(key, rectangle);
        }
      }
    }
  }
  return found;
}
const unitCount = (mesh) => unitFaces(rectangles(mesh)).size;
const next = (p, face) => p.map((c, axis) => c + (axis === AXES[face] ? OUT[face] : 0));

/** Pseudorandom numbers in [0, 1), the same in each run [Park and Miller, 1988]. */
function random(seed) {
  return () => (seed = (seed * 48271) % 2147483647) / 2147483647;
}

/** A map of random voxels in a box, some of them in slabs as walls and floors are, and the list of its solid ones. */
function randomMap(seed, [low, high], share) {
  const draw = random(seed), voxels = [], solid = [];
  for (let z = low[2]; z < high[2]; ++z) {
    for (let y = low[1]; y < high[1]; ++y) {
      for (let x = low[0]; x < high[0]; ++x) {
        const state = z % 7 === 0 || x % 11 === 3 || draw() < share ? (draw() < 0.9 ? OCCUPIED : FREE) : draw() < 0.6 ? FREE : UNKNOWN;
        voxels.push([x, y, z, state]);
        if (state === OCCUPIED) solid.push([x, y, z]);
      }
    }
  }
  return { map: mapOf(voxels), voxels, solid };
}
const BOX = [[-4, -5, 26], [36, 20, 40]]; // over the sides of several chunks

test("A voxel alone has six faces, two side by side have ten", () => {
  assert.equal(unitCount(meshChunk(mapOf([[3, 3, 3, OCCUPIED]]), 0, 0, 0)), 6);
  assert.equal(unitCount(meshChunk(mapOf([[7, 3, 3, OCCUPIED], [8, 3, 3, OCCUPIED]]), 0, 0, 0)), 10);
});

test("Faces between chunks are covered from both sides", () => {
  const map = mapOf([[31, 0, 0, OCCUPIED], [32, 0, 0, OCCUPIED]]);
  assert.equal(unitCount(meshChunk(map, 0, 0, 0)), 5);
  assert.equal(meshChunk(map, 1, 0, 0).count, 5);
});

test("A floor that fills a chunk is six rectangles, and more where a voxel on it casts a shade", () => {
  const floor = [];
  for (let y = 0; y < 32; ++y) for (let x = 0; x < 32; ++x) floor.push([x, y, 5, OCCUPIED]);
  const mesh = meshChunk(mapOf(floor), 0, 0, 0);
  assert.equal(mesh.count, 6);
  assert.equal(unitCount(mesh), 2 * 32 * 32 + 4 * 32);
  const shaded = meshChunk(mapOf([...floor, [16, 16, 6, OCCUPIED]]), 0, 0, 0);
  assert.ok(shaded.count > 6 + 5 + 8, "the shade around a voxel on the floor is lost");
});

test("The border lies between free and unknown voxels only", () => {
  assert.equal(unitCount(meshBorder(mapOf([[3, 3, 3, FREE]]), 0, 0, 0)), 6);
  assert.equal(unitCount(meshBorder(mapOf([[3, 3, 3, FREE], [4, 3, 3, OCCUPIED], [3, 4, 3, FREE]]), 0, 0, 0)), 9);
  assert.equal(meshBorder(mapOf([[3, 3, 3, OCCUPIED]]), 0, 0, 0), null);
});

test("Merged faces cover each face between solid and open voxels once, with its normal and shading", () => {
  for (const [seed, share] of [[1, 0.02], [3, 0.5]]) {
    const { map, solid } = randomMap(seed, BOX, share);
    const isSolid = (p) => map.stateAt(...p) === OCCUPIED;
    const expected = new Set();
    for (const voxel of solid) {
      for (let face = 0; face < 6; ++face) if (!isSolid(next(voxel, face))) expected.add(`${face} ${voxel.join(" ")}`);
    }
    let merged = 0;
    const found = new Map();
    for (const chunk of chunksOf(BOX, 0)) {
      const all = rectangles(meshChunk(map, ...chunk), chunk);
      merged += all.length;
      for (const [key, rectangle] of unitFaces(all)) found.set(key, rectangle);
    }
    assert.deepEqual([...found.keys()].sort(), [...expected].sort());
    assert.ok(merged < expected.size, `${merged} rectangles for ${expected.size} faces`);
    // At each corner of each face: what is interpolated there equals the count of open cells beside it.
    for (const [key, rectangle] of found) {
      const [face, ...voxel] = key.split(" ").map(Number);
      const before = next(voxel, face), sides = [0, 1, 2].filter((axis) => axis !== AXES[face]);
      for (const [a, b] of [[0, 0], [1, 0], [0, 1], [1, 1]]) {
        const beside = (da, db) => isSolid(before.map((c, axis) => c + (axis === sides[0] ? da : axis === sides[1] ? db : 0)));
        const [s, t] = [2 * a - 1, 2 * b - 1];
        const [side, other, diagonal] = [beside(s, 0), beside(0, t), beside(s, t)].map(Number);
        const open = side && other ? 0 : 3 - side - other - diagonal;
        const place = voxel.map((c, axis) => c + (axis === AXES[face] ? (OUT[face] > 0 ? 1 : 0) : axis === sides[0] ? a : b));
        assert.equal(shadeAt(rectangle, place, sides), open, `${key} at ${place}`);
      }
    }
  }
});

/** The openness of a rectangle at a place on it, as its two triangles interpolate it. */
function shadeAt({ low, high, order, openness }, place, sides) {
  const [u, v] = sides.map((axis) => (place[axis] - low[axis]) / (high[axis] - low[axis]));
  const value = (a, b) => {
    const corner = [...low];
    if (a) corner[sides[0]] = high[sides[0]];
    if (b) corner[sides[1]] = high[sides[1]];
    return openness.get(corner.join());
  };
  // The triangles 0, 1, 2 and 0, 2, 3 share the diagonal from the first corner to the third.
  const first = order[0].split(",").map(Number), rising = (first[sides[0]] === low[sides[0]]) === (first[sides[1]] === low[sides[1]]);
  const [p00, p10, p01, p11] = [value(0, 0), value(1, 0), value(0, 1), value(1, 1)];
  if (rising) return u >= v ? p00 + u * (p10 - p00) + v * (p11 - p10) : p00 + v * (p01 - p00) + u * (p11 - p01);
  return u + v <= 1 ? p00 + u * (p10 - p00) + v * (p01 - p00) : p11 + (1 - u) * (p01 - p11) + (1 - v) * (p10 - p11);
}

/** The chunks of a level that a box meets. */
function chunksOf([low, high], level) {
  const width = [32 << level, 32 << level, 32], chunks = [];
  const [from, to] = [low, high.map((c) => c - 1)].map((p) => p.map((c, axis) => Math.floor(c / width[axis])));
  for (let z = from[2]; z <= to[2]; ++z) for (let y = from[1]; y <= to[1]; ++y) for (let x = from[0]; x <= to[0]; ++x) chunks.push([x, y, z]);
  return chunks;
}

test("A coarse chunk has every cell with an occupied voxel, no other, and its heights are exact", () => {
  for (const level of LEVELS.slice(1)) {
    const wide = 1 << level, { map, solid } = randomMap(4, BOX, 0.02);
    const cellOf = ([x, y, z]) => [x & -wide, y & -wide, z], solidCells = new Set(solid.map((voxel) => cellOf(voxel).join(" ")));
    for (const chunk of chunksOf(BOX, level)) {
      const mine = ([x, y, z]) => x >> (5 + level) === chunk[0] && y >> (5 + level) === chunk[1] && z >> 5 === chunk[2];
      const found = unitFaces(rectangles(meshChunk(map, ...chunk, level), chunk, level), wide);
      for (const key of found.keys()) {
        const [, ...cell] = key.split(" ");
        assert.ok(solidCells.has(cell.join(" ")), `the cell at ${cell} is free`);
      }
      for (const key of solidCells) {
        const cell = key.split(" ").map(Number);
        if (!mine(cell)) continue;
        for (let face = 0; face < 6; ++face) {
          const beyond = cell.map((c, axis) => c + (axis === AXES[face] ? OUT[face] * (axis === 2 ? 1 : wide) : 0));
          if (mine(beyond)) assert.equal(found.has(`${face} ${key}`), !solidCells.has(beyond.join(" ")), `face ${face} of ${key}`);
          else if (!solidCells.has(beyond.join(" "))) assert.ok(found.has(`${face} ${key}`), `face ${face} of ${key} at the side of its chunk`);
        }
      }
    }
  }
});

test("Where chunks of any two levels meet, each open place beside a solid one has a face between them", () => {
  const { map } = randomMap(6, [[20, 0, 0], [140, 24, 12]], 0.03);
  const solidAt = (p, level) => {
    for (let dy = 0; dy < 1 << level; ++dy) {
      for (let dx = 0; dx < 1 << level; ++dx) if (map.stateAt((p[0] & -(1 << level)) + dx, (p[1] & -(1 << level)) + dy, p[2]) === OCCUPIED) return true;
    }
    return false;
  };
  for (const left of LEVELS) {
    for (const right of LEVELS) {
      // The side at x = 128 belongs to chunks of each level.
      const meshes = [[left, (128 >> (5 + left)) - 1, 0], [right, 128 >> (5 + right), 1]].map(([level, x, face]) => {
        const found = unitFaces(rectangles(meshChunk(map, x, 0, 0, level), [x, 0, 0], level), 1 << level);
        return (p) => found.has(`${face} ${p[0] & -(1 << level)} ${p[1] & -(1 << level)} ${p[2]}`);
      });
      let faces = 0;
      for (let z = 0; z < 12; ++z) {
        for (let y = 0; y < 24; ++y) {
          const [near, far] = [[127, y, z], [128, y, z]], [a, b] = [solidAt(near, left), solidAt(far, right)];
          if (a && !b) assert.ok(meshes[0](near), `levels ${left}, ${right}: a hole at ${near}`);
          if (b && !a) assert.ok(meshes[1](far), `levels ${left}, ${right}: a hole at ${far}`);
          faces += a !== b ? 1 : 0;
        }
      }
      assert.ok(faces > 20);
    }
  }
});

test("Only faces that were born together are merged, and a cell is as old as its oldest voxel", () => {
  const { map, solid } = randomMap(8, BOX, 0.05);
  const bornAt = (x, y) => (x + 2 * y > 10 ? 200 : 3);
  for (const level of LEVELS) {
    const wide = 1 << level, oldest = new Map();
    for (const [x, y, z] of solid) {
      const key = [x & -wide, y & -wide, z].join(" ");
      oldest.set(key, Math.min(oldest.get(key) ?? Infinity, bornAt(x, y)));
    }
    const times = new Set();
    for (const chunk of chunksOf(BOX, level)) {
      for (const [key, { born }] of unitFaces(rectangles(meshChunk(map, ...chunk, level, bornAt), chunk, level), wide)) {
        assert.equal(born, oldest.get(key.split(" ").slice(1).join(" ")));
        times.add(born);
      }
    }
    assert.deepEqual([...times].sort(), [200, 3]);
  }
});

test("The merged border is that of brute force", () => {
  const { map, voxels } = randomMap(9, BOX, 0.05);
  const expected = [];
  for (const [x, y, z, state] of voxels) {
    for (let face = 0; face < 6 && state === FREE; ++face) {
      if (map.stateAt(...next([x, y, z], face)) === UNKNOWN) expected.push(`${face} ${x} ${y} ${z}`);
    }
  }
  const found = chunksOf(BOX, 0).flatMap((chunk) => [...unitFaces(rectangles(meshBorder(map, ...chunk), chunk)).keys()]);
  assert.deepEqual(found.sort(), expected.sort());
});

test("A ray finds the voxel that is nearest by the ray's distance to each of them, below any cut", () => {
  const draw = random(12), { map, solid } = randomMap(11, [[0, 0, 0], [24, 24, 24]], 0.01);
  let hits = 0, cut = 0;
  for (let n = 0; n < 150; ++n) {
    const origin = [0, 1, 2].map(() => 60 * draw() - 20), to = [0, 1, 2].map(() => 24 * draw());
    const length = Math.hypot(...to.map((c, k) => c - origin[k])), direction = to.map((c, k) => (c - origin[k]) / length);
    const top = n % 2 ? 24 * draw() : Infinity;
    if (map.stateAt(...origin.map(Math.floor)) === OCCUPIED) continue;
    let nearest = Infinity;
    for (const voxel of solid) {
      if (voxel[2] >= top) continue;
      // Where the ray is between both planes of each axis.
      const spans = voxel.map((c, k) => [(c - origin[k]) / direction[k], (c + 1 - origin[k]) / direction[k]].sort((a, b) => a - b));
      const enters = Math.max(...spans.map(([from]) => from)), leaves = Math.min(...spans.map(([, until]) => until));
      if (enters >= 0 && enters < leaves) nearest = Math.min(nearest, enters);
    }
    const hit = map.cast(origin, direction, 200, top);
    assert.ok(nearest === Infinity ? hit === null : Math.abs(hit.distance - nearest) < 1e-9, `ray ${n}: ${hit?.distance}, not ${nearest}`);
    if (hit) ++hits;
    if (hit && top < Infinity) ++cut;
  }
  assert.ok(hits > 80 && cut > 20, `${hits} hits, ${cut} of them below a cut`);
});

test("A ray passes what lies above the cut", () => {
  const map = mapOf([[0, 0, 5, OCCUPIED], [0, 0, 0, OCCUPIED]]);
  assert.equal(map.cast([0.5, 0.5, 9.5], [0, 0, -1], 20).distance, 3.5);
  assert.deepEqual(map.cast([0.5, 0.5, 9.5], [0, 0, -1], 20, 5), { distance: 8.5, normal: [0, 0, 1] });
  assert.equal(map.cast([0.5, 0.5, -3.5], [0, 0, -1], 20), null);
});
