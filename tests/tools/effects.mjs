// What each command of an operator brings about, as a client of the gateway sees it: of a robot that has begun to explore.
import { DONE, IGNORED, PAUSED, SET_ASIDE, heardSeconds } from "./live_page.mjs";
import { Observer, check, distance, placeIn, truth } from "./observer.mjs";

const [address] = process.argv.slice(2);
const OUTCOME_OPERATOR = 9, CHOSEN = 1; // of thalweg_msgs
const observer = await Observer.connect(address, ["/explorer/status", "/explorer/frontiers", "/simulator/status", "/health"]);
const latest = (topic) => observer.last.get(topic);
const explorer = () => latest("/explorer/status");
const position = () => truth(latest("/simulator/status"));
const isPaused = ({ state }) => state === PAUSED;
const point = ([x, y, z]) => ({ x, y, z });

/** Waits for a message of the topic that comes after this moment and satisfies the condition. */
const next = (what, topic, condition) => observer.until(what, (its, message) => its === topic && condition(message));

/** Calls a service that the explorer must accept. Commands come a second apart, since more than 5 a second are refused. */
async function order(name, request = {}) {
  await heardSeconds(observer, 1);
  const answer = await observer.call(name, request);
  check(answer.accepted && answer.service === "explorer", `${name} ${JSON.stringify(request)}: ${JSON.stringify(answer)}`);
  return answer.reason;
}
/** One decision, carried out; then the frontiers are those of that decision. */
async function step() {
  const { plans } = explorer();
  await order("step");
  await next("a decision carried out", "/explorer/status", (its) => isPaused(its) && its.plans > plans);
}

// Where the robot has been it can return, so this goal is accepted.
await observer.untilLast("a position", "/simulator/status", () => true);
const start = position();
await observer.untilLast("the robot on its way", "/simulator/status", (its) => distance(truth(its), start) > 1);
await order("pause");
await observer.untilLast("the pause", "/explorer/status", isPaused);
await heardSeconds(observer, 1);
const stopped = position();
await heardSeconds(observer, 1);
check(distance(position(), stopped) < 0.02, `a paused robot moves from ${stopped} to ${position()}`);

const { strategy } = explorer();
await order("strategy", { strategy: "closest" });
await observer.untilLast("the other strategy", "/explorer/status", (its) => its.strategy === "closest");
await order("strategy", { strategy });
await observer.untilLast("the first strategy", "/explorer/status", (its) => its.strategy === strategy);

await order("goto", { point: point(start) });
await observer.untilLast("the robot at its goal", "/simulator/status", (its) => distance(truth(its), start) < 0.25);
await observer.untilLast("the pause there", "/explorer/status", isPaused);

await step();
const left = () => latest("/explorer/frontiers").frontiers.filter(({ fate }) => fate !== SET_ASIDE);
const looked = left().find(({ fate }) => fate === CHOSEN) ?? left()[0];
check(looked, "no frontier is left to look at");
await order("look_at", { point: looked.center });
/** [rad] From the robot's heading to the direction of a point, in the horizontal. */
const bearing = ({ map_from_body_true: { position: p, orientation: q } }, { x, y }) => {
  const yaw = Math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z));
  const off = Math.atan2(y - p.y, x - p.x) - yaw;
  return Math.atan2(Math.sin(off), Math.cos(off));
};
await next("the robot facing what it looks at", "/simulator/status", (its) => Math.abs(bearing(its, looked.center)) < 0.5);
await observer.untilLast("the pause after the look", "/explorer/status", isPaused);

await step();
const ignored = left()[0];
check(ignored, "no frontier is left to ignore");
const center = placeIn(await order("ignore", { point: ignored.center }));
await step();
await observer.untilLast("the frontier set aside", "/explorer/frontiers",
  ({ frontiers }) => frontiers.some((its) => its.fate === SET_ASIDE && its.reason === IGNORED && distance(Object.values(its.center), center) < 0.5));

await order("no_go", { point: { x: 5.6, y: 4.6, z: 0 }, corner: { x: 6.6, y: 5.6, z: 2.5 } });
await observer.untilLast("a box in force", "/explorer/status", ({ no_go }) => no_go.length === 1 && no_go[0].max.z === 2.5);
await order("clear_no_go");
await observer.untilLast("no box in force", "/explorer/status", ({ no_go }) => no_go.length === 0);

await order("resume");
await observer.untilLast("the robot exploring", "/explorer/status", ({ state }) => state !== PAUSED);
await observer.untilLast("the robot far from its start", "/simulator/status", (its) => distance(truth(its), start) > 1);
await order("home");
await observer.untilLast("the robot at its start", "/simulator/status", (its) => distance(truth(its), start) < 0.3);
await observer.untilLast("the end", "/explorer/status", ({ state, outcome }) => state === DONE && outcome === OUTCOME_OPERATOR);
console.log("effects: pause, strategy, goto, step, look_at, ignore, no_go, clear_no_go, resume and home do what they say");
process.exit(0);
