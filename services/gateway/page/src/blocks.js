// The map as meshes, one per chunk that is drawn, rebuilt a few per frame as blocks and the view change.
import * as THREE from "three";
import { ChunkTree, LEVELS } from "./chunks.js";
import { VoxelColors } from "./colors.js";
import { CHUNK, EDGE, Voxels, meshBorder, meshChunk } from "./mesher.js";
import { RAMP } from "./ramp.js";

const GAMMA = 1 / 2.4; // of sRGB, whose value is 1.055 * linear^GAMMA - 0.055 but for colors darker than any here

const NO_COLOR = 0.45; // to the power of GAMMA: the gray of voxels whose color was not measured

/** Colors along the ramp, mixed in linear light, to the power of GAMMA: the shader only multiplies by that of the light. */
function rampTexture() {
  const colors = RAMP.map((color) => new THREE.Color(color)), mixed = new THREE.Color();
  const texels = Array.from({ length: 256 }, (_, n) => {
    const t = (n / 255) * (RAMP.length - 1), k = Math.min(Math.floor(t), RAMP.length - 2);
    mixed.lerpColors(colors[k], colors[k + 1], t - k);
    return [...[mixed.r, mixed.g, mixed.b].map((c) => Math.round(255 * c ** GAMMA)), 255];
  });
  const texture = new THREE.DataTexture(new Uint8Array(texels.flat()), 256, 1);
  texture.magFilter = texture.minFilter = THREE.LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

/** A chunk's colors, as VoxelColors gives them. */
function colorTexture(cells, edge = CHUNK) {
  const texture = new THREE.Data3DTexture(cells, edge, edge, edge);
  texture.needsUpdate = true; // its filters are those for single cells
  return texture;
}

// Where a corner stands, and what is hidden: before the fragments, which cost most.
const PLACE = `
  attribute vec4 corner; // as meshChunk gives it
  attribute float born; // 0 where a map has no history
  uniform float voxel, cut, now;
  varying float height;
  varying vec3 inside; // the chunk, in cells: half a cell behind the face
  int face;
  void place() {
    int bits = int(corner.w);
    face = bits >> 4;
    float outward = (face & 1) == 0 ? 0.5 : -0.5;
    inside = corner.xyz - outward * vec3(face < 2, face == 2 || face == 3, face > 3);
    vec3 world = (modelMatrix * vec4(corner.xyz * voxel, 1.0)).xyz;
    // Walls end at the cut; floors and ceilings above it are beyond the far plane, as is what was not yet known.
    bool above = world.z > cut;
    if (above) {
      inside.z -= (world.z - cut) / voxel;
      world.z = cut;
    }
    // A tenth of a pixel wider: where corners of one rectangle lie on the side of another, rounding leaves no gap.
    float wider = 1e-4 * distance(world, cameraPosition);
    float first = (bits & 4) == 0 ? -wider : wider, second = (bits & 8) == 0 ? -wider : wider;
    if (above) second = 0.0;
    world += face < 2 ? vec3(0.0, first, second) : face < 4 ? vec3(first, 0.0, second) : vec3(first, second, 0.0);
    height = world.z;
    bool hidden = born > now || (above && face >= 4);
    gl_Position = hidden ? vec4(0.0, 0.0, 2.0, 1.0) : projectionMatrix * viewMatrix * vec4(world, 1.0);
  }`;

export class BlockMap {
  #voxels = new Voxels();
  #tree = new ChunkTree();
  #shown = []; // chunks
  #wanted = []; // chunks that are not yet built
  #changed = false; // whether what is shown or wanted may be others
  #eye = null; // [m]
  #focal = 0; // [pixels]
  #colors = new VoxelColors();
  #cloud = null; // of which they are
  #noColors = colorTexture(new Uint8Array(4), 1);
  #borders = new Map(); // Chunk -> Mesh of its border to the unknown
  #dirtyBorders = new Set();
  #corners = null; // of rectangles' triangles, for all meshes
  #size = 0.1;

  /** @param bornAt (x, y, z of a voxel) -> when it became known, in units of uniforms.now; absent = always drawn */
  constructor(bornAt) {
    this.bornAt = bornAt;
    this.group = new THREE.Group();
    this.border = new THREE.Group();
    this.border.visible = false;
    this.bounds = new THREE.Box3();
    this.faces = 0; // rectangles of the meshes that are shown
    this.uniforms = {
      cut: { value: 1e9 },
      low: { value: 0 },
      high: { value: 1 },
      voxel: { value: 0.1 },
      now: { value: 1e9 },
      section: { value: new THREE.Color() },
      ramp: { value: rampTexture() },
      byColor: { value: false },
      colors: { value: this.#noColors }, // of the chunk that is drawn
    };
    this.#material = new THREE.ShaderMaterial({
      uniforms: this.uniforms,
      side: THREE.DoubleSide,
      vertexShader: `${PLACE}
        varying float light;
        void main() {
          place();
          float side = face < 2 ? 0.78 : face < 4 ? 0.66 : face < 5 ? 1.0 : 0.5;
          light = pow(side * (0.55 + 0.15 * float(int(corner.w) & 3)), ${GAMMA}) * 1.055;
        }`,
      fragmentShader: `
        uniform float low, high;
        uniform vec3 section;
        uniform sampler2D ramp;
        uniform bool byColor;
        uniform highp sampler3D colors;
        varying float height, light;
        varying vec3 inside;
        void main() {
          vec3 paint;
          if (byColor) {
            vec4 measured = texture(colors, inside / ${CHUNK}.0);
            paint = measured.a > 0.5 ? (measured.rgb + 0.055) / 1.055 : vec3(${NO_COLOR});
          } else {
            float t = clamp((height - low) / max(high - low, 0.01), 0.0, 1.0);
            paint = texture2D(ramp, vec2(t * ${255 / 256} + ${0.5 / 256}, 0.5)).rgb;
          }
          vec3 color = paint * light - 0.055;
          // Through the cut one sees the inside of solid voxels: their back faces.
          gl_FragColor = vec4(gl_FrontFacing ? color : section, 1.0);
        }`,
    });
    this.#borderMaterial = new THREE.ShaderMaterial({
      uniforms: { ...this.uniforms, color: { value: new THREE.Color("#b07cff") } },
      side: THREE.DoubleSide,
      transparent: true,
      depthWrite: false,
      vertexShader: `${PLACE}
        void main() {
          place();
        }`,
      fragmentShader: `
        uniform vec3 color;
        void main() {
          gl_FragColor = vec4(color, 0.3);
          #include <colorspace_fragment>
        }`,
    });
  }
  #material;
  #borderMaterial;

  /** The color of what the cut plane opens. */
  setSection(color) {
    this.uniforms.section.value.set(color).convertLinearToSRGB(); // as it is drawn
  }

  /** [m] Bottom of the lowest and top of the highest voxel that was occupied; infinite where none was. */
  get low() {
    return this.#voxels.low * this.#size;
  }
  get high() {
    return this.#voxels.high * this.#size;
  }

  /** How many chunks are still to be built for the picture to be complete. */
  get waiting() {
    return this.#wanted.length + this.#dirtyBorders.size + (this.#changed || this.#unpainted() ? 1 : 0);
  }

  /** How many voxels have a measured color, as far as it was asked for. */
  get coloredCount() {
    return this.#colors.count;
  }

  /** Whether the map is colored as it was measured, by setColors, and not by height. */
  paintByColor(on) {
    this.uniforms.byColor.value = on;
    if (!on) this.#forgetColors();
  }

  /** @param message sensor_msgs/msg/PointCloud2: the centers of all voxels whose color is known */
  setColors(message) {
    this.#cloud = message;
    for (const block of this.#colors.set(message, this.#size)) {
      for (const chunk of this.#tree.holding(...block)) chunk.painted = false;
    }
  }
  #forgetColors() {
    this.#cloud = null;
    this.#colors.clear();
    this.#dropTextures();
  }
  #dropTextures() {
    for (let level = 0; level < LEVELS; ++level) for (const chunk of this.#tree.at(level)) this.#paint(chunk, null);
  }
  /** @param cells of VoxelColors.ofChunk */
  #paint(chunk, cells) {
    chunk.texture?.dispose();
    chunk.texture = cells && colorTexture(cells);
    chunk.painted = true;
  }
  /** A chunk that is shown and not yet painted. */
  #unpainted() {
    return this.uniforms.byColor.value ? this.#shown.find(({ mesh, painted }) => mesh && !painted) : undefined;
  }

  clear() {
    this.#forgetColors();
    this.#clearBlocks();
  }
  /** Colors stay: after a reconnection they may arrive before the blocks. */
  #clearBlocks() {
    this.#dropTextures();
    for (const group of [this.group, this.border]) {
      for (const mesh of group.children) this.#dispose(mesh);
      group.clear();
    }
    this.#borders.clear();
    this.#dirtyBorders.clear();
    this.#tree.clear();
    this.#voxels.clear();
    this.#shown = [];
    this.#wanted = [];
    this.#changed = true;
    this.bounds.makeEmpty();
    this.faces = 0;
  }

  /** @param message thalweg_msgs/msg/BlockStates */
  update(message) {
    const isOfSize = message.voxel_size_m === this.#size;
    if (message.reset || !isOfSize) this.#clearBlocks();
    this.#size = message.voxel_size_m;
    if (!isOfSize && this.#cloud) this.#colors.set(this.#cloud, this.#size);
    this.uniforms.voxel.value = this.#size;
    const block = this.#size * EDGE;
    const { position, states } = message;
    for (let n = 0; n * 3 < position.length; ++n) {
      const [x, y, z] = position.slice(3 * n, 3 * n + 3);
      const solid = this.#voxels.setBlock(x, y, z, states.subarray(128 * n, 128 * n + 128));
      this.#tree.add(x, y, z);
      if (!solid && !this.border.visible) continue;
      if (solid) this.bounds.expandByPoint(new THREE.Vector3(x * block, y * block, z * block));
      if (solid) this.bounds.expandByPoint(new THREE.Vector3((x + 1) * block, (y + 1) * block, (z + 1) * block));
      this.#tree.forEachAround(x, y, z, (chunk) => {
        chunk.dirty ||= solid;
        if (this.border.visible && chunk.level === 0) this.#dirtyBorders.add(chunk);
      });
    }
    this.#changed = true;
  }

  /**
   * Draws far parts of the map at a lower resolution, as seen by a camera: by cells of 2 pixels at most.
   * @param height [pixels] of the picture
   */
  lookFrom({ position, fov }, height) {
    const focal = height / 2 / Math.tan((fov * Math.PI) / 360);
    if (this.#eye?.equals(position) && this.#focal === focal) return;
    this.#eye = position.clone();
    this.#focal = focal;
    this.#changed = true;
  }

  /** Builds the chunks that are missing or have changed, for at most `budget` milliseconds. Returns whether the picture changed. */
  rebuild(budget = 8) {
    const end = performance.now() + budget;
    let any = this.#choose();
    while (this.#buildNext()) {
      any = true;
      if (performance.now() > end) break;
    }
    return any;
  }
  /** Returns whether there was anything to build. */
  #buildNext() {
    if (this.#wanted.length > 0) {
      this.#build(this.#wanted.shift());
    } else if (this.#dirtyBorders.size > 0) {
      this.#buildBorder();
    } else {
      const chunk = this.#unpainted();
      if (!chunk) return false;
      this.#paint(chunk, this.#colors.ofChunk(chunk.x, chunk.y, chunk.z, chunk.level));
    }
    return true;
  }

  /** Shows the chunks that the view asks for. Returns whether they are others than before. */
  #choose() {
    if (!this.#changed) return false;
    this.#changed = false;
    const eye = this.#eye?.toArray().map((c) => c / this.#size) ?? null;
    const { shown, wanted } = this.#tree.choose(eye, this.#focal);
    this.#wanted = wanted;
    const same = shown.length === this.#shown.length && shown.every((chunk, n) => chunk === this.#shown[n]);
    if (same) return false;
    for (const { mesh } of this.#shown) if (mesh) mesh.visible = false;
    for (const { mesh } of shown) if (mesh) mesh.visible = true;
    this.#shown = shown;
    this.faces = shown.reduce((sum, { mesh }) => sum + (mesh?.userData.faces ?? 0), 0);
    return true;
  }

  /** Shows the border to the unknown, whose faces are made only while it is seen. */
  showBorder(on) {
    this.border.visible = on;
    if (on) for (const chunk of this.#tree.at(0)) this.#dirtyBorders.add(chunk);
  }

  /** Where a ray [m] meets the map below the cut: { point, normal }, or null. */
  cast(ray, reach = 200) {
    const scaled = [ray.origin.x, ray.origin.y, ray.origin.z].map((c) => c / this.#size);
    const direction = [ray.direction.x, ray.direction.y, ray.direction.z];
    const hit = this.#voxels.cast(scaled, direction, reach / this.#size, this.uniforms.cut.value / this.#size);
    if (!hit) return null;
    return { point: ray.at(hit.distance * this.#size, new THREE.Vector3()), normal: new THREE.Vector3(...hit.normal) };
  }

  get blockCount() {
    return this.#voxels.blockCount;
  }
  counts() {
    return this.#voxels.counts();
  }

  #build(chunk) {
    const { level, x, y, z } = chunk;
    const visible = chunk.mesh?.visible ?? this.#shown.includes(chunk);
    const before = chunk.mesh;
    chunk.mesh = this.#replace(this.group, before, meshChunk(this.#voxels, x, y, z, level, this.bornAt), chunk, this.#material);
    if (chunk.mesh) {
      chunk.mesh.visible = visible;
      chunk.mesh.onBeforeRender = () => {
        if (!this.uniforms.byColor.value) return;
        this.uniforms.colors.value = chunk.texture ?? this.#noColors;
        this.#material.uniformsNeedUpdate = true; // which all chunks share
      };
    }
    if (visible) this.faces += (chunk.mesh?.userData.faces ?? 0) - (before?.userData.faces ?? 0);
    if (!chunk.built) this.#changed = true; // it may take the place of others
    chunk.built = true;
    chunk.dirty = false;
  }

  #buildBorder() {
    const [chunk] = this.#dirtyBorders;
    this.#dirtyBorders.delete(chunk);
    if (!this.border.visible) return;
    const faces = meshBorder(this.#voxels, chunk.x, chunk.y, chunk.z);
    const mesh = this.#replace(this.border, this.#borders.get(chunk), faces, chunk, this.#borderMaterial);
    if (mesh) this.#borders.set(chunk, mesh);
    else this.#borders.delete(chunk);
  }

  /** Puts the mesh of a chunk in the place of its old one. Returns it, or null if there are no faces. */
  #replace(group, old, faces, { level, x, y, z }, material) {
    if (old) {
      group.remove(old);
      this.#dispose(old);
    }
    if (!faces) return null;
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("corner", new THREE.BufferAttribute(faces.position, 4));
    if (this.bornAt) {
      const born = Float32Array.from({ length: 4 * faces.count }, (_, n) => faces.born[n >> 2]);
      geometry.setAttribute("born", new THREE.BufferAttribute(born, 1));
    }
    geometry.setIndex(this.#cornersOf(faces.count));
    geometry.setDrawRange(0, 6 * faces.count);
    const edge = CHUNK * this.#size;
    geometry.boundingSphere = new THREE.Sphere(new THREE.Vector3(edge / 2, edge / 2, edge / 2), (edge * Math.sqrt(3)) / 2);
    const mesh = new THREE.Mesh(geometry, material);
    mesh.scale.set(2 ** level, 2 ** level, 1);
    mesh.position.set(x * edge * 2 ** level, y * edge * 2 ** level, z * edge);
    mesh.updateMatrix();
    mesh.matrixAutoUpdate = false;
    mesh.userData.faces = faces.count;
    group.add(mesh);
    return mesh;
  }

  /** The corners of each rectangle's two triangles, for as many rectangles or more. */
  #cornersOf(rectangles) {
    if (this.#corners?.count >= 6 * rectangles) return this.#corners;
    const index = new Uint32Array(6 * 2 ** Math.ceil(Math.log2(Math.max(rectangles, 4096))));
    for (let n = 0; n < index.length / 6; ++n) index.set([0, 1, 2, 0, 2, 3].map((k) => 4 * n + k), 6 * n);
    this.#corners = new THREE.BufferAttribute(index, 1);
    return this.#corners;
  }

  #dispose({ geometry }) {
    geometry.setIndex(null); // which others use
    geometry.dispose();
  }
}
