// The time of the run: slider, play, the robot's place and the plan that it carried out then.

const $ = (id) => document.getElementById(id);
const STRIDE = 8; // floats of a pose: time, position, quaternion
const SPEEDS = [1, 2, 5, 10, 20, 50, 100];
const PLAY = "<svg viewBox='0 0 16 16'><path d='M4 2.5v11l9-5.5z'/></svg>";
const PAUSE = "<svg viewBox='0 0 16 16'><path d='M4 3h3v10H4zM9 3h3v10H9z'/></svg>";

/** A sentence of the run's, in which areas and volumes are written "m2" and "m3" for terminals. */
export const raised = (text) => text.replace(/\bm([23])\b/g, (_, power) => (power === "2" ? "m²" : "m³"));

export function clockText(seconds) {
  const whole = Math.round(seconds), two = (n) => String(n).padStart(2, "0");
  return whole >= 3600 ? `${Math.floor(whole / 3600)}:${two(Math.floor(whole / 60) % 60)}:${two(whole % 60)}`
    : `${Math.floor(whole / 60)}:${two(whole % 60)}`;
}

/** The index of the last row whose value is not beyond `limit`; -1 if there is none. */
function lastUntil(count, valueOf, limit) {
  let low = 0, high = count;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (valueOf(middle) <= limit) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

function fill(dl, rows) {
  dl.replaceChildren();
  for (const [key, value] of rows) {
    const dt = document.createElement("dt"), dd = document.createElement("dd");
    dt.textContent = key;
    dd.textContent = value;
    dl.append(dt, dd);
  }
}

export class Timeline {
  #poses;
  #playing = false;
  #before = 0;
  #onDecision = [];
  #shown = -2;

  /** @param path poses, STRIDE floats each, ascending in time */
  constructor({ run, path, scene, onTime }) {
    this.run = run;
    this.path = path;
    this.scene = scene;
    this.onTime = onTime;
    this.#poses = path.length / STRIDE;
    this.duration = Math.max(run.report.duration_s, this.#poses ? path[(this.#poses - 1) * STRIDE] : 0);
    this.time = 0;
    this.#layPath();
    this.#markDecisions();
    $("slider").oninput = () => this.seek(($("slider").value / 10000) * this.duration);
    $("play").onclick = () => this.toggle();
    $("play").innerHTML = PLAY;
    const fitting = SPEEDS.find((speed) => this.duration / speed <= 40) ?? SPEEDS.at(-1);
    for (const speed of SPEEDS) {
      const option = document.createElement("option");
      option.value = speed;
      option.textContent = `${speed}×`;
      option.selected = speed === fitting;
      $("speed").append(option);
    }
  }

  /** Calls back with the index of the decision that is under way whenever it changes; -1 before the first. */
  onDecision(callback) {
    this.#onDecision.push(callback);
  }

  toggle() {
    if (!this.#playing && this.time >= this.duration) this.seek(0);
    this.#playing = !this.#playing;
    this.#before = 0;
    $("play").innerHTML = this.#playing ? PAUSE : PLAY;
    $("play").setAttribute("aria-label", this.#playing ? "Pause" : "Play");
  }

  /** @param now [ms] of the browser */
  advance(now) {
    if (!this.#playing) return;
    const passed = this.#before ? Math.min((now - this.#before) / 1000, 0.2) : 0;
    this.#before = now;
    this.seek(this.time + passed * Number($("speed").value));
    if (this.time >= this.duration) this.toggle();
  }

  seek(time) {
    this.time = Math.min(Math.max(time, 0), this.duration);
    const share = this.duration > 0 ? this.time / this.duration : 1;
    $("slider").value = Math.round(10000 * share);
    $("slider").setAttribute("aria-valuetext", clockText(this.time));
    $("clock").textContent = clockText(this.time);
    this.scene.map.uniforms.now.value = share >= 1 ? 1e9 : 255 * share;
    this.#placeRobot();
    this.#showValues();
    this.#showDecision();
    this.scene.changed();
    this.onTime(this.time);
  }

  #layPath() {
    const flat = [];
    for (let n = 0; n < this.#poses; ++n) flat.push(...this.path.subarray(n * STRIDE + 1, n * STRIDE + 4));
    this.scene.flown.set(flat);
    this.scene.whole.set(flat);
  }

  #markDecisions() {
    for (const { t_s: t, interruption } of this.run.decisions) {
      const line = document.createElementNS("http://www.w3.org/2000/svg", "line");
      const x = this.duration > 0 ? (1000 * t) / this.duration : 0;
      line.setAttribute("x1", x);
      line.setAttribute("x2", x);
      line.setAttribute("y1", 1);
      line.setAttribute("y2", 10);
      line.setAttribute("vector-effect", "non-scaling-stroke");
      line.setAttribute("class", interruption ? "interrupted" : "made");
      $("ticks").append(line);
    }
  }

  #placeRobot() {
    if (this.#poses === 0) return;
    const n = Math.max(lastUntil(this.#poses, (k) => this.path[k * STRIDE], this.time), 0);
    const m = Math.min(n + 1, this.#poses - 1);
    const a = this.path.subarray(n * STRIDE, (n + 1) * STRIDE), b = this.path.subarray(m * STRIDE, (m + 1) * STRIDE);
    const share = b[0] > a[0] ? Math.min(Math.max((this.time - a[0]) / (b[0] - a[0]), 0), 1) : 0;
    const mix = (k, sign = 1) => a[k] + share * (sign * b[k] - a[k]);
    // Neighbors differ little, so that a normalized mean is as good as a slerp.
    const sign = a[4] * b[4] + a[5] * b[5] + a[6] * b[6] + a[7] * b[7] < 0 ? -1 : 1;
    const q = [4, 5, 6, 7].map((k) => mix(k, sign)), norm = Math.hypot(...q) || 1;
    const [x, y, z, w] = q.map((c) => c / norm);
    this.scene.setPose({ position: { x: mix(1), y: mix(2), z: mix(3) }, orientation: { x, y, z, w } });
    this.scene.flown.line.geometry.instanceCount = n;
    this.scene.flown.line.visible = n > 0;
  }

  /** What was known at this time: the last sample that is not later. */
  #showValues() {
    const { t_s: t, coverage, explored_m3: known, distance_m: length, frontiers } = this.run.progress;
    const n = Math.max(lastUntil(t.length, (k) => t[k], this.time), 0);
    const rows = [];
    const row = (key, column, text) => column[n] !== null && column[n] !== undefined && rows.push([key, text(column[n])]);
    row("Coverage", coverage, (v) => `${(100 * v).toFixed(1)} %`);
    row("Known volume", known, (v) => `${v.toFixed(1)} m³`);
    row("Distance", length, (v) => `${v.toFixed(1)} m`);
    row("Frontiers left", frontiers, String);
    fill($("values"), rows);
  }

  #showDecision() {
    const { decisions } = this.run;
    const n = lastUntil(decisions.length, (k) => decisions[k].t_s, this.time);
    if (n === this.#shown) return;
    this.#shown = n;
    for (const callback of this.#onDecision) callback(n);
    this.#layPlan(n);
    if (n < 0) {
      $("decision").textContent = decisions.length ? "Before the first plan" : "No plan was heard of";
      $("purpose").textContent = "";
      fill($("plan"), []);
      return;
    }
    const { number, t_s: t, purpose, target, length_m: length, interruption } = decisions[n];
    $("decision").textContent = `Plan ${number}`;
    $("purpose").textContent = raised(purpose);
    const rows = [["Made at", clockText(t)]];
    if (length !== null) rows.push(["Path", `${length.toFixed(1)} m`]);
    if (target) rows.push(["Target", target.map((c) => c.toFixed(2)).join(", ")]);
    if (interruption) rows.push(["Interrupted", interruption]);
    fill($("plan"), rows);
  }

  /** Shows the path that was flown during a plan. */
  #layPlan(n) {
    const { decisions } = this.run;
    const points = [];
    if (n >= 0) {
      const end = decisions[n + 1]?.t_s ?? this.duration;
      for (let k = 0; k < this.#poses; ++k) {
        const t = this.path[k * STRIDE];
        if (t >= decisions[n].t_s && t <= end) points.push(...this.path.subarray(k * STRIDE + 1, k * STRIDE + 4));
      }
    }
    this.scene.ahead.set(points);
  }
}
