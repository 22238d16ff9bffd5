// The page: connects the gateway's channels to the 3D view and the panels.
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import { Connection } from "./connection.js";
import { paintPicture } from "./images.js";
import { Keys } from "./keys.js";
import { Log } from "./log.js";
import { DONE } from "./enums.js";
import { Services, showFrontierAge, showFrontiers, showLink, showNoExplorer, showStatus, showTime, showWhy } from "./panels.js";
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
  status: "/explorer/status", frontiers: "/explorer/frontiers", field: "/explorer/field", streamline: "/explorer/streamline",
  health: "/health", log: "/rosout", replay: "/replay/status", left: "/stereo/left/image_raw", right: "/stereo/right/image_raw", disparity: "/stereo/disparity",
  depth: "/depth/image", colored: "/map/colored", surface: "/thalweg/surface", surfaceStatus: "/surface/status",
};

const COLORS_WITHIN = 6000; // [ms] The mapper publishes them every 3 s, once somebody listens.

const keys = new Keys();
const scene = new Scene($("view"), keys, {
  onPick: ({ frontier, point, normal, at }) => {
    steering.forget();
    select(frontier);
    if (frontier === null && point && steersRobot()) steering.point({ point, normal, at });
  },
  onBox: (box) => steering.drawn(box),
  onCamera: (mode) => {
    for (const button of document.querySelectorAll("[data-camera]")) button.classList.toggle("on", button.dataset.camera === mode);
  },
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
  showFrontiers(frontiers, index, select);
}
function select(index) {
  selected = index === null ? null : frontiers[index];
  drawFrontiers();
}

// ---- Flown path and curves

let flown = [];
let flownBreaks = new Set(); // numbers of its points that follow a jump in time
function onHistory(message) {
  if (message.reset) {
    flown = [];
    flownBreaks = new Set();
    for (const plot of Object.values(plots)) plot.clear();
  }
  for (let n = 0; n < message.time_s.length; ++n) {
    const time = message.time_s[n];
    const [x, y, z] = message.position_m.slice(3 * n, 3 * n + 3);
    const last = flown.length;
    if (!Number.isFinite(x)) {
      flownBreaks.add(last / 3);
      for (const plot of Object.values(plots)) plot.interrupt();
      continue;
    }
    const far = last === 0 || Math.hypot(x - flown[last - 3], y - flown[last - 2], z - flown[last - 1]) > 0.02;
    if (far) flown.push(x, y, z);
    plots.known.add(time, message.known_m3[n]);
    plots.rate.add(time, message.known_m3[n]);
    plots.distance.add(time, message.distance_m[n]);
    plots.planning.add(time, message.planning_ms[n]);
  }
  scene.flown.set(flown, flownBreaks);
  scene.changed();
}

const flat = (path) => path.poses.flatMap(({ pose: { position: p } }) => [p.x, p.y, p.z]);

// ---- Connection

function resetAll() {
  scene.map.clear();
  scene.surface.clear();
  flown = [];
  flownBreaks = new Set();
  frontiers = null;
  status = null;
  services.clear();
  log.clear();
  transforms.clear();
  for (const plot of Object.values(plots)) plot.clear();
  for (const line of [scene.flown, scene.ahead, scene.streamline]) line.set([]);
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
const timeline = new Timeline(connection, keys, showWhatSteers);
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
  if (ended) drawFrontiers();
  showFrontierAge(hasEnded() || frontiers === null ? 0 : secondsOf(message) - frontiersAt);
  steering.update(message);
});
connection.subscribe(TOPICS.frontiers, (message) => {
  frontiers = message.frontiers;
  frontiersAt = secondsOf(message);
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
  LAYERS.surface.button.hidden = false;
});

// ---- Layers

