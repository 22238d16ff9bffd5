import assert from "node:assert/strict";
import { test } from "node:test";
import { FieldFeed } from "../../../../../services/gateway/page/src/field_feed.js";

const TOPICS = { field: "/field", sealed: "/sealed", streamline: "/streamline" };
/** A feed, the topics it reads, and what it says. */
function makeFeed() {
  const handlers = new Map(), said = [];
  const subscribe = (topic, handler) => handlers.set(topic, handler), unsubscribe = (topic) => handlers.delete(topic);
  const feed = new FieldFeed({ subscribe, unsubscribe }, TOPICS, {
    onField: ({ name }) => said.push(name), onSealed: ({ name }) => said.push(name),
    onStreamline: () => said.push("streamline"), onForgotten: () => said.push("forgotten"),
    onKnown: (isThere, strategy) => said.push(`${strategy}: ${isThere}`),
  });
  const send = (name, sec) => handlers.get("/field")({ name, header: { stamp: { sec, nanosec: 0 } } });
  return { feed, handlers, said, send, reads: () => [...handlers.keys()] };
}

test("A field is read until one has come, then only while it is shown", () => {
  const { feed, said, send, reads } = makeFeed();
  feed.follow("potential");
  assert.deepEqual(said, ["forgotten", "potential: false"]);
  assert.deepEqual(reads(), ["/field"]);
  send("first", 1);
  assert.deepEqual(said.slice(2), ["potential: true"]);
  assert.deepEqual(reads(), []);
  feed.show(true);
  assert.deepEqual(reads().sort(), ["/field", "/sealed", "/streamline"]);
  send("second", 2);
  assert.deepEqual(said.slice(3), ["first", "second"]);
  feed.show(false);
  assert.deepEqual(reads(), []);
});

test("What is sealed is read only while the field is shown, whether or not there is one", () => {
  for (const isThere of [false, true]) {
    const { feed, handlers, said, send, reads } = makeFeed();
    feed.follow("potential");
    if (isThere) send("field", 1);
    assert.ok(!reads().includes("/sealed"));
    feed.show(true);
    said.length = 0;
    handlers.get("/sealed")({ name: "dead ends" });
    assert.deepEqual(said, ["dead ends"]);
    feed.show(false);
    assert.ok(!reads().includes("/sealed"));
  }
});

test("What another strategy has sealed is forgotten with its field, and what the next one seals is read", () => {
  const { feed, handlers, said, send, reads } = makeFeed();
  feed.follow("potential");
  feed.show(true);
  send("field", 1);
  handlers.get("/sealed")({ name: "dead ends" });
  said.length = 0;
  feed.follow("cover");
  assert.deepEqual(said, ["forgotten", "cover: false"]);
  assert.deepEqual(reads().sort(), ["/field", "/sealed", "/streamline"]);
  handlers.get("/sealed")({ name: "others" });
  assert.deepEqual(said.slice(2), ["others"]);
});

test("What is at hand is shown at once, unless the robot has decided since", () => {
  for (const [decision, shown] of [[5, ["field"]], [6, []]]) {
    const { feed, said, send } = makeFeed();
    feed.follow("potential");
    send("field", 5);
    feed.decided(decision);
    said.length = 0;
    feed.show(true);
    assert.deepEqual(said, shown);
  }
});

test("What was sealed off from the field at hand is shown with it, but not what another strategy has sealed", () => {
  const { feed, handlers, said, send } = makeFeed();
  feed.follow("potential");
  feed.show(true);
  send("field", 5);
  handlers.get("/sealed")({ name: "dead ends" });
  feed.show(false);
  said.length = 0;
  feed.show(true);
  assert.deepEqual(said, ["field", "dead ends"]);
  feed.follow("potential_flux");
  send("its field", 6);
  feed.show(false);
  said.length = 0;
  feed.show(true);
  assert.deepEqual(said, ["its field"]);
});

test("Of another strategy it is not known whether it has a field; the one before is forgotten", () => {
  const { feed, said, send, reads } = makeFeed();
  feed.follow("potential");
  send("field", 5);
  said.length = 0;
  feed.follow("potential");
  assert.deepEqual(said, []);
  feed.follow("cover");
  assert.deepEqual(said, ["forgotten", "cover: false"]);
  assert.deepEqual(reads(), ["/field"]);
  feed.show(true);
  assert.deepEqual(said.slice(2), [], "a field of another strategy is shown");
});

test("Before a strategy is known there is no field either", () => {
  const { feed, said } = makeFeed();
  feed.follow(null);
  feed.follow(null);
  assert.deepEqual(said, ["forgotten", "null: false"]);
});
