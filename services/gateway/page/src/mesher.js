// Turns the states of voxels into the visible faces of the occupied ones, merged to rectangles.

export const UNKNOWN = 0, FREE = 1, OCCUPIED = 2;
export const EDGE = 8; // voxels along a block
export const CHUNK = 32; // cells along a chunk, which is drawn in one call

/** A number that no other block within 8192 blocks of the origin has. */
export const blockKey = (x, y, z) => (x + 8192) * 268435456 + (y + 8192) * 16384 + (z + 8192);

/** The states of a map's voxels, by block. */
export class Voxels {
  #blocks = new Map();

  /** Bottom of the lowest and top of the highest voxel that was occupied since the map was empty. */
  low = Infinity;
  high = -Infinity;

  clear() {
    this.#blocks.clear();
    this.low = Infinity;
    this.high = -Infinity;
  }

  /** The state of a voxel, by its indices. */
  stateAt(x, y, z) {
    const block = this.block(Math.floor(x / EDGE), Math.floor(y / EDGE), Math.floor(z / EDGE));
    return block ? block.states[((z & (EDGE - 1)) * EDGE + (y & (EDGE - 1))) * EDGE + (x & (EDGE - 1))] : UNKNOWN;
  }

  /**
   * The first occupied voxel along a ray, in units of voxels, by stepping from voxel to voxel
   * [Amanatides and Woo, A Fast Voxel Traversal Algorithm for Ray Tracing, Eurographics 1987].
   * Voxels whose bottom lies at `top` or above are passed. Returns { distance, normal } or null.
   */
  cast(origin, direction, reach, top = Infinity) {
    const cell = origin.map(Math.floor), step = direction.map(Math.sign);
    const delta = direction.map((d) => (d === 0 ? Infinity : Math.abs(1 / d)));
    const next = origin.map((o, k) => (step[k] === 0 ? Infinity : (step[k] > 0 ? cell[k] + 1 - o : o - cell[k]) * delta[k]));
    let distance = 0, axis = -1;
    while (distance < reach) {
      if (axis >= 0 && cell[2] < top && this.stateAt(...cell) === OCCUPIED) {
        return { distance, normal: [0, 1, 2].map((k) => (k === axis ? -step[k] : 0)) };
      }
      axis = next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : next[1] < next[2] ? 1 : 2;
      distance = next[axis];
      next[axis] += delta[axis];
      cell[axis] += step[axis];
    }
    return null;
  }

  /** @param octets 128 octets, 2 bits a voxel, x fastest. Returns whether any voxel is or was occupied. */
  setBlock(x, y, z, octets) {
    const key = blockKey(x, y, z);
    const before = this.#blocks.get(key);
    const states = new Uint8Array(512);
    let known = 0, occupied = 0;
    for (let k = 0; k < 512; ++k) {
      const state = (octets[k >> 2] >> (2 * (k & 3))) & 3;
      states[k] = state;
      if (state !== UNKNOWN) ++known;
      if (state !== OCCUPIED) continue;
      ++occupied;
      const height = z * EDGE + (k >> 6);
      if (height < this.low) this.low = height;
      if (height >= this.high) this.high = height + 1;
    }
    this.#blocks.set(key, { states, known, occupied });
    return occupied > 0 || (before?.occupied ?? 0) > 0;
  }

  block(x, y, z) {
    return this.#blocks.get(blockKey(x, y, z));
  }

  get blockCount() {
    return this.#blocks.size;
  }

  counts() {
    let known = 0, occupied = 0;
    for (const block of this.#blocks.values()) {
      known += block.known;
      occupied += block.occupied;
    }
    return { known, occupied };
  }
}

// For each face: the axes of its normal and, so that (u, v, normal) is right-handed, of its sides.
const FACES = [
  { n: 0, out: 1, u: 1, v: 2 },
  { n: 0, out: -1, u: 2, v: 1 },
  { n: 1, out: 1, u: 2, v: 0 },
  { n: 1, out: -1, u: 0, v: 2 },
  { n: 2, out: 1, u: 0, v: 1 },
  { n: 2, out: -1, u: 1, v: 0 },
];
const PLAIN = 2;
const SIZE = CHUNK + 2; // with a border of one cell
const STEP = [1, SIZE, SIZE * SIZE]; // from a cell to the next one along each axis
const cells = new Uint8Array(SIZE ** 3); // of a chunk and its border: states of voxels, or 1 = solid
const bornOf = new Float32Array(SIZE ** 3); // of the solid cells within
const at = (x, y, z) => x + SIZE * (y + SIZE * z);

