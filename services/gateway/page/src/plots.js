// Small curves over the time of the run.

/** A value over time, in pieces: where time is missing in between, what follows is not joined to what came before. */
export class Curve {
  times = [];
  values = [];
  #begins = []; // numbers of the points with which a piece begins, but for the first

  clear() {
    this.times = [];
    this.values = [];
    this.#begins = [];
  }

  add(time, value) {
    if (!Number.isFinite(value)) return;
    this.times.push(time);
    this.values.push(value);
  }

  /** What is added next begins a piece. */
  interrupt() {
    if (this.values.length > (this.#begins.at(-1) ?? 0)) this.#begins.push(this.values.length);
  }

  /** [first, last] of each piece. */
  pieces() {
    const begins = [0, ...this.#begins].filter((n) => n < this.values.length);
    return begins.map((begin, k) => [begin, (begins[k + 1] ?? this.values.length) - 1]);
  }

  /** The slope over up to `span` seconds before each point, within its piece; at least 0. */
  slopes(span) {
    return this.pieces().flatMap(([begin, last]) => {
      let first = begin;
      return this.values.slice(begin, last + 1).map((value, k) => {
        const time = this.times[begin + k];
        while (time - this.times[first] > span) ++first;
        const passed = time - this.times[first];
        return passed > 0 ? Math.max((value - this.values[first]) / passed, 0) : 0;
      });
    });
  }
}

export class Plot {
  #curve = new Curve();
  #stale = true;

  /** @param format value -> text; @param rate plot the slope over `rate` seconds instead of the value */
  constructor(parent, { title, unit, format, color, rate = 0 }) {
    this.format = format;
    this.color = color;
    this.rate = rate;
    this.element = document.createElement("div");
    this.element.className = "plot";
    this.element.innerHTML = "<span></span><b class='number'></b><canvas></canvas>";
    this.element.querySelector("span").textContent = title;
    this.unit = unit;
    this.canvas = this.element.querySelector("canvas");
    parent.append(this.element);
  }

  clear() {
    this.#curve.clear();
    this.#stale = true;
  }

  add(time, value) {
    this.#curve.add(time, value);
    this.#stale = true;
  }

  interrupt() {
    this.#curve.interrupt();
  }

  draw() {
    if (!this.#stale) return;
    this.#stale = false;
    const { times } = this.#curve;
    const values = this.rate > 0 ? this.#curve.slopes(this.rate) : this.#curve.values;
    const last = values.at(-1);
    const label = this.element.querySelector("b");
    label.textContent = last === undefined ? "–" : this.format(last);
    if (last !== undefined) label.insertAdjacentHTML("beforeend", `<small>${this.unit}</small>`);
    const ratio = devicePixelRatio, { clientWidth: width, clientHeight: height } = this.canvas;
    this.canvas.width = width * ratio;
    this.canvas.height = height * ratio;
    const context = this.canvas.getContext("2d");
    context.scale(ratio, ratio);
    const style = getComputedStyle(document.documentElement);
    context.fillStyle = style.getPropertyValue("--line");
    context.fillRect(0, height - 1, width, 1);
    if (values.length < 2) return;
    const t0 = times[0], t1 = Math.max(times.at(-1), t0 + 1e-6);
    const top = Math.max(...values, 1e-9) * 1.08;
    const x = (n) => ((times[n] - t0) / (t1 - t0)) * (width - 4) + 1;
    const y = (n) => height - 1.5 - (values[n] / top) * (height - 5);
    const step = Math.max(1, Math.floor(values.length / (2 * width)));
    const color = style.getPropertyValue(this.color).trim();
    context.strokeStyle = context.fillStyle = color;
    context.lineWidth = 1.6;
    context.lineJoin = "round";
    for (const [begin, last] of this.#curve.pieces()) {
      context.beginPath();
      context.moveTo(x(begin), y(begin));
      for (let n = begin + step; n < last; n += step) context.lineTo(x(n), y(n));
      context.lineTo(x(last), y(last));
      context.stroke();
      context.lineTo(x(last), height);
      context.lineTo(x(begin), height);
      context.globalAlpha = 0.13;
      context.fill();
      context.globalAlpha = 1;
    }
    context.beginPath();
    context.arc(x(values.length - 1), y(values.length - 1), 2.4, 0, 7);
    context.fill();
  }

  redraw() {
    this.#stale = true;
    this.draw();
  }
}