const LAYERS = {
  map: { title: "Map", key: "m", color: RAMP_CSS },
  surface: { title: "Surface", key: "y", color: "linear-gradient(90deg, #c9a27b, #8fa9b8)", off: true },
  flown: { title: "Path flown", key: "p", color: "var(--text)" },
  ahead: { title: "Path ahead", key: "a", color: "var(--accent)" },
  frontiers: { title: "Frontiers", key: "f", color: "var(--warn)" },
  unknown: { title: "Border to unknown", key: "u", color: "#b07cff", off: true },
  field: { title: "Field", key: "d", color: "linear-gradient(90deg, #2b3a8f, #f0764a)", off: true },
  noGo: { title: "No-go boxes", key: "n", color: "#ff5c6c" },
  pictures: { title: "Camera", key: "c", color: "var(--good)", off: true },
};
const shown = {};
function setLayer(name, on) {
  shown[name] = on;
  LAYERS[name].button.classList.toggle("on", on);
  LAYERS[name].button.setAttribute("aria-pressed", on);
  if (name === "pictures") return showPictures(on);
  scene.setLayer(name, on);
  if (name === "surface") return showSurfaceMesh(on);
  if (name !== "field") return;
  $("slice").hidden = !on;
  if (on) sliceHeight();
  if (on) {
    connection.subscribe(TOPICS.field, (message) => scene.setField(message, sliceHeight()));
    connection.subscribe(TOPICS.streamline, (message) => {
      scene.streamline.set(flat(message));
      scene.changed();
    });
  } else {
    connection.unsubscribe(TOPICS.field);
    connection.unsubscribe(TOPICS.streamline);
  }
}
/** Voxels would hide it; who wants both turns them on again. */
function showSurfaceMesh(on) {
  setLayer("map", !on);
  if (on) connection.subscribe(TOPICS.surface, (message) => scene.surface.update(message));
  else connection.unsubscribe(TOPICS.surface);
}
for (const [name, layer] of Object.entries(LAYERS)) {
  layer.button = document.createElement("button");
  layer.button.innerHTML = "<i></i><span></span>";
  layer.button.querySelector("span").textContent = layer.title;
  layer.button.style.setProperty("--swatch", layer.color);
  layer.button.title = `${layer.title} (${layer.key.toUpperCase()})`;
  layer.button.onclick = () => setLayer(name, !shown[name]);
  $("layers").append(layer.button);
}
LAYERS.surface.button.hidden = true; // until there is one

// ---- Color of the map: by height, or as it was measured, which is subscribed to only while it is shown

let colorsMissing; // the timer that reports it
function paintMap(paint) {
  const byColor = paint === "color";
  for (const button of document.querySelectorAll("[data-paint]")) {
    button.classList.toggle("on", button.dataset.paint === paint);
    button.setAttribute("aria-checked", button.dataset.paint === paint);
  }
  scene.map.paintByColor(byColor);
  scene.changed();
  $("legend-heights").hidden = byColor;
  $("no-colors").hidden = true;
  clearTimeout(colorsMissing);
  if (!byColor) return connection.unsubscribe(TOPICS.colored);
  colorsMissing = setTimeout(() => ($("no-colors").hidden = false), COLORS_WITHIN);
  connection.subscribe(TOPICS.colored, (message) => {
    clearTimeout(colorsMissing);
    $("no-colors").hidden = true;
    scene.map.setColors(message);
    scene.changed();
  });
}
const paintsByColor = () => scene.map.uniforms.byColor.value;
for (const button of document.querySelectorAll("[data-paint]")) button.onclick = () => paintMap(button.dataset.paint);

// ---- Pictures: subscribed to only while shown

let picture = "left";
let pictureMissing; // the timer that reports it
const SOURCE = { depth: "a robot with depth_source: DEPTH_IMAGE publishes it" };
const STEREO_SOURCE = "a simulated run has cameras with depth_source: STEREO, as in kitchen_stereo";
function showScale(scale) {
  $("picture-scale").hidden = scale === null;
  if (scale === null) return;
  const number = (value) => `${value.toFixed(scale.unit === "m" ? 1 : 0)} ${scale.unit}`;
  $("scale-low").textContent = number(scale.low);
  $("scale-high").textContent = number(scale.high);
}
function showPictures(on) {
  $("pictures").hidden = !on;
  $("picture-info").title = "";
  clearTimeout(pictureMissing);
  for (const button of document.querySelectorAll("[data-picture]")) {
    connection.unsubscribe(TOPICS[button.dataset.picture]);
    button.classList.toggle("on", button.dataset.picture === picture);
  }
  if (!on) return;
  $("picture-info").textContent = "no image yet";
  showScale(null);
  pictureMissing = setTimeout(() => {
    $("picture-info").textContent = "no image arrives";
    $("picture-info").title = `None has come on ${TOPICS[picture]}: ${SOURCE[picture] ?? STEREO_SOURCE}.`;
  }, 2000);
  $("picture").getContext("2d").clearRect(0, 0, $("picture").width, $("picture").height);
  connection.subscribe(TOPICS[picture], (message) => {
    clearTimeout(pictureMissing);
    $("picture-info").title = "";
    const { text, scale } = paintPicture($("picture"), message);
    $("picture-info").textContent = text;
    showScale(scale ?? null);
  });
}
for (const button of document.querySelectorAll("[data-picture]")) {
  button.onclick = () => {
    picture = button.dataset.picture;
    showPictures(true);
  };
}

// ---- Cut, theme, keys

for (const scale of document.querySelectorAll(".ramp")) scale.style.background = RAMP_CSS;
function drawCut() {
  const { low, high } = scene.map;
  if (!Number.isFinite(low)) return;
  const share = $("cut").value / 1000;
  const height = low + (high - low) * share;
  scene.map.uniforms.low.value = low;
  scene.map.uniforms.high.value = high;
  scene.setCut(share >= 1 ? 1e9 : height);
  $("cut-value").textContent = share >= 1 ? "none" : `${height.toFixed(2)} m`;
  $("legend-low").textContent = `${low.toFixed(1)} m`;
  $("legend-high").textContent = `${high.toFixed(1)} m`;
}
$("cut").oninput = drawCut;

