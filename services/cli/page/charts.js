// Line charts as SVG, with bands, a cursor and a readout. Stands alone: the report of a run bundles it, and the
// evaluation's page contains it as it is.

const SVG = "http://www.w3.org/2000/svg";
const MARGIN = { left: 50, right: 14, top: 10, bottom: 34 };

/** Round numbers within [low, high], about `count` of them, spaced by 1, 2 or 5 times a power of ten. */
export function niceTicks(low, high, count) {
  const rough = (high - low) / Math.max(count, 1);
  if (!(rough > 0)) return [low];
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= rough * 0.999);
  const ticks = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) ticks.push(k * step);
  return ticks;
}

/** The y of a series at x, by the last point that is not beyond it; undefined before the first. */
export function valueAt(points, x) {
  let low = 0, high = points.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (points[middle][0] <= x) low = middle + 1;
    else high = middle;
  }
  return low > 0 ? points[low - 1][1] : undefined;
}

function plain(value) {
  const size = Math.abs(value);
  return size >= 100 ? value.toFixed(0) : size >= 10 ? String(+value.toFixed(1)) : String(+value.toFixed(2));
}

function add(parent, tag, attributes, text) {
  const made = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  if (text !== undefined) made.textContent = text;
  parent.append(made);
  return made;
}

/**
 * A chart that fills the width of its parent.
 * @param x, y { label, min, max, format, log }: format turns a value into text; log only for y
 * @param series [{ name, color, points: [[x, y]], band: [[x, low, high]], faint }], x ascending
 * @param onPick called with x when the chart is clicked
 * @returns { setCursor(x), setSpec({ x, y, series }) }
 */
export function lineChart(parent, { title, height = 220, x, y, series, onPick }) {
  const figure = document.createElement("figure");
  figure.className = "chart";
  const caption = document.createElement("figcaption");
  const name = document.createElement("b");
  name.textContent = title;
  const key = document.createElement("span");
  key.className = "key number";
  caption.append(name, key);
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("role", "img");
  svg.setAttribute("aria-label", title);
  figure.append(caption, svg);
  parent.append(figure);
  let toX, toY, cursor, width = 0, at = null;

  function showKey(where) {
    key.replaceChildren();
    for (const { name: what, color, points } of series) {
      const item = document.createElement("span");
      const value = where === null ? undefined : valueAt(points, where);
      item.style.setProperty("--series", color);
      item.className = what ? "named" : "";
      item.textContent = [what, value === undefined ? "" : (y.format ?? plain)(value)].filter(Boolean).join(" ");
      if (item.textContent) key.append(item);
    }
    if (where !== null) {
      const item = document.createElement("span");
      item.className = "where";
      item.textContent = `at ${(x.format ?? plain)(where)}`;
      key.append(item);
    }
  }

  function drawAxes(right, bottom) {
    const ticksX = niceTicks(x.min ?? 0, x.max, Math.max(2, Math.min(8, width / 85)));
    for (const tick of ticksX) {
      add(svg, "text", { x: toX(tick), y: bottom + 16, "text-anchor": "middle", class: "tick" }, (x.format ?? plain)(tick));
    }
    let ticksY = niceTicks(y.min ?? 0, y.max, 4);
    if (y.log) {
      ticksY = [];
      for (let e = Math.floor(Math.log10(y.min)); e <= Math.ceil(Math.log10(y.max)); ++e) {
        if (10 ** e >= y.min * 0.999 && 10 ** e <= y.max * 1.001) ticksY.push(10 ** e);
      }
    }
    for (const tick of ticksY) {
      add(svg, "line", { x1: MARGIN.left, x2: right, y1: toY(tick), y2: toY(tick), class: "rule" });
      add(svg, "text", { x: MARGIN.left - 7, y: toY(tick) + 4, "text-anchor": "end", class: "tick" }, (y.format ?? plain)(tick));
    }
    add(svg, "text", { x: right, y: bottom + 31, "text-anchor": "end", class: "label" }, x.label);
  }

  function drawSeries() {
    for (const { color, band } of series) {
      if (!band || band.length < 2) continue;
      const there = band.map(([px, , high]) => `${toX(px).toFixed(1)},${toY(high).toFixed(1)}`);
      const back = band.map(([px, low]) => `${toX(px).toFixed(1)},${toY(low).toFixed(1)}`).reverse();
      add(svg, "polygon", { points: [...there, ...back].join(" "), fill: color, class: "band" });
    }
    for (const { color, points, faint } of series) {
      const step = Math.max(1, Math.floor(points.length / 1200));
      const some = points.filter((_, n) => n % step === 0 || n === points.length - 1);
      const path = some.map(([px, py]) => `${toX(px).toFixed(1)},${toY(py).toFixed(1)}`);
      add(svg, "polyline", { points: path.join(" "), stroke: color, class: faint ? "curve faint" : "curve" });
    }
  }

  function draw() {
    width = figure.clientWidth;
    if (width === 0) return;
    svg.replaceChildren();
    svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    svg.style.height = `${height}px`;
    const right = width - MARGIN.right, bottom = height - MARGIN.bottom;
    const x0 = x.min ?? 0;
    toX = (value) => MARGIN.left + ((value - x0) / Math.max(x.max - x0, 1e-9)) * (right - MARGIN.left);
    const scale = y.log ? (value) => Math.log10(Math.max(value, y.min)) : (value) => value;
    const low = scale(y.min ?? 0), span = Math.max(scale(y.max) - low, 1e-9);
    toY = (value) => bottom - Math.min(Math.max((scale(value) - low) / span, 0), 1) * (bottom - MARGIN.top);
    drawAxes(right, bottom);
    drawSeries();
    cursor = add(svg, "line", { y1: MARGIN.top, y2: bottom, class: "cursor" });
    moveCursor(at);
  }

  function moveCursor(where) {
    if (!cursor) return;
    cursor.style.display = where === null ? "none" : "";
    if (where === null) return;
    cursor.setAttribute("x1", toX(where));
    cursor.setAttribute("x2", toX(where));
  }

  function xOf(event) {
    const box = svg.getBoundingClientRect();
    const share = (event.clientX - box.left - MARGIN.left) / (width - MARGIN.left - MARGIN.right);
    return (x.min ?? 0) + Math.min(Math.max(share, 0), 1) * (x.max - (x.min ?? 0));
  }
  svg.addEventListener("pointermove", (event) => {
    moveCursor(xOf(event));
    showKey(xOf(event));
  });
  svg.addEventListener("pointerleave", () => {
    moveCursor(at);
    showKey(at);
  });
  if (onPick) {
    svg.classList.add("pick");
    svg.addEventListener("click", (event) => onPick(xOf(event)));
  }
  new ResizeObserver(() => figure.clientWidth !== width && draw()).observe(figure);
  draw();
  showKey(null);
  return {
    setCursor(where) {
      at = where;
      moveCursor(at);
      showKey(at);
    },
    setSpec(spec) {
      ({ x = x, y = y, series = series } = spec);
      draw();
      showKey(at);
    },
  };
}
