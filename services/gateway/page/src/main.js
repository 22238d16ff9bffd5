// The page: connects the gateway's channels to the 3D view and the panels.
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import { Connection } from "./connection.js";
import { Drawer } from "./drawer.js";
import { DONE } from "./enums.js";
import { FieldFeed } from "./field_feed.js";
import { Heights } from "./heights.js";
import { fillHelp, toggleHelp } from "./help.js";
import { History } from "./history.js";
import { Keys } from "./keys.js";
import { Layers } from "./layers.js";
import { Log } from "./log.js";
import { Services, showFrontierAge, showFrontiers, showLink, showNoExplorer, showStatus, showTime, showWhy } from "./panels.js";
import { Paint } from "./paint.js";
import { Pictures } from "./pictures.js";
import { Plot } from "./plots.js";
import { RAMP_CSS } from "./ramp.js";
import { robotFrom } from "./robot.js";
import { Scene } from "./scene.js";
import { Steering } from "./steering.js";
import { showSurface } from "./surface.js";
import { Timeline } from "./timeline.js";
import { toast } from "./toasts.js";
import { Transforms } from "./transforms.js";

const $ = (id) => document.getElementById(id);
const TOPICS = {
  blocks: "/thalweg/blocks", history: "/thalweg/history", odometry: "/odometry", transforms: "/tf", staticTransforms: "/tf_static", path: "/explorer/path",
  status: "/explorer/status", frontiers: "/explorer/frontiers", field: "/explorer/field", sealed: "/explorer/sealed",
  streamline: "/explorer/streamline",
  health: "/health", log: "/rosout", replay: "/replay/status", left: "/stereo/left/image_raw", right: "/stereo/right/image_raw", disparity: "/stereo/disparity",
  depth: "/depth/image", colored: "/map/colored", surface: "/thalweg/surface", surfaceStatus: "/surface/status",
};

const keys = new Keys();
const drawer = new Drawer(() => {
  scene.resize();
  if (!scene.cameras.touched) scene.frame();
});
const scene = new Scene($("view"), keys, {
  onPick: ({ frontier, point, normal, at }) => {
    steering.forget();
    select(frontier);
    if (frontier !== null) drawer.show($("why-card"));
    if (frontier === null && point && steersRobot()) steering.point({ point, normal, at });
  },
  onBox: (box) => steering.drawn(box),
  onCamera: (mode) => {
    for (const button of document.querySelectorAll("[data-camera]")) button.classList.toggle("on", button.dataset.camera === mode);
  },
  covered: () => drawer.covered(), clear: () => drawer.clear(),
});
const services = new Services((name, event) => {
  // With the gateway gone, or the run at its end, that is no news.
  if (event === "silent" && isLinked && !hasEnded()) toast("no sign of life for 3.5 s", "bad", name);
  if (event === "restarted") toast("was restarted", "warn", name);
  if (event === "back") toast("is heard again", "good", name);
});
const log = new Log($("log"), $("log-warnings"));
const one = (value) => value.toFixed(value < 10 ? 2 : 1);
const plots = {
  known: new Plot($("plots"), { title: "Known volume", unit: "m³", format: one, color: "--accent" }),
  rate: new Plot($("plots"), { title: "Rate", unit: "m³/s", format: (v) => v.toFixed(2), color: "--good", rate: 10 }),
  distance: new Plot($("plots"), { title: "Distance", unit: "m", format: one, color: "--warn" }),
  planning: new Plot($("plots"), { title: "Planning, median", unit: "ms", format: (v) => v.toFixed(0), color: "--accent" }),
};

// ---- Frontiers

let frontiers = null; // until they are heard
let frontiersAt = 0; // [s] their stamp
const secondsOf = ({ header: { stamp } }) => stamp.sec + stamp.nanosec * 1e-9;
let selected = null; // the frontier itself, since indices change with every plan
function indexOfSelected() {
  if (!selected || !frontiers) return null;
  const { x, y, z } = selected.center;
  const distances = frontiers.map(({ center }) => Math.hypot(center.x - x, center.y - y, center.z - z));
  const least = Math.min(...distances);
  return least < 0.3 ? distances.indexOf(least) : null;
}
function drawFrontiers() {
  const index = indexOfSelected();
  selected = index === null ? null : frontiers[index];
  scene.select(index);
  showWhy(selected);
  showFrontiers(frontiers, index, selectInList);
}
function select(index) {
  selected = index === null ? null : frontiers[index];
  drawFrontiers();
}

