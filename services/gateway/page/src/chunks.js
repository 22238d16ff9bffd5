// Which parts of the map are drawn at which resolution: a tree of chunks, of which the near ones are drawn by their children.
import { CHUNK, EDGE } from "./mesher.js";

export const LEVELS = 3; // a chunk of level n has cells of 2^n voxels along x and y
// [pixels] From this size of its cells on a chunk is drawn by its children; below the other it is drawn itself again.
const SPLIT = 2, JOIN = 1.5;

export class Chunk {
  children = [];
  mesh = null; // for who draws it
  built = false; // whether its faces have been made
  dirty = false; // whether voxels have changed since
  texture = null; // of its cells' colors, for who draws it
  painted = false; // whether that is of the colors as they are
  split = false; // whether it is near enough to be drawn by its children
  open = false; // whether it is, since they were all built

  constructor(level, x, y, z) {
    Object.assign(this, { level, x, y, z });
  }

  /** Voxels along x and y; along z there are CHUNK at each level. */
  get width() {
    return CHUNK << this.level;
  }

  distanceTo([x, y, z]) {
    const off = (c, low, width) => Math.max(low - c, 0, c - low - width);
    return Math.hypot(off(x, this.x * this.width, this.width), off(y, this.y * this.width, this.width), off(z, this.z * CHUNK, CHUNK));
  }
}

export class ChunkTree {
  #levels = Array.from({ length: LEVELS }, () => new Map()); // "x,y,z" -> Chunk

  clear() {
    for (const level of this.#levels) level.clear();
  }

  /** All chunks of a level. */
  at(level) {
    return this.#levels[level].values();
  }

  /** The chunk of level 0 that holds a block, with its parents. */
  add(x, y, z) {
    const perChunk = CHUNK / EDGE;
    return this.#chunk(0, Math.floor(x / perChunk), Math.floor(y / perChunk), Math.floor(z / perChunk));
  }
  #chunk(level, x, y, z) {
    const key = `${x},${y},${z}`;
    let chunk = this.#levels[level].get(key);
    if (chunk) return chunk;
    chunk = new Chunk(level, x, y, z);
    this.#levels[level].set(key, chunk);
    if (level + 1 < LEVELS) this.#chunk(level + 1, x >> 1, y >> 1, z).children.push(chunk);
    return chunk;
  }

  /** The chunks of all levels that hold a block. */
  holding(x, y, z) {
    const of = (level) => [x, y].map((c) => Math.floor((c * EDGE) / (CHUNK << level)));
    return this.#levels.map((chunks, level) => chunks.get(`${of(level)},${Math.floor((z * EDGE) / CHUNK)}`)).filter(Boolean);
  }

  /** Calls visit(chunk) for the chunks of all levels whose faces or shading depend on a block: of it and its neighbors. */
  forEachAround(x, y, z, visit) {
    this.#levels.forEach((chunks, level) => {
      const wide = (CHUNK / EDGE) << level, tall = CHUNK / EDGE;
      for (let cz = Math.floor((z - 1) / tall); cz <= Math.floor((z + 1) / tall); ++cz) {
        for (let cy = Math.floor((y - 1) / wide); cy <= Math.floor((y + 1) / wide); ++cy) {
          for (let cx = Math.floor((x - 1) / wide); cx <= Math.floor((x + 1) / wide); ++cx) {
            const chunk = chunks.get(`${cx},${cy},${cz}`);
            if (chunk) visit(chunk);
          }
        }
      }
    });
  }

  /**
   * The chunks that draw the map as seen from a place: every voxel by one of them, if all that it needs are built.
   * @param eye   in voxels; null = everything at level 0
   * @param focal how many pixels a voxel at distance 1 fills
   * @returns { shown: those to draw, wanted: those to build, the coarse ones first, which give a picture soon }
   */
  choose(eye, focal) {
    const shown = [], wanted = [];
    const showBuilt = (chunk) => (chunk.built ? shown.push(chunk) : chunk.children.forEach(showBuilt));
    const visit = (chunk) => {
      const pixels = eye && (focal * 2 ** chunk.level) / Math.max(chunk.distanceTo(eye), 1);
      chunk.split = chunk.level > 0 && (eye === null || pixels > (chunk.split ? JOIN : SPLIT));
      const missing = chunk.split && eye ? chunk.children.filter(({ built }) => !built) : [];
      chunk.open = chunk.split && (chunk.open || missing.length === 0);
      if (chunk.open) return chunk.children.forEach(visit);
      wanted.push(...missing);
      if (!chunk.built) wanted.push(chunk);
      showBuilt(chunk);
    };
    for (const root of this.at(LEVELS - 1)) visit(root);
    wanted.push(...shown.filter(({ dirty }) => dirty));
    const distance = new Map(eye ? wanted.map((chunk) => [chunk, chunk.distanceTo(eye)]) : []);
    wanted.sort((a, b) => b.level - a.level || (distance.get(a) ?? 0) - (distance.get(b) ?? 0));
    return { shown, wanted };
  }
}
