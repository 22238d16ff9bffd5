// What stands beside the 3D view: state, frontiers, services.

const $ = (id) => document.getElementById(id);
const element = (tag, className, text) => {
  const made = document.createElement(tag);
  if (className) made.className = className;
  if (text !== undefined) made.textContent = text;
  return made;
};

// In the order of ExplorationState and ExplorationOutcome in thalweg_msgs.
const STATES = [["Waiting", "warn"], ["Looking", "go"], ["Planning", "go"], ["Moving", "go"], ["Done", "good"]];
const OUTCOMES = ["", "Complete", "Too much unknown", "Nothing reachable", "No free space", "Time is up", "Distance used up",
  "No path home", "Ended"];
const FATES = ["Not seen yet", "Chosen", "Set aside"];
const FATE_COLORS = ["var(--warn)", "var(--good)", "var(--quiet)"];

const seconds = (s) => `${Math.floor(s / 60)}:${String(Math.floor(s % 60)).padStart(2, "0")}`;
const number = (value, digits, unit) => (Number.isFinite(value) ? `${value.toFixed(digits)} ${unit}`.trim() : "–");

export function showTime(now) {
  $("clock").textContent = seconds(now);
}

export function showLink(state, text) {
  const link = document.querySelector(".link");
  link.className = `link ${state}`;
  link.querySelector("span").textContent = text;
}

/** @param status thalweg_msgs/msg/ExplorationStatus */
export function showStatus(status) {
  const [name, tone] = STATES[status.state] ?? ["–", ""];
  const done = status.state === 4;
  const bad = done && status.outcome !== 1;
  $("state").textContent = done ? OUTCOMES[status.outcome] || name : status.homeward ? "Going home" : name;
  $("state").className = `pill ${bad ? "warn" : tone}`;
  $("activity").textContent = (done && status.stop_reason) || status.activity;
  $("activity").title = $("activity").textContent;
}

/** The list, chosen first, then those left by score, then those set aside. */
export function showFrontiers(frontiers, selected, onSelect) {
  const order = frontiers.map((_, n) => n);
  const rank = ({ fate, score, voxels }) => [fate === 1 ? 0 : fate === 0 ? 1 : 2, Number.isFinite(score) ? -score : 1e9, -voxels];
  order.sort((a, b) => {
    const x = rank(frontiers[a]), y = rank(frontiers[b]);
    return x[0] - y[0] || x[1] - y[1] || x[2] - y[2];
  });
  const left = frontiers.filter(({ fate }) => fate !== 2).length;
  $("frontier-count").textContent = `${left} left, ${frontiers.length - left} set aside`;
  const list = $("frontiers");
  const top = list.scrollTop;
  list.replaceChildren();
  for (const n of order.slice(0, 60)) {
    const { fate, score, voxels, path_length_m: way, reason } = frontiers[n];
    const row = element("button", n === selected ? "row on" : "row");
    const dot = element("i");
    dot.style.background = FATE_COLORS[fate];
    row.append(dot, element("span", "number", `${voxels} ${voxels === 1 ? "voxel" : "voxels"}`),
      element("span", "tag number", fate === 2 ? "" : number(way, 1, "m")),
      element("span", "number", Number.isFinite(score) ? score.toPrecision(3) : FATES[fate].toLowerCase()));
    if (reason) row.append(element("span", "note", reason));
    row.onclick = () => onSelect(n);
    list.append(row);
  }
  if (frontiers.length === 0) list.append(element("div", "none", "None: nothing is left to see."));
  if (order.length > 60) list.append(element("div", "none", `and ${order.length - 60} more`));
  list.scrollTop = top;
}

export function showWhy(frontier) {
  $("why-card").hidden = !frontier;
  if (!frontier) return;
  const { fate, score, voxels, path_length_m: way, reason, center } = frontier;
  const rows = [["Fate", FATES[fate]], ["Score", Number.isFinite(score) ? score.toPrecision(4) : "none"], ["Unknown voxels", voxels],
    ["Way to a view of it", number(way, 2, "m")], ["Center", [center.x, center.y, center.z].map((c) => c.toFixed(2)).join(", ")]];
  const dl = element("dl");
  for (const [key, value] of rows) dl.append(element("dt", "", key), element("dd", "number", String(value)));
  const why = fate === 1 ? "The goal of the current plan: the strategy scored it best."
    : fate === 2 ? `Ignored: ${reason || "no reason given"}.` : "Waits for its turn: another frontier scored better.";
  $("why").replaceChildren(dl, element("p", "quiet", why));
}

/** Services by the health messages that arrive from them. */
export class Services {
  #known = new Map(); // name -> { message, heard, changed }

  clear() {
    this.#known.clear();
  }

  /** @param message thalweg_msgs/msg/ServiceHealth */
  update(message) {
    const sum = (counters) => counters.reduce((total, { count }) => total + Number(count), 0);
    const now = performance.now();
    const rejected = sum(message.rejected), dropped = sum(message.dropped);
    const before = this.#known.get(message.service);
    const grew = before && before.message.process_id === message.process_id && rejected > before.rejected;
    this.#known.set(message.service, { message, rejected, dropped, heard: now, changed: grew ? now : (before?.changed ?? -1e9),
      restarted: before && before.message.process_id !== message.process_id ? now : (before?.restarted ?? -1e9) });
  }

  draw() {
    const list = $("services");
    list.replaceChildren();
    const now = performance.now();
    for (const name of [...this.#known.keys()].sort()) {
      const { message, rejected, dropped, heard, changed, restarted } = this.#known.get(name);
      const silent = (now - heard) / 1000;
      const row = element("div", "row");
      const dot = element("i");
      dot.style.background = silent > 3.5 ? "var(--bad)" : now - changed < 5000 ? "var(--warn)" : "var(--good)";
      const slowest = message.timings.filter(({ count }) => count > 0n).sort((a, b) => b.p95_ms - a.p95_ms)[0];
      const state = silent > 3.5 ? `silent for ${silent.toFixed(0)} s` : now - restarted < 10000 ? "restarted"
        : slowest ? `${slowest.name} ${slowest.p95_ms.toFixed(slowest.p95_ms < 10 ? 1 : 0)} ms` : "";
      row.append(dot, element("span", "", name), element("span", "tag number", state),
        element("span", rejected ? "tag warn number" : "tag number", `${rejected} rejected`));
      const last = [...message.rejected, ...message.dropped].at(-1);
      const dropNote = dropped ? `${dropped} dropped` : "";
      if (last) row.append(element("span", "note", [dropNote, `${last.name}: ${last.last}`].filter(Boolean).join(" · ")));
      row.title = [...message.rejected, ...message.dropped].map(({ name: what, count, last: why }) => `${what}: ${count} (${why})`)
        .concat(message.timings.map((t) => `${t.name}: median ${t.p50_ms.toFixed(1)}, 95 % ${t.p95_ms.toFixed(1)} ms`)).join("\n");
      list.append(row);
    }
    if (this.#known.size === 0) list.append(element("div", "none", "None heard yet."));
  }
}
