// The 3D view: camera, robot, paths, frontiers and field around the map. World axes as in the map frame, z up.
import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { Line2 } from "three/addons/lines/Line2.js";
import { LineGeometry } from "three/addons/lines/LineGeometry.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { BlockMap, RAMP } from "./blocks.js";

export const FATE = { left: 0, chosen: 1, aside: 2 };
const THEMES = {
  dark: { back: "#0c0f14", grid: "#1d2430", section: "#323b49", flown: "#f2f5f9", ahead: "#4cc2ff", robot: "#ffffff",
    fate: ["#f5b83d", "#45d19a", "#707b8c"] },
  light: { back: "#eef1f5", grid: "#d4dae3", section: "#aab4c2", flown: "#1b2433", ahead: "#0a7ac2", robot: "#17202e",
    fate: ["#d98600", "#12885a", "#8792a3"] },
};
const MAX_RATIO = 2; // of device pixels; beyond, only the cost grows
const MIN_RATIO = 0.5;

class FatLine {
  constructor(width) {
    this.material = new LineMaterial({ linewidth: width, worldUnits: false });
    this.line = new Line2(new LineGeometry(), this.material);
    this.line.visible = false;
    this.line.frustumCulled = false;
  }
  /** @param points flat x, y, z */
  set(points) {
    this.line.visible = points.length >= 6;
    if (!this.line.visible) return;
    this.line.geometry.dispose();
    this.line.geometry = new LineGeometry();
    this.line.geometry.setPositions(points);
  }
}

export class Scene {
  #needsFrame = true;
  #chosen = null;
  #ratio = Math.min(devicePixelRatio, MAX_RATIO);
  #pace = 16; // [ms] between frames, smoothed
  #lastDraw = 0;
  #layers = { map: true, flown: true, ahead: true, frontiers: true, field: false };

