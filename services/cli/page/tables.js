// Figures and tables of a run. All text of the run goes through textContent.
import { clockText, raised } from "./timeline.js";

function element(tag, className, text) {
  const made = document.createElement(tag);
  if (className) made.className = className;
  if (text !== undefined && text !== null) made.textContent = text;
  return made;
}

const known = (value, digits, unit = "") => (value === null || value === undefined ? "–" : `${value.toFixed(digits)}${unit && ` ${unit}`}`);

export function showFigures(parent, { report }) {
  const figure = (value, meaning, tone) => {
    const box = element("div");
    box.append(element("b", tone, value), element("span", "", meaning));
    parent.append(box);
  };
  if (report.coverage !== null) figure(known(100 * report.coverage, 1, "%"), "of what can be seen is known");
  figure(known(report.explored_m3, 1, "m³"), "known volume");
  figure(known(report.distance_m, 1, "m"), "traveled");
  const clock = report.true_collisions === null ? "on the run's clock" : "simulated";
  figure(clockText(report.duration_s), `${clock}, ${clockText(report.wall_s)} wall clock`);
  figure(String(report.plans), `plans, ${report.replans} abandoned as unsafe`);
  if (report.true_collisions !== null) figure(String(report.true_collisions), "collisions", report.true_collisions ? "bad" : "good");
  if (report.agreement !== null) figure(known(100 * report.agreement, 1, "%"), "of the map agrees with the truth");
  if (report.least_clearance_m !== null) figure(known(report.least_clearance_m, 2, "m"), "nearest to a surface");
}

/** @param columns [{ name, words, cell: (row) -> text or element }] */
function table(columns, rows) {
  const made = element("table"), head = element("tr");
  for (const { name, words } of columns) head.append(element("th", words ? "words" : "", name));
  const top = element("thead"), body = element("tbody");
  top.append(head);
  for (const row of rows) {
    const line = element("tr");
    for (const { words, cell } of columns) {
      const value = cell(row);
      const td = element("td", words ? "words" : "");
      if (value instanceof Node) {
        td.className = "bar-cell";
        td.append(value);
      } else {
        td.textContent = value ?? "–";
      }
      line.append(td);
    }
    body.append(line);
  }
  made.append(top, body);
  return made;
}

function section(parent, title, note) {
  const made = element("section");
  made.append(element("h2", "", title));
  if (note) made.append(element("p", "quiet", note));
  const card = element("div", "card");
  made.append(card);
  parent.append(made);
  return card;
}

function scrolling(parent, what, tall) {
  const box = element("div", tall ? "scroll tall" : "scroll");
  box.tabIndex = 0;
  box.append(what);
  parent.append(box);
  return box;
}

function bar(value, most, second) {
  const box = document.createDocumentFragment();
  const cell = element("span");
  const width = (v) => `${Math.min(100, (100 * v) / Math.max(most, 1e-9)).toFixed(1)}%`;
  const first = element("i");
  first.style.width = width(value);
  cell.append(first);
  if (second !== undefined) {
    const other = element("i", "second");
    other.style.width = width(second);
    cell.append(other);
  }
  box.append(cell);
  return box;
}

function showDecisions(parent, run, timeline) {
  const { decisions, decisions_forgotten: forgotten } = run;
  if (decisions.length === 0) return;
  const abandoned = decisions.filter(({ interruption }) => interruption).length;
  const card = section(parent, "Decisions",
    `${decisions.length} plans, ${abandoned} of them interrupted on the way. A click shows the run at that time.` +
    (forgotten ? ` ${forgotten} earlier ones are not listed.` : ""));
  const made = table([
    { name: "plan", cell: (d) => String(d.number) },
    { name: "time", cell: (d) => clockText(d.t_s) },
    { name: "purpose", words: true, cell: (d) => raised(d.purpose) },
    { name: "path [m]", cell: (d) => known(d.length_m, 1) },
    { name: "target [m]", cell: (d) => (d.target ? d.target.map((c) => c.toFixed(1)).join(", ") : "–") },
    { name: "interrupted because", words: true, cell: (d) => d.interruption },
  ], decisions);
  const rows = [...made.querySelectorAll("tbody tr")];
  rows.forEach((row, n) => {
    row.className = "pick";
    row.tabIndex = 0;
    row.onclick = () => timeline.seek(decisions[n].t_s);
    row.onkeydown = (event) => event.key === "Enter" && row.onclick();
  });
  const box = scrolling(card, made, true);
  timeline.onDecision((n) => {
    rows.forEach((row, k) => row.classList.toggle("on", k === n));
    const row = rows[n];
    if (row) box.scrollTop = Math.max(0, row.offsetTop - box.clientHeight / 2);
  });
}

