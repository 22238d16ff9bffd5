// A free camera: dragging turns it, the arrow keys move it.
import * as THREE from "three";

const SPEED = 3; // [m/s]
const TURN = 0.004; // [rad] a pixel

export class Fly {
  #last = 0;
  constructor(camera, canvas, keys) {
    this.camera = camera;
    this.keys = keys;
    this.on = false;
    let from = null;
    canvas.addEventListener("pointerdown", (event) => (from = this.on && event.button === 0 ? [event.clientX, event.clientY] : null));
    canvas.addEventListener("pointermove", (event) => {
      if (!from || !this.on) return;
      this.#turn((event.clientX - from[0]) * TURN, (event.clientY - from[1]) * TURN);
      from = [event.clientX, event.clientY];
    });
    addEventListener("pointerup", () => (from = null));
    const group = "Flying (view 4)";
    for (const [key, text] of [["ArrowUp", "Forward, back"], ["ArrowDown", "Forward, back"], ["ArrowLeft", "Left, right"],
      ["ArrowRight", "Left, right"], ["PageUp", "Up, down"], ["PageDown", "Up, down"]]) keys.claim(key, { group, text });
  }

  /** Turns the camera about the vertical and about its own right axis; never over the top. */
  #turn(right, down) {
    const { camera } = this;
    const forward = camera.getWorldDirection(new THREE.Vector3());
    const heading = Math.atan2(forward.y, forward.x) - right;
    const pitch = Math.min(Math.max(Math.asin(forward.z) - down, -1.5), 1.5);
    const to = new THREE.Vector3(Math.cos(heading) * Math.cos(pitch), Math.sin(heading) * Math.cos(pitch), Math.sin(pitch));
    camera.up.set(0, 0, 1);
    camera.lookAt(camera.position.clone().add(to));
    this.turned = true;
  }

  /** Moves the camera on. Returns whether it has moved or turned. */
  update() {
    const now = performance.now(), seconds = Math.min((now - this.#last) / 1000, 0.1);
    this.#last = now;
    const turned = this.turned;
    this.turned = false;
    if (!this.keys.anyDown) return turned;
    const forward = this.camera.getWorldDirection(new THREE.Vector3());
    const right = new THREE.Vector3().crossVectors(forward, new THREE.Vector3(0, 0, 1)).normalize();
    const along = (plus, minus) => (this.keys.isDown(plus) ? 1 : 0) - (this.keys.isDown(minus) ? 1 : 0);
    const move = forward.multiplyScalar(along("ArrowUp", "ArrowDown")).addScaledVector(right, along("ArrowRight", "ArrowLeft"));
    move.z += along("PageUp", "PageDown");
    this.camera.position.addScaledVector(move, SPEED * seconds);
    return true;
  }
}
