// What is known of the run so far, in rows by time: more than the gateway tells, once a replay has gone back.
import { Curve } from "./plots.js";

const CLOSE = 0.02; // [m] between points of the path that are drawn as one
const LATE = 3000; // [ms] after a jump within which what came before it may still arrive
const LEAST_GAP = 1; // [s]

export class History {
  rows = []; // { time, place [x, y, z], known, distance, planning, joined: whether to the row before }
  #now = -1; // number of the row that came last
  #jumped = null; // when [ms] a jump was asked for that has yet to show

  clear() {
    this.rows = [];
    this.#now = -1;
  }

  /** A replay was sent elsewhere: what comes from there is not joined to what came before. */
  jump() {
    this.#jumped = performance.now();
  }

  /**
   * @param message thalweg_msgs/msg/RunHistory
   * @param keep    whether what is known stays where the message begins from the start: a replay that has gone back repeats
   *                the same recording
   */
  add(message, keep) {
    if (message.reset && !keep) this.clear();
    let joined = !message.reset;
    message.time_s.forEach((time, n) => {
      const place = message.position_m.slice(3 * n, 3 * n + 3);
      if (!Number.isFinite(place[0])) return (joined = false);
      if (this.#isJump(time)) joined = false;
      this.#put({ time, place, known: message.known_m3[n], distance: message.distance_m[n], planning: message.planning_ms[n], joined });
      joined = true;
    });
  }

  /** Whether a row is farther from the one before than rows are: where a replay is fast, many seconds are no gap. */
  #isJump(time) {
    if (this.#jumped === null || this.#now < 0) return false;
    const last = this.rows.slice(Math.max(this.#now - 4, 0), this.#now + 1);
    const spacing = Math.max(...last.map((row, n) => (n > 0 && row.joined ? row.time - last[n - 1].time : 0)));
    const isJump = Math.abs(time - last.at(-1).time) > Math.max(LEAST_GAP, 1.6 * spacing);
    if (isJump || performance.now() - this.#jumped > LATE) this.#jumped = null;
    return isJump;
  }

  /** Puts a row in its place: of what was known between it and the row to which it is joined, it takes the place. */
  #put(row) {
    let from = this.#after(row.joined && this.#now >= 0 ? this.rows[this.#now].time : row.time);
    if (!row.joined && this.rows[from - 1]?.time === row.time) --from;
    const to = Math.max(this.#after(row.time), from), next = this.rows[to];
    // In the midst of what is known, time is missing on neither side.
    if (!row.joined) row.joined = from < to ? this.rows[from].joined : next !== undefined && next.joined;
    this.rows.splice(from, to - from, row);
    this.#now = from;
  }
  /** The number of the first row that is later. */
  #after(time) {
    let low = 0, high = this.rows.length;
    if (high === 0 || this.rows[high - 1].time <= time) return high;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.rows[middle].time <= time) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  /** { points: flat x, y, z, breaks: numbers of those to which no line leads } up to now. */
  path() {
    const points = [], breaks = new Set();
    for (let n = 0; n <= this.#now; ++n) {
      const { place, joined } = this.rows[n], last = points.length;
      if (!joined && last > 0) breaks.add(last / 3);
      else if (last > 0 && Math.hypot(...place.map((c, k) => c - points[last - 3 + k])) <= CLOSE) continue;
      points.push(...place);
    }
    return { points, breaks };
  }

  /** { pieces: [first, last] times of each, now } [s] */
  get shown() {
    const curve = this.curve("distance");
    return { pieces: curve.pieces().map((piece) => piece.map((n) => curve.times[n])), now: curve.times[curve.now] ?? null };
  }

  /** @param name of a row's number: "known", "distance" or "planning" */
  curve(name) {
    const curve = new Curve();
    this.rows.forEach((row, n) => {
      if (!row.joined) curve.interrupt();
      curve.add(row.time, row[name]);
      if (n === this.#now) curve.isNow();
    });
    return curve;
  }
}
