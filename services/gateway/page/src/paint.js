// The color of the map: by height, or as it was measured, which is subscribed to only while it is shown.
const $ = (id) => document.getElementById(id);
const WITHIN = 6000; // [ms] The mapper publishes the colors every 3 s, once somebody listens.

export class Paint {
  #missing; // the timer that reports that none come

  constructor(connection, topic, scene) {
    Object.assign(this, { connection, topic, scene });
    for (const button of document.querySelectorAll("[data-paint]")) button.onclick = () => this.by(button.dataset.paint);
  }

  get byColor() {
    return this.scene.map.uniforms.byColor.value;
  }

  /** @param what "height" or "color" */
  by(what) {
    const byColor = what === "color";
    for (const button of document.querySelectorAll("[data-paint]")) {
      button.classList.toggle("on", button.dataset.paint === what);
      button.setAttribute("aria-checked", button.dataset.paint === what);
    }
    this.scene.map.paintByColor(byColor);
    this.scene.changed();
    $("legend-heights").hidden = byColor;
    $("no-colors").hidden = true;
    clearTimeout(this.#missing);
    if (!byColor) return this.connection.unsubscribe(this.topic);
    this.#missing = setTimeout(() => ($("no-colors").hidden = false), WITHIN);
    this.connection.subscribe(this.topic, (message) => {
      clearTimeout(this.#missing);
      $("no-colors").hidden = true;
      this.scene.map.setColors(message);
      this.scene.changed();
    });
  }
}
