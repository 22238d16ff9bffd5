// What the pointer does on the map, beside moving the camera: it picks, and draws boxes.
import * as THREE from "three";

/** Takes the events of a canvas on which a Scene is drawn, and passes on what they mean as scene.events.onPick and onBox. */
export function listen(canvas, scene) {
  let down = null;
  canvas.addEventListener("pointerdown", (event) => (down = event.button === 0 ? [event.clientX, event.clientY] : null));
  canvas.addEventListener("pointerup", (event) => {
    if (scene.drawing || !down || Math.hypot(event.clientX - down[0], event.clientY - down[1]) > 4) return;
    pick(event, canvas, scene);
  });
  listenForBoxes(canvas, scene);
}

function rayAt(event, canvas, { camera }) {
  const box = canvas.getBoundingClientRect();
  const at = new THREE.Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
  const caster = new THREE.Raycaster();
  caster.setFromCamera(at, camera);
  return caster;
}

/** Where a ray meets the floor's plane; null if it does not. */
function onFloor({ ray }, { map }) {
  const floor = Number.isFinite(map.low) ? map.low : 0;
  return ray.intersectPlane(new THREE.Plane(new THREE.Vector3(0, 0, 1), -floor), new THREE.Vector3());
}

function pick(event, canvas, scene) {
  const caster = rayAt(event, canvas, scene);
  const solid = scene.map.group.visible || scene.surface.group.visible ? scene.map.cast(caster.ray) : null;
  // A frontier behind a wall can still be clicked: it is drawn before the wall in no view, but wanted more.
  const frontier = scene.marks.at(caster);
  const floor = solid ? null : onFloor(caster, scene);
  scene.events.onPick({ frontier, point: solid?.point ?? floor, normal: solid?.normal ?? new THREE.Vector3(0, 0, 1), at: [event.clientX, event.clientY] });
}

/** While a box is drawn: its foot is dragged on the floor, its height by the handle. */
function listenForBoxes(canvas, scene) {
  let from = null, pulling = false;
  canvas.addEventListener("pointerdown", (event) => {
    if (!scene.drawing || event.button !== 0) return;
    const caster = rayAt(event, canvas, scene);
    pulling = scene.boxes.handle.visible && caster.intersectObject(scene.boxes.handle).length > 0;
    from = pulling ? null : onFloor(caster, scene);
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!scene.drawing) return;
    const caster = rayAt(event, canvas, scene);
    if (pulling) {
      const { min, max } = scene.boxes.box;
      scene.events.onBox({ min, max: { ...max, z: Math.max(scene.boxes.pullTo(caster.ray), min.z + 0.1) } });
    } else if (from) {
      const to = onFloor(caster, scene);
      if (!to || from.distanceTo(to) > 100) return;
      const { min, max } = scene.boxes.box ?? { min: { z: from.z }, max: { z: from.z + 2 } };
      scene.events.onBox({ min: { x: Math.min(from.x, to.x), y: Math.min(from.y, to.y), z: min.z },
        max: { x: Math.max(from.x, to.x), y: Math.max(from.y, to.y), z: max.z } });
    }
  });
  addEventListener("pointerup", () => {
    from = null;
    pulling = false;
  });
}