/** Calls visit(block, [bx, by, bz], [[x0, x1], [y0, y1], [z0, z1]]) for the blocks of a chunk and of the voxels around it. */
function visitBlocks(voxels, cx, cy, cz, level, visit) {
  const wide = (CHUNK / EDGE) << level, tall = CHUNK / EDGE;
  const range = (b, end) => (b < 0 ? [EDGE - 1, EDGE] : b === end ? [0, 1] : [0, EDGE]);
  for (let bz = -1; bz <= tall; ++bz) {
    for (let by = -1; by <= wide; ++by) {
      for (let bx = -1; bx <= wide; ++bx) {
        const block = voxels.block(cx * wide + bx, cy * wide + by, cz * tall + bz);
        if (block) visit(block, [bx, by, bz], [range(bx, wide), range(by, wide), range(bz, tall)]);
      }
    }
  }
}

/** Sets `cells` to the states of a chunk's voxels. Returns whether any of them is free. */
function fillStates(voxels, cx, cy, cz) {
  cells.fill(UNKNOWN);
  let free = false;
  visitBlocks(voxels, cx, cy, cz, 0, (block, [bx, by, bz], [[x0, x1], [y0, y1], [z0, z1]]) => {
    free ||= block.known > block.occupied;
    for (let z = z0; z < z1; ++z) {
      for (let y = y0; y < y1; ++y) {
        const row = (z * EDGE + y) * EDGE, to = at(bx * EDGE + 1, by * EDGE + y + 1, bz * EDGE + z + 1);
        for (let x = x0; x < x1; ++x) cells[to + x] = block.states[row + x];
      }
    }
  });
  return free;
}

/**
 * Sets `cells` to 1 where a chunk is solid. Returns whether it is anywhere.
 * A cell is solid if any of its voxels is occupied. One beyond the chunk hides a face of the chunk only if all voxels
 * at that face are occupied: so the faces meet without a gap whatever the level of the chunk beyond.
 */
function fillSolid(voxels, cx, cy, cz, level, bornAt) {
  cells.fill(0);
  if (bornAt) bornOf.fill(Infinity);
  const wide = (CHUNK / EDGE) << level, tall = CHUNK / EDGE;
  let any = false;
  visitBlocks(voxels, cx, cy, cz, level, (block, [bx, by, bz], [[x0, x1], [y0, y1], [z0, z1]]) => {
    if (block.occupied === 0) return;
    const within = bx >= 0 && bx < wide && by >= 0 && by < wide && bz >= 0 && bz < tall;
    any ||= within;
    for (let z = z0; z < z1; ++z) {
      for (let y = y0; y < y1; ++y) {
        const row = (z * EDGE + y) * EDGE, to = at(1, ((by * EDGE + y) >> level) + 1, bz * EDGE + z + 1);
        for (let x = x0; x < x1; ++x) {
          if (block.states[row + x] !== OCCUPIED) continue;
          const cell = to + ((bx * EDGE + x) >> level);
          cells[cell] = within ? 1 : cells[cell] + 1;
          if (!bornAt || !within) continue;
          const born = bornAt((cx * wide + bx) * EDGE + x, (cy * wide + by) * EDGE + y, (cz * tall + bz) * EDGE + z);
          if (born < bornOf[cell]) bornOf[cell] = born;
        }
      }
    }
  });
  if (!any || level === 0) return any;
  for (let z = 0; z < SIZE; ++z) {
    for (let y = 0; y < SIZE; ++y) {
      const inner = y > 0 && y <= CHUNK, step = inner && z > 0 && z <= CHUNK ? SIZE - 1 : 1;
      for (let x = 0; x < SIZE; x += step) {
        const all = (x > 0 && x <= CHUNK ? 1 << level : 1) * (inner ? 1 << level : 1);
        cells[at(x, y, z)] = cells[at(x, y, z)] === all ? 1 : 0;
      }
    }
  }
  return any;
}

// What the faces of a chunk are gathered in: 4 octets a corner, and one time a rectangle.
let position = new Uint8Array(1 << 16), born = new Float32Array(1 << 12), count = 0;

/** Adds the rectangle of a face's slice `layer` that begins at cell (a, b) of it. */
function push({ n, out, u, v }, face, layer, a, b, width, height, open, time) {
  if (16 * (count + 1) > position.length) {
    const [smaller, fewer] = [position, born];
    position = new Uint8Array(2 * smaller.length);
    born = new Float32Array(2 * fewer.length);
    position.set(smaller);
    born.set(fewer);
  }
  // The diagonal joins the more open corners, so that shading does not depend on the winding.
  const first = open[0] + open[2] >= open[1] + open[3] ? 0 : 1;
  for (let k = 0; k < 4; ++k) {
    const corner = (first + k) & 3, to = 16 * count + 4 * k;
    const right = corner === 1 || corner === 2 ? 1 : 0, up = corner >= 2 ? 1 : 0;
    position[to + n] = layer + (out > 0 ? 1 : 0);
    position[to + u] = a + right * width;
    position[to + v] = b + up * height;
    position[to + 3] = (face << 4) | ((u < v ? up : right) << 3) | ((u < v ? right : up) << 2) | open[corner];
  }
  born[count++] = time;
}

