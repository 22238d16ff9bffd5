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
const solid = new Uint8Array(SIZE ** 3);
const at = (x, y, z) => (z * SIZE + y) * SIZE + x;
const STEP = (a) => a[0] + SIZE * (a[1] + SIZE * a[2]);

function fill(voxels, cx, cy, cz) {
  solid.fill(0);
  let any = false;
  const perChunk = CHUNK / EDGE;
  for (let bz = -1; bz <= perChunk; ++bz) {
    for (let by = -1; by <= perChunk; ++by) {
      for (let bx = -1; bx <= perChunk; ++bx) {
        const block = voxels.block(cx * perChunk + bx, cy * perChunk + by, cz * perChunk + bz);
        if (!block || block.occupied === 0) continue;
        const range = (b) => (b < 0 ? [EDGE - 1, EDGE] : b === perChunk ? [0, 1] : [0, EDGE]);
        const [x0, x1] = range(bx), [y0, y1] = range(by), [z0, z1] = range(bz);
        for (let z = z0; z < z1; ++z) {
          for (let y = y0; y < y1; ++y) {
            for (let x = x0; x < x1; ++x) {
              if (block.states[(z * EDGE + y) * EDGE + x] !== OCCUPIED) continue;
              solid[at(bx * EDGE + x + 1, by * EDGE + y + 1, bz * EDGE + z + 1)] = 1;
              any = true;
            }
          }
        }
      }
    }
  }
  return any;
}

/**
 * The faces of a chunk's occupied voxels that no other occupied voxel covers.
 * @returns { position: Uint8Array, 4 per vertex: x, y, z within the chunk, and 8 * face + openness 0..3;
 *            index: Uint32Array } or null if there is no face.
 * Openness darkens a corner by the three voxels beside it, which lets edges and furniture stand out.
 */
export function meshChunk(voxels, cx, cy, cz) {
  if (!fill(voxels, cx, cy, cz)) return null;
  const position = [], index = [];
  for (let f = 0; f < 6; ++f) {
    const { n, u, v } = FACES[f];
    const dn = STEP(n), du = STEP(u), dv = STEP(v);
    for (let z = 1; z <= CHUNK; ++z) {
      for (let y = 1; y <= CHUNK; ++y) {
        for (let x = 1; x <= CHUNK; ++x) {
          const here = at(x, y, z);
          if (!solid[here] || solid[here + dn]) continue;
          const first = position.length / 4;
          const open = [];
          for (let corner = 0; corner < 4; ++corner) {
            const a = corner === 1 || corner === 2 ? 1 : 0, b = corner >= 2 ? 1 : 0;
            const su = a ? du : -du, sv = b ? dv : -dv;
            const s1 = solid[here + dn + su], s2 = solid[here + dn + sv], s3 = solid[here + dn + su + sv];
            const openness = s1 && s2 ? 0 : 3 - s1 - s2 - s3;
            open.push(openness);
            position.push(
              x - 1 + a * u[0] + b * v[0] + (n[0] > 0 ? 1 : 0),
              y - 1 + a * u[1] + b * v[1] + (n[1] > 0 ? 1 : 0),
              z - 1 + a * u[2] + b * v[2] + (n[2] > 0 ? 1 : 0),
              8 * f + openness,
            );
          }
          // The diagonal joins the more open corners, so that shading does not depend on the winding.
          if (open[0] + open[2] >= open[1] + open[3]) index.push(first, first + 1, first + 2, first, first + 2, first + 3);
          else index.push(first + 1, first + 2, first + 3, first + 1, first + 3, first);
        }
      }
    }
  }
  if (index.length === 0) return null;
  return { position: new Uint8Array(position), index: new Uint32Array(index) };
}
