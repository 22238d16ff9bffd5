// Foxglove's own client of the protocol subscribes to every channel of a live run and decodes what arrives.
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import protocol from "@foxglove/ws-protocol";
import WebSocket from "ws";
import { LONG as DEADLINE, waitForGateway } from "./observer.mjs";

const { FoxgloveClient } = protocol;
const [address] = process.argv.slice(2);
// Topics on which a run of the kitchen by potential and with a stereo camera always publishes. Others are offered, but nobody
// publishes on them there.
const EXPECTED = ["/clock", "/tf", "/tf_static", "/odometry", "/depth/points", "/stereo/left/image_raw", "/stereo/right/image_raw",
  "/stereo/left/camera_info", "/stereo/right/camera_info", "/map/updates", "/map/octomap", "/map/occupied", "/explorer/path",
  "/explorer/status", "/explorer/frontiers", "/explorer/frontier_markers", "/explorer/field", "/explorer/streamline", "/command/pose",
  "/command/velocity", "/command/velocity_stamped", "/controller/status", "/simulator/status", "/health", "/rosout", "/thalweg/blocks",
  "/thalweg/history", "/thalweg/map_points"];

async function decodeAll(subprotocol) {
  const socket = new WebSocket(address, [subprotocol]);
  const client = new FoxgloveClient({ ws: socket });
  const readers = new Map(), seen = new Map(), offered = new Set();
  const writers = new Map(), listeners = new Map(), services = new Set();
  const graphIsWhole = () => writers.get("/odometry")?.includes("simulator") && listeners.get("/odometry")?.includes("explorer") &&
    listeners.get("/depth/points")?.includes("mapper") && services.has("/operator/pause");
  await new Promise((resolve, reject) => {
    const timer = setTimeout(() => reject(new Error(`nothing on ${EXPECTED.filter((t) => !seen.has(t)).join(", ")}; graph: ${JSON.stringify([...writers])}`)), DEADLINE);
    client.on("error", reject);
    client.on("close", () => reject(new Error("the gateway closed the connection")));
    client.on("status", ({ message }) => reject(new Error(`status: ${message}`)));
    client.on("serverInfo", () => client.subscribeConnectionGraph());
    client.on("connectionGraphUpdate", ({ publishedTopics, subscribedTopics, advertisedServices }) => {
      for (const { name, publisherIds } of publishedTopics) writers.set(name, publisherIds);
      for (const { name, subscriberIds } of subscribedTopics) listeners.set(name, subscriberIds);
      for (const { name } of advertisedServices) services.add(name);
    });
    client.on("advertise", (channels) => {
      for (const channel of channels) {
        offered.add(channel.topic);
        if (channel.schema === "") return reject(new Error(`${channel.topic} has no schema`));
        readers.set(client.subscribe(channel.id), { topic: channel.topic, reader: new MessageReader(parse(channel.schema, { ros2: true })) });
      }
    });
    client.on("message", ({ subscriptionId, data }) => {
      const { topic, reader } = readers.get(subscriptionId);
      try {
        seen.set(topic, reader.readMessage(data));
      } catch (error) {
        return reject(new Error(`${topic}: ${error.message}`));
      }
      if (EXPECTED.every((name) => seen.has(name)) && graphIsWhole()) {
        clearTimeout(timer);
        resolve();
      }
    });
  });
  if (socket.protocol !== subprotocol) throw new Error(`asked for ${subprotocol}, got ${socket.protocol}`);
  const cloud = seen.get("/depth/points");
  if (cloud.data.byteLength !== cloud.height * cloud.row_step) throw new Error("the cloud's size disagrees with its fields");
  const blocks = seen.get("/thalweg/blocks");
  if (blocks.states.length !== (blocks.position.length / 3) * 128) throw new Error("the blocks' states disagree with their positions");
  const points = seen.get("/thalweg/map_points");
  const named = points.fields.map(({ name }) => name).join();
  if (named !== "x,y,z,rgb" || points.data.length !== 16 * points.width || points.header.frame_id !== "map") throw new Error("the map's points are wrong");
  const image = seen.get("/stereo/left/image_raw"), { width } = seen.get("/stereo/left/camera_info");
  if (image.data.length !== image.height * image.step || image.width !== width) throw new Error("the image's size disagrees with its fields");
  const field = seen.get("/explorer/field");
  if (field.width === 0 || field.data.length !== field.width * field.point_step) throw new Error("the field is empty, or not whole");
  const update = seen.get("/map/updates");
  if (update.voxel_size_m !== blocks.voxel_size_m) throw new Error("blocks and map updates disagree on the voxel's size");
  console.log(`${subprotocol}: ${offered.size} channels offered, ${seen.size} decoded`);
  client.close();
}

function refused(options) {
  return new Promise((resolve, reject) => {
    const socket = new WebSocket(address, options.protocols ?? ["foxglove.websocket.v1"], options);
    socket.once("unexpected-response", (_, { statusCode }) => resolve(statusCode));
    socket.once("open", () => reject(new Error(`${JSON.stringify(options)} was let in`)));
    socket.once("error", () => {});
  });
}

const page = await waitForGateway(address);
if (page.status !== 200) throw new Error(`the page: status ${page.status}`);
await decodeAll("foxglove.websocket.v1");
await decodeAll("foxglove.sdk.v1");
for (const [options, status] of [[{ origin: "http://evil.example" }, 403], [{ protocols: ["chat"] }, 400],
  [{ headers: { Host: "evil.example" } }, 403]]) {
  const got = await refused(options);
  if (got !== status) throw new Error(`${JSON.stringify(options)}: status ${got}, not ${status}`);
}
console.log("foreign origin, host and subprotocol refused");
process.exit(0);
