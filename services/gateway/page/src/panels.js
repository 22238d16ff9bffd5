// What stands beside the 3D view: state, frontiers, services.
import { CHOSEN, DONE, FATES, OUTCOMES, PAUSED, REASONS, SET_ASIDE, STATES } from "./enums.js";

const $ = (id) => document.getElementById(id);
const element = (tag, className, text) => {
  const made = document.createElement(tag);
  if (className) made.className = className;
  if (text !== undefined) made.textContent = text;
  return made;
};

// How the gateway calls the counter of what slow pages did not get (gateway_service.cpp).
const VIEWERS = "viewers";

const FATE_COLORS = ["var(--warn)", "var(--good)", "var(--quiet)"];

const seconds = (s) => `${Math.floor(s / 60)}:${String(Math.floor(s % 60)).padStart(2, "0")}`;
const number = (value, digits, unit) => (Number.isFinite(value) ? `${value.toFixed(digits)} ${unit}`.trim() : "–");

export function showTime(now) {
  $("clock").textContent = seconds(now);
}

export function showLink(state, text) {
  const link = document.querySelector(".link");
  link.className = `link ${state}`;
  link.title = text;
  link.querySelector("span").textContent = state === "refused" ? state : text;
}

/** @param status thalweg_msgs/msg/ExplorationStatus; @param replayed whether it comes from a recording */
export function showStatus(status, replayed) {
  const [name, tone] = STATES[status.state] ?? ["–", ""];
  const done = status.state === DONE;
  const bad = done && status.outcome !== 1;
  document.documentElement.dataset.state = name.toLowerCase();
  const paused = status.state === PAUSED;
  // The robot of a recording may stand while its replay plays.
  $("state").textContent = done ? OUTCOMES[status.outcome] || name : paused && replayed ? "Robot paused" : status.homeward && !paused ? "Going home" : name;
  $("state").className = `pill ${bad ? "warn" : tone}`;
  // A reason that only repeats the state says nothing.
  const reason = done && status.stop_reason.toLowerCase() !== $("state").textContent.toLowerCase() ? status.stop_reason : "";
  $("activity").textContent = done ? reason : status.activity;
  $("activity").title = $("activity").textContent;
}

/** Why a frontier is set aside, or that its voxels are known but uncertain; "" if neither. */
const reasonOf = ({ reason, doubtful }) => [doubtful ? "doubtful" : "", REASONS[reason] ?? "unknown reason"].filter(Boolean).join(": ");

/** What is said while no explorer is heard: before a run, and after it. */
export function showNoExplorer() {
  document.documentElement.dataset.state = "absent";
  $("state").textContent = "No explorer";
  $("state").className = "pill";
  $("activity").textContent = $("activity").title = "No explorer is heard: its run has ended or has not begun.";
}

/** How old the list is [s], where that matters: an explorer that is paused, or does what it was commanded, does not plan. */
export function showFrontierAge(age) {
  $("frontier-age").textContent = age < 5 ? "" : `${age.toFixed(0)} s old`;
}

/** The list, chosen first, then those left by score, then those set aside; null before any was heard. */
export function showFrontiers(frontiers, selected, onSelect) {
  if (frontiers === null) {
    $("frontier-count").textContent = "";
    return $("frontiers").replaceChildren(element("div", "none", "Not heard yet."));
  }
  const order = frontiers.map((_, n) => n);
  const rank = ({ fate, score, voxels }) => [fate === CHOSEN ? 0 : fate === SET_ASIDE ? 2 : 1, Number.isFinite(score) ? -score : 1e9, -voxels];
  order.sort((a, b) => {
    const x = rank(frontiers[a]), y = rank(frontiers[b]);
    return x[0] - y[0] || x[1] - y[1] || x[2] - y[2];
  });
  const left = frontiers.filter(({ fate }) => fate !== SET_ASIDE).length;
  $("frontier-count").textContent = `${left} left, ${frontiers.length - left} set aside`;
  const list = $("frontiers");
  const top = list.scrollTop;
  list.replaceChildren();
  for (const n of order.slice(0, 60)) {
    const { fate, score, voxels, path_length_m: length } = frontiers[n];
    const reason = reasonOf(frontiers[n]);
    const row = element("button", n === selected ? "row on" : "row");
    const dot = element("i");
    dot.style.background = FATE_COLORS[fate];
    row.title = Number.isFinite(score) ? "Unknown voxels, path to a view of them, score by the strategy (the largest is best)" : "";
    row.append(dot, element("span", "number", `${voxels} ${voxels === 1 ? "voxel" : "voxels"}`),
      element("span", "tag number", fate === SET_ASIDE ? "" : number(length, 1, "m")),
      element("span", "number", Number.isFinite(score) ? score.toPrecision(3) : FATES[fate].toLowerCase()));
    if (reason) row.append(element("span", "note", reason));
    row.onclick = () => onSelect(n);
    list.append(row);
  }
  if (frontiers.length === 0) list.append(element("div", "none", document.documentElement.dataset.state === "done" ? "None: nothing is left to see." : "None found yet."));
  if (order.length > 60) list.append(element("div", "none", `and ${order.length - 60} more`));
  list.scrollTop = top;
}

