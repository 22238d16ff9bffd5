// Boxes that the robot keeps out of: those in force, and the one that is being drawn.
import * as THREE from "three";

const edgesOfUnit = new THREE.EdgesGeometry(new THREE.BoxGeometry(1, 1, 1));
const unit = new THREE.BoxGeometry(1, 1, 1);

function makeBox(color, opacity) {
  const group = new THREE.Group();
  group.add(new THREE.Mesh(unit, new THREE.MeshBasicMaterial({ color, transparent: true, opacity, depthWrite: false })),
    new THREE.LineSegments(edgesOfUnit, new THREE.LineBasicMaterial({ color })));
  return group;
}
function place(group, { min, max }) {
  group.position.set((min.x + max.x) / 2, (min.y + max.y) / 2, (min.z + max.z) / 2);
  group.scale.set(Math.max(max.x - min.x, 1e-3), Math.max(max.y - min.y, 1e-3), Math.max(max.z - min.z, 1e-3));
}

export class Boxes {
  constructor() {
    this.group = new THREE.Group();
    this.inForce = new THREE.Group();
    this.draft = makeBox("#ff9f6b", 0.22);
    this.draft.visible = false;
    // The handle on top of the draft, by which its height is pulled.
    this.handle = new THREE.Mesh(new THREE.ConeGeometry(0.09, 0.24, 20).rotateX(Math.PI / 2), new THREE.MeshBasicMaterial({ color: "#ff9f6b" }));
    this.handle.visible = false;
    this.box = null; // the draft: { min, max }
    this.group.add(this.inForce, this.draft, this.handle);
  }

  /** @param boxes [{ min, max }], points in map */
  set(boxes) {
    this.inForce.clear();
    for (const box of boxes) {
      const made = makeBox("#ff5c6c", 0.2);
      place(made, box);
      this.inForce.add(made);
    }
  }

  setDraft(box) {
    this.box = box;
    this.draft.visible = this.handle.visible = box !== null;
    if (!box) return;
    place(this.draft, box);
    this.handle.position.set((box.min.x + box.max.x) / 2, (box.min.y + box.max.y) / 2, box.max.z + 0.16);
  }

  /** The height [m] to which a pointer's ray pulls the handle: of the point nearest to the ray above the box. */
  pullTo(ray) {
    const base = this.handle.position.clone().setZ(0);
    const w = base.clone().sub(ray.origin), d = ray.direction;
    const level = 1 - d.z * d.z; // 0 where the ray is vertical itself
    if (level < 1e-6) return this.box.max.z;
    return (d.z * w.dot(d) - w.z) / level - 0.16;
  }
}
