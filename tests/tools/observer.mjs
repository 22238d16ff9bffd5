// A client of the gateway that keeps the last message of each topic and sends commands, by Foxglove's own libraries.
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import protocol from "@foxglove/ws-protocol";
import WebSocket from "ws";

export const LONG = 120_000; // [ms] that anything may take
export const check = (condition, what) => {
  if (!condition) throw new Error(what);
};

/** Waits until the gateway of the run that was just started serves its page. */
export async function waitForGateway(address) {
  for (const end = Date.now() + LONG; ; ) {
    try {
      return await fetch(address.replace("ws:", "http:"));
    } catch (error) {
      if (Date.now() > end) throw error;
      await new Promise((resolve) => setTimeout(resolve, 300));
    }
  }
}

export class Observer {
  #readers = new Map(); // subscription -> { topic, reader }
  #listeners = new Set();
  #calls = new Map();
  #services = new Map();
  last = new Map(); // topic -> message
  statuses = []; // of the gateway

  /** @param topics to which it subscribes; resolves when they and the services are offered */
  static async connect(address, topics, subprotocol = "foxglove.sdk.v1") {
    await waitForGateway(address);
    const observer = new Observer();
    const client = (observer.client = new protocol.FoxgloveClient({ ws: new WebSocket(address, [subprotocol]) }));
    client.on("close", () => (observer.closed = true));
    client.on("status", (status) => {
      observer.statuses.push(status);
      observer.#notify("status", status);
    });
    client.on("message", ({ subscriptionId, data }) => {
      const { topic, reader } = observer.#readers.get(subscriptionId);
      const message = reader.readMessage(data);
      observer.last.set(topic, message);
      observer.#notify(topic, message);
    });
    client.on("serviceCallResponse", ({ callId, data }) => observer.#calls.get(callId)?.(JSON.parse(Buffer.from(data.buffer, data.byteOffset, data.byteLength).toString())));
    client.on("serviceCallFailure", ({ callId, message }) => observer.#calls.get(callId)?.({ accepted: false, service: "gateway", reason: message }));
    const offered = new Promise((resolve, reject) => {
      client.on("error", reject);
      client.on("advertise", (channels) => {
        observer.channels = channels;
        observer.subscribe(topics);
      });
      client.on("advertiseServices", (services) => {
        for (const { id, name } of services) observer.#services.set(name, id);
        resolve();
      });
    });
    await offered;
    return observer;
  }

  /** To those of the topics that are offered. */
  subscribe(topics) {
    for (const { id, topic, schema } of this.channels) {
      if (topics.includes(topic)) this.#readers.set(this.client.subscribe(id), { topic, reader: new MessageReader(parse(schema, { ros2: true })) });
    }
  }

  #notify(topic, message) {
    for (const listener of this.#listeners) listener(topic, message);
  }

  /** Calls listen(topic, message) until it is true of one; throws after LONG, saying `what` did not happen. */
  until(what, listen) {
    return new Promise((resolve, reject) => {
      const end = (act, value) => {
        clearTimeout(timer);
        this.#listeners.delete(listener);
        act(value);
      };
      const timer = setTimeout(() => end(reject, new Error(`in vain: ${what}`)), LONG);
      const listener = (topic, message) => {
        try {
          const found = listen(topic, message);
          if (found) end(resolve, found);
        } catch (error) {
          end(reject, error);
        }
      };
      this.#listeners.add(listener);
    });
  }
  /** Resolves when the last message of a topic satisfies the condition. */
  async untilLast(what, topic, condition) {
    if (this.last.has(topic) && condition(this.last.get(topic))) return;
    await this.until(what, (its, message) => its === topic && condition(message));
  }
  /** Calls watch with every message of a topic, and returns a function that ends it. */
  watch(topic, watch) {
    const listener = (its, message) => its === topic && watch(message);
    this.#listeners.add(listener);
    return () => this.#listeners.delete(listener);
  }

  #nextCall = 1;
  /** @param name of a service, e.g. "/replay/pause"; those of the operator without "/operator/" */
  call(name, request = {}) {
    const callId = this.#nextCall++;
    const data = new TextEncoder().encode(JSON.stringify(request));
    return new Promise((resolve) => {
      this.#calls.set(callId, resolve);
      this.client.sendServiceCallRequest({ serviceId: this.#services.get(name.startsWith("/") ? name : `/operator/${name}`), callId, encoding: "json", data: new DataView(data.buffer) });
    });
  }
  get serviceNames() {
    return [...this.#services.keys()];
  }
  close() {
    this.client.close();
  }
}

export const seconds = ({ sec, nanosec, nsec }) => sec + 1e-9 * (nanosec ?? nsec);
/** The robot's true position: [x, y, z]. */
export const truth = (status) => {
  const { x, y, z } = status.map_from_body_true.position;
  return [x, y, z];
};
/** The first place that a text names as (x, y, z): [x, y, z]. */
export const placeIn = (text) => text.match(/\(([^)]*)\)/)[1].split(",").map(Number);
export const distance = (a, b) => Math.hypot(...a.map((c, k) => c - b[k]));
