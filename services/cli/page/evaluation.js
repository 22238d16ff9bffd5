// The evaluation's page: curves with bands, the tail on a scale of its own, and the paths from any start.
import { lineChart } from "./charts.js";

const evaluation = JSON.parse(document.getElementById("data").textContent);
const colorOf = (n) => `var(--s${n % 7})`;
const LEAST_LEFT = 0.1; // [%] where the scale of what is left ends

function make(tag, className, text) {
  const made = document.createElement(tag);
  if (className) made.className = className;
  if (text !== undefined) made.textContent = text;
  return made;
}

function makeSvg(tag, attributes) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  return made;
}

async function floats(base64) {
  const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Float32Array(await new Response(stream).arrayBuffer());
}

/** @param along "distance" or "time"; @param left whether to show what is left instead of what is covered */
function curves(strategies, along, left) {
  const value = left ? (share) => Math.max(100 * (1 - share), LEAST_LEFT) : (share) => 100 * share;
  return strategies.map((strategy, n) => {
    const { at, mean, low, high } = strategy[along];
    const band = at.map((x, k) => [x, value(left ? high[k] : low[k]), value(left ? low[k] : high[k])]);
    return { name: strategy.name, color: colorOf(n), points: at.map((x, k) => [x, value(mean[k])]), band };
  });
}

function showCurves(parent, strategies) {
  const box = make("div", "two"), charts = [];
  parent.append(box);
  const axis = (along) => ({ label: along === "distance" ? "distance traveled [m]" : "time [s]",
    max: Math.max(...strategies.map((strategy) => strategy[along].at.at(-1) ?? 0), 1e-3) });
  const percent = (v) => `${v === 0 ? "0" : v < 1 ? v.toFixed(1) : v < 10 ? String(+v.toFixed(1)) : v < 99.95 ? String(+v.toFixed(1)) : "100"} %`;
  for (const left of [false, true]) {
    const card = make("div", "card");
    box.append(card);
    const y = left ? { log: true, min: LEAST_LEFT, max: 100, format: percent } : { max: 100, format: percent };
    charts.push({ left, chart: lineChart(card, { title: left ? "Left to see, on a log scale" : "Coverage", height: 270, x: axis("distance"), y,
      series: curves(strategies, "distance", left) }) });
  }
  return (along) => charts.forEach(({ left, chart }) => chart.setSpec({ x: axis(along), series: curves(strategies, along, left) }));
}

/** One start: a dot for each strategy at its path to 95 %, a ring at its end. */
function startRow(runs, longest) {
  const row = make("button", "start");
  row.append(make("span", "", `start ${runs.find(Boolean).start}`));
  const svg = makeSvg("svg", { preserveAspectRatio: "none" });
  const x = (meters) => `${(100 * meters) / longest}%`;
  const dots = runs.map((run) => run && (run.to_95_m ?? run.distance_m)).filter((value) => value !== undefined && value !== null);
  svg.append(makeSvg("line", { x1: x(Math.min(...dots)), x2: x(Math.max(...dots)), y1: 12, y2: 12, class: "link" }));
  runs.forEach((run, n) => {
    if (!run) return;
    const cy = 12 + (n - (runs.length - 1) / 2) * Math.min(4, 12 / runs.length);
    svg.append(makeSvg("circle", { cx: x(run.distance_m), cy, r: 4, fill: "none", "stroke-width": 1.3, stroke: colorOf(n), opacity: 0.65 }));
    if (run.to_95_m !== null) svg.append(makeSvg("circle", { cx: x(run.to_95_m), cy, r: 4.5, fill: colorOf(n) }));
  });
  row.append(svg);
  return row;
}

