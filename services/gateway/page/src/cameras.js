// What the view is seen from: a camera that orbits, one that follows the robot, the robot's own, and one that flies.
import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { Fly } from "./fly.js";
import { behind, between, bothInView, headingOf, orbitFrom, shifted } from "./views.js";

const GLIDE = 450; // [ms] from one view to the next
const AHEAD = 4; // [m] What a camera that flies looks at, as far as others care.

export class Cameras {
  #glide = null; // { from, to, since [ms] }
  #waits = false; // for a robot to follow
  #allowed = true;
  #covered = { right: 0, bottom: 0 }; // share of the view
  #size = { width: 1, height: 1 }; // [px]

  /**
   * @param map    BlockMap
   * @param robot  Group with the robot's pose
   * @param sensor Object3D in it, which looks along its z
   * @param events { changed(), onCamera(mode), hasPose(), radiusOf() of the robot [m],
   *                 clear() part of the view that no panel hides { left, top, right, bottom } [px] }
   */
  constructor(canvas, keys, map, robot, sensor, events) {
    Object.assign(this, { map, robot, sensor, events });
    this.camera = new THREE.PerspectiveCamera(50, 1, 0.05, 2000);
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(-7, -8, 9);
    this.keys = keys;
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = true;
    this.controls.addEventListener("change", events.changed);
    this.fly = new Fly(this.camera, canvas, keys);
    this.mode = "orbit";
    this.touched = false; // by a person: until then the whole map is kept in view
    const stop = () => {
      this.touched = true;
      this.#glide = null;
    };
    for (const event of ["pointerdown", "wheel"]) canvas.addEventListener(event, stop);
  }

  /** @param right, bottom [px] of the view, which panels cover: the middle of the view is in what is left */
  resize(width, height, { right, bottom }) {
    this.#covered = { right: right / width, bottom: bottom / height };
    this.#size = { width, height };
    this.camera.aspect = width / height;
    this.camera.setViewOffset(width, height, right / 2, bottom / 2, width, height);
    this.camera.updateProjectionMatrix();
  }

  /** Whether dragging moves the camera. */
  allow(allowed) {
    this.#allowed = allowed;
    this.controls.enabled = allowed && (this.mode === "orbit" || this.mode === "follow");
  }

