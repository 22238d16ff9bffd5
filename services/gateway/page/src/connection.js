// A client of the Foxglove WebSocket protocol that reconnects by itself and keeps its subscriptions.

const PROTOCOLS = ["foxglove.sdk.v1", "foxglove.websocket.v1"];
// [s] A network that breaks closes no connection. The page subscribes to health, which the gateway itself publishes each
// second: after so long without a message the link is reported as lost, and then replaced by another one.
const QUIET = 3, GONE = 20;

export class Connection {
  #handlers = new Map(); // topic -> handler(message, time [s])
  #channels = new Map(); // topic -> { id, reader }
  #subscriptions = new Map(); // subscription id -> topic
  #unread = new Set(); // topics that had a message which could not be read
  #nextId = 1;
  #socket = null;
  #session = null;
  #services = new Map(); // name -> id
  #calls = new Map(); // call id -> resolve
  #nextCall = 1;
  #wait = 500;
  #quiet = 0; // ticks since the last message; none while the page sleeps

  /**
   * @param events   { onLink("live", "lost" or "refused", text), onReset(), onTime(seconds), onParameters(map),
   *                 onSteering(whether commands are taken) }
   * @param readerOf (schema in ros2msg) -> { readMessage(bytes) }, or throws
   * @param whyRefused () -> promise of the reason why the gateway lets no socket of this page in, "" if it does or is
   *                 away; never rejects. A browser does not say why a socket did not open.
   */
  constructor(url, events, readerOf, whyRefused) {
    this.url = url;
    this.events = events;
    this.readerOf = readerOf;
    this.whyRefused = whyRefused;
    this.bytes = 0;
    this.#open();
    setInterval(() => this.#tick(), 1000);
  }

  /** Differs after each start of the gateway; null before it is known. */
  get session() {
    return this.#session;
  }

  /** Calls `handler` with the messages of a topic, also after a reconnection. */
  subscribe(topic, handler) {
    this.#handlers.set(topic, handler);
    this.#subscribeTo(topic);
  }

  unsubscribe(topic) {
    this.#handlers.delete(topic);
    for (const [id, its] of this.#subscriptions) {
      if (its !== topic) continue;
      this.#subscriptions.delete(id);
      this.#send({ op: "unsubscribe", subscriptionIds: [id] });
    }
  }

  /**
   * Calls a service, e.g. "/operator/goto", and waits for its answer: { accepted, service, reason }. Never rejects.
   */
  call(name, request = {}) {
    const service = this.#services.get(name);
    const refused = (reason) => ({ accepted: false, service: "page", reason });
    if (service === undefined || this.#socket?.readyState !== WebSocket.OPEN) {
      return Promise.resolve(refused(this.#socket?.readyState === WebSocket.OPEN ? "this page may only look" : "the gateway is away"));
    }
    const call = this.#nextCall++;
    const encoding = new TextEncoder().encode("json");
    const body = new TextEncoder().encode(JSON.stringify(request));
    const frame = new DataView(new ArrayBuffer(13 + encoding.length + body.length));
    frame.setUint8(0, 2);
    frame.setUint32(1, service, true);
    frame.setUint32(5, call, true);
    frame.setUint32(9, encoding.length, true);
    const bytes = new Uint8Array(frame.buffer);
    bytes.set(encoding, 13);
    bytes.set(body, 13 + encoding.length);
    this.#socket.send(frame.buffer);
    return new Promise((resolve) => this.#calls.set(call, { resolve, refused }));
  }

  #answer(call, answer) {
    const waiting = this.#calls.get(call);
    this.#calls.delete(call);
    waiting?.resolve(answer ?? waiting.refused("no answer"));
  }

  #open() {
    const socket = new WebSocket(this.url, PROTOCOLS);
    socket.binaryType = "arraybuffer";
    let isOpened = false;
    socket.onopen = () => {
      isOpened = true;
      this.#wait = 500;
      this.events.onLink("live", "live");
      this.#send({ op: "getParameters", parameterNames: [], id: "all" });
    };
    socket.onmessage = ({ data }) => {
      if (this.#quiet >= QUIET) this.events.onLink("live", "live");
      this.#quiet = 0;
      if (typeof data === "string") this.#onText(JSON.parse(data));
      else this.#onBinary(data);
    };
    socket.onclose = async ({ reason }) => {
      const refusal = isOpened ? "" : await this.whyRefused();
      if (refusal) this.#onLost("refused", refusal);
      else this.#onLost("lost", reason || "gateway is away");
    };
    this.#socket = socket;
    this.#quiet = 0;
  }

  #onLost(state, reason) {
    this.#channels.clear();
    this.#subscriptions.clear();
    this.#services.clear();
    for (const { resolve, refused } of this.#calls.values()) resolve(refused("the connection was lost"));
    this.#calls.clear();
    this.events.onLink(state, reason);
    setTimeout(() => this.#open(), this.#wait);
    this.#wait = Math.min(this.#wait * 1.6, 5000);
  }

  #tick() {
    if (this.#socket.readyState !== WebSocket.OPEN) return;
    ++this.#quiet;
    if (this.#quiet === QUIET) this.events.onLink("lost", "nothing arrives");
    if (this.#quiet !== GONE) return;
    // Its own end would wait for an answer of the other side.
    Object.assign(this.#socket, { onopen: null, onmessage: null, onclose: null });
    this.#socket.close();
    this.#onLost("lost", "nothing arrives");
  }

  #send(object) {
    if (this.#socket?.readyState === WebSocket.OPEN) this.#socket.send(JSON.stringify(object));
  }

  #onText(message) {
    switch (message.op) {
      case "serverInfo":
        if (this.#session !== null && this.#session !== message.sessionId) this.events.onReset();
        this.#session = message.sessionId;
        this.events.onSteering(message.capabilities.includes("services"));
        break;
      case "advertiseServices":
        for (const { id, name } of message.services) this.#services.set(name, id);
        break;
      case "serviceCallFailure":
        this.#answer(message.callId, { accepted: false, service: "gateway", reason: message.message });
        break;
      case "advertise":
        for (const channel of message.channels) {
          try {
            this.#channels.set(channel.topic, { id: channel.id, reader: this.readerOf(channel.schema) });
          } catch (error) {
            console.warn(`${channel.topic}: its schema cannot be read: ${error.message}`);
          }
        }
        for (const topic of this.#handlers.keys()) this.#subscribeTo(topic);
        break;
      case "parameterValues":
        this.events.onParameters(new Map(message.parameters.map(({ name, value }) => [name, value])));
        break;
      case "status":
        console.warn(`gateway: ${message.message}`);
        break;
    }
  }

  #subscribeTo(topic) {
    const channel = this.#channels.get(topic);
    if (!channel || [...this.#subscriptions.values()].includes(topic)) return;
    const id = this.#nextId++;
    this.#subscriptions.set(id, topic);
    this.#send({ op: "subscribe", subscriptions: [{ id, channelId: channel.id }] });
  }

  #onBinary(buffer) {
    this.bytes += buffer.byteLength;
    const view = new DataView(buffer);
    const seconds = (at) => Number(view.getBigUint64(at, true)) * 1e-9;
    if (view.getUint8(0) === 2) return this.events.onTime(seconds(1));
    if (view.getUint8(0) === 3) {
      const json = new TextDecoder().decode(new Uint8Array(buffer, 13 + view.getUint32(9, true)));
      return this.#answer(view.getUint32(5, true), JSON.parse(json));
    }
    if (view.getUint8(0) !== 1) return;
    const topic = this.#subscriptions.get(view.getUint32(1, true));
    const handler = this.#handlers.get(topic);
    if (!handler) return;
    let message;
    try {
      message = this.#channels.get(topic).reader.readMessage(new Uint8Array(buffer, 13));
    } catch (error) {
      // E.g. a service of another version, whose messages have other fields.
      if (!this.#unread.has(topic)) console.warn(`${topic}: a message cannot be read: ${error.message}`);
      this.#unread.add(topic);
      return;
    }
    handler(message, seconds(5));
  }
}
