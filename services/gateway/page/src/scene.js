// The 3D view: camera, robot, paths, frontiers and field around the map. World axes as in the map frame, z up.
import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { Line2 } from "three/addons/lines/Line2.js";
import { LineGeometry } from "three/addons/lines/LineGeometry.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";
import { BlockMap } from "./blocks.js";
import { Boxes } from "./boxes.js";
import { FieldSlice } from "./field.js";
import { Fly } from "./fly.js";
import { SurfaceMesh } from "./surface.js";

export const FATE = { left: 0, chosen: 1, aside: 2 };
const THEMES = {
  dark: { back: "#0c0f14", grid: "#1d2430", section: "#323b49", flown: "#f2f5f9", ahead: "#4cc2ff", robot: "#ffffff",
    fate: ["#f5b83d", "#45d19a", "#707b8c"] },
  light: { back: "#eef1f5", grid: "#d4dae3", section: "#aab4c2", flown: "#1b2433", ahead: "#0a7ac2", robot: "#17202e",
    fate: ["#d98600", "#12885a", "#8792a3"] },
};
const MAX_RATIO = 2; // of device pixels; beyond, only the cost grows
const MIN_RATIO = 0.5;

export class FatLine {
  constructor(width) {
    this.material = new LineMaterial({ linewidth: width, worldUnits: false });
    this.line = new Line2(new LineGeometry(), this.material);
    this.line.visible = false;
    this.line.frustumCulled = false;
  }
  /** @param points flat x, y, z; @param breaks numbers of points to which no line leads */
  set(points, breaks = new Set()) {
    const pairs = [];
    for (let n = 1; n < points.length / 3; ++n) {
      if (!breaks.has(n)) for (let k = 3 * n - 3; k < 3 * n + 3; ++k) pairs.push(points[k]);
    }
    this.line.visible = pairs.length > 0;
    if (!this.line.visible) return;
    this.line.geometry.dispose();
    this.line.geometry = new LineSegmentsGeometry();
    this.line.geometry.setPositions(pairs);
  }
  /** How many pieces of it are drawn. */
  get pieces() {
    return this.line.visible && this.material.visible ? this.line.geometry.getAttribute("instanceStart").count : 0;
  }
}

export class Scene {
  #needsFrame = true;
  #chosen = null;
  #ratio = Math.min(devicePixelRatio, MAX_RATIO);
  #pace = 16; // [ms] between frames, smoothed
  #lastDraw = 0;
  #layers = { map: true, flown: true, ahead: true, frontiers: true, field: false, unknown: false, noGo: true, surface: false };

