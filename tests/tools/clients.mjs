// Ten clients that subscribe to every channel of a gateway, one of which reads 1 kB/s, until the gateway ends. Prints the
// largest memory of the gateway, and what the clients got.
import { randomBytes } from "node:crypto";
import { readFile } from "node:fs/promises";
import { connect } from "node:net";
import WebSocket from "ws";
import { waitForGateway } from "./observer.mjs";

const [address, run, kind] = process.argv.slice(2); // process id of the run; alone: no clients, only the gateway's memory
const FAST = 9, SLOW_BYTES = 1024, PERIOD_MS = 1000;
const { hostname, port, host } = new URL(address);

/** A text frame of RFC 6455 from a client; a mask of zeros leaves the text as it is. */
function frame(text) {
  const payload = Buffer.from(text), head = Buffer.alloc(8);
  head.writeUInt16BE(0x81fe, 0);
  head.writeUInt16BE(payload.length, 2);
  return Buffer.concat([head, payload]);
}

const subscribe = (channels) => JSON.stringify({ op: "subscribe", subscriptions: channels.map((id) => ({ id, channelId: id })) });
const bytes = Array(FAST + 1).fill(0);

function startFast(index) {
  const socket = new WebSocket(address, ["foxglove.websocket.v1"]);
  socket.on("error", () => {});
  socket.on("message", (data, isBinary) => {
    bytes[index] += data.length;
    if (isBinary) return;
    const message = JSON.parse(data);
    if (message.op === "advertise") socket.send(subscribe(message.channels.map(({ id }) => id)));
  });
}

/** A client without a library, since none lets it leave bytes in the kernel's buffers. */
function startSlow(channels) {
  const socket = connect({ host: hostname, port, highWaterMark: SLOW_BYTES });
  socket.on("error", () => {});
  socket.write(`GET / HTTP/1.1\r\nHost: ${host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n` +
    `Sec-WebSocket-Key: ${randomBytes(16).toString("base64")}\r\nSec-WebSocket-Protocol: foxglove.websocket.v1\r\n\r\n`);
  socket.once("readable", () => socket.write(frame(subscribe(channels)))); // after the server's handshake; bytes stay until they are read
  setInterval(() => { bytes[FAST] += socket.read(SLOW_BYTES)?.length ?? socket.read()?.length ?? 0; }, PERIOD_MS);
}

/** Process id of the gateway, a child of the run. */
async function findGateway() {
  await waitForGateway(address);
  const children = (await readFile(`/proc/${run}/task/${run}/children`, "utf8")).trim().split(" ");
  for (const child of children) if ((await readFile(`/proc/${child}/cmdline`, "utf8")).includes("thalweg-gateway")) return child;
  throw new Error("the run has no gateway");
}

let peakKb = 0;
const gateway = await findGateway();
const watch = async () => {
  const status = await readFile(`/proc/${gateway}/status`, "utf8").catch(() => null);
  if (!status?.includes("VmRSS")) {
    console.log(`gateway at most ${(peakKb / 1024).toFixed(0)} MB; clients read ${bytes.map((n) => (n / 1e6).toFixed(3)).join(" ")} MB`);
    process.exit(0);
  }
  peakKb = Math.max(peakKb, Number(/VmRSS:\s+(\d+)/.exec(status)[1]));
  setTimeout(watch, 200);
};

if (kind !== "alone") {
  for (let k = 0; k < FAST; ++k) startFast(k);
  const first = new WebSocket(address, ["foxglove.websocket.v1"]);
  first.on("message", (data, isBinary) => {
    const message = isBinary ? {} : JSON.parse(data);
    if (message.op !== "advertise") return;
    first.close();
    startSlow(message.channels.map(({ id }) => id));
  });
}
watch();