function showLeft(parent, { report, frontiers }) {
  const left = report.frontiers_left === 1
    ? "1 frontier, a place where the unknown begins, was left"
    : `${report.frontiers_left} frontiers, places where the unknown begins, were left`;
  const card = section(parent, "What stayed unknown", `${left} to see at the end. Others were set aside:`);
  const most = Math.max(...report.frontiers_set_aside.map(({ voxels }) => voxels), 1);
  if (report.frontiers_set_aside.length === 0) card.append(element("span", "quiet", "None were set aside."));
  else {
    scrolling(card, table([
      { name: "reason", words: true, cell: (entry) => entry.reason },
      { name: "frontiers", cell: (entry) => String(entry.clusters) },
      { name: "unknown voxels", cell: (entry) => String(entry.voxels) },
      { name: "", cell: (entry) => bar(entry.voxels, most) },
    ], report.frontiers_set_aside));
  }
  if (frontiers.length > 0) card.append(element("p", "quiet", `${frontiers.length} of the last plan are drawn in the map above.`));
}

function showTimings(parent, { report }) {
  const timings = [...report.planning.map((t) => ({ ...t, of: "explorer" })), ...report.integration.map((t) => ({ ...t, of: "mapper" }))]
    .filter(({ count }) => count > 0);
  if (timings.length === 0) return;
  const most = Math.max(...timings.map(({ p95_ms: p95 }) => p95));
  scrolling(section(parent, "Timings", "Median (thick) and 95th percentile (thin) of each stage; \"plan\" is a whole decision."), table([
    { name: "stage", words: true, cell: (t) => t.name },
    { name: "service", words: true, cell: (t) => t.of },
    { name: "times", cell: (t) => String(t.count) },
    { name: "p50 [ms]", cell: (t) => known(t.p50_ms, 1) },
    { name: "p95 [ms]", cell: (t) => known(t.p95_ms, 1) },
    { name: "max [ms]", cell: (t) => known(t.max_ms, 1) },
    { name: "", cell: (t) => bar(t.p50_ms, most, t.p95_ms) },
  ], timings));
}

function showHealth(parent, { report, services }) {
  const card = section(parent, "Health", "Rejected: invalid messages. Dropped: valid ones that came too late or could not be placed.");
  if (services.length === 0) card.append(element("span", "quiet", "No service was heard."));
  else {
    scrolling(card, table([
      { name: "service", words: true, cell: (s) => s.name },
      { name: "host", words: true, cell: (s) => s.host },
      { name: "processes", cell: (s) => String(s.processes) },
      { name: "up", cell: (s) => clockText(s.uptime_s) },
      { name: "rejected", cell: (s) => String(s.rejected) },
      { name: "dropped", cell: (s) => String(s.dropped) },
    ], services));
  }
  const counts = [...report.messages_rejected.by_topic, ...report.messages_dropped.by_topic].filter(({ count }) => count > 0);
  if (counts.length === 0) return;
  card.append(element("h3", "", "What was refused or dropped, and why"));
  card.lastChild.style.marginTop = "18px";
  scrolling(card, table([
    { name: "service", words: true, cell: (c) => c.service },
    { name: "topic and event", words: true, cell: (c) => c.name },
    { name: "times", cell: (c) => String(c.count) },
    { name: "latest reason", words: true, cell: (c) => c.last },
  ], counts));
}

function showScenario(parent, { scenario_text: text, report }) {
  if (!text) return;
  const card = section(parent, "Scenario");
  const details = element("details");
  details.append(element("summary", "", `${report.scenario}: every field with its value, defaults marked`));
  const pre = element("pre");
  pre.tabIndex = 0;
  for (const line of text.split("\n")) pre.append(element("span", /#.*default/.test(line) ? "default" : "", `${line}\n`));
  details.append(pre);
  card.append(details);
}

function showTerms(parent, { map }) {
  const card = section(parent, "What the words mean");
  const terms = element("dl", "terms");
  for (const [term, meaning] of [
    ["coverage", "share of all surfaces and space that this robot could see from anywhere it can reach that the map knows; needs a true world"],
    ["agreement", "share of the same that the map has right; unknown counts as wrong"],
    ["frontier", "a place where known free space borders the unknown"],
    ["set aside", "a frontier that looking does not resolve; it may be looked at again later, or from elsewhere"],
    ["map", "the faces of occupied voxels, colored by height; with the slider it is what was known at that time" +
      (map && map.voxel_size_m > map.true_voxel_size_m * 1.01
        ? `; drawn with voxels of ${map.voxel_size_m.toFixed(2)} m instead of ${map.true_voxel_size_m.toFixed(2)} m, so that this page stays small` : "") +
      (map?.left_out ? `; ${map.left_out} voxels lie too far away to be drawn` : "")],
    ["path of this plan", "the path that the robot took until its next plan"],
  ]) terms.append(element("dt", "", term), element("dd", "", meaning));
  card.append(terms);
}

/** Everything below the curves. */
export function showTables(parent, run, timeline) {
  if (run.report.warnings.length > 0) {
    const card = section(parent, "Warnings");
    for (const warning of run.report.warnings) card.append(element("p", "warn", warning));
  }
  showDecisions(parent, run, timeline);
  showLeft(parent, run);
  showTimings(parent, run);
  showHealth(parent, run);
  showScenario(parent, run);
  showTerms(parent, run);
}