/** A row of the list: the frontier may be anywhere, and comes into view. */
function selectInList(index) {
  select(index);
  scene.show(selected.center);
}

// ---- Flown path and curves

const run = new History();
let recording = null; // that its rows are of, if it is a replay's
let flown = 0; // points of the path
function onHistory(message) {
  const file = timeline.shown?.file ?? null;
  run.add(message, file !== null && file === recording);
  recording = file;
  drawHistory();
}
function drawHistory() {
  const { points, breaks } = run.path();
  scene.flown.set(points, breaks);
  flown = points.length / 3;
  for (const [name, source] of Object.entries({ known: "known", rate: "known", distance: "distance", planning: "planning" })) plots[name].set(run.curve(source));
  scene.changed();
}

const flat = (path) => path.poses.flatMap(({ pose: { position: p } }) => [p.x, p.y, p.z]);

// ---- Connection

function resetAll() {
  scene.map.clear();
  scene.surface.clear();
  run.clear();
  frontiers = null;
  status = null;
  field.follow(null);
  services.clear();
  log.clear();
  transforms.clear();
  drawHistory();
  for (const line of [scene.ahead, scene.streamline]) line.set([]);
  scene.setFrontiers([]);
  drawFrontiers();
}

const WAITING = ["b", "span"].map((its) => $("empty").querySelector(its).textContent);
const query = new URLSearchParams(location.search); // holds the token, if one is needed
query.set("name", "page");
let steers = false;
let isLinked = false;
let explorerHeard = false;
/** Whether there is a robot that this page may steer: the one of a replay cannot be. */
const steersRobot = () => steers && explorerHeard && !timeline.present;
function showWhoIsThere() {
  const before = explorerHeard;
  explorerHeard = services.hears("explorer");
  if (explorerHeard && !before && status) showStatus(status, timeline.present);
  showWhatSteers();
  // One that has ended says how.
  if (!explorerHeard && !timeline.present && !hasEnded()) showNoExplorer();
}
function showWhatSteers() {
  steering.allow(steersRobot());
  timeline.allow(steers);
  $("read-only").hidden = steers;
  $("replayed").hidden = !timeline.present;
  if (status && explorerHeard) showStatus(status, timeline.present);
}
let pose = null; // of the robot
let status = null; // of the exploration
const hasEnded = () => status?.state === DONE;
let robot = null; // its shape and frames
const transforms = new Transforms();
const connection = new Connection(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/?${query}`, {
  onLink: (state, text) => {
    isLinked = state === "live";
    if (state === "lost" && hasEnded()) showLink("", "run is over");
    else showLink(state, text);
    const [title, more] = state === "refused" ? ["The gateway refuses this page", text] : WAITING;
    $("empty").querySelector("b").textContent = title;
    $("empty").querySelector("span").textContent = more;
  },
  onReset: resetAll,
  onTime: showTime,
  onSteering: (allowed) => {
    steers = allowed;
    showWhatSteers();
  },
  onParameters: (values) => {
    robot = robotFrom(values);
    scene.setRobotShape(robot);
    placeCamera();
    const at = (n, end) => ({ x: values.get(`world.no_go.${n}.${end}.x`), y: values.get(`world.no_go.${n}.${end}.y`), z: values.get(`world.no_go.${n}.${end}.z`) });
    const boxes = [];
    for (let n = 0; values.has(`world.no_go.${n}.min_m.x`); ++n) boxes.push({ min: at(n, "min_m"), max: at(n, "max_m") });
    steering.setFixedBoxes(boxes);
  },
}, (schema) => new MessageReader(parse(schema, { ros2: true })),
() => fetch(`/may-connect?${query}`).then(async (answer) => (answer.ok ? "" : answer.text()), () => ""));
const timeline = new Timeline(connection, keys, showWhatSteers, () => run.jump());
const steering = new Steering(connection, scene, keys, { replay: timeline, robot: () => pose?.position ?? null, frontier: () => selected,
  deselect: () => select(null), strategies: STRATEGIES });

connection.subscribe(TOPICS.blocks, (message) => {
  scene.map.update(message);
  $("empty").hidden = scene.map.blockCount > 0;
});
connection.subscribe(TOPICS.history, onHistory);
connection.subscribe(TOPICS.odometry, (message) => {
  pose = message.pose.pose;
  scene.setPose(pose);
});
/** By whoever states it: our own publisher of poses, the mapper, or the robot's, in tf_static or with joints of its own. */
function placeCamera() {
  const camera = robot && transforms.poseOf(robot.cameraFrame, robot.bodyFrame);
  if (camera) scene.setCameraInBody(camera);
}
for (const topic of [TOPICS.transforms, TOPICS.staticTransforms]) {
  connection.subscribe(topic, (message) => {
    transforms.add(message);
    placeCamera();
  });
}
connection.subscribe(TOPICS.path, (message) => {
  scene.ahead.set(flat(message));
  scene.changed();
});
connection.subscribe(TOPICS.status, (message) => {
  const ended = message.state === DONE && status?.state !== DONE;
  status = message;
  showStatus(message, timeline.present);
  field.follow(message.strategy);
  if (ended) drawFrontiers();
  showFrontierAge(hasEnded() || frontiers === null ? 0 : secondsOf(message) - frontiersAt);
  steering.update(message);
});
connection.subscribe(TOPICS.frontiers, (message) => {
  frontiers = message.frontiers;
  frontiersAt = secondsOf(message);
  field.decided(frontiersAt);
  showFrontierAge(0);
  scene.setFrontiers(frontiers);
  drawFrontiers();
});
connection.subscribe(TOPICS.health, (message) => services.update(message));
connection.subscribe(TOPICS.log, (message) => log.add(message));
connection.subscribe(TOPICS.replay, (message) => {
  timeline.update(message);
  // A second later than now, since the machines that wrote the lines may have had other clocks.
  log.forget(message.now.sec + 1, message.end.sec + 1);
});
connection.subscribe(TOPICS.surfaceStatus, (message) => {
  showSurface($("surface-card"), message);
  layers.hide("surface", false);
});

// ---- What layers need

const pictures = new Pictures(connection, { left: TOPICS.left, right: TOPICS.right, disparity: TOPICS.disparity, depth: TOPICS.depth });
const field = new FieldFeed(connection, TOPICS, {
  onField: (message) => scene.setField(message, heights.slice()),
  onSealed: (message) => scene.setSealed(message),
  onStreamline: (message) => {
    scene.streamline.set(flat(message));
    scene.changed();
  },
  onForgotten: () => {
    scene.clearField();
    scene.streamline.set([]);
  },
  onKnown: (isThere, strategy) => layers.excuse("field", isThere ? "" : "none yet", isThere ? ""
    : `${strategy ? `strategy ${strategy} has published none` : "no explorer has published one"}; those that solve for a potential do, with each decision`),
});

function showLayer(name, on) {
  if (name === "pictures") return pictures.show(on);
  scene.setLayer(name, on);
  if (name === "surface") showSurfaceMesh(on);
  if (name !== "field") return;
  $("slice").hidden = !on;
  if (on) heights.slice();
  field.show(on);
}
/** Voxels would hide it; who wants both turns them on again. */
function showSurfaceMesh(on) {
  layers.set("map", !on);
  if (on) connection.subscribe(TOPICS.surface, (message) => scene.surface.update(message));
  else connection.unsubscribe(TOPICS.surface);
}

// ---- Theme, keys, layers

for (const scale of document.querySelectorAll(".ramp")) scale.style.background = RAMP_CSS;
const paint = new Paint(connection, TOPICS.colored, scene);
const heights = new Heights(scene, () => pose?.position ?? null);

function setTheme(name) {
  document.documentElement.dataset.theme = name;
  localStorage.setItem("theme", name);
  scene.setTheme(name);
  for (const plot of Object.values(plots)) plot.redraw();
}
const theme = () => document.documentElement.dataset.theme;
const swapTheme = () => setTheme(theme() === "dark" ? "light" : "dark");
$("theme").onclick = swapTheme;
setTheme(localStorage.getItem("theme") ?? (matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark"));

const claim = (group, key, text, act, repeats = false) => keys.claim(key, { group, text, act, repeats });
claim("View", "1", "Orbit: drag, right drag, wheel; after Fly about the robot in view, or the map", () => scene.setMode("orbit"));
claim("View", "2", "Follow the robot from behind; again: behind it once more", () => scene.setMode("follow"));
claim("View", "3", "What the robot sees", () => scene.setMode("robot"));
claim("View", "4", "Fly: drag turns, arrow keys move", () => scene.setMode("fly"));
claim("View", "r", "The whole map", () => scene.frame());
claim("View", "[", "Cut lower", () => heights.moveCut(-25), true);
claim("View", "]", "Cut higher", () => heights.moveCut(25), true);
claim("View", "o", "Color the map by height, or as measured", () => paint.by(paint.byColor ? "height" : "color"));
claim("View", "v", "Color the surface by how it was seen", () => {
  scene.surface.uniforms.byViews.value = !scene.surface.uniforms.byViews.value;
  scene.changed();
});
const layers = new Layers(keys, showLayer);
claim("Page", "t", "Dark or light", swapTheme);
claim("Page", "Escape", "Forget what was clicked", () => {
  steering.forget();
  select(null);
});
keys.claim("?", { group: "Page", text: "This help", act: toggleHelp, dialog: "help" });
fillHelp(keys);
keys.listen(window, () => document.querySelector("dialog[open]")?.id ?? null);
// What was clicked would keep the keys that act on it: the space bar, the arrow keys. Who came by keyboard stays there.
addEventListener("click", ({ target, detail }) => detail > 0 && target.closest("button, input[type=range]")?.blur());
$("counts").title = "Known voxels; what arrives; frames drawn";
$("ask").onclick = toggleHelp;
$("why-close").onclick = () => select(null);
for (const button of document.querySelectorAll("[data-camera]")) button.onclick = () => scene.setMode(button.dataset.camera);

// ---- Frames

layers.hide("surface", true); // until there is one
field.follow(null);
layers.reset();
paint.by("height");
scene.setMode("orbit");
drawFrontiers();
let frames = 0, frameTime = 0, bytesBefore = 0;
function tick() {
  const start = performance.now();
  if (scene.draw()) {
    ++frames;
    frameTime += performance.now() - start;
  }
  heights.fit();
  requestAnimationFrame(tick);
}
requestAnimationFrame(tick);
setInterval(() => {
  for (const plot of Object.values(plots)) plot.draw();
  services.draw(hasEnded());
  showWhoIsThere();
  log.draw();
}, 500);
setInterval(() => {
  const { known, occupied } = scene.map.counts();
  const rate = (connection.bytes - bytesBefore) / 1000;
  bytesBefore = connection.bytes;
  const thousand = (n) => n.toLocaleString("en").replaceAll(",", "\u2009");
  const drawn = frames ? `${frames} frames/s` : "still";
  $("counts").textContent = `${thousand(known)} voxels · ${rate.toFixed(0)} kB/s · ${drawn}`;
  const place = pose?.position;
  window.thalweg = { robot: place && [place.x, place.y, place.z], state: status?.state, noGo: status?.no_go.length ?? 0, steers: steersRobot(), replay: timeline.shown, session: connection.session,
    known, occupied, colored: scene.map.coloredCount, byColor: paint.byColor, faces: scene.map.faces, waiting: scene.map.waiting, frames, frameMs: frames ? frameTime / frames : 0, flown,
    surface: scene.surface.faces, surfaceDrawn: scene.surface.group.children.length, surfaceLeft: scene.surface.left,
    field: scene.field.shown, sealed: scene.field.sealed, streamline: scene.streamline.pieces, ahead: scene.ahead.pieces,
    frontiers: frontiers?.length ?? 0, bytes: connection.bytes, borders: scene.map.border.children.length,
    shape: robot, layers: { ...layers.shown }, camera: scene.cameras.shown, curves: run.shown, screenOf: (point) => scene.screenOf(point) };
  frames = frameTime = 0;
}, 1000);
