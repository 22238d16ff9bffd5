// Foxglove's own client of the protocol subscribes to every channel that the gateway lists, and decodes each of them.
// usage: node channels.mjs GATEWAY live THALWEG   in a run of kitchen_camera by potential with --surface
//        node channels.mjs GATEWAY rest THALWEG   with a gateway alone, where the topics of ABSENT are published by hand
import common from "@foxglove/rosmsg-msgs-common";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import protocol from "@foxglove/ws-protocol";
import { spawn } from "node:child_process";
import WebSocket from "ws";
import { LONG as DEADLINE, check, waitForGateway } from "./observer.mjs";

const { FoxgloveClient } = protocol;
const [address, part, thalweg] = process.argv.slice(2);

/** Channels on which such a run says nothing, why, and what is published there by hand instead. */
const TRACKER = "there is no tracking system beside the cameras";
const DEPTH = "the clouds come from the stereo camera";
const LINK = "the frames of a link travel in a domain of their own";
const REPLAY = "nothing is replayed";
const ABSENT = new Map([
  ["/outside/odometry", [TRACKER, "{child_frame_id: marked}", ({ child_frame_id: marked }) => marked]],
  ["/outside/pose", [TRACKER, "{header: {frame_id: marked}}", ({ header }) => header.frame_id]],
  ["/depth/image", [DEPTH, "{encoding: marked}", ({ encoding }) => encoding]],
  ["/depth/camera_info", [DEPTH, "{distortion_model: marked}", ({ distortion_model: model }) => model]],
  ["/link/up", [LINK, "{session: 77}", ({ session }) => (session === 77n ? "marked" : "")]],
  ["/link/down", [LINK, "{session: 77}", ({ session }) => (session === 77n ? "marked" : "")]],
  ["/replay/command", [REPLAY, "{sender: marked}", ({ sender }) => sender]],
  ["/replay/status", [REPLAY, "{file: marked}", ({ file }) => file]],
]);
/** Topics of a run on which somebody must ask for something before anything is said; a request is repeated until then. */
const ASKED = new Map(["/map/requests", "/surface/requests"].map((topic) => [topic, "{header: {frame_id: map}, reader: channels, reason: test}"]));

const publish = (topic, message, ...options) => spawn(thalweg, ["topic", "pub", topic.slice(1), message, "--timeout", "60", ...options],
  { stdio: "ignore" });

/** The fields of a definition, as far as they are on the wire. */
const fieldsOf = ({ definitions }) => definitions.filter(({ isConstant }) => !isConstant).map(({ name, type, isArray, arrayLength }) =>
  `${type.replace("/msg/", "/")}${isArray ? `[${arrayLength ?? ""}]` : ""} ${name}`).join(", ");
/** Compares the types of a schema, as far as they are ROS 2's own, with the definitions that Foxglove took from ROS 2 Humble. */
function compareWithRos2(schemaName, types, compared) {
  for (const type of types) {
    const name = (type.name ?? schemaName).replace("/msg/", "/");
    const original = common.ros2humble[name];
    if (!original) continue;
    check(fieldsOf(type) === fieldsOf(original), `${name} is ${fieldsOf(type)}, and in ROS 2 ${fieldsOf(original)}`);
    compared.add(name);
  }
}

/** Subscribes to all channels. Resolves with the last message of each when `isEnough` holds of (messages, offered, graph). */
async function decodeAll(subprotocol, isEnough, missing, command) {
  const socket = new WebSocket(address, [subprotocol]);
  const client = new FoxgloveClient({ ws: socket });
  const readers = new Map(), seen = new Map(), offered = new Set();
  const graph = { writers: new Map(), listeners: new Map(), services: new Set() };
  const services = new Map(), compared = new Set();
  let calls = 0;
  const caller = command && setInterval(() => {
    if (!services.has(command.name) || ["/operator/command", "/operator/reply"].every((topic) => seen.has(topic))) return;
    const body = new TextEncoder().encode(JSON.stringify(command.request));
    client.sendServiceCallRequest({ serviceId: services.get(command.name), callId: ++calls, encoding: "json", data: new DataView(body.buffer) });
  }, 2000);
  const ended = new Promise((resolve, reject) => {
    const timer = setTimeout(() => reject(new Error(`nothing on ${missing(seen, offered).join(", ")}; graph: ${JSON.stringify([...graph.writers])}`)), DEADLINE);
    const done = (act, value) => {
      clearTimeout(timer);
      clearInterval(caller);
      act(value);
    };
    const fail = (what) => done(reject, new Error(what));
    client.on("error", (error) => done(reject, error));
    client.on("close", () => fail("the gateway closed the connection"));
    client.on("status", ({ message }) => fail(`status: ${message}`));
    client.on("serverInfo", () => client.subscribeConnectionGraph());
    client.on("connectionGraphUpdate", ({ publishedTopics, subscribedTopics, advertisedServices }) => {
      for (const { name, publisherIds } of publishedTopics) graph.writers.set(name, publisherIds);
      for (const { name, subscriberIds } of subscribedTopics) graph.listeners.set(name, subscriberIds);
      for (const { name } of advertisedServices) graph.services.add(name);
    });
    client.on("advertiseServices", (list) => list.forEach(({ id, name }) => services.set(name, id)));
    client.on("advertise", (channels) => {
      for (const { id, topic, schema, schemaName, encoding, schemaEncoding } of channels) {
        offered.add(topic);
        if (schema === "" || schemaName === "") return fail(`${topic} has no schema`);
        if (encoding !== "cdr" || (schemaEncoding ?? "ros2msg") !== "ros2msg") return fail(`${topic} comes as ${encoding}, ${schemaEncoding}`);
        const types = parse(schema, { ros2: true });
        try {
          compareWithRos2(schemaName, types, compared);
        } catch (error) {
          return fail(`${topic}: ${error.message}`);
        }
        readers.set(client.subscribe(id), { topic, reader: new MessageReader(types) });
      }
    });
    client.on("message", ({ subscriptionId, data }) => {
      const { topic, reader } = readers.get(subscriptionId);
      try {
        seen.set(topic, reader.readMessage(data));
      } catch (error) {
        return fail(`${topic}: ${error.message}`);
      }
      if (isEnough(seen, offered, graph)) done(resolve);
    });
  });
  await ended;
  check(socket.protocol === subprotocol, `asked for ${subprotocol}, got ${socket.protocol}`);
  client.close();
  return { seen, offered, compared };
}

