// A client steers a live run in every way that the gateway offers, and is refused where it must be.
import { MessageWriter } from "@foxglove/rosmsg2-serialization";
import { parse } from "@foxglove/rosmsg";
import { Observer, check } from "./observer.mjs";

const [address] = process.argv.slice(2);
const PAUSED = 5;
const TOPICS = ["/explorer/status", "/health"];
const EVERY = ["pause", "resume", "step", "stop", "home", "goto", "look_at", "ignore", "no_go", "clear_no_go", "strategy", "save_map"];

for (const subprotocol of ["foxglove.websocket.v1", "foxglove.sdk.v1"]) {
  const observer = await Observer.connect(address, TOPICS, subprotocol);
  check(EVERY.every((name) => observer.serviceNames.includes(`/operator/${name}`)), `services: ${observer.serviceNames}`);
  await observer.untilLast("a map and a plan", "/explorer/status", ({ plans }) => plans > 0);

  const paused = await observer.call("pause");
  check(paused.accepted && paused.service === "explorer", `pause: ${JSON.stringify(paused)}`);
  await observer.untilLast("the pause", "/explorer/status", ({ state }) => state === PAUSED);
  const refused = await observer.call("goto", { point: { x: 900, y: 900, z: 900 } });
  check(!refused.accepted && refused.service === "explorer" && refused.reason.length > 10, `goto: ${JSON.stringify(refused)}`);
  const malformed = await observer.call("goto", { point: [1, 2, 3] });
  check(!malformed.accepted && malformed.reason.includes('"point"'), `malformed: ${JSON.stringify(malformed)}`);
  const unknown = await observer.call("strategy", { strategy: "magic" });
  check(!unknown.accepted && unknown.reason.includes("flow"), `strategy: ${JSON.stringify(unknown)}`);
  const nothing = await observer.call("/replay/pause");
  check(!nothing.accepted && nothing.reason === "nothing is replayed here", `replay: ${JSON.stringify(nothing)}`);
  const saved = await observer.call("save_map");
  check(saved.accepted && saved.service === "mapper", `save_map: ${JSON.stringify(saved)}`);

  // The same as messages: the answer is a status.
  const status = (word) => observer.until(`a status with "${word}"`, (topic, { message }) => topic === "status" && message.includes(word));
  const json = observer.client.advertise({ topic: "/operator/command", encoding: "json", schemaName: "" });
  let answer = status("explorer: ");
  observer.client.sendMessage(json, new TextEncoder().encode(JSON.stringify({ kind: "resume" })));
  await answer;
  await observer.untilLast("the run to go on", "/explorer/status", ({ state }) => state !== PAUSED);
  const schema = observer.channels.find(({ topic }) => topic === "/operator/command").schema;
  const cdr = observer.client.advertise({ topic: "/operator/command", encoding: "cdr", schemaName: "thalweg_msgs/msg/OperatorCommand" });
  const zero = { x: 0, y: 0, z: 0 };
  const bytes = new MessageWriter(parse(schema, { ros2: true })).writeMessage({ header: { stamp: { sec: 0, nanosec: 0 }, frame_id: "map" },
    sender: "test", id: 1n, kind: 0, point: zero, corner: zero, yaw_rad: NaN, strategy: "" });
  answer = status("explorer: ");
  observer.client.sendMessage(cdr, bytes);
  await answer;
  await observer.untilLast("the pause", "/explorer/status", ({ state }) => state === PAUSED);
  answer = status("no thalweg_msgs/msg/OperatorCommand");
  observer.client.sendMessage(cdr, bytes.subarray(0, 20));
  await answer;
  answer = status("/operator/command and /replay/command only");
  const pose = observer.client.advertise({ topic: "/command/pose", encoding: "cdr", schemaName: "geometry_msgs/msg/PoseStamped" });
  observer.client.sendMessage(pose, bytes);
  await answer;

  // A flood is refused, counted, and stops nobody else.
  const other = await Observer.connect(address, [], subprotocol);
  const flood = await Promise.all(Array.from({ length: 60 }, () => observer.call("pause")));
  check(flood.some(({ reason }) => reason.includes("more than 5 commands a second") || reason.includes("wait for their answers")), "a flood passes");
  check((await other.call("resume")).accepted, "another client is held up by the flood");
  await observer.untilLast("the flood in the gateway's health", "/health",
    ({ service, rejected }) => service === "gateway" && rejected.some(({ name }) => name.startsWith("viewers' commands")));
  other.close();
  observer.close();
  console.log(`${subprotocol}: ${EVERY.length} services; commands by call, json and cdr are answered, refusals with their reasons`);
}
process.exit(0);
