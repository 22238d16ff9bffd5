import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { Connection } from "../../../../../services/gateway/page/src/connection.js";

/** Sockets of a gateway that the test plays. */
class FakeSocket {
  static OPEN = 1;
  static all = [];
  readyState = 0;
  sent = [];
  constructor(url, protocols) {
    Object.assign(this, { url, protocols });
    FakeSocket.all.push(this);
  }
  static get last() {
    return FakeSocket.all.at(-1);
  }
  send(data) {
    this.sent.push(typeof data === "string" ? JSON.parse(data) : data);
  }
  close() {
    this.readyState = 2; // closing, for as long as the other side does not answer
  }

  open(session = "a") {
    this.readyState = 1;
    this.onopen();
    this.text({ op: "serverInfo", sessionId: session, capabilities: ["services"] });
    this.text({ op: "advertise", channels: [{ id: 7, topic: "/health", schema: "uint8 value" }, { id: 8, topic: "/odd", schema: "bad" }] });
    this.text({ op: "advertiseServices", services: [{ id: 4, name: "/operator/pause" }] });
  }
  text(message) {
    this.onmessage?.({ data: JSON.stringify(message) });
  }
  message(subscription, ...payload) {
    const frame = new DataView(new ArrayBuffer(13 + payload.length));
    frame.setUint8(0, 1);
    frame.setUint32(1, subscription, true);
    frame.setBigUint64(5, 1_500_000_000n, true);
    payload.forEach((byte, n) => frame.setUint8(13 + n, byte));
    this.onmessage?.({ data: frame.buffer });
  }
  end(reason = "") {
    this.readyState = 3;
    this.onclose?.({ reason });
  }
  subscriptions() {
    return this.sent.filter(({ op }) => op === "subscribe").flatMap(({ subscriptions }) => subscriptions);
  }
}

/** The page's timers, which the test moves on. */
const timers = {
  now: 0,
  all: [],
  /** @param ms to pass */
  pass(ms) {
    const end = this.now + ms;
    for (;;) {
      const next = this.all.filter(({ at }) => at <= end).sort((a, b) => a.at - b.at)[0];
      if (!next) break;
      this.now = next.at;
      if (next.every) next.at += next.every;
      else this.all.splice(this.all.indexOf(next), 1);
      next.act();
    }
    this.now = end;
  },
};
globalThis.setTimeout = (act, ms) => timers.all.push({ at: timers.now + ms, act });
globalThis.setInterval = (act, ms) => timers.all.push({ at: timers.now + ms, every: ms, act });
globalThis.WebSocket = FakeSocket;
const warnings = [];
console.warn = (text) => warnings.push(text);

/** Reads one octet; 0 cannot be read. */
function readerOf(schema) {
  if (schema === "bad") throw new Error("no such type");
  return {
    readMessage: ([value]) => {
      if (value === 0) throw new Error("too short");
      return { value };
    },
  };
}
let events, links, resets, refusal;
const settled = () => new Promise((resolve) => setImmediate(resolve));
function connect() {
  links = [];
  resets = 0;
  events = { onLink: (...link) => links.push(link.join(": ")), onReset: () => ++resets, onTime() {}, onParameters() {}, onSteering() {} };
  return new Connection("ws://robot", events, readerOf, async () => refusal);
}
const pass = (seconds) => timers.pass(1000 * seconds);

beforeEach(() => {
  Object.assign(timers, { now: 0, all: [] });
  warnings.length = 0;
  refusal = "";
  FakeSocket.all = [];
});

test("a handler gets its topic's messages with their time, and none after it has left", () => {
  const connection = connect(), heard = [];
  connection.subscribe("/health", ({ value }, time) => heard.push([value, time]));
  FakeSocket.last.open();
  assert.deepEqual(FakeSocket.last.subscriptions(), [{ id: 1, channelId: 7 }]);
  FakeSocket.last.message(1, 5);
  FakeSocket.last.message(99, 6); // of no subscription
  assert.deepEqual(heard, [[5, 1.5]]);
  connection.unsubscribe("/health");
  assert.deepEqual(FakeSocket.last.sent.at(-1), { op: "unsubscribe", subscriptionIds: [1] });
  FakeSocket.last.message(1, 5);
  assert.equal(heard.length, 1);
});

test("a message or schema that cannot be read is reported once and stops nothing", () => {
  const connection = connect(), heard = [];
  connection.subscribe("/odd", () => heard.push("odd"));
  connection.subscribe("/health", ({ value }) => heard.push(value));
  FakeSocket.last.open();
  for (const value of [0, 0, 3]) FakeSocket.last.message(1, value);
  assert.deepEqual(heard, [3]);
  assert.deepEqual(warnings,
    ["/odd: its schema cannot be read: no such type", "/health: a message cannot be read: too short"]);
});

