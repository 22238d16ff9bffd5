// On a phone held upright the panels are one drawer, below the map and the commands: its handle pulls it up.
const $ = (id) => document.getElementById(id);
const IN_DRAWER = ["pictures", "layers", "cut-card", "slice", "legend"]; // beside the panels; in this order, before them
const EDGE = 16; // [px] beside a panel, where something would be half hidden

export class Drawer {
  #phone = matchMedia("(max-width: 560px)"); // as in style.css
  #homes = new Map(); // element -> what marks its place on a larger screen

  /** @param onChange called when the drawer covers more or less of the view */
  constructor(onChange) {
    this.onChange = onChange;
    for (const id of IN_DRAWER) {
      const home = document.createComment(id);
      $(id).before(home);
      this.#homes.set($(id), home);
    }
    $("drawer-handle").onclick = () => this.open(!this.isOpen);
    this.#phone.onchange = () => {
      this.#move();
      this.open(false);
    };
    this.#move();
  }

  get isOpen() {
    return document.documentElement.classList.contains("drawer-open");
  }
  open(on) {
    document.documentElement.classList.toggle("drawer-open", on);
    $("drawer-handle").setAttribute("aria-expanded", on);
    this.onChange();
  }
  /** Brings a panel into view, if the panels are in the drawer. */
  show(panel) {
    if (!this.#phone.matches) return;
    this.open(true);
    panel.scrollIntoView({ block: "nearest" });
  }

  /** What the panels hide of the view [px]. */
  covered() {
    if (!this.#phone.matches) return { right: innerWidth > 900 ? 330 : 0, bottom: 0 };
    return { right: 0, bottom: innerHeight - document.querySelector(".side").getBoundingClientRect().top };
  }

  /** The part of the view that no panel hides, in which something can be shown { left, top, right, bottom } [px]. */
  clear() {
    const box = (selector) => document.querySelector(selector).getBoundingClientRect();
    const { right, bottom } = this.covered();
    const below = ["#dock", "#timeline", "#legend"].map(box).filter(({ height }) => height > 0).map(({ top }) => top);
    return {
      left: (this.#phone.matches ? 0 : box("#layers").right) + EDGE,
      top: box("header").bottom + EDGE,
      right: innerWidth - right - EDGE,
      bottom: Math.min(innerHeight - bottom, ...below) - EDGE,
    };
  }

  #move() {
    for (const [element, home] of [...this.#homes].reverse()) {
      if (this.#phone.matches) $("drawer-handle").after(element);
      else home.after(element);
    }
  }
}
