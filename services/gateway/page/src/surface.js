// The mesh of the surface that the robot has seen, one per chunk of blocks, rebuilt a few per frame as blocks change.
import * as THREE from "three";
import { blocksOf, joined } from "./surface_blocks.js";

export class SurfaceMesh {
  #chunks = new Map(); // key -> { blocks: Map, mesh }
  #dirty = new Set();

  /** @param cut uniform: what is above this height is hidden */
  constructor(cut) {
    this.group = new THREE.Group();
    this.faces = 0;
    this.uniforms = { cut, byViews: { value: false } };
    this.material = new THREE.ShaderMaterial({
      uniforms: this.uniforms,
      vertexShader: `
        attribute vec3 color;
        attribute float views; // + 1 = seen from near and squarely, + 2 = sampled finely
        varying vec3 own;
        varying float height, light, seen;
        void main() {
          vec4 world = modelMatrix * vec4(position, 1.0);
          vec3 n = normalize(normal * (255.0 / 127.0) - 1.0);
          light = 0.74 + 0.2 * n.z + 0.14 * dot(n, normalize(vec3(-3.0, -5.0, 2.0)));
          height = world.z;
          own = color;
          seen = mod(views, 2.0);
          gl_Position = projectionMatrix * viewMatrix * world;
        }`,
      fragmentShader: `
        uniform float cut;
        uniform bool byViews;
        varying vec3 own;
        varying float height, light, seen;
        void main() {
          if (height > cut) discard;
          vec3 color = own;
          if (byViews) {
            float gray = dot(own, vec3(0.3, 0.59, 0.11));
            color = mix(vec3(0.3 + 0.6 * gray), mix(vec3(0.98, 0.62, 0.2), vec3(0.22, 0.8, 0.55), seen), 0.62);
          }
          gl_FragColor = vec4(color * light, 1.0);
        }`,
    });
  }

  /** @param message thalweg_msgs/msg/SurfaceMesh */
  update(message) {
    if (message.reset) this.clear();
    for (const block of blocksOf(message)) {
      const chunk = this.#chunks.get(block.chunk) ?? { blocks: new Map(), mesh: null };
      this.#chunks.set(block.chunk, chunk);
      this.faces += (block.faces.length - (chunk.blocks.get(block.key)?.faces.length ?? 0)) / 3;
      if (block.faces.length > 0) chunk.blocks.set(block.key, block);
      else chunk.blocks.delete(block.key);
      this.#dirty.add(block.chunk);
    }
  }

  clear() {
    for (const chunk of this.#chunks.values()) this.#remove(chunk);
    this.#chunks.clear();
    this.#dirty.clear();
    this.faces = 0;
  }
  #remove(chunk) {
    if (!chunk.mesh) return;
    chunk.mesh.geometry.dispose();
    this.group.remove(chunk.mesh);
    chunk.mesh = null;
  }

  /** Chunks that are still to be made. */
  get left() {
    return this.#dirty.size;
  }

  /** Makes meshes of what has changed, for so long [ms] while it is shown. Returns whether there were any. */
  rebuild(budget) {
    if (!this.group.visible || this.#dirty.size === 0) return false;
    const end = performance.now() + budget;
    for (const key of this.#dirty) {
      this.#dirty.delete(key);
      this.#build(this.#chunks.get(key));
      if (performance.now() > end) break;
    }
    return true;
  }
  #build(chunk) {
    this.#remove(chunk);
    if (chunk.blocks.size === 0) return;
    const { points, normals, colors, views, faces } = joined([...chunk.blocks.values()]);
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(points, 3));
    geometry.setAttribute("normal", new THREE.BufferAttribute(normals, 3, true));
    geometry.setAttribute("color", new THREE.BufferAttribute(colors, 3, true));
    geometry.setAttribute("views", new THREE.BufferAttribute(views, 1));
    geometry.setIndex(new THREE.BufferAttribute(faces, 1));
    chunk.mesh = new THREE.Mesh(geometry, this.material);
    this.group.add(chunk.mesh);
  }
}

/** Fills the card about the surface. @param status thalweg_msgs/msg/SurfaceStatus */
export function showSurface(card, status) {
  const { area_m2: area, inspected_m2: inspected, fine_m2: fine } = status;
  const share = (part) => `${part.toFixed(1)} m², ${area > 0 ? ((100 * part) / area).toFixed(0) : 0} %`;
  const rows = [["Seen", `${area.toFixed(1)} m²`],
    [`Within ${status.inspection_distance_m} m, ${status.inspection_angle_deg.toFixed(0)}°`, share(inspected)],
    [`Sampled at ${(1000 * status.sampling_m).toFixed(0)} mm`, share(fine)],
    ["Memory", `${(Number(status.bytes) / 1e6).toFixed(0)} MB${status.full ? ", full" : ""}`]];
  card.querySelector("dl").replaceChildren(...rows.flatMap(([name, value]) => [
    Object.assign(document.createElement("dt"), { textContent: name }),
    Object.assign(document.createElement("dd"), { textContent: value, className: "number" })]));
  card.hidden = false;
}
