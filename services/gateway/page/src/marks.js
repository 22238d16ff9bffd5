// The frontiers in the 3D view: a ball each, colored by its fate, and a halo around the one that is chosen.
import * as THREE from "three";

const MOST = 2048; // that are drawn

export class FrontierMarks {
  #frontiers = [];
  #colors = []; // by fate

  constructor() {
    const sphere = new THREE.SphereGeometry(1, 20, 14);
    this.balls = new THREE.InstancedMesh(sphere, new THREE.MeshStandardMaterial({ roughness: 0.45 }), MOST);
    this.balls.count = 0;
    this.balls.frustumCulled = false;
    this.ring = new THREE.Mesh(new THREE.SphereGeometry(0.3, 24, 16),
      new THREE.MeshBasicMaterial({ transparent: true, opacity: 0.28, depthWrite: false, depthTest: false })); // also behind a wall
    this.ring.renderOrder = 1;
    this.ring.visible = false;
    this.group = new THREE.Group().add(this.balls, this.ring);
  }

  /** @param colors by fate; @param halo of the one that is chosen */
  setTheme(colors, halo) {
    this.#colors = colors;
    this.ring.material.color.set(halo);
    this.#paint();
  }

  set(frontiers) {
    this.#frontiers = frontiers;
    this.balls.count = Math.min(frontiers.length, MOST);
    const matrix = new THREE.Matrix4();
    for (let n = 0; n < this.balls.count; ++n) {
      const { center, voxels } = frontiers[n];
      const radius = Math.min(0.05 + 0.018 * Math.cbrt(voxels), 0.22);
      matrix.makeScale(radius, radius, radius).setPosition(center.x, center.y, center.z);
      this.balls.setMatrixAt(n, matrix);
    }
    this.balls.instanceMatrix.needsUpdate = true;
    this.balls.computeBoundingSphere();
    this.#paint();
  }

  showAll(on) {
    this.balls.visible = on;
  }

  /** Puts the halo around a frontier, also while the others are hidden; null around none. */
  select(index) {
    const frontier = index === null ? undefined : this.#frontiers[index];
    this.ring.visible = frontier !== undefined;
    if (frontier) this.ring.position.copy(frontier.center);
  }

  /** The number of the frontier that a ray meets, or null. */
  at(caster) {
    const [hit] = this.balls.visible ? caster.intersectObject(this.balls) : [];
    return hit ? hit.instanceId : null;
  }

  #paint() {
    const color = new THREE.Color();
    for (let n = 0; n < this.balls.count; ++n) this.balls.setColorAt(n, color.set(this.#colors[this.#frontiers[n].fate] ?? this.#colors[0]));
    if (this.balls.instanceColor) this.balls.instanceColor.needsUpdate = true;
  }
}
