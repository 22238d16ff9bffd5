// The map as meshes, one per chunk, rebuilt a few per frame as blocks change.
import * as THREE from "three";
import { CHUNK, EDGE, Voxels, facesBorn, meshBorder, meshChunk } from "./mesher.js";

const PER_CHUNK = CHUNK / EDGE;
export const RAMP = ["#2b3a8f", "#2378b5", "#2fb3a3", "#a6cf5b", "#f3c14b", "#f0764a"];

export class BlockMap {
  #voxels = new Voxels();
  #meshes = new Map(); // "x,y,z" of the chunk -> Mesh
  #borders = new Map(); // likewise
  #chunks = new Set(); // all that hold a known block
  #dirty = new Set();
  #size = 0.1;

  /** @param bornAt (x, y, z of a voxel) -> when it became known, in units of uniforms.now; absent = always drawn */
  constructor(bornAt) {
    this.bornAt = bornAt;
    this.group = new THREE.Group();
    this.border = new THREE.Group();
    this.border.visible = false;
    this.low = Infinity; // [m] of occupied blocks
    this.high = -Infinity;
    this.bounds = new THREE.Box3();
    this.faces = 0;
    this.uniforms = {
      cut: { value: 1e9 },
      low: { value: 0 },
      high: { value: 1 },
      voxel: { value: 0.1 },
      now: { value: 1e9 },
      section: { value: new THREE.Color() },
      ramp: { value: RAMP.map((color) => new THREE.Color(color)) },
    };
    this.#material = new THREE.ShaderMaterial({
      uniforms: this.uniforms,
      side: THREE.DoubleSide,
      vertexShader: `
        attribute vec4 corner;
        attribute float born; // 0 where a map has no history
        uniform float voxel;
        varying float height, light, age;
        void main() {
          vec4 world = modelMatrix * vec4(corner.xyz * voxel, 1.0);
          float face = floor(corner.w / 8.0), openness = mod(corner.w, 8.0);
          float side = face < 2.0 ? 0.78 : face < 4.0 ? 0.66 : face < 5.0 ? 1.0 : 0.5;
          light = side * (0.55 + 0.15 * openness);
          height = world.z;
          age = born;
          gl_Position = projectionMatrix * viewMatrix * world;
        }`,
      fragmentShader: `
        uniform float cut, low, high, now;
        uniform vec3 section;
        uniform vec3 ramp[${RAMP.length}];
        varying float height, light, age;
        void main() {
          if (height > cut || age > now) discard;
          // Through the cut one sees the inside of solid voxels: their back faces.
          vec3 color = section;
          if (gl_FrontFacing) {
            float t = clamp((height - low) / max(high - low, 0.01), 0.0, 1.0) * ${(RAMP.length - 1).toFixed(1)};
            color = ramp[0];
            for (int k = 0; k < ${RAMP.length - 1}; ++k) color = mix(color, ramp[k + 1], clamp(t - float(k), 0.0, 1.0));
            color *= light;
          }
          gl_FragColor = vec4(color, 1.0);
          #include <colorspace_fragment>
        }`,
    });
    this.#borderMaterial = new THREE.ShaderMaterial({
      uniforms: { ...this.uniforms, color: { value: new THREE.Color("#b07cff") } },
      side: THREE.DoubleSide,
      transparent: true,
      depthWrite: false,
      vertexShader: `
        attribute vec4 corner;
        uniform float voxel;
        varying float height;
        void main() {
          vec4 world = modelMatrix * vec4(corner.xyz * voxel, 1.0);
          height = world.z;
          gl_Position = projectionMatrix * viewMatrix * world;
        }`,
      fragmentShader: `
        uniform float cut;
        uniform vec3 color;
        varying float height;
        void main() {
          if (height > cut) discard;
          gl_FragColor = vec4(color, 0.3);
          #include <colorspace_fragment>
        }`,
    });
  }
  #material;
  #borderMaterial;

  clear() {
    for (const mesh of this.#meshes.values()) this.#remove(this.group, mesh);
    for (const mesh of this.#borders.values()) this.#remove(this.border, mesh);
    this.#meshes.clear();
    this.#borders.clear();
    this.#chunks.clear();
    this.#voxels.clear();
    this.#dirty.clear();
    this.low = Infinity;
    this.high = -Infinity;
    this.bounds.makeEmpty();
    this.faces = 0;
  }

  /** @param message thalweg_msgs/msg/BlockStates */
  update(message) {
    if (message.reset || message.voxel_size_m !== this.#size) this.clear();
    this.#size = message.voxel_size_m;
    this.uniforms.voxel.value = this.#size;
    const block = this.#size * EDGE;
    const { position, states } = message;
    for (let n = 0; n * 3 < position.length; ++n) {
      const [x, y, z] = position.slice(3 * n, 3 * n + 3);
      const solid = this.#voxels.setBlock(x, y, z, states.subarray(128 * n, 128 * n + 128));
      this.#chunks.add([x, y, z].map((c) => Math.floor(c / PER_CHUNK)).join(","));
      if (!solid && !this.border.visible) continue;
      if (solid) this.bounds.expandByPoint(new THREE.Vector3(x * block, y * block, z * block));
      if (solid) this.bounds.expandByPoint(new THREE.Vector3((x + 1) * block, (y + 1) * block, (z + 1) * block));
      // Neighbors too: their faces and shading at the border depend on this block.
      for (let dz = -1; dz <= 1; ++dz) {
        for (let dy = -1; dy <= 1; ++dy) {
          for (let dx = -1; dx <= 1; ++dx) {
            const chunk = [x + dx, y + dy, z + dz].map((c) => Math.floor(c / PER_CHUNK));
            this.#dirty.add(chunk.join(","));
          }
        }
      }
    }
  }

  /** Rebuilds changed chunks for at most `budget` milliseconds. Returns whether any was. */
  rebuild(budget = 8) {
    const end = performance.now() + budget;
    let any = false;
    for (const key of this.#dirty) {
      this.#dirty.delete(key);
      this.#build(key);
      any = true;
      if (performance.now() > end) break;
    }
    return any;
  }

  /** Shows the border to the unknown, whose faces are made only while it is seen. */
  showBorder(on) {
    this.border.visible = on;
    if (on) for (const key of this.#chunks) this.#dirty.add(key);
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

  #build(key) {
    const [x, y, z] = key.split(",").map(Number);
    const mesh = this.#replace(this.#meshes, this.group, key, meshChunk(this.#voxels, x, y, z), this.#material);
    if (mesh) {
      this.faces += mesh.userData.faces;
      const corners = mesh.geometry.getAttribute("corner").array;
      for (let n = 2; n < corners.length; n += 4) {
        const height = z * CHUNK * this.#size + corners[n] * this.#size;
        if (height < this.low) this.low = height;
        if (height > this.high) this.high = height;
      }
    }
    if (this.border.visible) this.#replace(this.#borders, this.border, key, meshBorder(this.#voxels, x, y, z), this.#borderMaterial);
  }

  /** Puts the mesh of a chunk in the place of its old one. Returns it, or undefined if there are no faces. */
  #replace(meshes, group, key, faces, material) {
    const old = meshes.get(key);
    if (old) {
      this.#remove(group, old);
      meshes.delete(key);
    }
    if (!faces) return undefined;
    const [x, y, z] = key.split(",").map(Number);
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("corner", new THREE.BufferAttribute(faces.position, 4));
    if (this.bornAt) geometry.setAttribute("born", new THREE.BufferAttribute(facesBorn(faces.position, x, y, z, this.bornAt), 1));
    geometry.setIndex(new THREE.BufferAttribute(faces.index, 1));
    const edge = CHUNK * this.#size;
    geometry.boundingSphere = new THREE.Sphere(new THREE.Vector3(edge / 2, edge / 2, edge / 2), (edge * Math.sqrt(3)) / 2);
    const mesh = new THREE.Mesh(geometry, material);
    mesh.position.set(x * edge, y * edge, z * edge);
    mesh.userData.faces = faces.index.length / 6;
    meshes.set(key, mesh);
    group.add(mesh);
    return mesh;
  }

  #remove(group, mesh) {
    if (group === this.group) this.faces -= mesh.userData.faces;
    group.remove(mesh);
    mesh.geometry.dispose();
  }
}