/** At the robot, until somebody moves the slider. */
let sliceMoved = false;
function sliceHeight() {
  const { low, high } = scene.map;
  if (!sliceMoved && pose && high > low) $("slice-height").value = Math.round((1000 * (pose.position.z - low)) / (high - low));
  const height = low + ((high - low) * $("slice-height").value) / 1000;
  $("slice-value").textContent = Number.isFinite(height) ? `${height.toFixed(2)} m` : "–"; // without a map
  return height;
}
$("slice-height").oninput = () => {
  sliceMoved = true;
  scene.sliceField(sliceHeight());
};
function moveCut(by) {
  $("cut").value = Number($("cut").value) + by;
  drawCut();
}

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
claim("View", "1", "Orbit: drag, right drag, wheel", () => scene.setMode("orbit"));
claim("View", "2", "Follow the robot", () => scene.setMode("follow"));
claim("View", "3", "What the robot sees", () => scene.setMode("robot"));
claim("View", "4", "Fly: drag turns, arrow keys move", () => scene.setMode("fly"));
claim("View", "r", "The whole map", () => scene.frame());
claim("View", "[", "Cut lower", () => moveCut(-25), true);
claim("View", "]", "Cut higher", () => moveCut(25), true);
for (const [name, { key, title }] of Object.entries(LAYERS)) claim("Layers", key, title, () => {
  if (LAYERS[name].button.hidden) toast("this run has none: thalweg run --surface", "", title);
  else setLayer(name, !shown[name]);
});
claim("View", "o", "Color the map by height, or as measured", () => paintMap(paintsByColor() ? "height" : "color"));
claim("View", "v", "Color the surface by how it was seen", () => {
  scene.surface.uniforms.byViews.value = !scene.surface.uniforms.byViews.value;
  scene.changed();
});
claim("Page", "t", "Dark or light", swapTheme);
claim("Page", "Escape", "Forget what was clicked", () => {
  steering.forget();
  select(null);
});
keys.claim("?", { group: "Page", text: "This help", act: () => toggleHelp(), dialog: "help" });
for (const [group, lines] of keys.help()) {
  const section = document.createElement("section"), title = document.createElement("h3"), dl = document.createElement("dl");
  title.textContent = group;
  for (const [names, text] of lines) {
    const dt = document.createElement("dt"), dd = document.createElement("dd");
    for (const name of names) dt.append(Object.assign(document.createElement("kbd"), { textContent: name }));
    dd.textContent = text;
    dl.append(dt, dd);
  }
  section.append(title, dl);
  $("keys").append(section);
}
function toggleHelp() {
  if ($("help").open) $("help").close();
  else $("help").showModal();
}
keys.listen(window, () => document.querySelector("dialog[open]")?.id ?? null);
// What was clicked would keep the keys that act on it: the space bar, the arrow keys. Who came by keyboard stays there.
addEventListener("click", ({ target, detail }) => detail > 0 && target.closest("button, input[type=range]")?.blur());
$("counts").title = "Known voxels; what arrives; frames drawn";
$("ask").onclick = toggleHelp;
$("why-close").onclick = () => select(null);
for (const button of document.querySelectorAll("[data-camera]")) button.onclick = () => scene.setMode(button.dataset.camera);

// ---- Frames

for (const name of Object.keys(LAYERS)) setLayer(name, !LAYERS[name].off);
paintMap("height");
scene.setMode("orbit");
drawFrontiers();
let frames = 0, frameTime = 0, bytesBefore = 0, heights = "";
function tick() {
  const start = performance.now();
  if (scene.draw()) {
    ++frames;
    frameTime += performance.now() - start;
  }
  const its = `${scene.map.low} ${scene.map.high}`;
  if (its !== heights) {
    heights = its;
    drawCut();
  }
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
    known, occupied, colored: scene.map.coloredCount, byColor: paintsByColor(), faces: scene.map.faces, waiting: scene.map.waiting, frames, frameMs: frames ? frameTime / frames : 0, flown: flown.length / 3,
    surface: scene.surface.faces, surfaceDrawn: scene.surface.group.children.length, surfaceLeft: scene.surface.left,
    field: scene.field.shown, streamline: scene.streamline.pieces, ahead: scene.ahead.pieces, frontiers: frontiers?.length ?? 0, bytes: connection.bytes, borders: scene.map.border.children.length,
    shape: robot, layers: { ...shown }, screenOf: (point) => scene.screenOf(point) };
  frames = frameTime = 0;
}, 1000);
