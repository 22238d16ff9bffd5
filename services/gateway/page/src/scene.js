// The 3D view: camera, robot, paths, frontiers and field around the map. World axes as in the map frame, z up.
import * as THREE from "three";
import { BlockMap } from "./blocks.js";
import { Boxes } from "./boxes.js";
import { Cameras } from "./cameras.js";
import { FieldSlice } from "./field.js";
import { FatLine } from "./lines.js";
import { FrontierMarks } from "./marks.js";
import { listen } from "./pointer.js";
import { SurfaceMesh } from "./surface.js";

const THEMES = {
  dark: { back: "#0c0f14", grid: "#1d2430", section: "#323b49", flown: "#f2f5f9", ahead: "#4cc2ff", robot: "#ffffff",
    sealed: "#2be62b", fate: ["#f5b83d", "#45d19a", "#707b8c"] },
  light: { back: "#eef1f5", grid: "#d4dae3", section: "#aab4c2", flown: "#1b2433", ahead: "#0a7ac2", robot: "#17202e",
    sealed: "#007a10", fate: ["#d98600", "#12885a", "#8792a3"] },
};
const MAX_RATIO = 2; // of device pixels; beyond, only the cost grows
const MIN_RATIO = 0.5;

export class Scene {
  #needsFrame = true;
  #ratio = Math.min(devicePixelRatio, MAX_RATIO);
  #pace = 16; // [ms] between frames, smoothed
  #lastDraw = 0;
  #layers = { map: true, flown: true, ahead: true, frontiers: true, field: false, unknown: false, noGo: true, surface: false };

  /** @param keys Keys, of which the view claims those that move its camera */
  constructor(canvas, keys, events) {
    // { onPick({ frontier, point, normal, at }), onCamera(name), onBox(box while it is drawn), bornAt as BlockMap, covered() and
    // clear() as Cameras: what panels hide of the view, and where nothing is hidden [px]; by default nothing is }
    const clear = () => ({ left: 0, top: 0, right: canvas.clientWidth, bottom: canvas.clientHeight });
    this.events = { covered: () => ({ right: 0, bottom: 0 }), clear, ...events };
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, powerPreference: "high-performance" });
    this.scene = new THREE.Scene();
    this.map = new BlockMap(events.bornAt);
    this.surface = new SurfaceMesh(this.map.uniforms.cut);
    this.surface.group.visible = false;
    this.scene.add(this.map.group, this.map.border, this.surface.group);
    this.boxes = new Boxes();
    this.scene.add(this.boxes.group);
    this.drawing = false; // whether dragging draws a box
    this.grid = null;
    this.flown = new FatLine(2);
    this.ahead = new FatLine(4);
    this.streamline = new FatLine(1.5);
    for (const line of [this.flown, this.ahead, this.streamline]) this.scene.add(line.line);
    this.#makeRobot();
    this.cameras = new Cameras(canvas, keys, this.map, this.robot, this.frustum, { changed: () => this.changed(), hasPose: () => this.hasPose,
      radiusOf: () => this.radius, clear: () => this.events.clear(), onCamera: (mode) => {
        this.#showRobot();
        events.onCamera(mode);
      } });
    this.camera = this.cameras.camera;
    this.controls = this.cameras.controls;
    this.marks = new FrontierMarks();
    this.scene.add(this.marks.group);
    this.field = new FieldSlice();
    this.scene.add(this.field.group);
    this.#makeTarget();
    listen(canvas, this);
    addEventListener("resize", () => this.resize());
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
    this.field.setTheme(theme.flown, theme.sealed);
    this.target.children.forEach(({ material }) => material.color.set(theme.ahead));
    this.#layGrid();
    this.marks.setTheme(theme.fate, theme.robot);
    this.changed();
  }

  changed() {
    this.#needsFrame = true;
  }

  resize() {
    const { clientWidth, clientHeight } = this.renderer.domElement;
    this.renderer.setPixelRatio(this.#ratio);
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.cameras.resize(clientWidth, clientHeight, this.events.covered());
    this.changed();
  }

  get mode() {
    return this.cameras.mode;
  }
  setMode(mode) {
    this.cameras.set(mode);
  }
  /** Brings the whole map into view. */
  frame() {
    this.cameras.frame();
  }

  setLayer(name, on) {
    this.#layers[name] = on;
    this.map.group.visible = this.#layers.map;
    this.surface.group.visible = this.#layers.surface;
    this.flown.line.material.visible = this.#layers.flown;
    this.ahead.line.material.visible = this.#layers.ahead;
    this.marks.showAll(this.#layers.frontiers);
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
    const isNew = !this.hasPose;
    this.hasPose = true;
    if (isNew) this.#showRobot();
    this.cameras.onRobot(moved, isNew);
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
    this.radius = radius;
    this.hasShape = true;
    this.#showRobot();
    this.changed();
  }

  setFrontiers(frontiers) {
    this.marks.set(frontiers);
    this.changed();
  }
  /** Brings a place { x, y, z } into view, as far as the camera may be moved. */
  show(place) {
    this.cameras.show(place);
  }
  /** Marks the frontier of this number; null for none. */
  select(index) {
    this.marks.select(index);
    this.changed();
  }

  /** @param message sensor_msgs/msg/PointCloud2 with x, y, z, intensity */
  setField(message, height) {
    this.field.set(message, height);
    this.changed();
  }
  /** @param message sensor_msgs/msg/PointCloud2 with x, y, z */
  setSealed(message) {
    this.field.setSealed(message);
    this.changed();
  }
  clearField() {
    this.field.clear();
    this.changed();
  }
  sliceField(height) {
    this.field.cutAt(height);
    this.changed();
  }

  /** Draws a frame if anything has changed. Returns whether it has. */
  draw() {
    if (this.cameras.update(this.#pace)) this.#needsFrame = true;
    this.map.lookFrom(this.camera, this.renderer.domElement.height);
    // Where drawing takes long, faces may take as long, or a large map would be complete only after minutes.
    const budget = Math.max(8, this.#pace / 2);
    if (this.map.rebuild(budget)) {
      this.#needsFrame = true;
      this.#layGrid();
      if (!this.cameras.touched && this.mode === "orbit") this.frame();
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

  #makeRobot() {
    this.robot = new THREE.Group();
    this.robot.visible = false;
    this.hasPose = this.hasShape = false;
    this.radius = 0; // [m]
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

  /** Begins or ends the drawing of a box: dragging on the map then draws instead of turning. */
  setDrawing(on) {
    this.drawing = on;
    this.renderer.domElement.style.cursor = on ? "crosshair" : "";
    if (this.mode === "robot" && on) this.setMode("orbit");
    this.cameras.allow(!on);
  }
  setDraft(box) {
    this.boxes.setDraft(box);
    this.changed();
  }
  setNoGo(boxes) {
    this.boxes.set(boxes);
    this.changed();
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

  /** Where a place [x, y, z] in map is on the screen [px]. */
  screenOf(place) {
    this.camera.updateMatrixWorld();
    const at = new THREE.Vector3(...place).project(this.camera);
    const box = this.renderer.domElement.getBoundingClientRect();
    return [box.left + ((at.x + 1) / 2) * box.width, box.top + ((1 - at.y) / 2) * box.height];
  }
}