  constructor(canvas, events) {
    this.events = events; // { onPick(index or null), onCamera(name) }
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, powerPreference: "high-performance" });
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(50, 1, 0.05, 2000);
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(-7, -8, 9);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = true;
    this.controls.dampingFactor = 0.12;
    this.controls.addEventListener("change", () => (this.#needsFrame = true));
    this.controls.addEventListener("start", () => (this.touched = true));
    this.touched = false;
    this.mode = "orbit";

    this.map = new BlockMap();
    this.scene.add(this.map.group);
    this.grid = null;
    this.flown = new FatLine(2);
    this.ahead = new FatLine(4);
    this.streamline = new FatLine(1.5);
    for (const line of [this.flown, this.ahead, this.streamline]) this.scene.add(line.line);
    this.#makeRobot();
    this.#makeFrontiers();
    this.field = new THREE.Points(new THREE.BufferGeometry(), new THREE.PointsMaterial({ size: 0.06, vertexColors: true }));
    this.field.frustumCulled = false;
    this.scene.add(this.field);
    this.#listen(canvas);
    this.setTheme("dark");
    this.resize();
  }

  setTheme(name) {
    const theme = THEMES[name];
    this.theme = theme;
    this.renderer.setClearColor(theme.back);
    this.map.uniforms.section.value.set(theme.section);
    this.flown.material.color.set(theme.flown);
    this.ahead.material.color.set(theme.ahead);
    this.streamline.material.color.set("#c38bff");
    this.body.material.color.set(theme.robot);
    this.frustum.material.color.set(theme.ahead);
    this.#layGrid();
    this.#paintFrontiers();
    this.changed();
  }

  changed() {
    this.#needsFrame = true;
  }

  resize() {
    const { clientWidth, clientHeight } = this.renderer.domElement;
    this.renderer.setPixelRatio(this.#ratio);
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / clientHeight;
    // The panels cover the right side: keep the center of the view in what is left.
    const covered = clientWidth > 900 ? 330 : 0;
    this.camera.setViewOffset(clientWidth, clientHeight, covered / 2, 0, clientWidth, clientHeight);
    this.camera.updateProjectionMatrix();
    this.changed();
  }

  /** Brings the whole map into view. */
  frame() {
    if (this.map.bounds.isEmpty()) return;
    const center = this.map.bounds.getCenter(new THREE.Vector3());
    const radius = Math.max(this.map.bounds.getSize(new THREE.Vector3()).length() / 2, 1);
    const direction = new THREE.Vector3(-0.5, -0.72, 0.86).normalize();
    this.controls.target.copy(center);
    this.camera.position.copy(center).addScaledVector(direction, radius * 2.15);
    this.touched = false;
    this.setMode("orbit");
  }

  setMode(mode) {
    if (this.mode === "robot" && mode !== "robot") {
      this.camera.up.set(0, 0, 1);
      this.camera.position.copy(this.robot.position).add(new THREE.Vector3(-3, -3, 3.5));
      this.controls.target.copy(this.robot.position);
    }
    this.mode = mode;
    this.controls.enabled = mode !== "robot";
    this.robot.visible = mode !== "robot" && this.hasPose;
    this.events.onCamera(mode);
    this.changed();
  }

  setLayer(name, on) {
    this.#layers[name] = on;
    this.map.group.visible = this.#layers.map;
    this.flown.line.material.visible = this.#layers.flown;
    this.ahead.line.material.visible = this.#layers.ahead;
    this.markers.visible = this.#layers.frontiers;
    this.field.visible = this.#layers.field;
    this.streamline.line.material.visible = this.#layers.field;
    this.changed();
  }

  setCut(height) {
    this.map.uniforms.cut.value = height;
    this.changed();
  }

  /** @param pose geometry_msgs/msg/Pose of the body in map */
  setPose(pose) {
    const { position: p, orientation: q } = pose;
    const moved = new THREE.Vector3(p.x, p.y, p.z).sub(this.robot.position);
    this.robot.position.set(p.x, p.y, p.z);
    this.robot.quaternion.set(q.x, q.y, q.z, q.w);
    if (!this.hasPose) {
      this.hasPose = true;
      this.robot.visible = this.mode !== "robot";
    } else if (this.mode === "follow") {
      this.controls.target.add(moved);
      this.camera.position.add(moved);
    }
    this.changed();
  }

  /** @param transform geometry_msgs/msg/Transform of the camera in the body */
  setCameraInBody({ translation: t, rotation: q }) {
    this.frustum.position.set(t.x, t.y, t.z);
    this.frustum.quaternion.set(q.x, q.y, q.z, q.w);
  }

  setRobotShape({ radius, height, fovDeg, aspect }) {
    const geometry = height > 0 ? new THREE.CylinderGeometry(radius, radius, height, 32).rotateX(Math.PI / 2)
      : new THREE.SphereGeometry(radius, 24, 16);
    this.body.geometry.dispose();
    this.body.geometry = geometry;
    const x = Math.tan((fovDeg * Math.PI) / 360), y = x / aspect, length = 0.9;
    const corner = [[-x, -y], [x, -y], [x, y], [-x, y]].map(([a, b]) => [a * length, b * length, length]);
    const points = [];
    corner.forEach((c, k) => points.push(0, 0, 0, ...c, ...c, ...corner[(k + 1) % 4]));
    this.frustum.geometry.setAttribute("position", new THREE.Float32BufferAttribute(points, 3));
    this.fovDeg = 2 * Math.atan(y) * (180 / Math.PI);
    this.changed();
  }

  setFrontiers(frontiers) {
    this.frontiers = frontiers;
    this.markers.count = Math.min(frontiers.length, this.markers.instanceMatrix.count);
    const matrix = new THREE.Matrix4();
    for (let n = 0; n < this.markers.count; ++n) {
      const { center, voxels } = frontiers[n];
      const radius = Math.min(0.05 + 0.018 * Math.cbrt(voxels), 0.22);
      matrix.makeScale(radius, radius, radius).setPosition(center.x, center.y, center.z);
      this.markers.setMatrixAt(n, matrix);
    }
    this.markers.instanceMatrix.needsUpdate = true;
    this.markers.computeBoundingSphere();
    this.#paintFrontiers();
    this.changed();
  }

  select(index) {
    this.#chosen = index;
    const frontier = index === null ? undefined : this.frontiers[index];
    this.ring.visible = frontier !== undefined;
    if (frontier) this.ring.position.set(frontier.center.x, frontier.center.y, frontier.center.z);
    this.#paintFrontiers();
    this.changed();
  }

  /** @param message sensor_msgs/msg/PointCloud2 with x, y, z, intensity */
  setField(message) {
    const offset = Object.fromEntries(message.fields.map(({ name, offset }) => [name, offset]));
    if (["x", "y", "z", "intensity"].some((name) => offset[name] === undefined)) return;
    const view = new DataView(message.data.buffer, message.data.byteOffset, message.data.byteLength);
    const count = Math.floor(message.data.byteLength / message.point_step);
    const position = new Float32Array(3 * count), color = new Float32Array(3 * count);
    const ramp = RAMP.map((each) => new THREE.Color(each));
    const mixed = new THREE.Color();
    for (let n = 0; n < count; ++n) {
      const at = n * message.point_step;
      ["x", "y", "z"].forEach((axis, k) => (position[3 * n + k] = view.getFloat32(at + offset[axis], true)));
      const t = Math.min(Math.max((view.getFloat32(at + offset.intensity, true) + 1) / 2, 0), 0.999) * (ramp.length - 1);
      mixed.lerpColors(ramp[Math.floor(t)], ramp[Math.floor(t) + 1], t % 1).toArray(color, 3 * n);
    }
    this.field.geometry.dispose();
    this.field.geometry = new THREE.BufferGeometry();
    this.field.geometry.setAttribute("position", new THREE.BufferAttribute(position, 3));
    this.field.geometry.setAttribute("color", new THREE.BufferAttribute(color, 3));
    this.changed();
  }

  /** Draws a frame if anything has changed. Returns whether it has. */
  draw() {
    if (this.mode === "robot" && this.hasPose) this.#lookAsRobot();
    else this.controls.update();
    if (this.map.rebuild()) {
      this.#needsFrame = true;
      this.#layGrid();
      if (!this.touched && this.mode === "orbit") this.frame();
    }
    if (!this.#needsFrame) {
      this.#lastDraw = 0;
      return false;
    }
    this.#needsFrame = false;
    this.renderer.render(this.scene, this.camera);
    this.#keepPace();
    return true;
  }

  /** Fewer pixels where frames in a row take long, more where they are fast: a slow machine stays usable. */
  #keepPace() {
    const now = performance.now();
    if (this.#lastDraw > 0) this.#pace += 0.1 * (Math.min(now - this.#lastDraw, 500) - this.#pace);
    this.#lastDraw = now;
    const most = Math.min(devicePixelRatio, MAX_RATIO);
    const ratio = this.#pace > 60 ? Math.max(this.#ratio * 0.7, MIN_RATIO) : this.#pace < 22 ? Math.min(this.#ratio * 1.3, most) : this.#ratio;
    if (ratio === this.#ratio) return;
    this.#ratio = ratio;
    this.#pace = 40; // so that the next change waits for its effect
    this.resize();
  }

  #lookAsRobot() {
    const q = new THREE.Quaternion().multiplyQuaternions(this.robot.quaternion, this.frustum.quaternion);
    // The optical frame looks along z with y down; a camera of the scene looks along -z with y up.
    q.multiply(new THREE.Quaternion(1, 0, 0, 0));
    this.camera.position.copy(this.frustum.position).applyQuaternion(this.robot.quaternion).add(this.robot.position);
    this.camera.quaternion.copy(q);
  }

  #makeRobot() {
    this.robot = new THREE.Group();
    this.robot.visible = false;
    this.hasPose = false;
    this.body = new THREE.Mesh(new THREE.SphereGeometry(0.2, 24, 16), new THREE.MeshStandardMaterial({ roughness: 0.5 }));
    this.frustum = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial());
    this.frustum.frustumCulled = false;
    // Looks along the body's x axis until the transforms have told better.
    this.frustum.quaternion.set(-0.5, 0.5, -0.5, 0.5);
    this.robot.add(this.body, this.frustum);
    this.scene.add(this.robot, new THREE.HemisphereLight("#ffffff", "#7a8699", 2.2));
    const sun = new THREE.DirectionalLight("#ffffff", 1.2);
    sun.position.set(-3, -5, 8);
    this.scene.add(sun);
    this.setRobotShape({ radius: 0.2, height: 0, fovDeg: 90, aspect: 4 / 3 });
  }

  #makeFrontiers() {
    this.frontiers = [];
    const sphere = new THREE.SphereGeometry(1, 20, 14);
    this.markers = new THREE.InstancedMesh(sphere, new THREE.MeshStandardMaterial({ roughness: 0.45 }), 2048);
    this.markers.count = 0;
    this.markers.frustumCulled = false;
    this.ring = new THREE.Mesh(new THREE.SphereGeometry(0.3, 24, 16),
      new THREE.MeshBasicMaterial({ color: "#ffffff", transparent: true, opacity: 0.28, depthWrite: false }));
    this.ring.visible = false;
    this.scene.add(this.markers, this.ring);
  }

  #paintFrontiers() {
    const color = new THREE.Color();
    for (let n = 0; n < this.markers.count; ++n) {
      color.set(this.theme.fate[this.frontiers[n].fate] ?? this.theme.fate[0]);
      this.markers.setColorAt(n, color);
    }
    if (this.markers.instanceColor) this.markers.instanceColor.needsUpdate = true;
  }

  #layGrid() {
    const bounds = this.map.bounds;
    const size = bounds.isEmpty() ? 20 : 2 * Math.ceil(Math.max(bounds.max.x - bounds.min.x, bounds.max.y - bounds.min.y) / 2) + 8;
    const z = Number.isFinite(this.map.low) ? this.map.low : 0;
    const key = `${size} ${this.theme.grid} ${z}`;
    if (this.gridKey === key) return;
    this.gridKey = key;
    if (this.grid) {
      this.scene.remove(this.grid);
      this.grid.geometry.dispose();
    }
    this.grid = new THREE.GridHelper(size, size, this.theme.grid, this.theme.grid);
    this.grid.rotation.x = Math.PI / 2;
    const center = bounds.isEmpty() ? new THREE.Vector3() : bounds.getCenter(new THREE.Vector3());
    this.grid.position.set(Math.round(center.x), Math.round(center.y), z - 0.02);
    this.scene.add(this.grid);
  }

  #listen(canvas) {
    let down = null;
    canvas.addEventListener("pointerdown", (event) => (down = [event.clientX, event.clientY]));
    canvas.addEventListener("pointerup", (event) => {
      if (!down || Math.hypot(event.clientX - down[0], event.clientY - down[1]) > 4) return;
      const box = canvas.getBoundingClientRect();
      const at = new THREE.Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
      const ray = new THREE.Raycaster();
      ray.setFromCamera(at, this.camera);
      const [hit] = this.markers.visible ? ray.intersectObject(this.markers) : [];
      this.events.onPick(hit ? hit.instanceId : null);
    });
    addEventListener("resize", () => this.resize());
  }
}
