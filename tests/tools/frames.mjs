// How fast the page draws maps of a given size: this program is the gateway, and the map is a made-up building.
import { createServer } from "node:http";
import { readFile } from "node:fs/promises";
import { join } from "node:path";
import { chromium } from "playwright-core";
import { WebSocketServer } from "ws";

const [folder, program, ...sizes] = process.argv.slice(2); // the built page; Chromium; known voxels in millions
const SCHEMA = "float64 voxel_size_m\nbool reset\nint16[] position\nuint8[] states\n";
const SECONDS = 10; // over which frames are counted, while the view turns

/** Rooms of 4 x 4 x 2.4 m with voxels of 0.1 m: walls, a floor, a ceiling and a table in each. The state of a voxel. */
function stateOf(x, y, z) {
  const [u, v] = [x % 40, y % 40];
  const wall = (u === 0 && !(v > 15 && v < 24 && z < 20)) || (v === 0 && !(u > 15 && u < 24 && z < 20));
  const table = u > 12 && u < 26 && v > 12 && v < 22 && z === 8;
  return z === 0 || z === 23 || wall || table ? 2 : 1;
}

/** The building's blocks in CDR messages as the gateway sends them, of 1024 blocks each. */
function messagesOf(voxels) {
  const edge = 8 * Math.ceil(Math.sqrt(voxels / 24) / 8);
  const blocks = [];
  for (let bz = 0; bz < 3; ++bz) for (let by = 0; by < edge / 8; ++by) for (let bx = 0; bx < edge / 8; ++bx) blocks.push([bx, by, bz]);
  const messages = [];
  for (let first = 0; first < blocks.length; first += 1024) {
    const some = blocks.slice(first, first + 1024);
    const bytes = Buffer.alloc(4 + 8 + 4 + 4 + 6 * some.length + 8 + 128 * some.length);
    bytes[1] = 1; // CDR, little endian
    bytes.writeDoubleLE(0.1, 4);
    bytes[12] = first === 0 ? 1 : 0;
    bytes.writeUInt32LE(3 * some.length, 16);
    let at = 20;
    for (const block of some) for (const c of block) at = bytes.writeInt16LE(c, at);
    at += (4 - ((at - 4) % 4)) % 4;
    at = bytes.writeUInt32LE(128 * some.length, at);
    for (const [bx, by, bz] of some) {
      for (let k = 0; k < 512; ++k) {
        const state = stateOf(8 * bx + (k & 7), 8 * by + ((k >> 3) & 7), 8 * bz + (k >> 6));
        bytes[at + (k >> 2)] |= state << (2 * (k & 3));
      }
      at += 128;
    }
    messages.push(bytes.subarray(0, at));
  }
  return { messages, known: blocks.length * 512 };
}

function serve(messages) {
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
      for (const message of messages) socket.send(Buffer.concat([head, message]));
    });
  });
  return new Promise((resolve) => server.listen(0, "127.0.0.1", () => resolve(server)));
}

for (const millions of sizes) {
  const { messages, known } = messagesOf(1e6 * Number(millions));
  const server = await serve(messages);
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
  // The view turns: every frame is drawn again.
  const result = await page.evaluate((seconds) => new Promise((resolve) => {
    const canvas = document.getElementById("view"), start = performance.now();
    let frames = 0, x = 400;
    const send = (type) => canvas.dispatchEvent(new PointerEvent(type, { pointerId: 1, button: 0, buttons: 1, clientX: x, clientY: 300, bubbles: true }));
    canvas.setPointerCapture = canvas.releasePointerCapture = () => {};
    send("pointerdown");
    const step = () => {
      x += 3;
      send("pointermove");
      if (performance.now() - start < 1000 * seconds) return ++frames, requestAnimationFrame(step);
      resolve({ rate: frames / ((performance.now() - start) / 1000), faces: window.thalweg.faces, ratio: canvas.width / innerWidth });
    };
    requestAnimationFrame(step);
  }), SECONDS);
  const bytes = messages.reduce((sum, { length }) => sum + length, 0);
  console.log(`${(known / 1e6).toFixed(2)} M voxels: ${result.faces} faces, ${(bytes / 1e6).toFixed(2)} MB, shown after ${loaded.toFixed(1)} s, ` +
    `${result.rate.toFixed(1)} frames/s at ${result.ratio.toFixed(2)} of the pixels`);
  await browser.close();
  server.close();
  server.closeAllConnections();
}
process.exit(0);
