import assert from "node:assert/strict";
import { test } from "node:test";
import { Keys } from "../../../../../services/gateway/page/src/keys.js";

test("A key that is claimed twice is refused by the names of both claims", () => {
  const keys = new Keys();
  keys.claim("m", { group: "Layers", text: "Map", act: () => {} });
  assert.throws(() => keys.claim("m", { group: "View", text: "Move" }), /"m" is claimed twice: for "Map" and for "Move"/);
});

test("A press acts, and says whether the key is known", () => {
  const keys = new Keys();
  let pressed = 0;
  keys.claim(" ", { group: "Steering", text: "Pause", act: () => ++pressed });
  assert.equal(keys.press(" "), true);
  assert.equal(keys.press("q"), false);
  assert.equal(pressed, 1);
});

test("A key without an action is down from its press to its release", () => {
  const keys = new Keys();
  keys.claim("ArrowUp", { group: "Flying", text: "Forward" });
  keys.press("ArrowUp");
  assert.equal(keys.isDown("ArrowUp"), true);
  keys.release("ArrowUp");
  assert.equal(keys.anyDown, false);
});

test("The help names every key once, keys of one text in one line", () => {
  const keys = new Keys();
  for (const key of ["ArrowLeft", "ArrowRight"]) keys.claim(key, { group: "Flying", text: "Left, right" });
  keys.claim("?", { group: "Page", text: "This help", act: () => {} });
  assert.deepEqual(keys.help(), [["Flying", [[["←", "→"], "Left, right"]]], ["Page", [[["?"], "This help"]]]]);
});

/** The keys, in order, that acted when they were pressed: [key, tagName, type of the input] each. */
function pressedOf(presses, openDialog) {
  const keys = new Keys();
  const pressed = [];
  for (const key of ["s", "Escape", " ", "Enter"]) keys.claim(key, { group: "Page", text: key, act: () => pressed.push(key) });
  keys.claim("?", { group: "Page", text: "Help", act: () => pressed.push("?"), dialog: "help" });
  keys.claim("ArrowUp", { group: "Flying", text: "Forward" });
  const target = new EventTarget();
  keys.listen(target, openDialog);
  for (const [key, tagName, type] of presses) {
    const event = new Event("keydown", { cancelable: true });
    Object.defineProperty(event, "target", { value: { tagName, type } });
    target.dispatchEvent(Object.assign(event, { key }));
    if (keys.isDown("ArrowUp")) pressed.push("ArrowUp");
    keys.releaseAll();
    assert.equal(event.defaultPrevented, pressed.at(-1) === (key.length === 1 ? key.toLowerCase() : key), `${key} on ${tagName}`);
  }
  return pressed;
}

test("What is typed into a field is no key, but Escape is", () => {
  assert.deepEqual(pressedOf([["s", "INPUT", "text"], ["S", "BODY"], [" ", "SELECT"], ["Escape", "INPUT", "text"]]), ["s", "Escape"]);
});

test("A button in focus is pressed by Space and Enter, and leaves the other keys", () => {
  assert.deepEqual(pressedOf([[" ", "BUTTON"], ["Enter", "BUTTON"], ["s", "BUTTON"], [" ", "CANVAS"]]), ["s", " "]);
});

test("A slider in focus is moved by the arrow keys, and leaves the other keys", () => {
  assert.deepEqual(pressedOf([["ArrowUp", "INPUT", "range"], [" ", "INPUT", "range"], ["ArrowUp", "CANVAS"]]), [" ", "ArrowUp"]);
});

test("An open dialog has all keys but its own", () => {
  const keys = [[" ", "BODY"], ["Enter", "BODY"], ["Escape", "BODY"], ["ArrowUp", "BODY"], ["?", "BODY"]];
  assert.deepEqual(pressedOf(keys, () => "stop-dialog"), []);
  assert.deepEqual(pressedOf(keys, () => "help"), ["?"]);
});