export function showWhy(frontier) {
  $("why-card").hidden = !frontier;
  if (!frontier) return;
  const { fate, score, voxels, path_length_m: length, center } = frontier;
  const rows = [["State", FATES[fate]], ["Score", Number.isFinite(score) ? score.toPrecision(4) : "none"], ["Unknown voxels", voxels],
    ["Path to a view of it", number(length, 2, "m")], ["Center", [center.x, center.y, center.z].map((c) => c.toFixed(2)).join(", ")]];
  const dl = element("dl");
  for (const [key, value] of rows) dl.append(element("dt", "", key), element("dd", "number", String(value)));
  const why = fate === CHOSEN ? "The goal of the current plan: the strategy scored it best."
    : fate === SET_ASIDE ? `Ignored: ${reasonOf(frontier) || "no reason given"}.` : Number.isFinite(score) ? "Waits for its turn: another frontier scored better." : "Waits for its turn.";
  $("why").replaceChildren(dl, element("p", "quiet", why));
}

const AT_ONCE = 2500; // [ms] within which two instances that run at once are both heard
const SLEPT = 2000; // [ms] between two drawings
const SILENT = 3.5; // [s] without a health message, which comes once a second

/** Services by the health messages that arrive from them. */
export class Services {
  #drawn = performance.now();
  #known = new Map(); // name -> { message, heard, changed, silent }

  /** @param onEvent (name, "silent" or "restarted" or "back") */
  constructor(onEvent) {
    this.onEvent = onEvent;
  }

  clear() {
    this.#known.clear();
  }

  /** Whether a service of this name lives. */
  hears(name) {
    const known = this.#known.get(name);
    return known !== undefined && !known.silent;
  }

  /** @param message thalweg_msgs/msg/ServiceHealth */
  update(message) {
    const sum = (counters) => counters.reduce((total, { count }) => total + Number(count), 0);
    const now = performance.now();
    const rejected = sum(message.rejected), dropped = sum(message.dropped);
    const before = this.#known.get(message.service);
    const same = before?.message.instance === message.instance;
    const grew = same && rejected > before.rejected;
    const instances = before?.instances ?? new Map(); // instance -> when it was heard
    const isNew = before && !instances.has(message.instance);
    instances.set(message.instance, now);
    if (same && before.silent) this.onEvent(message.service, "back");
    this.#known.set(message.service, { message, rejected, dropped, heard: now, changed: grew ? now : (before?.changed ?? -1e9),
      restarted: before?.restarted ?? -1e9, begun: isNew ? now : before?.begun, instances, silent: false });
  }

  /** A new instance means a restart once the others of its name are silent: several gateways may run at once. */
  #noticeRestart(name, known, now) {
    if (known.begun === undefined || now - known.begun < AT_ONCE) return;
    const others = [...known.instances].filter(([instance]) => instance !== known.message.instance);
    if (others.every(([, heard]) => heard < known.begun)) {
      known.restarted = now;
      known.instances = new Map([[known.message.instance, known.heard]]);
      this.onEvent(name, "restarted");
    }
    known.begun = undefined;
  }

  /** @param isOver whether the run has ended, so that silence is to be expected */
  draw(isOver) {
    const list = $("services");
    list.replaceChildren();
    const now = performance.now();
    // A page that slept heard nobody meanwhile.
    if (now - this.#drawn > SLEPT) for (const known of this.#known.values()) known.heard += now - this.#drawn;
    this.#drawn = now;
    for (const name of [...this.#known.keys()].sort()) {
      const known = this.#known.get(name);
      const { message, rejected, dropped, heard, changed } = known;
      const silent = (now - heard) / 1000;
      if (silent > SILENT && !known.silent) this.onEvent(name, "silent");
      known.silent = silent > SILENT;
      this.#noticeRestart(name, known, now);
      for (const [instance, at] of known.instances) if (now - at > 10000 && instance !== message.instance) known.instances.delete(instance);
      const row = element("div", `row${silent > SILENT ? (isOver ? " ended" : " silent") : now - known.restarted < 10000 ? " restarted" : ""}`);
      const dot = element("i");
      dot.style.background = silent > SILENT ? (isOver ? "var(--quiet)" : "var(--bad)") : now - changed < 5000 ? "var(--warn)" : "var(--good)";
      const slowest = message.timings.filter(({ count }) => count > 0n).sort((a, b) => b.p95_ms - a.p95_ms)[0];
      const state = silent > SILENT ? (isOver ? "ended" : `silent for ${silent.toFixed(0)} s`) : now - known.restarted < 10000 ? "restarted"
        : slowest ? `${slowest.p95_ms.toFixed(slowest.p95_ms < 10 ? 1 : 0)} ms ${slowest.name}` : "";
      row.append(dot, element("span", "", known.instances.size > 1 ? `${name} × ${known.instances.size}` : name), element("span", "tag number", state),
        element("span", "tag warn number", rejected ? `${rejected} rejected` : ""));
      // What a slow page did not get is no fault of the gateway: newer messages took its place.
      const lost = message.dropped.filter(({ name: what }) => what !== VIEWERS);
      const skipped = message.dropped.filter(({ name: what }) => what === VIEWERS).reduce((total, { count }) => total + Number(count), 0);
      const last = [...message.rejected, ...lost].at(-1);
      const notes = [dropped > skipped ? `${dropped - skipped} dropped` : "", last ? `${last.name}: ${last.last}` : "",
        skipped ? `${skipped} skipped for slow pages` : ""].filter(Boolean);
      row.dataset.service = name;
      if (notes.length > 0) row.append(element("span", "note", notes.join(" · ")));
      row.title = [...message.rejected, ...message.dropped].map(({ name: what, count, last: why }) => `${what}: ${count} (${why})`)
        .concat(message.timings.map((t) => `${t.name}: median ${t.p50_ms.toFixed(1)}, 95 % ${t.p95_ms.toFixed(1)} ms`)).join("\n");
      list.append(row);
    }
    if (this.#known.size === 0) list.append(element("div", "none", "None heard yet."));
  }
}