/** What several channels say of the same thing agrees. */
function checkContents(seen) {
  const cloud = seen.get("/depth/points");
  check(cloud.data.byteLength === cloud.height * cloud.row_step, "the cloud's size disagrees with its fields");
  const blocks = seen.get("/thalweg/blocks");
  check(blocks.states.length === (blocks.position.length / 3) * 128, "the blocks' states disagree with their positions");
  const points = seen.get("/thalweg/map_points");
  const named = points.fields.map(({ name }) => name).join();
  check(named === "x,y,z,rgb" && points.data.length === 16 * points.width && points.header.frame_id === "map", "the map's points are wrong");
  for (const side of ["left", "right"]) {
    const image = seen.get(`/stereo/${side}/image_raw`), { width } = seen.get(`/stereo/${side}/camera_info`);
    check(image.data.length === image.height * image.step && image.width === width, `the ${side} image's size disagrees with its fields`);
  }
  const { image: disparity } = seen.get("/stereo/disparity");
  check(disparity.encoding === "32FC1" && disparity.data.length === disparity.height * disparity.step, "the disparities are not whole");
  const field = seen.get("/explorer/field");
  check(field.width > 0 && field.data.length === field.width * field.point_step, "the field is empty, or not whole");
  check(seen.get("/map/updates").voxel_size_m === blocks.voxel_size_m, "blocks and map updates disagree on the voxel's size");
  check(seen.get("/operator/command").sender === seen.get("/operator/reply").sender, "the reply is to another sender");
  check(seen.get("/simulator/odometry").child_frame_id === seen.get("/odometry").child_frame_id, "the truth is of another frame");
}

async function live(subprotocol) {
  const asking = [...ASKED].map(([topic, message]) => publish(topic, message, "--rate", "1"));
  const missing = (seen, offered) => [...offered].filter((topic) => !seen.has(topic) && !ABSENT.has(topic));
  const isEnough = (seen, offered, { writers, listeners, services }) => offered.size > 0 && missing(seen, offered).length === 0 &&
    writers.get("/odometry")?.includes("visual-odometry") && listeners.get("/odometry")?.includes("explorer") &&
    listeners.get("/depth/points")?.includes("mapper") && services.has("/operator/pause");
  try {
    const { seen, offered, compared } = await decodeAll(subprotocol, isEnough, missing, { name: "/operator/strategy", request: { strategy: "potential" } });
    const heard = [...ABSENT.keys()].filter((topic) => seen.has(topic));
    check(heard.length === 0, `somebody publishes ${heard.join(", ")} after all: take them out of ABSENT`);
    const gone = [...ABSENT.keys()].filter((topic) => !offered.has(topic));
    check(gone.length === 0, `the gateway does not offer ${gone.join(", ")}`);
    checkContents(seen);
    console.log(`${subprotocol}: ${seen.size} of ${offered.size} channels decoded in a run; ${compared.size} types are those of ROS 2`);
    for (const type of ["sensor_msgs/PointCloud2", "nav_msgs/Odometry", "tf2_msgs/TFMessage", "visualization_msgs/MarkerArray", "sensor_msgs/CameraInfo"])
      check(compared.has(type), `${type} was not compared`);
  } finally {
    for (const child of asking) child.kill("SIGINT");
  }
}

async function rest(subprotocol) {
  const publishers = [...ABSENT].map(([topic, [, message]]) => publish(topic, message, "--rate", "5"));
  const missing = (seen) => [...ABSENT].filter(([topic, [, , mark]]) => !seen.has(topic) || mark(seen.get(topic)) !== "marked").map(([topic]) => topic);
  try {
    await decodeAll(subprotocol, (seen) => missing(seen).length === 0, missing);
  } finally {
    for (const child of publishers) child.kill("SIGINT");
  }
  console.log(`${subprotocol}: the other ${ABSENT.size} decoded as they were published by hand`);
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
check(page.status === 200, `the page: status ${page.status}`);
for (const subprotocol of ["foxglove.websocket.v1", "foxglove.sdk.v1"]) await (part === "live" ? live : rest)(subprotocol);
if (part === "live") {
  for (const [topic, [reason]] of ABSENT) console.log(`not in such a run: ${topic}, since ${reason}`);
  for (const [options, status] of [[{ origin: "http://evil.example" }, 403], [{ protocols: ["chat"] }, 400],
    [{ headers: { Host: "evil.example" } }, 403]]) {
    const got = await refused(options);
    check(got === status, `${JSON.stringify(options)}: status ${got}, not ${status}`);
  }
  console.log("foreign origin, host and subprotocol refused");
}
process.exit(0);
