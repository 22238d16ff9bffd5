// The report of a run: reads the data that the page holds, and puts scene, timeline, curves and tables together.
import { RAMP_CSS } from "gateway/ramp.js";
import { Keys } from "gateway/keys.js";
import { FatLine } from "gateway/lines.js";
import { Scene } from "gateway/scene.js";
import { lineChart, valueAt } from "./charts.js";
import { showFigures, showTables } from "./tables.js";
import { Timeline, clockText, raised } from "./timeline.js";

const $ = (id) => document.getElementById(id);
const run = JSON.parse($("data").textContent);

async function inflated(base64) {
  const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// ---- The map: bits of occupied voxels, and when each became known

/** Puts the map into the scene. @returns (x, y, z) -> 0 to 255, when that voxel became known */
async function unpackMap({ voxel_size_m: size, blocks, data }) {
  const bytes = await inflated(data);
  const position = new Int16Array(bytes.buffer, 0, 3 * blocks);
  const bits = bytes.subarray(6 * blocks, 70 * blocks);
  const times = bytes.subarray(70 * blocks);
  const states = new Uint8Array(128 * blocks);
  const bornIn = new Map();
  let next = 0;
  for (let n = 0; n < blocks; ++n) {
    const born = new Uint8Array(512);
    for (let k = 0; k < 512; ++k) {
      const occupied = (bits[64 * n + (k >> 3)] >> (k & 7)) & 1;
      states[128 * n + (k >> 2)] |= (occupied ? 2 : 1) << (2 * (k & 3));
      if (occupied) born[k] = times[next++];
    }
    bornIn.set(position.subarray(3 * n, 3 * n + 3).join(), born);
  }
  const bornAt = (x, y, z) => bornIn.get(`${x >> 3},${y >> 3},${z >> 3}`)?.[((z & 7) * 8 + (y & 7)) * 8 + (x & 7)] ?? 0;
  return { bornAt, message: { reset: true, voxel_size_m: size, position, states } };
}

// ---- Theme

const themed = [];
function setTheme(name) {
  document.documentElement.dataset.theme = name;
  for (const each of themed) each(name);
}
const swapTheme = () => setTheme(document.documentElement.dataset.theme === "dark" ? "light" : "dark");
$("theme").onclick = swapTheme;

// ---- Scene

const LAYERS = {
  map: { title: "Map", color: RAMP_CSS },
  flown: { title: "Path", color: "var(--text)" },
  ahead: { title: "Path of this plan", color: "var(--accent)" },
  frontiers: { title: "Frontiers at the end", color: "var(--warn)" },
};

async function makeScene() {
  let map = null;
  if (run.map) map = await unpackMap(run.map);
  const scene = new Scene($("view"), new Keys(), {
    onPick: () => {},
    onCamera: (mode) => {
      for (const button of document.querySelectorAll("[data-camera]")) button.classList.toggle("on", button.dataset.camera === mode);
    },
    bornAt: map?.bornAt,
  });
  if (map) scene.map.update(map.message);
  while (scene.map.rebuild(1000));
  const { robot } = run;
  scene.setRobotShape({ radius: robot.radius_m, height: robot.height_m, fovDeg: robot.horizontal_fov_deg, aspect: robot.aspect });
  const [x, y, z] = robot.camera_position, [qx, qy, qz, qw] = robot.camera_rotation;
  scene.setCameraInBody({ translation: { x, y, z }, rotation: { x: qx, y: qy, z: qz, w: qw } });
  scene.setFrontiers(run.frontiers.map(({ center: [cx, cy, cz], ...rest }) => ({ ...rest, center: { x: cx, y: cy, z: cz } })));
  scene.whole = new FatLine(1);
  scene.whole.material.transparent = true;
  scene.whole.material.opacity = 0.35;
  scene.scene.add(scene.whole.line);
  themed.push((name) => {
    scene.setTheme(name);
    scene.whole.material.color.set(name === "dark" ? "#f2f5f9" : "#1b2433");
  });
  scene.setMode("orbit");
  scene.frame();
  // The near side of the map looks larger than the far side: a little back, and toward it.
  const away = scene.camera.position.clone().sub(scene.controls.target).multiplyScalar(1.1);
  scene.controls.target.add(away.clone().setZ(0).multiplyScalar(0.05));
  scene.camera.position.copy(scene.controls.target).add(away);
  $("view").addEventListener("focus", () => (scene.controls.enableZoom = true));
  $("view").addEventListener("blur", () => (scene.controls.enableZoom = false));
  scene.controls.enableZoom = false;
  new ResizeObserver(() => scene.resize()).observe($("view"));
  return scene;
}

function makeTools(scene) {
  for (const button of document.querySelectorAll("[data-camera]")) button.onclick = () => scene.setMode(button.dataset.camera);
  for (const [name, { title, color }] of Object.entries(LAYERS)) {
    const button = document.createElement("button");
    button.append(document.createElement("i"), document.createTextNode(title));
    button.style.setProperty("--swatch", color);
    const set = (on) => {
      button.classList.toggle("on", on);
      button.setAttribute("aria-pressed", on);
      if (name === "flown") scene.whole.line.material.visible = on;
      scene.setLayer(name, on);
    };
    button.onclick = () => set(!button.classList.contains("on"));
    set(true);
    $("layers").append(button);
  }
  const { low, high } = scene.map;
  const drawn = Number.isFinite(low);
  document.querySelector(".cut").hidden = document.querySelector(".legend").hidden = !drawn;
  if (!drawn) return;
  document.querySelector(".legend i").style.background = RAMP_CSS;
  scene.map.uniforms.low.value = low;
  scene.map.uniforms.high.value = high;
  $("legend-low").textContent = `${low.toFixed(1)} m`;
  $("legend-high").textContent = `${high.toFixed(1)} m`;
  $("cut").oninput = () => {
    const share = $("cut").value / 1000, height = low + (high - low) * share;
    scene.setCut(share >= 1 ? 1e9 : height);
    $("cut-value").textContent = share >= 1 ? "none" : `${height.toFixed(1)} m`;
  };
  $("cut").oninput();
}

// ---- Curves

function makeCharts(parent, duration, onPick) {
  const { t_s: t, ...columns } = run.progress;
  const x = { label: "time of the run", max: Math.max(duration, 1), format: clockText };
  const charts = [];
  for (const { key, title, color, scale = 1, unit } of [
    { key: "coverage", title: "Coverage", color: "var(--good)", scale: 100, unit: "%" },
    { key: "explored_m3", title: "Known volume", color: "var(--accent)", unit: "m³" },
    { key: "distance_m", title: "Distance traveled", color: "var(--warn)", unit: "m" },
    { key: "frontiers", title: "Frontiers left", color: "var(--accent)", unit: "" },
    { key: "planning_ms", title: "Planning, median so far", color: "var(--good)", unit: "ms" },
  ]) {
    const points = t.map((time, n) => [time, columns[key][n]]).filter(([, value]) => value !== null).map(([a, b]) => [a, b * scale]);
    if (points.length < 2) continue;
    const most = Math.max(...points.map(([, value]) => value), 1e-3);
    const card = document.createElement("div");
    card.className = "card";
    parent.append(card);
    charts.push(lineChart(card, { title: unit ? `${title} [${unit}]` : title, x, onPick, height: 200,
      y: { max: key === "coverage" ? 100 : most * 1.06 },
      series: [{ name: "", color, points }] }));
  }
  const seen = columns.coverage.some((value) => value !== null) ? columns.coverage.map((v) => 100 * v) : columns.explored_m3;
  if (t.length > 1) charts.push(overDistance(parent, t, columns.distance_m, seen, onPick));
  return charts;
}

/** What was seen over the distance traveled; its cursor follows the time as those of the others do. */
function overDistance(parent, t, distance, seen, onPick) {
  const covered = seen !== run.progress.explored_m3;
  const card = document.createElement("div");
  card.className = "card";
  parent.append(card);
  const byTime = t.map((time, n) => [time, distance[n]]), byDistance = distance.map((length, n) => [length, t[n]]);
  const chart = lineChart(card, { title: covered ? "Coverage over distance [%]" : "Known volume over distance [m³]", height: 200,
    x: { label: "distance traveled [m]", max: Math.max(distance.at(-1), 1) },
    y: { max: covered ? 100 : Math.max(...seen, 1e-3) * 1.06 },
    series: [{ name: "", color: "var(--accent)", points: distance.map((length, n) => [length, seen[n]]) }],
    onPick: (length) => onPick(valueAt(byDistance, length) ?? 0) });
  return { setCursor: (time) => chart.setCursor(valueAt(byTime, time) ?? 0) };
}

// ---- All of it

async function main() {
  const { report } = run;
  const title = run.title || report.scenario;
  document.title = `${title}: report of a run`;
  $("title").textContent = title;
  $("what").textContent = [report.scenario, report.strategy].filter(Boolean).join(" · ");
  $("state").textContent = report.stop_reason || "no end reported";
  $("state").className = `pill ${run.succeeded ? "good" : "warn"}`;
  $("end").textContent = raised(report.stop_details);
  showFigures($("figures"), run);

  const scene = await makeScene();
  makeTools(scene);
  const path = new Float32Array((await inflated(run.path.data)).buffer);
  let charts = [];
  const timeline = new Timeline({ run, path, scene, onTime: (time) => charts.forEach((chart) => chart.setCursor(time)) });
  const plots = document.createElement("section");
  plots.innerHTML = "<h2>Over time</h2><div class='grid'></div>";
  $("sections").append(plots);
  charts = makeCharts(plots.querySelector(".grid"), timeline.duration, (time) => timeline.seek(time));
  showTables($("sections"), run, timeline);
  $("footer").textContent = `thalweg ${run.version}. This page needs no server and no network; its data stands in the element with the id "data".`;
  setTheme(matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark");
  timeline.seek(timeline.duration);
  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || ["INPUT", "SELECT", "BUTTON", "SUMMARY"].includes(event.target.tagName)) return;
    const mode = { 1: "orbit", 2: "follow", 3: "robot" }[event.key];
    if (mode) scene.setMode(mode);
    if (event.key === "t") swapTheme();
    if (event.key === "r") scene.frame();
    if (event.key === " ") {
      event.preventDefault();
      timeline.toggle();
    }
  });
  const tick = (now) => {
    timeline.advance(now);
    scene.draw();
    window.thalweg = { time: timeline.time, robot: scene.robot.position.toArray(), faces: scene.map.faces, charts: charts.length,
      now: scene.map.uniforms.now.value, frontiers: run.frontiers.length };
    requestAnimationFrame(tick);
  };
  requestAnimationFrame(tick);
}

main().catch((error) => {
  $("end").textContent = `This page could not be drawn: ${error.message}. report.png and report.json hold the same figures.`;
  throw error;
});