async function drawPath(parent, world, strategy, n, run) {
  const figure = make("figure"), caption = make("figcaption"), name = make("b", "", strategy.name);
  name.style.setProperty("--series", colorOf(n));
  caption.append(name);
  figure.append(caption);
  parent.append(figure);
  if (!run) {
    caption.append(" has no run from this start");
    return;
  }
  const to95 = run.to_95_m === null ? "95 % never reached" : `${run.to_95_m.toFixed(1)} m to 95 %`;
  caption.append(make("br"), `${to95}, ${run.distance_m.toFixed(1)} m to the end: ${run.end}, ${(100 * run.coverage).toFixed(1)} %` +
    (run.collisions ? `, ${run.collisions} collisions` : ""));
  const xy = await floats(run.path);
  const points = [];
  for (let k = 0; k + 1 < xy.length; k += 2) points.push([xy[k], -xy[k + 1]]);
  const xs = points.map(([x]) => x), ys = points.map(([, y]) => y);
  const around = { x: Math.min(...xs) - 1, y: Math.min(...ys) - 1, width: Math.max(...xs) - Math.min(...xs) + 2, height: Math.max(...ys) - Math.min(...ys) + 2 };
  const view = world ? { x: world.min_x, y: -world.min_y - world.height, width: world.width, height: world.height } : around;
  const svg = makeSvg("svg", { viewBox: `${view.x} ${view.y} ${view.width} ${view.height}`, role: "img" });
  svg.setAttribute("aria-label", `Path of ${strategy.name} from start ${run.start}`);
  if (world) svg.append(makeSvg("image", { ...view, href: `data:image/png;base64,${world.png}`, preserveAspectRatio: "none" }));
  const thick = Math.max(view.width, view.height) / 110;
  const path = points.map((p) => p.map((c) => c.toFixed(2)).join()).join(" ");
  svg.append(makeSvg("polyline", { points: path, class: "halo", "stroke-width": 2 * thick }),
    makeSvg("polyline", { points: path, class: "path", "stroke-width": thick, stroke: colorOf(n) }));
  if (points.length > 0) {
    const [sx, sy] = points[0], [ex, ey] = points.at(-1);
    svg.append(makeSvg("circle", { cx: sx, cy: sy, r: 2 * thick, fill: "#ffffff", stroke: colorOf(n), "stroke-width": thick * 0.8 }),
      makeSvg("circle", { cx: ex, cy: ey, r: 2 * thick, fill: colorOf(n), stroke: "#ffffff", "stroke-width": thick * 0.6 }));
  }
  figure.append(svg);
}

/** What the pictures from above mean: paths, heights, walls. */
function legend(world) {
  const box = make("div", "map-key");
  const key = (className, text) => {
    const made = make("span"), mark = make("i", className);
    made.append(mark, text);
    box.append(made);
    return mark;
  };
  key("ring", "start");
  key("dot", "end");
  if (!world) return box;
  const { heights, wall, hollow } = evaluation.colors;
  box.append(`${world.lowest.toFixed(1)} m`);
  key("ramp", `${world.highest.toFixed(1)} m`).style.background = `linear-gradient(90deg, ${heights.join(",")})`;
  key("square", "wall").style.background = wall;
  key("square", "nothing below").style.background = hollow;
  return box;
}

function showStarts(parent, { world, strategies }) {
  const starts = [...new Set(strategies.flatMap(({ runs }) => runs.map(({ run }) => run)))].sort((a, b) => a - b);
  const box = make("div", "two"), card = make("div", "card"), list = make("div", "starts"), right = make("div", "card"), paths = make("div", "paths");
  card.append(make("h3", "", "Path from each start: dot to 95 %, ring at the end"), list);
  const title = make("h3");
  right.append(title, paths, legend(world));
  box.append(card, right);
  parent.append(box);
  const longest = Math.max(...strategies.flatMap(({ runs }) => runs.map(({ distance_m: length }) => length)), 1) * 1.04;
  const rows = [];
  let drawn = Promise.resolve();
  const choose = (start) => {
    rows.forEach(({ row, start: its }) => row.classList.toggle("on", its === start));
    const runs = strategies.map((strategy) => strategy.runs.find(({ run }) => run === start));
    title.textContent = `Start ${runs.find(Boolean).start}, from above`;
    drawn = drawn.then(async () => {
      paths.replaceChildren();
      for (const [n, strategy] of strategies.entries()) await drawPath(paths, world, strategy, n, runs[n]);
    });
  };
  for (const start of starts) {
    const row = startRow(strategies.map(({ runs }) => runs.find(({ run }) => run === start)), longest);
    row.onclick = () => choose(start);
    rows.push({ row, start });
    list.append(row);
  }
  const axis = make("div", "axis"), ends = make("div");
  ends.append(make("span", "", "0 m"), make("span", "", `${longest.toFixed(0)} m`));
  axis.append(make("span"), ends);
  card.append(axis);
  choose(starts[0]);
}

function showScenario(scenario) {
  const section = make("section"), head = make("div", "scenario-head"), choice = make("div", "segments");
  head.append(make("h2", "", scenario.name), choice);
  section.append(head);
  document.getElementById("scenarios").append(section);
  const redraw = showCurves(section, scenario.strategies);
  for (const [along, text] of [["distance", "over distance"], ["time", "over time"]]) {
    const button = make("button", along === "distance" ? "on" : "", text);
    button.onclick = () => {
      for (const other of choice.children) other.classList.toggle("on", other === button);
      redraw(along);
    };
    choice.append(button);
  }
  showStarts(section, scenario);
}

const root = document.documentElement;
root.dataset.theme = matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark";
document.getElementById("theme").onclick = () => (root.dataset.theme = root.dataset.theme === "dark" ? "light" : "dark");
for (const scenario of evaluation.scenarios) showScenario(scenario);
