// The time line of a replay: where it is in its recording, and what steers it. Hidden while nothing is replayed.
import { toast } from "./toasts.js";

const $ = (id) => document.getElementById(id);
export const RATES = [0.25, 0.5, 1, 2, 5, 10];
const STEP = 5; // [s]
const SILENT = 3500; // [ms] without a status, which comes once a second at least

const seconds = ({ sec, nanosec }) => sec + 1e-9 * nanosec;
const two = (n) => String(n).padStart(2, "0");

/** "1:23", or "1:02:03" where the recording takes hours; with a tenth where it takes less than a minute. */
export function clockText(time, length) {
  const whole = Math.floor(time + 1e-6);
  const [h, m, s] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60, whole % 60];
  if (length >= 3600) return `${h}:${two(m)}:${two(s)}`;
  return `${m + 60 * h}:${two(s)}${length < 60 ? `.${Math.floor(10 * (time + 1e-6 - whole))}` : ""}`;
}

/** The next of RATES above a rate, or below it; the rate itself at the end. */
export function nextRate(rate, up) {
  const rest = up ? RATES.filter((each) => each > rate * 1.001) : RATES.filter((each) => each < rate * 0.999).reverse();
  return rest[0] ?? rate;
}

export class Timeline {
  #connection;
  #status = null; // { length, now [s], rate, paused, file }
  #heard = 0;
  #wanted = null; // [s] where it is dragged to, or was sent to and has yet to answer
  #allowed = false;

  /** @param onPresence called when a replay begins to be heard, and when it no longer is; @param onSeek when it is sent elsewhere */
  constructor(connection, keys, onPresence, onSeek) {
    this.#connection = connection;
    this.onPresence = onPresence;
    this.onSeek = onSeek;
    for (const rate of RATES) this.#offer(rate);
    $("replay-pause").onclick = () => this.toggle();
    $("replay-rate").onchange = () => this.#send("rate", { rate: Number($("replay-rate").value) });
    const line = $("replay-seek");
    line.oninput = () => {
      this.#wanted = Number(line.value);
      this.#draw();
      this.#hint(this.#wanted);
    };
    line.onchange = () => {
      $("replay-hint").hidden = true;
      this.seek(Number(line.value));
    };
    line.onpointermove = ({ clientX }) => {
      if (line.disabled || line.matches(":active")) return;
      const box = line.getBoundingClientRect(), thumb = 14;
      const share = (clientX - box.left - thumb / 2) / (box.width - thumb);
      this.#hint(Math.min(Math.max(share, 0), 1) * Number(line.max));
    };
    line.onpointerleave = () => ($("replay-hint").hidden = true);
    const claim = (key, text, act) => keys.claim(key, { group: "Replay", text, act: () => this.present && act() });
    claim("j", `Back ${STEP} s`, () => this.#step(-STEP));
    claim("k", `Forward ${STEP} s`, () => this.#step(STEP));
    claim("Home", "To the beginning", () => this.seek(0));
    claim("-", "Slower", () => this.#changeRate(false));
    claim("+", "Faster", () => this.#changeRate(true));
    claim("=", "Faster", () => this.#changeRate(true));
    setInterval(() => {
      if (this.present && performance.now() - this.#heard > SILENT) this.#leave();
    }, 500);
  }

  get present() {
    return this.#status !== null;
  }
  /** { length, now [s], rate, paused, file }, or null */
  get shown() {
    return this.#status;
  }

  /** Whether this page may steer. */
  allow(allowed) {
    this.#allowed = allowed;
    for (const id of ["replay-pause", "replay-rate", "replay-seek"]) $(id).disabled = !allowed;
  }

  /** @param message thalweg_msgs/msg/ReplayStatus */
  update(message) {
    const began = !this.present;
    const begin = seconds(message.begin);
    this.#status = { length: seconds(message.end) - begin, now: seconds(message.now) - begin, rate: message.rate, paused: message.paused,
      file: message.file };
    this.#heard = performance.now();
    $("replay-file").textContent = message.file;
    $("replay-file").title = message.loop ? `${message.file}, again and again` : message.file;
    $("replay-loop").hidden = !message.loop;
    if (began) {
      $("timeline").hidden = false;
      this.onPresence(true);
    }
    this.#draw();
  }
  #leave() {
    this.#status = this.#wanted = null;
    $("timeline").hidden = true;
    this.onPresence(false);
    toast("has ended", "", "Replay");
  }

  toggle() {
    return this.#send(this.#status.paused ? "resume" : "pause");
  }
  async seek(time) {
    this.#wanted = Math.min(Math.max(time, 0), this.#status.length);
    this.#draw();
    const target = this.#wanted;
    this.onSeek();
    await this.#send("seek", { time_s: target });
    if (this.#wanted === target) this.#wanted = null;
    if (this.present) this.#draw();
  }
  #step(by) {
    return this.seek((this.#wanted ?? this.#status.now) + by);
  }
  #changeRate(up) {
    const rate = nextRate(this.#status.rate, up);
    if (rate === this.#status.rate) return;
    this.#status.rate = rate; // for the next press, which may come before the answer
    this.#send("rate", { rate });
  }
  async #send(name, request = {}) {
    if (!this.#allowed) return toast("this page may only look", "warn", "Replay");
    const { accepted, reason } = await this.#connection.call(`/replay/${name}`, request);
    if (!accepted) toast(reason || "no reason given", "warn", "Replay refuses");
  }

  #offer(rate) {
    const option = document.createElement("option");
    option.value = rate;
    option.textContent = `${Number(rate.toPrecision(3))} ×`;
    $("replay-rate").append(option);
  }

  /** Shows a time above its place on the line. */
  #hint(time) {
    if (!this.present) return;
    const hint = $("replay-hint"), { length } = this.#status;
    hint.hidden = false;
    hint.textContent = clockText(time, length);
    hint.style.setProperty("--share", length > 0 ? time / length : 0);
  }

  #draw() {
    const { length, now, rate, paused } = this.#status;
    const time = this.#wanted ?? now, line = $("replay-seek");
    line.max = length;
    line.step = "any";
    line.value = time;
    line.style.setProperty("--share", length > 0 ? Math.min(time / length, 1) : 0);
    line.setAttribute("aria-valuetext", `${clockText(time, length)} of ${clockText(length, length)}`);
    $("replay-time").textContent = clockText(time, length);
    $("replay-length").textContent = clockText(length, length);
    $("replay-pause").classList.toggle("paused", paused);
    $("replay-pause").setAttribute("aria-label", paused ? "Resume the replay" : "Pause the replay");
    const menu = $("replay-rate");
    if (document.activeElement === menu && menu.matches(":focus-visible")) return;
    if (![...menu.options].some(({ value }) => Number(value) === rate)) this.#offer(rate);
    menu.value = [...menu.options].find(({ value }) => Number(value) === rate).value;
  }
}
