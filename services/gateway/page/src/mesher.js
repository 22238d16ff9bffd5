// Turns the states of voxels into the visible faces of the occupied ones.

export const UNKNOWN = 0, FREE = 1, OCCUPIED = 2;
export const EDGE = 8; // voxels along a block
export const CHUNK = 32; // voxels along a chunk, which is drawn in one call

/** The states of a map's voxels, by block. */
export class Voxels {
  #blocks = new Map();
  static #key(x, y, z) {
    return (x + 8192) * 268435456 + (y + 8192) * 16384 + (z + 8192);
  }

  clear() {
    this.#blocks.clear();
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
    const key = Voxels.#key(x, y, z);
    const before = this.#blocks.get(key);
    const states = new Uint8Array(512);
    let known = 0, occupied = 0;
    for (let n = 0; n < 128; ++n) {
      const four = octets[n];
      for (let k = 0; k < 4; ++k) {
        const state = (four >> (2 * k)) & 3;
        states[4 * n + k] = state;
        if (state !== UNKNOWN) ++known;
        if (state === OCCUPIED) ++occupied;
      }
    }
    this.#blocks.set(key, { states, known, occupied });
    return occupied > 0 || (before?.occupied ?? 0) > 0;
  }

  block(x, y, z) {
    return this.#blocks.get(Voxels.#key(x, y, z));
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

// For each face: its normal, and the two axes along it, so that (u, v, normal) is right-handed.
const FACES = [
  { n: [1, 0, 0], u: [0, 1, 0], v: [0, 0, 1] },
  { n: [-1, 0, 0], u: [0, 0, 1], v: [0, 1, 0] },
  { n: [0, 1, 0], u: [0, 0, 1], v: [1, 0, 0] },
  { n: [0, -1, 0], u: [1, 0, 0], v: [0, 0, 1] },
  { n: [0, 0, 1], u: [1, 0, 0], v: [0, 1, 0] },
  { n: [0, 0, -1], u: [0, 1, 0], v: [1, 0, 0] },
];
const SIZE = CHUNK + 2; // with a border of one voxel
const cells = new Uint8Array(SIZE ** 3); // states of the voxels of a chunk and its border
const at = (x, y, z) => (z * SIZE + y) * SIZE + x;
const STEP = (a) => a[0] + SIZE * (a[1] + SIZE * a[2]);

/** Copies the states of a chunk to `cells`. Returns whether any of its voxels is [occupied, free]. */
function fill(voxels, cx, cy, cz) {
  cells.fill(UNKNOWN);
  let occupied = false, free = false;
  const perChunk = CHUNK / EDGE;
  for (let bz = -1; bz <= perChunk; ++bz) {
    for (let by = -1; by <= perChunk; ++by) {
      for (let bx = -1; bx <= perChunk; ++bx) {
        const block = voxels.block(cx * perChunk + bx, cy * perChunk + by, cz * perChunk + bz);
        if (!block || block.known === 0) continue;
        occupied ||= block.occupied > 0;
        free ||= block.known > block.occupied;
        const range = (b) => (b < 0 ? [EDGE - 1, EDGE] : b === perChunk ? [0, 1] : [0, EDGE]);
        const [x0, x1] = range(bx), [y0, y1] = range(by), [z0, z1] = range(bz);
        for (let z = z0; z < z1; ++z) {
          for (let y = y0; y < y1; ++y) {
            const row = (z * EDGE + y) * EDGE, to = at(bx * EDGE + 1, by * EDGE + y + 1, bz * EDGE + z + 1);
            for (let x = x0; x < x1; ++x) cells[to + x] = block.states[row + x];
          }
        }
      }
    }
  }
  return [occupied, free];
}

function packed(position, index) {
  return index.length === 0 ? null : { position: new Uint8Array(position), index: new Uint32Array(index) };
}

/** One face of a voxel of the chunk: its four corners, each with what `shade` gives it. */
function pushFace(position, x, y, z, { n, u, v }, shade) {
  for (let corner = 0; corner < 4; ++corner) {
    const a = corner === 1 || corner === 2 ? 1 : 0, b = corner >= 2 ? 1 : 0;
    position.push(
      x - 1 + a * u[0] + b * v[0] + (n[0] > 0 ? 1 : 0),
      y - 1 + a * u[1] + b * v[1] + (n[1] > 0 ? 1 : 0),
      z - 1 + a * u[2] + b * v[2] + (n[2] > 0 ? 1 : 0),
      shade(a, b),
    );
  }
}

/**
 * The border to the unknown: the faces between a chunk's free voxels and unknown ones, in the form of
 * meshChunk. The robot's frontiers lie there; where the border is gone, everything is known.
 */
export function meshBorder(voxels, cx, cy, cz) {
  const [, free] = fill(voxels, cx, cy, cz);
  if (!free) return null;
  const position = [], index = [];
  for (let f = 0; f < 6; ++f) {
    const dn = STEP(FACES[f].n);
    for (let z = 1; z <= CHUNK; ++z) {
      for (let y = 1; y <= CHUNK; ++y) {
        for (let x = 1; x <= CHUNK; ++x) {
          const here = at(x, y, z);
          if (cells[here] !== FREE || cells[here + dn] !== UNKNOWN) continue;
          const first = position.length / 4;
          pushFace(position, x, y, z, FACES[f], () => 8 * f + 3);
          index.push(first, first + 1, first + 2, first, first + 2, first + 3);
        }
      }
    }
  }
  return packed(position, index);
}

/**
 * The faces of a chunk's occupied voxels that no other occupied voxel covers.
 * @returns { position: Uint8Array, 4 per vertex: x, y, z within the chunk, and 8 * face + openness 0..3;
 *            index: Uint32Array } or null if there is no face.
 * Openness darkens a corner by the three voxels beside it, which lets edges and furniture stand out.
 */
export function meshChunk(voxels, cx, cy, cz) {
  const [occupied] = fill(voxels, cx, cy, cz);
  if (!occupied) return null;
  const position = [], index = [];
  const solid = (k) => (cells[k] === OCCUPIED ? 1 : 0);
  for (let f = 0; f < 6; ++f) {
    const dn = STEP(FACES[f].n), du = STEP(FACES[f].u), dv = STEP(FACES[f].v);
    for (let z = 1; z <= CHUNK; ++z) {
      for (let y = 1; y <= CHUNK; ++y) {
        for (let x = 1; x <= CHUNK; ++x) {
          const here = at(x, y, z);
          if (cells[here] !== OCCUPIED || cells[here + dn] === OCCUPIED) continue;
          const first = position.length / 4;
          const open = [];
          pushFace(position, x, y, z, FACES[f], (a, b) => {
            const su = a ? du : -du, sv = b ? dv : -dv;
            const s1 = solid(here + dn + su), s2 = solid(here + dn + sv), s3 = solid(here + dn + su + sv);
            open.push(s1 && s2 ? 0 : 3 - s1 - s2 - s3);
            return 8 * f + open.at(-1);
          });
          // The diagonal joins the more open corners, so that shading does not depend on the winding.
          if (open[0] + open[2] >= open[1] + open[3]) index.push(first, first + 1, first + 2, first, first + 2, first + 3);
          else index.push(first + 1, first + 2, first + 3, first + 1, first + 3, first);
        }
      }
    }
  }
  return packed(position, index);
}

/** When the voxel behind each vertex of meshChunk became known: all four of a face have its voxel's. */
export function facesBorn(position, cx, cy, cz, bornAt) {
  const born = new Float32Array(position.length / 4);
  for (let first = 0; first < born.length; first += 4) {
    const { n } = FACES[position[4 * first + 3] >> 3];
    const low = [0, 1, 2].map((axis) => {
      let least = 255;
      for (let k = 0; k < 4; ++k) least = Math.min(least, position[4 * (first + k) + axis]);
      return least - (n[axis] > 0 ? 1 : 0);
    });
    born.fill(bornAt(cx * CHUNK + low[0], cy * CHUNK + low[1], cz * CHUNK + low[2]), first, first + 4);
  }
  return born;
}
