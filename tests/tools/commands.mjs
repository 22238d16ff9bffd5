// A client steers a live run in every way that the gateway offers, and is refused where it must be.
import { MessageWriter } from "@foxglove/rosmsg2-serialization";
import { parse } from "@foxglove/rosmsg";
import { Observer, check, distance, truth } from "./observer.mjs";

const [address] = process.argv.slice(2);
const PAUSED = 5, DONE = 4, SET_ASIDE = 2, IGNORED = 6; // of thalweg_msgs
const START = { x: 1.5, y: 4.7, z: 1.2 }; // of the kitchen's robot
const TOPICS = ["/explorer/status", "/explorer/frontiers", "/simulator/status", "/health"];
const EVERY = ["pause", "resume", "step", "stop", "home", "goto", "look_at", "ignore", "no_go", "clear_no_go", "strategy", "save_map"];

/** Calls a service that the explorer must accept; a second after the call before, since no more than 5 a second are taken. */
async function accepted(observer, name, request = {}) {
  await observer.until("a second", (topic, { service }) => topic === "/health" && service === "simulator");
  const answer = await observer.call(name, request);
  check(answer.accepted && answer.service === "explorer", `${name}: ${JSON.stringify(answer)}`);
}
const isPaused = ({ state }) => state === PAUSED;

/** What each command of a robot that is paused brings about; it is paused again at the end. */
async function carriesOutAll(observer) {
  const status = () => observer.last.get("/explorer/status");
  const { strategy } = status();
  /** One decision more, after which the frontiers are those of this moment. */
  const steps = async () => {
    const { plans } = status();
    await accepted(observer, "step");
    await observer.untilLast("a decision carried out", "/explorer/status", (its) => isPaused(its) && its.plans > plans);
  };
  await accepted(observer, "strategy", { strategy: "closest" });
  await observer.untilLast("the other strategy", "/explorer/status", (its) => its.strategy === "closest");
  await accepted(observer, "strategy", { strategy });
  await observer.untilLast("the first strategy", "/explorer/status", (its) => its.strategy === strategy);

  await steps();
  await accepted(observer, "goto", { point: START });
  await observer.untilLast("the robot at its goal", "/simulator/status", (its) => distance(truth(its), Object.values(START)) < 0.25);
  await observer.untilLast("the pause there", "/explorer/status", isPaused);

  const isNear = ({ center: { x, y, z } }, { center }) => Math.hypot(x - center.x, y - center.y, z - center.z) < 0.5;
  const frontier = observer.last.get("/explorer/frontiers").frontiers.find(({ fate }) => fate !== SET_ASIDE);
  await accepted(observer, "look_at", { point: frontier.center });
  await observer.until("a second", (topic, { service }) => topic === "/health" && service === "simulator");
  await observer.untilLast("the pause after the look", "/explorer/status", isPaused);

  await steps();
  const ignored = observer.last.get("/explorer/frontiers").frontiers.find(({ fate }) => fate === 0);
  check(ignored, "the explorer has no frontier left to ignore");
  await accepted(observer, "ignore", { point: ignored.center });
  await steps();
  await observer.untilLast("the frontier set aside", "/explorer/frontiers",
    ({ frontiers }) => frontiers.some((its) => its.fate === SET_ASIDE && its.reason === IGNORED && isNear(its, ignored)));

  await accepted(observer, "no_go", { point: { x: 5.6, y: 4.6, z: 0 }, corner: { x: 6.6, y: 5.6, z: 2.5 } });
  await observer.untilLast("a box in force", "/explorer/status", ({ no_go }) => no_go.length === 1 && no_go[0].max.z === 2.5);
  await accepted(observer, "clear_no_go");
  await observer.untilLast("no box in force", "/explorer/status", ({ no_go }) => no_go.length === 0);
}

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
  await carriesOutAll(observer);

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
  observer.client.advertise({ topic: "/command/pose", encoding: "cdr", schemaName: "geometry_msgs/msg/PoseStamped" });
  await answer;

  // A flood is refused, counted, and stops nobody else.
  const other = await Observer.connect(address, [], subprotocol);
  const flood = await Promise.all(Array.from({ length: 60 }, () => observer.call("pause")));
  check(flood.some(({ reason }) => reason.includes("more than 5 commands a second") || reason.includes("wait for their answers")), "a flood passes");
  check((await other.call("resume")).accepted, "another client is held up by the flood");
  await observer.untilLast("the flood in the gateway's health", "/health",
    ({ service, rejected }) => service === "gateway" && rejected.some(({ name }) => name.startsWith("viewers' commands")));
  other.close();
  if (subprotocol === "foxglove.sdk.v1") { // which is the last; home is the page's
    await accepted(observer, "stop");
    await observer.untilLast("the end", "/explorer/status", ({ state, stop_reason: why }) => state === DONE && why === "ended by the operator");
  }
  observer.close();
  console.log(`${subprotocol}: ${EVERY.length} services; commands by call, json and cdr are answered, refusals with their reasons`);
}
process.exit(0);
