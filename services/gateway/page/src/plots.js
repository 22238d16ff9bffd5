// Small curves over the time of the run.

export class Plot {
  #times = [];
  #values = [];
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
    this.#times = [];
    this.#values = [];
    this.#stale = true;
  }

  add(time, value) {
    if (!Number.isFinite(value)) return;
    this.#times.push(time);
    this.#values.push(value);
    this.#stale = true;
  }

  #curve() {
    if (this.rate === 0) return this.#values;
    let first = 0;
    return this.#values.map((value, n) => {
      while (this.#times[n] - this.#times[first] > this.rate) ++first;
      const span = this.#times[n] - this.#times[first];
      return span > 0 ? Math.max((value - this.#values[first]) / span, 0) : 0;
    });
  }

  draw() {
    if (!this.#stale) return;
    this.#stale = false;
    const values = this.#curve();
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
    const t0 = this.#times[0], t1 = Math.max(this.#times.at(-1), t0 + 1e-6);
    const top = Math.max(...values, 1e-9) * 1.08;
    const x = (n) => ((this.#times[n] - t0) / (t1 - t0)) * (width - 4) + 1;
    const y = (n) => height - 1.5 - (values[n] / top) * (height - 5);
    const step = Math.max(1, Math.floor(values.length / (2 * width)));
    context.beginPath();
    context.moveTo(x(0), y(0));
    for (let n = step; n < values.length; n += step) context.lineTo(x(n), y(n));
    const end = values.length - 1;
    context.lineTo(x(end), y(end));
    const color = style.getPropertyValue(this.color).trim();
    context.strokeStyle = color;
    context.lineWidth = 1.6;
    context.lineJoin = "round";
    context.stroke();
    context.lineTo(x(end), height);
    context.lineTo(x(0), height);
    context.globalAlpha = 0.13;
    context.fillStyle = color;
    context.fill();
    context.globalAlpha = 1;
    context.beginPath();
    context.arc(x(end), y(end), 2.4, 0, 7);
    context.fill();
  }
  redraw() {
    this.#stale = true;
    this.draw();
  }
}