  set(mode) {
    const before = this.mode;
    this.mode = mode;
    this.fly.on = mode === "fly";
    this.#waits = false;
    this.allow(this.#allowed);
    this.events.onCamera(mode);
    this.events.changed();
    if (mode === "orbit" && before === "orbit") return;
    this.touched = true;
    this.#glide = null;
    // From the robot's own view out, too: it looked where the robot looks.
    if (mode === "follow" || before === "robot") this.#standBehind();
    else if (mode === "orbit" && before === "fly") this.#orbitAgain();
  }

  /** Brings the whole map into view, at once. */
  frame() {
    if (this.map.bounds.isEmpty()) return;
    const center = this.#center();
    this.set("orbit");
    this.#glide = null;
    this.#place({ eye: center.clone().addScaledVector(new THREE.Vector3(-0.5, -0.72, 0.86).normalize(), this.#far()), target: center });
    this.touched = false;
  }

  /**
   * Brings a place { x, y, z } into view. A camera that orbits turns about it then; one that follows the robot still does, and
   * moves only if the place is not in view; one that flies turns to it; the robot's own is left alone.
   */
  show(place) {
    if (this.mode === "robot") return;
    this.touched = true;
    // A camera that is still on its way is judged by where it will stand.
    const view = this.#glide?.to ?? this.#view();
    if (this.mode === "fly") return this.#glideTo({ eye: view.eye, target: place });
    if (this.mode === "orbit") return this.#glideTo(shifted(view, place, this.#clearFrom(place)));
    if (!this.#sees(place, view)) this.#glideTo(bothInView(this.robot.position.clone(), place, this.#half()));
  }

  /** The robot has moved. @param isNew whether it was not seen before */
  onRobot(moved, isNew) {
    if (this.mode !== "follow") return;
    if (isNew) return this.#waits && this.#standBehind();
    this.controls.target.add(moved);
    this.camera.position.add(moved);
    for (const view of this.#glide ? [this.#glide.from, this.#glide.to] : []) {
      view.eye = moved.clone().add(view.eye);
      view.target = moved.clone().add(view.target);
    }
  }

  /** Moves the camera on. @param pace [ms] between frames @returns whether it has moved of itself */
  update(pace) {
    if (this.#glide && this.keys.anyDown) this.#glide = null;
    if (this.#glide) return this.#goOn();
    if (this.mode === "robot") this.#lookAsRobot();
    else if (this.mode === "fly") return this.fly.update();
    else {
      this.controls.dampingFactor = 1 - 0.88 ** (pace / 16); // as long at any frame rate
      this.controls.update();
    }
    return false;
  }

  /** { mode, eye, target [m], moves: whether it is on its way to another view } */
  get shown() {
    const { eye, target } = this.#view();
    return { mode: this.mode, eye: eye.toArray(), target: target.toArray(), moves: this.#glide !== null };
  }

  // ---- Views

  #center() {
    return this.map.bounds.getCenter(new THREE.Vector3());
  }
  /** [m] from which the whole map is seen, also in a view that is higher than wide. */
  #far() {
    const radius = Math.max(this.map.bounds.getSize(new THREE.Vector3()).length() / 2, 1);
    const { right, bottom } = this.#covered;
    return (radius * 2.15) / Math.min((this.camera.aspect * (1 - right)) / (1 - bottom), 1);
  }
  #view() {
    const eye = this.camera.position.clone();
    const target = this.mode === "orbit" || this.mode === "follow" ? this.controls.target.clone()
      : this.camera.getWorldDirection(new THREE.Vector3()).multiplyScalar(AHEAD).add(eye);
    return { eye, target };
  }

  /** From the middle of the view to the nearer of the panels above and below [rad]. */
  #half() {
    const { top, bottom } = this.events.clear(), { height } = this.#size;
    const middle = (height * (1 - this.#covered.bottom)) / 2;
    return Math.atan((Math.tan(THREE.MathUtils.degToRad(this.camera.fov / 2)) * Math.min(middle - top, bottom - middle)) / (height / 2));
  }

  /** Whether a place is in the part of a view { eye, target } that no panel hides. */
  #sees(place, { eye, target }) {
    const camera = this.camera.clone();
    camera.position.copy(eye);
    camera.lookAt(target.x, target.y, target.z);
    camera.updateMatrixWorld();
    const { x, y, z } = new THREE.Vector3().copy(place).project(camera);
    const { left, top, right, bottom } = this.events.clear(), { width, height } = this.#size;
    const across = ((x + 1) / 2) * width, down = ((1 - y) / 2) * height;
    return z < 1 && across > left && across < right && down > top && down < bottom;
  }

  #standBehind() {
    this.#waits = !this.events.hasPose();
    if (this.#waits) return;
    const at = this.robot.position.clone();
    this.#glideTo(behind(at, headingOf(this.robot.quaternion), this.events.radiusOf(), this.#clearFrom(at)));
  }
  /** Whether nothing of the map stands between a place and an eye. */
  #clearFrom(place) {
    return (eye) => {
      const start = new THREE.Vector3().copy(place), to = new THREE.Vector3().copy(eye).sub(start), distance = to.length();
      return this.map.cast(new THREE.Ray(start, to.normalize()), distance) === null;
    };
  }
  #orbitAgain() {
    const { position } = this.robot;
    const robot = this.events.hasPose() && this.#sees(position, { eye: this.camera.position, target: this.#ahead() }) ? position.clone() : null;
    if (!robot && this.map.bounds.isEmpty()) return this.controls.target.copy(this.#ahead());
    this.#glideTo(orbitFrom(this.camera.position.clone(), robot, this.#center(), this.#far()));
  }
  #ahead() {
    return this.camera.getWorldDirection(new THREE.Vector3()).multiplyScalar(AHEAD).add(this.camera.position);
  }

  #lookAsRobot() {
    if (!this.events.hasPose()) return;
    const q = new THREE.Quaternion().multiplyQuaternions(this.robot.quaternion, this.sensor.quaternion);
    // The optical frame looks along z with y down; a camera of the scene looks along -z with y up.
    q.multiply(new THREE.Quaternion(1, 0, 0, 0));
    this.camera.position.copy(this.sensor.position).applyQuaternion(this.robot.quaternion).add(this.robot.position);
    this.camera.quaternion.copy(q);
  }

  // ---- The way from one to the next

  #place({ eye, target }) {
    this.controls.target.copy(target);
    this.camera.position.copy(eye);
    this.camera.lookAt(target.x, target.y, target.z);
    this.events.changed();
  }
  #glideTo(to) {
    const { eye } = this.#view(), { target } = this.#direction(to);
    this.#glide = { from: { eye, target }, to, since: performance.now() };
    if (matchMedia("(prefers-reduced-motion: reduce)").matches) this.#glide.since -= GLIDE;
    this.events.changed();
  }
  /** What is looked at now, as far away as what will be. */
  #direction({ eye, target }) {
    const distance = new THREE.Vector3().copy(eye).distanceTo(new THREE.Vector3().copy(target));
    return { target: this.camera.getWorldDirection(new THREE.Vector3()).multiplyScalar(distance).add(this.camera.position) };
  }
  #goOn() {
    const { from, to, since } = this.#glide;
    const share = Math.min((performance.now() - since) / GLIDE, 1);
    if (share === 1) this.#glide = null;
    this.#place(share === 1 ? to : between(from, to, share * share * (3 - 2 * share)));
    return true;
  }
}
