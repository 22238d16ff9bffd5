// What a person does to the run: the dock of commands, clicks on the map and boxes to keep out of.
import { DONE, PAUSED } from "./enums.js";
import { toast } from "./toasts.js";

const $ = (id) => document.getElementById(id);
const CLEAR = 0.5; // [m] between a wall or ceiling and the place proposed before it
const text = ({ x, y, z }) => [x, y, z].map((c) => c.toFixed(2)).join(", ");
const xyz = ({ x, y, z }) => ({ x, y, z });

export class Steering {
  #connection;
  #scene;
  #status = null;
  #goal = null; // { point to look at, goal to go to, foot }
  #allowed = false;
  #boxes = [];

  /**
   * @param replay     Timeline, which pauses instead of the robot while something is replayed
   * @param robot      () => position of the robot, or null
   * @param frontier   () => the selected frontier, or null
   * @param deselect   forgets it
   * @param strategies [{ name, summary }] to choose from
   */
  constructor(connection, scene, keys, { replay, robot, frontier, deselect, strategies }) {
    this.#connection = connection;
    this.#scene = scene;
    this.replay = replay;
    this.robot = robot;
    this.frontier = frontier;
    this.deselect = deselect;
    this.#makeMenu(strategies);
    this.#claim(keys);
    const clicks = { "do-pause": () => this.pauseOrResume(), "do-step": () => this.send("step"), "do-home": () => this.ask("home"),
      "do-stop": () => this.ask("stop"), "do-box": () => this.toggleDrawing(), "do-save": () => this.send("save_map"),
      "goal-go": () => this.goThere(), "goal-look": () => this.lookThere(), "goal-close": () => this.forget(),
      "why-go": () => this.goThere(), "why-ignore": () => this.ignore(), "box-send": () => this.sendBox(),
      "box-cancel": () => this.toggleDrawing(false), "clear-boxes": () => this.send("clear_no_go") };
    for (const [id, act] of Object.entries(clicks)) $(id).onclick = act;
    $("goal-height").oninput = () => this.#setHeight(Number($("goal-height").value));
    $("box-low").oninput = $("box-high").oninput = () => this.#boxFromFields();
    $("strategy").onchange = () => this.send("strategy", { strategy: $("strategy").value }).then(() => this.#showStrategy());
    for (const name of ["home", "stop"]) {
      const dialog = $(`${name}-dialog`);
      dialog.onclose = () => {
        if (dialog.returnValue === name) this.send(name);
        dialog.returnValue = "";
      };
    }
    this.allow(false);
  }

  #claim(keys) {
    const group = "Steering";
    const claim = (key, line, act) => keys.claim(key, { group, text: line, act: () => this.#allowed && act() });
    keys.claim(" ", { group, text: "Pause, resume: the robot, or the replay",
      act: () => (this.replay.present ? this.replay.toggle() : this.#allowed && this.pauseOrResume()) });
    claim(".", "One decision, then pause", () => this.send("step"));
    claim("h", "Go home and end there", () => this.ask("home"));
    claim("x", "End the exploration here", () => this.ask("stop"));
    claim("g", "Go to what was clicked", () => this.goThere());
    claim("l", "Look at what was clicked", () => this.lookThere());
    claim("i", "Ignore the chosen frontier", () => this.ignore());
    claim("b", "Draw a no-go box", () => this.toggleDrawing());
    claim("Enter", "Put the drawn box in force", () => this.sendBox());
    claim("s", "Save the map", () => this.send("save_map"));
  }

  #makeMenu(strategies) {
    for (const { name, summary } of strategies) {
      const option = document.createElement("option");
      option.value = option.textContent = name;
      option.title = summary;
      $("strategy").append(option);
    }
  }

  /** Shows the controls, if there is a robot to steer and this page may. */
  allow(allowed) {
    this.#allowed = allowed;
    $("dock").hidden = !allowed;
    for (const each of document.querySelectorAll("[data-steers]")) each.hidden = !allowed;
    if (!allowed) this.forget();
  }

  /** Sends a command and shows its answer. */
  async send(name, request = {}) {
    const { accepted, service, reason } = await this.#connection.call(`/operator/${name}`, request);
    toast(reason || (accepted ? "done" : "no reason given"), accepted ? "good" : "warn", accepted ? service : `${service} refuses`);
    return accepted;
  }

  pauseOrResume() {
    return this.send(this.#status?.state === PAUSED ? "resume" : "pause");
  }
  /** Asks before the exploration is ended, by home or stop. */
  ask(name) {
    const dialog = $(`${name}-dialog`);
    if (!dialog.open) dialog.showModal();
  }

  // ---- Places

  /** A click on the map: proposes to go before the place, or to look at it. */
  point({ point, normal, at }) {
    const goal = point.clone();
    const height = this.robot()?.z ?? 1.2;
    if (normal.z > 0.5) goal.z = Math.max(height, point.z + CLEAR);
    else goal.addScaledVector(normal, CLEAR);
    this.#goal = { point, goal };
    $("goal-height").value = goal.z.toFixed(2);
    const card = $("goal-card");
    card.hidden = false;
    const { offsetWidth: width, offsetHeight: tall } = card;
    // Between the bar and the dock, and clear of the panels, which are on the right, or below on a phone.
    const panels = document.querySelector(".side").getBoundingClientRect();
    const areBelow = panels.left < innerWidth / 2;
    const right = areBelow ? innerWidth - 12 : panels.left - 15;
    const bottom = document.getElementById("dock").getBoundingClientRect().top - 12;
    card.style.left = `${Math.max(Math.min(at[0] + 18, right - width), 12)}px`;
    card.style.top = `${Math.max(Math.min(at[1] - tall / 2, bottom - tall), 70)}px`;
    this.#showGoal();
  }
  #setHeight(z) {
    if (!this.#goal || !Number.isFinite(z)) return;
    this.#goal.goal.z = z;
    this.#showGoal();
  }
  #showGoal() {
    const { goal, point } = this.#goal;
    $("goal-place").textContent = `${goal.x.toFixed(2)}, ${goal.y.toFixed(2)}`;
    this.#scene.setTarget(goal, point);
  }

  goThere() {
    // A frontier's center is not known to be free; looking at it leads to the nearest place that sees it.
    const frontier = this.frontier();
    if (frontier) return this.send("look_at", { point: xyz(frontier.center) });
    if (!this.#goal) return toast("click a place on the map first", "", "Go there");
    const { goal } = this.#goal;
    this.forget();
    return this.send("goto", { point: xyz(goal) });
  }
  lookThere() {
    const frontier = this.frontier();
    if (frontier) return this.send("look_at", { point: xyz(frontier.center) });
    if (!this.#goal) return toast("click a place on the map first", "", "Look there");
    const { point } = this.#goal;
    this.forget();
    return this.send("look_at", { point: xyz(point) });
  }
  async ignore() {
    const frontier = this.frontier();
    if (!frontier) return toast("click a frontier first", "", "Ignore");
    if (await this.send("ignore", { point: xyz(frontier.center) })) this.deselect();
  }

  /** Forgets the clicked place and the drawn box. */
  forget() {
    this.#goal = null;
    $("goal-card").hidden = true;
    this.#scene.setTarget(null);
    if (this.#scene.drawing) this.toggleDrawing(false);
  }

  // ---- Boxes

  toggleDrawing(on = !this.#scene.drawing) {
    if (on) this.forget();
    this.#scene.setDrawing(on);
    this.#scene.setDraft(null);
    $("do-box").classList.toggle("on", on);
    $("box-card").hidden = !on;
    this.drawn(null);
  }
  /** The box while it is drawn. */
  drawn(box) {
    this.#scene.setDraft(box);
    $("box-hint").hidden = box !== null;
    $("box-fields").hidden = box === null;
    if (!box) return;
    $("box-size").textContent = `${(box.max.x - box.min.x).toFixed(1)} × ${(box.max.y - box.min.y).toFixed(1)} m`;
    $("box-low").value = box.min.z.toFixed(2);
    $("box-high").value = box.max.z.toFixed(2);
  }
  #boxFromFields() {
    const { box } = this.#scene.boxes;
    const [low, high] = [Number($("box-low").value), Number($("box-high").value)];
    if (!box || !(low < high)) return;
    this.#scene.setDraft({ min: { ...box.min, z: low }, max: { ...box.max, z: high } });
  }
  async sendBox() {
    const { box } = this.#scene.boxes;
    if (!box) return;
    if (await this.send("no_go", { point: xyz(box.min), corner: xyz(box.max) })) this.toggleDrawing(false);
  }

  #showBoxes(boxes) {
    this.#boxes = boxes;
    this.#scene.setNoGo(boxes);
    $("boxes-card").hidden = boxes.length === 0;
    $("boxes").replaceChildren(...boxes.map(({ min, max, fixed }) => {
      const row = document.createElement("div");
      row.className = "row box number";
      row.append(document.createElement("i"), `${text(min)} to ${text(max)}${fixed ? " · scenario" : ""}`);
      return row;
    }));
  }

  // ---- The state of the run

  /** @param boxes those of the scenario */
  setFixedBoxes(boxes) {
    this.fixed = boxes.map((box) => ({ ...box, fixed: true }));
    this.#showBoxes([...this.fixed, ...this.#boxes.filter(({ fixed }) => !fixed)]);
  }

  /** @param status thalweg_msgs/msg/ExplorationStatus */
  update(status) {
    const drawn = JSON.stringify(status.no_go);
    if (drawn !== this.drawnBoxes) this.#showBoxes([...(this.fixed ?? []), ...status.no_go]);
    this.drawnBoxes = drawn;
    this.#status = status;
    const paused = status.state === PAUSED, done = status.state === DONE;
    $("do-pause").classList.toggle("paused", paused);
    $("do-pause").querySelector("span").textContent = paused ? "Resume" : "Pause";
    for (const id of ["do-pause", "do-step", "do-home", "do-stop", "do-box", "strategy"]) $(id).disabled = done;
    this.#showStrategy();
  }
  #showStrategy() {
    const name = this.#status?.strategy;
    if (!name || document.activeElement === $("strategy")) return;
    if (![...$("strategy").options].some(({ value }) => value === name)) this.#makeMenu([{ name, summary: "of the explorer that runs" }]);
    $("strategy").value = name;
  }
}
