// A ROS 2 node in TypeScript (@foxglove/rtps and ROS's own message definitions, nothing of ours) asks for what rviz2 shows,
// with rviz2's QoS, and receives every message at the rate at which it is published. Not tf_static, which Cyclone reads in
// tests/integration: this node sends its requests for what was written earlier to the port for discovery, where Fast DDS does
// not look for them.
import nodejs from "@foxglove/rtps/nodejs";
import common from "@foxglove/rosmsg-msgs-common";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import rtps from "@foxglove/rtps";
import { Observer, seconds } from "./observer.mjs";

const { Durability, HistoryKind, Participant, Reliability } = rtps;
const { UdpSocketNode } = nodejs;
const [gateway, domain, address, cloudHz, odometryHz, imageHz] = process.argv.slice(2);
const DEADLINE_MS = 60_000, CLOUDS = 50;
const FOREVER = { sec: 0x7fffffff, nsec: 0xffffffff };

// As rviz2's displays request them: topic, type, durability and depth, all reliable; the rate of the stamps where it is fixed.
const REQUESTED = [
  ["depth/points", "sensor_msgs/PointCloud2", Durability.Volatile, 5, Number(cloudHz)],
  ["stereo/left/image_raw", "sensor_msgs/Image", Durability.Volatile, 5, Number(imageHz)],
  ["stereo/left/camera_info", "sensor_msgs/CameraInfo", Durability.Volatile, 5, Number(imageHz)],
  ["odometry", "nav_msgs/Odometry", Durability.Volatile, 10, Number(odometryHz)],
  ["tf", "tf2_msgs/TFMessage", Durability.Volatile, 100, Number(odometryHz)],
  ["explorer/path", "nav_msgs/Path", Durability.Volatile, 10],
  ["map/occupied", "sensor_msgs/PointCloud2", Durability.Volatile, 5],
  ["explorer/frontier_markers", "visualization_msgs/MarkerArray", Durability.Volatile, 10],
  ["rosout", "rcl_interfaces/Log", Durability.Volatile, 10],
];

/** The definition of a ROS 2 type and of all that it contains, the type itself first. */
function definitionsOf(type, known = new Map()) {
  if (known.has(type)) return known;
  if (common.ros2humble[type] === undefined) throw new Error(`ROS 2 has no type ${type}`);
  known.set(type, { ...common.ros2humble[type], name: type });
  for (const field of common.ros2humble[type].definitions) if (field.isComplex) definitionsOf(field.type, known);
  return known;
}

// The node announces itself once, so that a process which starts after it would never hear of it.
const run = await Observer.connect(gateway, ["/command/pose"]);
await run.untilLast("the robot moves", "/command/pose", () => true);
run.close();

const readers = new Map(), received = new Map(REQUESTED.map(([topic]) => [topic, []]));
const node = new Participant({ name: "rviz", addresses: [address], domainId: Number(domain), udpSocketCreate: UdpSocketNode.Create });
await new Promise((resolve, reject) => {
  const missing = () => REQUESTED.map(([topic]) => topic).filter((topic) => received.get(topic).length === 0);
  const timer = setTimeout(() => reject(new Error(`nothing on ${missing().join(", ") || "(all came)"}, or fewer than ${CLOUDS} clouds: ` +
    `${received.get("depth/points").length}`)), DEADLINE_MS);
  node.on("error", reject);
  node.on("userData", ({ subscription, serializedData }) => {
    const topic = subscription.topicName.replace(/^rt\//, "");
    try {
      received.get(topic).push(readers.get(topic).readMessage(serializedData));
    } catch (error) {
      return reject(new Error(`${topic}: ${error.message}`));
    }
    if (received.get("depth/points").length < CLOUDS || missing().length > 0) return;
    clearTimeout(timer);
    resolve();
  });
  for (const [topic, type, durability, depth] of REQUESTED) {
    readers.set(topic, new MessageReader([...definitionsOf(type).values()]));
    node.subscribe({ topicName: `rt/${topic}`, typeName: type.replace("/", "::msg::dds_::") + "_", durability,
      reliability: { kind: Reliability.Reliable, maxBlockingTime: FOREVER }, history: { kind: HistoryKind.KeepLast, depth } });
  }
  node.start().catch(reject);
});
await node.shutdown();

for (const [topic, type, , , rate] of REQUESTED) {
  const messages = received.get(topic);
  let line = `${topic}: ${messages.length} of ${type}`;
  if (rate !== undefined) {
    const stamps = messages.map(({ header, transforms }) => seconds((header ?? transforms[0].header).stamp));
    const published = Math.round((stamps.at(-1) - stamps[0]) * rate) + 1;
    line += `, ${published} published meanwhile at ${rate} Hz`;
    if (messages.length !== published) throw new Error(line);
  }
  console.log(line);
}
const cloud = received.get("depth/points").at(-1), frames = new Set();
if (cloud.data.byteLength !== cloud.height * cloud.row_step || cloud.data.byteLength === 0) throw new Error("the cloud's size disagrees with its fields");
const image = received.get("stereo/left/image_raw").at(-1), info = received.get("stereo/left/camera_info").at(-1);
if (image.encoding !== "mono8" || image.step !== image.width || image.data.byteLength !== image.height * image.step) throw new Error("the image is not whole");
if (new Set(image.data).size < 20) throw new Error("the image has hardly any grays");
if (info.width !== image.width || info.height !== image.height || !(info.k[0] > 0) || info.k[2] !== (info.width - 1) / 2) {
  throw new Error(`the camera_info, ${info.width} x ${info.height}, K ${[...info.k]}, is not of the image, ${image.width} x ${image.height}`);
}
console.log(`an image of ${image.width} x ${image.height} ${image.encoding} with its camera_info`);
for (const { transforms } of received.get("tf")) {
  for (const { header, child_frame_id } of transforms) frames.add(`${header.frame_id} > ${child_frame_id}`);
}
if (!frames.has("odom > base_link") && !frames.has("map > base_link")) throw new Error(`the transforms: ${[...frames].join(", ")}`);
console.log(`transforms ${[...frames].join(", ")}`);
process.exit(0);