test("a lost connection is opened again, more and more slowly, and its subscriptions are made again", async () => {
  const connection = connect();
  connection.subscribe("/health", () => {});
  FakeSocket.last.open();
  FakeSocket.last.end();
  await settled();
  assert.deepEqual(links, ["live: live", "lost: gateway is away"]);
  timers.pass(500);
  FakeSocket.last.end("too many clients");
  await settled();
  timers.pass(799);
  assert.equal(FakeSocket.all.length, 2);
  timers.pass(1);
  assert.equal(FakeSocket.all.length, 3);
  FakeSocket.last.open();
  assert.deepEqual(links.slice(2), ["lost: too many clients", "live: live"]);
  assert.equal(FakeSocket.last.subscriptions().length, 1);
  assert.equal(resets, 0); // by the same gateway
});

test("a page that is let in nowhere says why, and goes on trying", async () => {
  connect();
  refusal = "the token is wrong";
  FakeSocket.last.end();
  await settled();
  assert.deepEqual(links, ["refused: the token is wrong"]);
  timers.pass(500);
  assert.equal(FakeSocket.all.length, 2);
  refusal = "";
  FakeSocket.last.open();
  refusal = "asked only where no socket opened";
  FakeSocket.last.end();
  await settled();
  assert.deepEqual(links.slice(1), ["live: live", "lost: gateway is away"]);
});

test("another gateway's session begins from nothing", async () => {
  connect();
  FakeSocket.last.open("a");
  FakeSocket.last.end();
  await settled();
  timers.pass(500);
  FakeSocket.last.open("b");
  assert.equal(resets, 1);
});

test("a call is answered by the gateway, or by the loss of the connection", async () => {
  const connection = connect();
  FakeSocket.last.open();
  const answered = connection.call("/operator/pause", { a: 1 }), lost = connection.call("/operator/pause");
  const frame = new DataView(FakeSocket.last.sent.at(-2));
  assert.deepEqual([frame.getUint8(0), frame.getUint32(1, true), frame.getUint32(5, true)], [2, 4, 1]);
  assert.equal(new TextDecoder().decode(new Uint8Array(frame.buffer, 13)), 'json{"a":1}');
  const body = new TextEncoder().encode('json{"accepted":true}'), answer = new Uint8Array(13 + body.length);
  answer.set(body, 13);
  const view = new DataView(answer.buffer);
  view.setUint8(0, 3);
  view.setUint32(5, 1, true);
  view.setUint32(9, 4, true);
  FakeSocket.last.onmessage({ data: answer.buffer });
  assert.deepEqual(await answered, { accepted: true });
  FakeSocket.last.end();
  await settled();
  assert.deepEqual(await lost, { accepted: false, service: "page", reason: "the connection was lost" });
  assert.equal((await connection.call("/operator/pause")).reason, "the gateway is away");
});

test("a page that may only look is refused here", async () => {
  const connection = connect();
  FakeSocket.last.open();
  assert.equal((await connection.call("/operator/other")).reason, "this page may only look");
});

test("a network that breaks without a word is reported, and what comes late brings the link back", () => {
  const connection = connect(), heard = [];
  connection.subscribe("/health", ({ value }) => heard.push(value));
  FakeSocket.last.open();
  pass(2);
  assert.deepEqual(links, ["live: live"]);
  FakeSocket.last.message(1, 1);
  pass(2);
  assert.deepEqual(links, ["live: live"]);
  pass(1);
  assert.deepEqual(links, ["live: live", "lost: nothing arrives"]);
  FakeSocket.last.message(1, 2);
  assert.deepEqual(links.at(-1), "live: live");
  assert.deepEqual(heard, [1, 2]);
  assert.equal(FakeSocket.all.length, 1);
});

test("a connection on which nothing comes for long is replaced, though its end is never confirmed", async () => {
  const connection = connect(), heard = [];
  connection.subscribe("/health", ({ value }) => heard.push(value));
  FakeSocket.last.open();
  const [dead] = FakeSocket.all;
  pass(21);
  assert.equal(dead.readyState, 2);
  assert.equal(FakeSocket.all.length, 2);
  FakeSocket.last.open();
  assert.equal(links.at(-1), "live: live");
  dead.message(1, 1);
  dead.end();
  await settled();
  assert.deepEqual([heard.length, links.at(-1), FakeSocket.all.length], [0, "live: live", 2]);
  FakeSocket.last.message(2, 9);
  assert.deepEqual(heard, [9]);
});
