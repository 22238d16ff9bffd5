// Every key of the page, in one table: no part of the page can take a key that another has.

const NAMES = { " ": "Space", Escape: "Esc", Enter: "Enter", ArrowUp: "↑", ArrowDown: "↓", ArrowLeft: "←", ArrowRight: "→", PageUp: "Page ↑",
  PageDown: "Page ↓", Home: "Home", "-": "−" };

const MOVES_SLIDER = new Set(["ArrowUp", "ArrowDown", "ArrowLeft", "ArrowRight", "PageUp", "PageDown", "Home", "End"]);
const PRESSES_BUTTON = new Set([" ", "Enter"]);

/** Whether the element in focus acts on the key itself. */
function isOfElement({ key, target: { tagName, type } }) {
  if (tagName === "BUTTON") return PRESSES_BUTTON.has(key);
  if (tagName === "INPUT" && type === "range") return MOVES_SLIDER.has(key);
  return (tagName === "INPUT" || tagName === "SELECT") && key !== "Escape";
}

export class Keys {
  #table = new Map(); // key -> { group, text, act, held }
  #held = new Set();

  /**
   * @param key   as KeyboardEvent.key gives it, letters in lower case
   * @param entry { group, text for the help, act() when pressed } or, for a key that is held, without act; dialog: id of the
   *              dialog, if it acts in one as well
   * Throws if the key is taken.
   */
  claim(key, entry) {
    const before = this.#table.get(key);
    if (before) throw new Error(`key "${key}" is claimed twice: for "${before.text}" and for "${entry.text}"`);
    this.#table.set(key, entry);
  }

  /** Whether a key without an action of its own is down. */
  isDown(key) {
    return this.#held.has(key);
  }
  get anyDown() {
    return this.#held.size > 0;
  }

  /** Returns whether the key is one of the table's. */
  press(key) {
    const entry = this.#table.get(key);
    if (!entry) return false;
    if (entry.act) entry.act();
    else this.#held.add(key);
    return true;
  }
  release(key) {
    this.#held.delete(key);
  }
  releaseAll() {
    this.#held.clear();
  }

  /** [group, [[names of the keys, text]]] in the order of the claims; keys of the same text share a line. */
  help() {
    const groups = new Map();
    for (const [key, { group, text }] of this.#table) {
      if (!groups.has(group)) groups.set(group, new Map());
      const lines = groups.get(group);
      lines.set(text, [...(lines.get(text) ?? []), NAMES[key] ?? key.toUpperCase()]);
    }
    return [...groups].map(([group, lines]) => [group, [...lines].map(([text, names]) => [names, text])]);
  }

  /**
   * Takes the keys of a window, except those that the element in focus needs itself.
   * @param openDialog () => id of the dialog that is open, or null. An open dialog has all keys but those claimed with its id.
   */
  listen(target, openDialog = () => null) {
    const keyOf = ({ key }) => (key.length === 1 ? key.toLowerCase() : key);
    target.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey || isOfElement(event)) return;
      const entry = this.#table.get(keyOf(event));
      const dialog = openDialog();
      if (dialog !== null && entry?.dialog !== dialog) return;
      if (event.repeat && entry?.act && !entry.repeats) return;
      if (this.press(keyOf(event))) event.preventDefault();
    });
    target.addEventListener("keyup", (event) => this.release(keyOf(event)));
    target.addEventListener("blur", () => this.releaseAll());
  }
}