  /** @param keys Keys, of which the view claims those that move its camera */
  constructor(canvas, keys, events) {
    // { onPick({ frontier, point, normal, at }), onCamera(name), onBox(box while it is drawn), bornAt as BlockMap, covered [px] at
    // the right }
    this.events = events;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, powerPreference: "high-performance" });
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(50, 1, 0.05, 2000);
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(-7, -8, 9);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = true;
    this.controls.addEventListener("change", () => (this.#needsFrame = true));
    this.controls.addEventListener("start", () => (this.touched = true));
    this.touched = false;
    this.mode = "orbit";

    this.map = new BlockMap(events.bornAt);
    this.surface = new SurfaceMesh(this.map.uniforms.cut);
    this.surface.group.visible = false;
    this.scene.add(this.map.group, this.map.border, this.surface.group);
    this.boxes = new Boxes();
    this.scene.add(this.boxes.group);
    this.drawing = false; // whether dragging draws a box
    this.fly = new Fly(this.camera, canvas, keys);
    this.grid = null;
    this.flown = new FatLine(2);
    this.ahead = new FatLine(4);
    this.streamline = new FatLine(1.5);
    for (const line of [this.flown, this.ahead, this.streamline]) this.scene.add(line.line);
    this.#makeRobot();
    this.#makeFrontiers();
    this.field = new FieldSlice();
    this.scene.add(this.field.group);
    this.#makeTarget();
    this.#listen(canvas);
    this.setTheme("dark");
    this.resize();
  }

  setTheme(name) {
    const theme = THEMES[name];
    this.theme = theme;
    this.renderer.setClearColor(theme.back);
    this.map.setSection(theme.section);
    this.flown.material.color.set(theme.flown);
    this.ahead.material.color.set(theme.ahead);
    this.streamline.material.color.set("#c38bff");
    this.body.material.color.set(theme.robot);
    this.frustum.material.color.set(theme.ahead);
    this.field.setTheme(theme.flown);
    this.target.children.forEach(({ material }) => material.color.set(theme.ahead));
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
    const covered = clientWidth > 900 ? (this.events.covered ?? 330) : 0;
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
    this.setMode("orbit"); // first, since it keeps what another camera has had in view
    this.controls.target.copy(center);
    this.camera.position.copy(center).addScaledVector(direction, radius * 2.15);
    this.touched = false;
    this.changed();
  }

  setMode(mode) {
    if (this.mode === "robot" && mode !== "robot") {
      this.camera.up.set(0, 0, 1);
      this.camera.position.copy(this.robot.position).add(new THREE.Vector3(-3, -3, 3.5));
      this.controls.target.copy(this.robot.position);
      this.camera.lookAt(this.robot.position); // it looked where the robot looks
    }
    this.mode = mode;
    this.fly.on = mode === "fly";
    this.controls.enabled = (mode === "orbit" || mode === "follow") && !this.drawing;
    if (mode === "orbit" || mode === "follow") this.#keepTargetAhead();
    this.#showRobot();
    this.events.onCamera(mode);
    this.changed();
  }

  setLayer(name, on) {
    this.#layers[name] = on;
    this.map.group.visible = this.#layers.map;
    this.surface.group.visible = this.#layers.surface;
    this.flown.line.material.visible = this.#layers.flown;
    this.ahead.line.material.visible = this.#layers.ahead;
    this.markers.visible = this.#layers.frontiers;
    this.field.group.visible = this.#layers.field;
    this.boxes.inForce.visible = this.#layers.noGo;
    if (name === "unknown") this.map.showBorder(on);
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
    const turned = new THREE.Quaternion(q.x, q.y, q.z, q.w);
    const moved = new THREE.Vector3(p.x, p.y, p.z).sub(this.robot.position);
    if (this.hasPose && moved.lengthSq() === 0 && turned.equals(this.robot.quaternion)) return; // a robot that stands costs no frame
    this.robot.position.set(p.x, p.y, p.z);
    this.robot.quaternion.copy(turned);
    if (!this.hasPose) {
      this.hasPose = true;
      this.#showRobot();
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
    this.hasShape = true;
    this.#showRobot();
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
  setField(message, height) {
    this.field.set(message, height);
    this.changed();
  }
  sliceField(height) {
    this.field.cutAt(height);
    this.changed();
  }

  /** Draws a frame if anything has changed. Returns whether it has. */
  draw() {
    if (this.mode === "robot" && this.hasPose && this.hasShape) this.#lookAsRobot();
    else if (this.mode === "fly") this.#needsFrame = this.fly.update() || this.#needsFrame;
    else {
      this.controls.dampingFactor = 1 - 0.88 ** (this.#pace / 16); // as long at any frame rate
      this.controls.update();
    }
    this.map.lookFrom(this.camera, this.renderer.domElement.height);
    // Where drawing takes long, faces may take as long, or a large map would be complete only after minutes.
    const budget = Math.max(8, this.#pace / 2);
    if (this.map.rebuild(budget)) {
      this.#needsFrame = true;
      this.#layGrid();
      if (!this.touched && this.mode === "orbit") this.frame();
    }
    if (this.surface.rebuild(budget)) this.#needsFrame = true;
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
    this.hasPose = this.hasShape = false;
    this.body = new THREE.Mesh(new THREE.BufferGeometry(), new THREE.MeshStandardMaterial({ roughness: 0.5 }));
    this.frustum = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial());
    this.frustum.frustumCulled = false;
    // Looks along the body's x axis until transforms arrive.
    this.frustum.quaternion.set(-0.5, 0.5, -0.5, 0.5);
    this.robot.add(this.body, this.frustum);
    this.scene.add(this.robot, new THREE.HemisphereLight("#ffffff", "#7a8699", 2.2));
    const sun = new THREE.DirectionalLight("#ffffff", 1.2);
    sun.position.set(-3, -5, 8);
    this.scene.add(sun);
  }
  #showRobot() {
    this.robot.visible = this.mode !== "robot" && this.hasPose && this.hasShape;
  }

  /** Where a command is about to send the robot: a ball, and the line down to what was clicked. */
  #makeTarget() {
    this.target = new THREE.Group();
    this.target.add(new THREE.Mesh(new THREE.SphereGeometry(0.1, 20, 14), new THREE.MeshBasicMaterial()),
      new THREE.Line(new THREE.BufferGeometry(), new THREE.LineBasicMaterial()));
    this.target.visible = false;
    this.scene.add(this.target);
  }
  /** @param goal, foot points in map; goal null hides it */
  setTarget(goal, foot) {
    this.target.visible = goal !== null;
    if (goal) {
      this.target.children[0].position.copy(goal);
      this.target.children[1].geometry.setFromPoints([new THREE.Vector3().copy(foot), new THREE.Vector3().copy(goal)]);
    }
    this.changed();
  }

  /** After flying, orbits turn about what the camera looks at. */
  #keepTargetAhead() {
    const forward = this.camera.getWorldDirection(new THREE.Vector3());
    const distance = Math.max(this.camera.position.distanceTo(this.controls.target), 1);
    const to = this.controls.target.clone().sub(this.camera.position).normalize();
    if (to.dot(forward) < 0.95) this.controls.target.copy(this.camera.position).addScaledVector(forward, Math.min(distance, 6));
  }

  /** Begins or ends the drawing of a box: dragging on the map then draws instead of turning. */
  setDrawing(on) {
    this.drawing = on;
    this.renderer.domElement.style.cursor = on ? "crosshair" : "";
    this.setMode(this.mode === "robot" && on ? "orbit" : this.mode);
  }
  setDraft(box) {
    this.boxes.setDraft(box);
    this.changed();
  }
  setNoGo(boxes) {
    this.boxes.set(boxes);
    this.changed();
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

  #rayAt(event) {
    const box = this.renderer.domElement.getBoundingClientRect();
    const at = new THREE.Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
    const caster = new THREE.Raycaster();
    caster.setFromCamera(at, this.camera);
    return caster;
  }
  /** Where a ray meets the floor's plane; null if it does not. */
  #onFloor({ ray }) {
    const floor = Number.isFinite(this.map.low) ? this.map.low : 0;
    return ray.intersectPlane(new THREE.Plane(new THREE.Vector3(0, 0, 1), -floor), new THREE.Vector3());
  }

  /** Where a place [x, y, z] in map is on the screen [px]. */
  screenOf(place) {
    this.camera.updateMatrixWorld();
    const at = new THREE.Vector3(...place).project(this.camera);
    const box = this.renderer.domElement.getBoundingClientRect();
    return [box.left + ((at.x + 1) / 2) * box.width, box.top + ((1 - at.y) / 2) * box.height];
  }

  #pick(event) {
    const caster = this.#rayAt(event);
    const solid = this.map.group.visible || this.surface.group.visible ? this.map.cast(caster.ray) : null;
    const [marker] = this.markers.visible ? caster.intersectObject(this.markers) : [];
    // A frontier behind a wall can still be clicked: it is drawn before the wall in no view, but wanted more.
    const floor = solid ? null : this.#onFloor(caster);
    this.events.onPick({ frontier: marker ? marker.instanceId : null, point: solid?.point ?? floor,
      normal: solid?.normal ?? new THREE.Vector3(0, 0, 1), at: [event.clientX, event.clientY] });
  }

  /** While a box is drawn: its foot is dragged on the floor, its height by the handle. */
  #listenForBoxes(canvas) {
    let from = null, pulling = false;
    canvas.addEventListener("pointerdown", (event) => {
      if (!this.drawing || event.button !== 0) return;
      const caster = this.#rayAt(event);
      pulling = this.boxes.handle.visible && caster.intersectObject(this.boxes.handle).length > 0;
      from = pulling ? null : this.#onFloor(caster);
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (!this.drawing) return;
      const caster = this.#rayAt(event);
      if (pulling) {
        const { min, max } = this.boxes.box;
        this.events.onBox({ min, max: { ...max, z: Math.max(this.boxes.pullTo(caster.ray), min.z + 0.1) } });
      } else if (from) {
        const to = this.#onFloor(caster);
        if (!to || from.distanceTo(to) > 100) return;
        const { min, max } = this.boxes.box ?? { min: { z: from.z }, max: { z: from.z + 2 } };
        this.events.onBox({ min: { x: Math.min(from.x, to.x), y: Math.min(from.y, to.y), z: min.z },
          max: { x: Math.max(from.x, to.x), y: Math.max(from.y, to.y), z: max.z } });
      }
    });
    addEventListener("pointerup", () => {
      from = null;
      pulling = false;
    });
  }

  #listen(canvas) {
    let down = null;
    canvas.addEventListener("pointerdown", (event) => (down = event.button === 0 ? [event.clientX, event.clientY] : null));
    canvas.addEventListener("pointerup", (event) => {
      if (this.drawing || !down || Math.hypot(event.clientX - down[0], event.clientY - down[1]) > 4) return;
      this.#pick(event);
    });
    this.#listenForBoxes(canvas);
    addEventListener("resize", () => this.resize());
  }
}
