// The switches of what the view shows.
import { RAMP_CSS } from "./ramp.js";
import { toast } from "./toasts.js";

const $ = (id) => document.getElementById(id);
const LAYERS = {
  map: { title: "Map", key: "m", color: RAMP_CSS },
  surface: { title: "Surface", key: "y", color: "linear-gradient(90deg, #c9a27b, #8fa9b8)", off: true },
  flown: { title: "Path flown", key: "p", color: "var(--text)" },
  ahead: { title: "Path ahead", key: "a", color: "var(--accent)" },
  frontiers: { title: "Frontiers", key: "f", color: "var(--warn)" },
  unknown: { title: "Border to unknown", key: "u", color: "#b07cff", off: true },
  field: { title: "Field", key: "d", color: "linear-gradient(90deg, #2b3a8f, #f0764a)", off: true,
    help: "Field; in green, sealed dead ends" },
  noGo: { title: "No-go boxes", key: "n", color: "#ff5c6c" },
  pictures: { title: "Camera", key: "c", color: "var(--good)", off: true },
};

export class Layers {
  #buttons = {};
  shown = {}; // name -> whether it is on

  /** @param apply (name, on), called for every change */
  constructor(keys, apply) {
    this.apply = apply;
    for (const [name, { title, key, color, help }] of Object.entries(LAYERS)) {
      const button = (this.#buttons[name] = document.createElement("button"));
      button.innerHTML = "<i></i><span></span><small></small>";
      button.querySelector("span").textContent = title;
      button.style.setProperty("--swatch", color);
      button.title = `${title} (${key.toUpperCase()})`;
      button.onclick = () => this.set(name, !this.shown[name]);
      $("layers").append(button);
      keys.claim(key, { group: "Layers", text: help ?? title, act: () => this.#press(name) });
    }
  }

  /** Sets all to what they are at the beginning. */
  reset() {
    for (const [name, { off }] of Object.entries(LAYERS)) this.set(name, !off);
  }

  set(name, on) {
    const button = this.#buttons[name];
    this.shown[name] = on;
    button.classList.toggle("on", on);
    button.setAttribute("aria-pressed", on);
    this.#disable(button);
    this.apply(name, on);
  }

  /** Takes a switch away, while nothing can be said of its layer, or brings it back. */
  hide(name, hidden) {
    this.#buttons[name].hidden = hidden;
  }

  /** Says in a word, and in a sentence, why a layer has nothing to show: it cannot be turned on then. "" if it can. */
  excuse(name, word, why) {
    const button = this.#buttons[name], { title, key } = LAYERS[name];
    button.querySelector("small").textContent = word;
    button.title = why ? `${title} (${key.toUpperCase()}): ${why}` : `${title} (${key.toUpperCase()})`;
    button.dataset.why = why;
    this.#disable(button);
  }
  #disable(button) {
    button.disabled = Boolean(button.dataset.why) && button.getAttribute("aria-pressed") !== "true";
  }

  #press(name) {
    const button = this.#buttons[name];
    if (button.hidden) toast("this run has none: thalweg run --surface", "", LAYERS[name].title);
    else if (button.disabled) toast(button.dataset.why, "", LAYERS[name].title);
    else this.set(name, !this.shown[name]);
  }
}