const slice = new Int32Array(CHUNK * CHUNK); // keys of the faces of a slice of the chunk, 0 = none
const open = [0, 0, 0, 0];

/**
 * Merges the chunk's faces to rectangles, slice by slice, row by row. Faces of equal key are merged along a side if their
 * openness is constant along it, so that a rectangle is shaded as its faces were.
 * @param keyOf (cell, the cell before the face, steps along u and v) -> 0 = no face, or 1 + openness of the four corners
 *              (2 bits each) + 512 * when the face was born
 */
function mergeFaces(keyOf) {
  count = 0;
  for (let f = 0; f < 6; ++f) {
    const face = FACES[f], dn = STEP[face.n] * face.out, du = STEP[face.u], dv = STEP[face.v];
    for (let layer = 0; layer < CHUNK; ++layer) {
      let faces = 0;
      for (let b = 0, k = 0; b < CHUNK; ++b) {
        let cell = (layer + 1) * STEP[face.n] + du + (b + 1) * dv;
        for (let a = 0; a < CHUNK; ++a, ++k, cell += du) {
          slice[k] = cells[cell] === 0 ? 0 : keyOf(cell, cell + dn, du, dv);
          if (slice[k] !== 0) ++faces;
        }
      }
      for (let k = 0; faces > 0; ++k) {
        const key = slice[k];
        if (key === 0) continue;
        for (let corner = 0; corner < 4; ++corner) open[corner] = ((key - 1) >> (2 * corner)) & 3;
        const a = k % CHUNK, b = (k - a) / CHUNK;
        let width = 1, height = 1;
        if (open[0] === open[1] && open[3] === open[2]) while (a + width < CHUNK && slice[k + width] === key) ++width;
        if (open[0] === open[3] && open[1] === open[2]) while (b + height < CHUNK && isRow(k + height * CHUNK, width, key)) ++height;
        for (let row = 0; row < height; ++row) slice.fill(0, k + row * CHUNK, k + row * CHUNK + width);
        faces -= width * height;
        push(face, f, layer, a, b, width, height, open, (key - 1) >> 9);
      }
    }
  }
  return count === 0 ? null : { position: position.slice(0, 16 * count), born: born.slice(0, count), count };
}
function isRow(from, width, key) {
  for (let k = from; k < from + width; ++k) if (slice[k] !== key) return false;
  return true;
}

/**
 * The border to the unknown: the faces between a chunk's free voxels and unknown ones, in the form of
 * meshChunk. The robot's frontiers lie there; where the border is gone, everything is known.
 */
export function meshBorder(voxels, cx, cy, cz) {
  if (!fillStates(voxels, cx, cy, cz)) return null;
  return mergeFaces((cell, before) => (cells[cell] === FREE && cells[before] === UNKNOWN ? 256 : 0));
}

/** Openness of a corner by the three cells beside it before the face: 3 = none of them is solid. */
const openness = (side, other, diagonal) => (side + other === 2 ? 0 : 3 - side - other - diagonal);

/**
 * The faces of a chunk's solid cells that no other solid cell covers, merged to rectangles.
 * At level n a cell, which is solid if any of its voxels is, spans 2^n voxels along x and y, and one along z: so heights,
 * by which the map is colored and cut, are exact at each level.
 * @param bornAt (x, y, z of a voxel) -> when it became known, a whole number below 2^22, or undefined. Only faces of
 *               equal times are merged; a cell has the time of its earliest voxel.
 * @returns { position: Uint8Array, four corners a rectangle, 4 octets a corner: x, y, z within the chunk in cells, and
 *            16 * face + 8, 4 where the corner is at the far end of its second, first side in the order of axes + openness 0..3;
 *            born: Float32Array, a time a rectangle; count: of rectangles } or null if there is no face.
 * Openness darkens a corner by the three cells beside it, which lets edges and furniture stand out; from level PLAIN on,
 * where voxels are too small for it to be seen, it is 3.
 */
export function meshChunk(voxels, cx, cy, cz, level = 0, bornAt = undefined) {
  if (!fillSolid(voxels, cx, cy, cz, level, bornAt)) return null;
  return mergeFaces((cell, before, du, dv) => {
    if (cells[before] !== 0) return 0;
    const time = bornAt ? 512 * bornOf[cell] : 0;
    if (level >= PLAIN) return 256 + time;
    const left = cells[before - du], right = cells[before + du], below = cells[before - dv], above = cells[before + dv];
    return time + 1 + openness(left, below, cells[before - du - dv]) + 4 * openness(right, below, cells[before + du - dv]) +
      16 * openness(right, above, cells[before + du + dv]) + 64 * openness(left, above, cells[before - du + dv]);
  });
}
