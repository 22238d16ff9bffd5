// The last log lines of all services.

const MOST = 300; // lines kept
const SHOWN = 120;
const TONES = { 30: "warn", 40: "bad", 50: "bad" };
const WARNING = 30;

/** A line without what counts its repetitions. */
const withoutCount = (text) => text.replace(/ \((\d+ more, )?\d+ in total\)$/, "");

const two = (n) => String(n).padStart(2, "0");
const timeOf = ({ sec }) => {
  const at = new Date(sec * 1000);
  return `${two(at.getHours())}:${two(at.getMinutes())}:${two(at.getSeconds())}`;
};

/** The last lines, by their stamps. */
export class LogLines {
  #lines = []; // { at [s], time, level, name, text }

  /** @param message rcl_interfaces/msg/Log; @return whether it changes what is kept */
  add({ stamp, level, name, msg }) {
    const at = stamp.sec + stamp.nanosec * 1e-9;
    // A replay that has jumped repeats the last lines.
    if (this.#lines.some((line) => line.at === at && line.name === name && line.text === msg)) return false;
    // A warning that is repeated with higher counts takes the place of the one before.
    if (level >= WARNING) {
      const warning = withoutCount(msg);
      const isBefore = (line) => line.name === name && line.at <= at && line.text !== msg && withoutCount(line.text) === warning;
      this.#lines = this.#lines.filter((line) => !isBefore(line));
    }
    // Lines of several services arrive in turns; the older ones of a service come all at once.
    let n = this.#lines.length;
    while (n > 0 && this.#lines[n - 1].at > at) --n;
    this.#lines.splice(n, 0, { at, time: timeOf(stamp), level, name, text: msg });
    if (this.#lines.length > MOST) this.#lines.shift();
    return true;
  }

  /** Forgets the lines of a span of time [s]: those that a replay has yet to come to. @return whether there were any */
  forget(from, to) {
    const left = this.#lines.filter(({ at }) => at <= from || at > to);
    const changed = left.length < this.#lines.length;
    this.#lines = left;
    return changed;
  }

  /** The last lines of at least this level. */
  last(most, least) {
    return this.#lines.filter(({ level }) => level >= least).slice(-most);
  }
}

export class Log {
  #lines = new LogLines();
  #least = 0;
  #changed = true;
  #follows = true; // whether the last line stays in view, until somebody scrolls up

  /** @param list, only  the element to fill, and the button that shows warnings only */
  constructor(list, only) {
    this.list = list;
    list.onscroll = () => (this.#follows = list.scrollHeight - list.scrollTop - list.clientHeight < 24);
    new ResizeObserver(() => this.#follow()).observe(list);
    only.onclick = () => {
      this.#least = this.#least ? 0 : WARNING;
      only.classList.toggle("on", this.#least > 0);
      only.setAttribute("aria-pressed", this.#least > 0);
      this.#changed = true;
      this.draw();
    };
  }

  clear() {
    this.#lines = new LogLines();
    this.#changed = true;
  }

  /** @param message rcl_interfaces/msg/Log */
  add(message) {
    if (this.#lines.add(message)) this.#changed = true;
  }

  /** Forgets the lines of a span of time [s]. */
  forget(from, to) {
    if (this.#lines.forget(from, to)) this.#changed = true;
  }

  draw() {
    if (!this.#changed) return;
    this.#changed = false;
    const { list } = this;
    const lines = this.#lines.last(SHOWN, this.#least);
    list.replaceChildren(...lines.map(({ time, level, name, text }) => {
      const row = document.createElement("div");
      row.className = `line ${TONES[level] ?? ""}`;
      for (const [className, content] of [["number quiet", time], ["who", name], ["what", text]]) {
        const part = document.createElement("span");
        part.className = className;
        part.textContent = content;
        row.append(part);
      }
      row.title = text;
      return row;
    }));
    if (lines.length === 0) {
      const none = document.createElement("div");
      none.className = "none";
      none.textContent = this.#least ? "No warnings." : "No lines yet.";
      list.append(none);
    }
    this.#follow();
  }
  #follow() {
    if (this.#follows) this.list.scrollTop = this.list.scrollHeight;
  }
}
