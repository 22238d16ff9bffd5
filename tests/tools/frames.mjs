// How fast the page draws maps of a given size: this program is the gateway, and the map is a made-up building, once with
// flat walls and once with rough ones. Processor time is that of all Chromium's processes; on a busy machine it says more
// than time does.
import { createServer } from "node:http";
import { readFileSync, readdirSync } from "node:fs";
import { readFile } from "node:fs/promises";
import { join } from "node:path";
import { chromium } from "playwright-core";
import { WebSocketServer } from "ws";

const [folder, program, ...sizes] = process.argv.slice(2); // the built page; Chromium; known voxels in millions
const SCHEMA = "float64 voxel_size_m\nbool reset\nint16[] position\nuint8[] states\n";
const SECONDS = 10; // over which frames are counted, while the view turns
const SCAN = { period: 100, edge: 10 }; // [ms], [blocks]: what changes while the robot moves, 100 blocks
const ROUGH = 0.1; // share of the walls' voxels that are missing, and of those that stand out

/** Rooms of 4 x 4 x 2.4 m with voxels of 0.1 m: walls, a floor, a ceiling and a table in each. The state of a voxel. */
function stateOf(x, y, z) {
  const [u, v] = [x % 40, y % 40];
  const wall = (u === 0 && !(v > 15 && v < 24 && z < 20)) || (v === 0 && !(u > 15 && u < 24 && z < 20));
  const table = u > 12 && u < 26 && v > 12 && v < 22 && z === 8;
  return z === 0 || z === 23 || wall || table ? 2 : 1;
}

/** Pseudorandom in [0, 1), the same for the same voxel. */
function noise(x, y, z) {
  let mixed = Math.imul(x, 374761393) ^ Math.imul(y, 668265263) ^ Math.imul(z, 1274126177);
  for (let k = 0; k < 2; ++k) mixed = Math.imul(mixed ^ (mixed >>> 15), 739982445);
  return ((mixed ^ (mixed >>> 15)) >>> 0) / 2 ** 32;
}
/** The same, of a building whose walls, floors and ceilings are rough, as those of measured maps are. */
function roughStateOf(x, y, z) {
  if (stateOf(x, y, z) === 2) return noise(x, y, z) < ROUGH ? 1 : 2;
  const beside = [[x - 1, y, z], [x + 1, y, z], [x, y - 1, z], [x, y + 1, z], [x, y, z - 1], [x, y, z + 1]];
  return beside.some((voxel) => voxel.every((c) => c >= 0) && stateOf(...voxel) === 2 && noise(...voxel) > 1 - ROUGH) ? 2 : 1;
}

/** Blocks in a CDR message as the gateway sends it. */
function messageOf(blocks, states, reset) {
  const bytes = Buffer.alloc(4 + 8 + 4 + 4 + 6 * blocks.length + 8 + 128 * blocks.length);
  bytes[1] = 1; // CDR, little endian
  bytes.writeDoubleLE(0.1, 4);
  bytes[12] = reset ? 1 : 0;
  bytes.writeUInt32LE(3 * blocks.length, 16);
  let at = 20;
  for (const block of blocks) for (const c of block) at = bytes.writeInt16LE(c, at);
  at += (4 - ((at - 4) % 4)) % 4;
  at = bytes.writeUInt32LE(128 * blocks.length, at);
  for (const [bx, by, bz] of blocks) {
    for (let k = 0; k < 512; ++k) {
      bytes[at + (k >> 2)] |= states(8 * bx + (k & 7), 8 * by + ((k >> 3) & 7), 8 * bz + (k >> 6)) << (2 * (k & 3));
    }
    at += 128;
  }
  return bytes.subarray(0, at);
}

/** The building's blocks in messages of 1024 blocks each. */
function messagesOf(edge, states) {
  const blocks = [];
  for (let bz = 0; bz < 3; ++bz) for (let by = 0; by < edge; ++by) for (let bx = 0; bx < edge; ++bx) blocks.push([bx, by, bz]);
  const messages = [];
  for (let first = 0; first < blocks.length; first += 1024) messages.push(messageOf(blocks.slice(first, first + 1024), states, first === 0));
  return { messages, known: blocks.length * 512 };
}

/** What a scan changes, from place to place along the building. */
function scanOf(n, edge, states) {
  const from = (4 * n) % Math.max(edge - SCAN.edge, 1), blocks = [];
  for (let by = 0; by < SCAN.edge; ++by) for (let bx = 0; bx < SCAN.edge; ++bx) blocks.push([from + bx, from + by, 1]);
  return messageOf(blocks, states, false);
}

/** [ms] Processor time of all processes that this one has started. */
function processorTime() {
  const all = readdirSync("/proc").filter((name) => /^\d+$/.test(name)).flatMap((id) => {
    try {
      const text = readFileSync(`/proc/${id}/stat`, "utf8"), fields = text.slice(text.lastIndexOf(")") + 2).split(" ");
      return [{ id: Number(id), parent: Number(fields[1]), time: 10 * (Number(fields[11]) + Number(fields[12])) }];
    } catch {
      return []; // has ended
    }
  });
  const sum = (parent) => all.filter((one) => one.parent === parent).reduce((total, { id, time }) => total + time + sum(id), 0);
  return sum(process.pid);
}

