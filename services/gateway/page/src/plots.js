// Small curves over the time of the run.

/** A value over time, in pieces: where time is missing in between, what follows is not joined to what came before. */
export class Curve {
  times = [];
  values = [];
  #begins = []; // numbers of the points with which a piece begins, but for the first
  now = -1; // number of the point that is true now: a replay that went back knows what comes later

  add(time, value) {
    if (!Number.isFinite(value)) return;
    this.times.push(time);
    this.values.push(value);
  }

  /** What is added next begins a piece. */
  interrupt() {
    if (this.values.length > (this.#begins.at(-1) ?? 0)) this.#begins.push(this.values.length);
  }
  /** What was added last is true now. */
  isNow() {
    this.now = this.values.length - 1;
  }

  /** [first, last] of each piece. */
  pieces() {
    const begins = [0, ...this.#begins].filter((n) => n < this.values.length);
    return begins.map((begin, k) => [begin, (begins[k + 1] ?? this.values.length) - 1]);
  }

  /** The slope over up to `span` seconds before each point, within its piece; at least 0, and NaN where a piece begins. */
  slopes(span) {
    return this.pieces().flatMap(([begin, last]) => {
      let first = begin;
      return this.values.slice(begin, last + 1).map((value, k) => {
        const time = this.times[begin + k];
        while (time - this.times[first] > span) ++first;
        const passed = time - this.times[first];
        return passed > 0 ? Math.max((value - this.values[first]) / passed, 0) : NaN;
      });
    });
  }

  /** [first, last] of what is drawn of each piece: its part up to now, or its part from now on. */
  parts(later) {
    const parts = this.pieces().map(([first, last]) => (later ? [Math.max(first, this.now), last] : [first, Math.min(last, this.now)]));
    return parts.filter(([first, last]) => first <= last && (!later || last > this.now));
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

  set(curve) {
    this.#curve = curve;
    this.#stale = true;
  }

  draw() {
    if (!this.#stale) return;
    this.#stale = false;
    const curve = this.#curve, { times, now } = curve;
    const values = this.rate > 0 ? curve.slopes(this.rate) : curve.values;
    const label = this.element.querySelector("b"), isKnown = Number.isFinite(values[now]);
    label.textContent = isKnown ? this.format(values[now]) : "–";
    if (isKnown) label.insertAdjacentHTML("beforeend", `<small>${this.unit}</small>`);
    const pieces = curve.pieces();
    this.element.title = pieces.length > 1 ? "Gray: not replayed here yet" : "";
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
    const top = Math.max(...values.filter(Number.isFinite), 1e-9) * 1.08;
    const x = (n) => ((times[n] - t0) / (t1 - t0)) * (width - 4) + 1;
    const y = (n) => height - 1.5 - (values[n] / top) * (height - 5);
    context.fillStyle = style.getPropertyValue("--fill");
    pieces.forEach(([begin], k) => k > 0 && context.fillRect(x(pieces[k - 1][1]), 0, x(begin) - x(pieces[k - 1][1]), height - 1));
    context.strokeStyle = context.fillStyle = style.getPropertyValue(this.color).trim();
    context.lineWidth = 1.6;
    context.lineJoin = "round";
    const step = Math.max(1, Math.floor(values.length / (2 * width)));
    const line = (alpha, begin, end) => {
      const first = Number.isFinite(values[begin]) ? begin : begin + 1; // a slope is not known where a piece begins
      if (first > end) return;
      context.globalAlpha = alpha;
      context.beginPath();
      if (first === end) { // a lonely point
        context.arc(x(first), y(first), 1.2, 0, 7);
        return context.fill();
      }
      context.moveTo(x(first), y(first));
      for (let n = first + step; n < end; n += step) context.lineTo(x(n), y(n));
      context.lineTo(x(end), y(end));
      context.stroke();
      context.lineTo(x(end), height);
      context.lineTo(x(first), height);
      context.globalAlpha = 0.13 * alpha;
      context.fill();
    };
    for (const part of curve.parts(true)) line(0.4, ...part);
    for (const part of curve.parts(false)) line(1, ...part);
    context.globalAlpha = 1;
    if (!isKnown) return;
    context.beginPath();
    context.arc(x(now), y(now), 2.4, 0, 7);
    context.fill();
  }

  redraw() {
    this.#stale = true;
    this.draw();
  }
}
