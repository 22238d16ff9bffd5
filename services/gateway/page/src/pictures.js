// The panel of camera images. They are large, so that they are read only while it is shown, and of one source: the first that
// has any, until another one is chosen.
import { paintPicture } from "./images.js";

const $ = (id) => document.getElementById(id);
const WITHIN = 2000; // [ms]
const SOURCE = { depth: "a robot with depth_source: DEPTH_IMAGE publishes it" };
const STEREO_SOURCE = "a simulated run has cameras with depth_source: STEREO, as in kitchen_stereo";

function showScale(scale) {
  $("picture-scale").hidden = scale === null;
  if (scale === null) return;
  const number = (value) => `${value.toFixed(scale.unit === "m" ? 1 : 0)} ${scale.unit}`;
  $("scale-low").textContent = number(scale.low);
  $("scale-high").textContent = number(scale.high);
}

export class Pictures {
  #source = null; // name of the topic; null = whichever has images
  #missing; // the timer that reports that none come

  /** @param topics name of a button -> topic */
  constructor(connection, topics) {
    Object.assign(this, { connection, topics });
    for (const button of document.querySelectorAll("[data-picture]")) {
      button.onclick = () => {
        this.#source = button.dataset.picture;
        this.show(true);
      };
    }
  }

  show(on) {
    clearTimeout(this.#missing);
    $("pictures").hidden = !on;
    this.#listenTo([]);
    if (!on) return;
    this.#say("no image yet");
    this.#listenTo(this.#source ? [this.#source] : Object.keys(this.topics));
    this.#missing = setTimeout(() => this.#sayMissing(), WITHIN);
  }

  #listenTo(names) {
    for (const [name, topic] of Object.entries(this.topics)) {
      if (names.includes(name)) this.connection.subscribe(topic, (message) => this.#paint(name, message));
      else this.connection.unsubscribe(topic);
    }
    const chosen = this.#source ?? (names.length === 1 ? names[0] : null);
    for (const button of document.querySelectorAll("[data-picture]")) button.classList.toggle("on", button.dataset.picture === chosen);
  }

  /** One line, in the place of the picture. */
  #say(text, title = "") {
    $("pictures").classList.add("waits");
    $("picture-info").textContent = text;
    $("picture-info").title = title;
    showScale(null);
  }
  #sayMissing() {
    const topics = this.#source ? this.topics[this.#source] : Object.values(this.topics).join(", ");
    const why = SOURCE[this.#source] ?? (this.#source ? STEREO_SOURCE : `${STEREO_SOURCE}; ${SOURCE.depth}`);
    this.#say(this.#source ? "no image arrives" : "no images in this run", `None has come on ${topics}: ${why}.`);
  }

  #paint(name, message) {
    clearTimeout(this.#missing);
    if (!this.#source) this.#listenTo([name]);
    $("pictures").classList.remove("waits");
    const { text, scale } = paintPicture($("picture"), message);
    $("picture-info").textContent = text;
    $("picture-info").title = "";
    showScale(scale ?? null);
  }
}