/** Returns { server, send(message): to the page, once it has subscribed }. */
function serve(messages) {
  let send = () => {};
  const server = createServer(async ({ url }, response) => {
    const name = url.split("?")[0] === "/" ? "index.html" : url.split("?")[0].slice(1);
    const type = name.endsWith(".js") ? "text/javascript" : name.endsWith(".css") ? "text/css" : "text/html";
    response.writeHead(200, { "Content-Type": type }).end(await readFile(join(folder, name)).catch(() => ""));
  });
  new WebSocketServer({ server, handleProtocols: () => "foxglove.sdk.v1" }).on("connection", (socket) => {
    socket.send(JSON.stringify({ op: "serverInfo", name: "test", capabilities: [], supportedEncodings: [], sessionId: "1" }));
    socket.send(JSON.stringify({ op: "advertise", channels: [{ id: 1, topic: "/thalweg/blocks", encoding: "cdr",
      schemaName: "thalweg_msgs/msg/BlockStates", schema: SCHEMA, schemaEncoding: "ros2msg" }] }));
    socket.on("message", (text) => {
      const request = JSON.parse(text);
      if (request.op !== "subscribe") return;
      const head = Buffer.alloc(13);
      head[0] = 1;
      head.writeUInt32LE(request.subscriptions[0].id, 1);
      send = (message) => socket.send(Buffer.concat([head, message]));
      messages.forEach(send);
    });
  });
  return new Promise((resolve) => server.listen(0, "127.0.0.1", () => resolve({ server, send: (message) => send(message) })));
}

/** Frames while the view turns, each of which is drawn again. */
const turn = (page) => page.evaluate((seconds) => new Promise((resolve) => {
  const canvas = document.getElementById("view"), start = performance.now();
  let frames = 0, x = 400;
  const send = (type) => canvas.dispatchEvent(new PointerEvent(type, { pointerId: 1, button: 0, buttons: 1, clientX: x, clientY: 300, bubbles: true }));
  canvas.setPointerCapture = canvas.releasePointerCapture = () => {};
  send("pointerdown");
  const step = () => {
    x += 3;
    send("pointermove");
    if (performance.now() - start < 1000 * seconds) return ++frames, requestAnimationFrame(step);
    send("pointerup");
    resolve({ frames, rate: frames / ((performance.now() - start) / 1000), faces: window.thalweg.faces, ratio: canvas.width / innerWidth,
      bytes: window.thalweg.bytes });
  };
  requestAnimationFrame(step);
}), SECONDS);
/** Waits for a second in which the page draws nothing. */
const comesToRest = (page) => page.waitForFunction(() => window.thalweg.frames === 0, null, { polling: 200 });

for (const millions of sizes) {
  for (const [kind, states] of [["flat", stateOf], ["rough", roughStateOf]]) {
    const edge = Math.ceil(Math.sqrt((1e6 * Number(millions)) / 24) / 8); // [blocks]
    const { messages, known } = messagesOf(edge, states);
    const { server, send } = await serve(messages);
    const browser = await chromium.launch({ executablePath: program, args: ["--headless=new", "--no-sandbox", "--use-gl=angle",
      "--use-angle=swiftshader-webgl", "--enable-unsafe-swiftshader", "--disable-gpu-rasterization", "--disable-background-networking",
      "--disable-component-update", "--disable-sync", "--no-first-run"] });
    const page = await browser.newPage({ viewport: { width: 1280, height: 720 } });
    page.setDefaultTimeout(400_000);
    const begin = Date.now();
    await page.goto(`http://127.0.0.1:${server.address().port}/`, { waitUntil: "commit" });
    await page.waitForFunction((all) => window.thalweg?.known === all, known, { timeout: 400_000 });
    // All chunks have faces when their number no longer grows between two looks, which come once a second.
    await page.waitForFunction(() => {
      const { faces } = window.thalweg, same = window.before === faces && faces > 0;
      if (window.looked !== window.thalweg) window.before = faces;
      const settled = same && window.looked !== window.thalweg;
      window.looked = window.thalweg;
      return settled;
    }, null, { timeout: 400_000, polling: 500 });
    const loaded = (Date.now() - begin) / 1000;
    const used = processorTime(), still = await turn(page), perFrame = (processorTime() - used) / still.frames;
    await comesToRest(page);
    let scans = 0;
    const before = (await page.evaluate(() => window.thalweg.bytes)), scanning = setInterval(() => send(scanOf(scans++, edge, states)), SCAN.period);
    const live = await turn(page);
    clearInterval(scanning);
    await comesToRest(page);
    const bytes = messages.reduce((sum, { length }) => sum + length, 0);
    console.log(`${(known / 1e6).toFixed(2)} M voxels, ${kind}: ${still.faces} faces, ${(bytes / 1e6).toFixed(2)} MB, shown after ${loaded.toFixed(1)} s, ` +
      `${still.rate.toFixed(1)} frames/s at ${still.ratio.toFixed(2)} of the pixels (${perFrame.toFixed(0)} ms of processor time each); ` +
      `${live.rate.toFixed(1)} while ${((live.bytes - before) / 1000 / SECONDS).toFixed(0)} kB/s of changes come; none at rest`);
    await browser.close();
    server.close();
    server.closeAllConnections();
  }
}
process.exit(0);
