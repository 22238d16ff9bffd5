// Compares recordings and schemas of ours with those of other implementations.
// usage: node check.js RECORDING_EXAMPLE
const assert = require("node:assert/strict");
const { execFileSync } = require("node:child_process");
const fs = require("node:fs");
const os = require("node:os");
const path = require("node:path");
const { parse } = require("@foxglove/rosmsg");
const { ros2humble } = require("@foxglove/rosmsg-msgs-common");
const { MessageReader, MessageWriter } = require("@foxglove/rosmsg2-serialization");
const lz4 = require("@foxglove/wasm-lz4").default ?? require("@foxglove/wasm-lz4");
const zstd = require("@foxglove/wasm-zstd");
const { McapIndexedReader, McapStreamReader, McapWriter } = require("@mcap/core");

const program = process.argv[2];
const folder = fs.mkdtempSync(path.join(os.tmpdir(), "recordings-"));
const ours = (...args) => execFileSync(program, args, { encoding: "utf8", maxBuffer: 1 << 28 });
const oursOf = (input, ...args) => execFileSync(program, args, { input, encoding: "utf8", maxBuffer: 1 << 28 });

// Its constants are not on the wire, and bounds do not show there.
const fieldsOf = (definition) =>
  definition.definitions
    .filter((field) => field.isConstant !== true)
    .map(({ name, type, isArray, arrayLength }) => ({ name, type: type.replace("/msg/", "/"), isArray, arrayLength }));

// Any message of ROS 2's packages is understood: the definitions are those of ROS 2, and what another implementation
// writes by its own definition is decoded and encoded to the same octets.
function checkStandardTypes() {
  const types = Object.keys(ros2humble).filter(
    (name) => !name.startsWith("test_msgs/") && (fieldsOf(ros2humble[name]).length > 0 || name === "std_msgs/Empty"));
  const definitions = JSON.parse(oursOf(types.join("\n"), "definitions"));
  const messages = {};
  for (const type of types) {
    assert.ok(definitions[type] !== "", `${type} is not defined`);
    const [root] = parse(definitions[type], { ros2: true });
    const times = { time: "builtin_interfaces/Time", duration: "builtin_interfaces/Duration" };
    if (type !== "std_msgs/Empty" && !type.startsWith("builtin_interfaces/")) {
      assert.deepEqual(fieldsOf(root).map((field) => ({ ...field, type: times[field.type] ?? field.type })),
        fieldsOf(ros2humble[type]).map((field) => ({ ...field, type: times[field.type] ?? field.type })), type);
    }
    const all = [{ ...ros2humble[type], name: undefined }, ...Object.values(ros2humble)];
    if (type === "std_msgs/Empty") continue;  // this writer leaves out the octet that ROS 2 sends
    messages[type] = [...new MessageWriter(all).writeMessage(exampleOf(ros2humble[type]))];
  }
  const again = JSON.parse(oursOf(JSON.stringify(messages), "recode"));
  for (const type of Object.keys(messages)) assert.deepEqual(again[type], messages[type], type);
  return `${types.length} standard types defined as in ROS 2, ${Object.keys(messages).length} decoded and encoded again`;
}

let counter = 0;
function exampleOf(definition) {
  const one = (type) => {
    ++counter;
    if (type === "time" || type === "duration") return { sec: counter, nanosec: counter };
    if (type === "string") return "text".repeat(counter % 4);
    if (type === "bool") return counter % 2 === 0;
    if (type === "int64" || type === "uint64") return BigInt(counter);
    if (/^u?int|^float|^byte$|^char$/.test(type)) return counter % 100;
    return exampleOf(ros2humble[type.replace("/msg/", "/")]);
  };
  const message = {};
  for (const { name, type, isArray, arrayLength } of fieldsOf(definition)) {
    message[name] = isArray ? Array.from({ length: arrayLength ?? counter % 4 }, () => one(type)) : one(type);
  }
  return message;
}

// Standard types have the fields of ROS 2 in their order; constants and comments may differ.
function checkSchemas() {
  const schemas = JSON.parse(ours("schemas"));
  let compared = 0;
  for (const [type, text] of Object.entries(schemas)) {
    const definitions = parse(text, { ros2: true });
    for (const definition of definitions) {
      const name = (definition.name ?? type).replace("/msg/", "/");
      const standard = ros2humble[name];
      assert.ok(standard != undefined || /^(thalweg_msgs|octomap_msgs|builtin_interfaces)\//.test(name), `${name} is unknown`);
      if (standard == undefined || name.startsWith("builtin_interfaces/")) continue;
      assert.deepEqual(fieldsOf(definition), fieldsOf(standard), name);
      ++compared;
    }
  }
  assert.ok(compared > 30, `only ${compared} definitions compared`);
  return `${Object.keys(schemas).length} schemas parsed, ${compared} definitions equal to those of ROS 2`;
}

const decompressHandlers = {
  zstd: (data, size) => zstd.decompress(data, Number(size)),
  lz4: (data, size) => lz4(data, Number(size)),
};

class Source {
  constructor(bytes) { this.bytes = bytes; }
  async size() { return BigInt(this.bytes.length); }
  async read(offset, size) { return this.bytes.subarray(Number(offset), Number(offset + size)); }
}

function checkMessage(k, decoded, message) {
  const time = 1_700_000_000_000_000_000n + 10_000_000n * BigInt(k);
  assert.equal(message.logTime, time);
  assert.equal(message.publishTime, time);
  assert.equal(message.sequence, Math.floor(k / 2));
  if (k % 2 === 0) {
    assert.equal(decoded.header.frame_id, "odom");
    assert.equal(decoded.pose.pose.position.x, 0.5 * k);
    assert.equal(decoded.pose.pose.orientation.w, 1);
    assert.equal(decoded.twist.twist.linear.x, 0.25 * k);
    assert.equal(decoded.pose.covariance.length, 36);
  } else {
    assert.equal(decoded.strategy, "flow");
    assert.equal(decoded.state, 3);
    assert.equal(decoded.plans, k);
    assert.equal(decoded.distance_m, 0.125 * k);
    assert.deepEqual(decoded.set_aside.map((aside) => aside.voxels), [k, k]);
    assert.equal(decoded.set_aside[1].reason, 7);
    assert.ok(Number.isInteger(decoded.header.stamp.nanosec ?? decoded.header.stamp.nsec));
  }
}

// @mcap/core reads ours, by index and as a stream, and every message is decoded by its schema.
async function checkOurs(compression) {
  const file = path.join(folder, `ours-${compression}.mcap`);
  ours("write", file, compression);
  const bytes = fs.readFileSync(file);
  const decoders = new Map();
  const decode = (schema, message) => {
    if (!decoders.has(schema.name)) {
      assert.equal(schema.encoding, "ros2msg");
      decoders.set(schema.name, new MessageReader(parse(new TextDecoder().decode(schema.data), { ros2: true })));
    }
    return decoders.get(schema.name).readMessage(message.data);
  };

  const indexed = await McapIndexedReader.Initialize({ readable: new Source(bytes), decompressHandlers });
  assert.equal(indexed.header.profile, "ros2");
  assert.equal(indexed.statistics.messageCount, 300n);
  assert.ok(indexed.chunkIndexes.length > 5);
  let k = 0;
  for await (const message of indexed.readMessages({ validateCrcs: true })) {
    const channel = indexed.channelsById.get(message.channelId);
    checkMessage(k++, decode(indexed.schemasById.get(channel.schemaId), message), message);
  }
  assert.equal(k, 300);
  const begin = 1_700_000_000_000_000_000n;
  let some = 0;
  for await (const message of indexed.readMessages({ startTime: begin + 1_000_000_000n, topics: ["/odometry"] })) {
    assert.ok(message.logTime >= begin + 1_000_000_000n);
    ++some;
  }
  assert.equal(some, 100);
  for await (const metadata of indexed.readMetadata()) assert.equal(metadata.metadata.get("name"), "kitchen");

  for (const cut of [bytes.length, Math.floor(bytes.length / 2)]) {
    const stream = new McapStreamReader({ includeChunks: false, decompressHandlers, validateCrcs: true });
    stream.append(bytes.subarray(0, cut));
    const schemas = new Map();
    const channels = new Map();
    let streamed = 0;
    for (let record; (record = stream.nextRecord()); ) {
      if (record.type === "Schema") schemas.set(record.id, record);
      if (record.type === "Channel") channels.set(record.id, record);
      if (record.type === "Message") {
        checkMessage(streamed++, decode(schemas.get(channels.get(record.channelId).schemaId), record), record);
      }
    }
    if (cut === bytes.length) {
      assert.ok(stream.done());
      assert.equal(streamed, 300);
    } else {
      assert.ok(streamed > 50 && streamed < 300, `${streamed} of a cut file`);
    }
  }
  return `ours by ${compression}: read by @mcap/core by index and as a stream, also cut in half`;
}

// Ours reads what @mcap/core writes, with and without chunks.
async function checkTheirs(name, options) {
  const parts = [];
  let position = 0n;
  const writable = {
    position: () => position,
    write: async (buffer) => { parts.push(Buffer.from(buffer)); position += BigInt(buffer.byteLength); },
  };
  const writer = new McapWriter({ writable, chunkSize: 2000, ...options });
  await writer.start({ profile: "ros2", library: "@mcap/core" });
  const schemaId = await writer.registerSchema({ name: "a/msg/A", encoding: "ros2msg", data: new TextEncoder().encode("uint32 n") });
  const topics = ["/a", "/b"];
  const channelIds = [];
  for (const topic of topics) {
    channelIds.push(await writer.registerChannel({ schemaId, topic, messageEncoding: "cdr", metadata: new Map() }));
  }
  const expected = [];
  for (let k = 0; k < 200; ++k) {
    const data = new Uint8Array(5 + (k * 37) % 90).map((_, i) => (i * k) % 7);
    const logTime = 5_000_000_000n + BigInt(k) * 1000n;
    await writer.addMessage({ channelId: channelIds[k % 2], sequence: k, logTime, publishTime: logTime - 7n, data });
    expected.push({ topic: topics[k % 2], type: "a/msg/A", sequence: k, log: String(logTime), publish: String(logTime - 7n),
                    size: data.length, crc: crc32(data) });
  }
  await writer.end();
  const file = path.join(folder, `theirs-${name}.mcap`);
  fs.writeFileSync(file, Buffer.concat(parts));
  const lines = ours("print", file).trim().split("\n").map((line) => JSON.parse(line));
  const end = lines.pop();
  assert.deepEqual(end.problems, []);
  assert.deepEqual(lines, expected);
  return `theirs, ${name}: read by ours${end.summary ? " by its summary" : " by a scan"}`;
}

// Ours plays what @mcap/core writes: a reader on the bus decodes what was encoded here.
async function checkPlayed() {
  const type = "thalweg_msgs/msg/MapRequest";
  const schema = JSON.parse(ours("schemas"))[type];
  const encoder = new MessageWriter(parse(schema, { ros2: true }));
  const parts = [];
  let position = 0n;
  const writer = new McapWriter({ chunkSize: 300, writable: {
    position: () => position,
    write: async (buffer) => { parts.push(Buffer.from(buffer)); position += BigInt(buffer.byteLength); },
  } });
  await writer.start({ profile: "ros2", library: "@mcap/core" });
  const schemaId = await writer.registerSchema({ name: type, encoding: "ros2msg", data: new TextEncoder().encode(schema) });
  const channelId = await writer.registerChannel({ schemaId, topic: "/map/requests", messageEncoding: "cdr", metadata: new Map() });
  const expected = [];
  for (let k = 0; k < 50; ++k) {
    const message = { header: { stamp: { sec: k, nanosec: 7 }, frame_id: "map" }, reader: `reader ${k}`, session: 1n, number: BigInt(k) << 40n,
      reason: "x".repeat(k) };
    const logTime = 5_000_000_000n + BigInt(k) * 2_000_000n;
    await writer.addMessage({ channelId, sequence: k, logTime, publishTime: logTime, data: encoder.writeMessage(message) });
    expected.push({ frame: "map", reader: message.reader, number: Number(message.number), reason: message.reason });
  }
  await writer.end();
  const file = path.join(folder, "played.mcap");
  fs.writeFileSync(file, Buffer.concat(parts));
  const lines = ours("play", file).trim().split("\n").map((line) => JSON.parse(line));
  assert.deepEqual(lines, expected);
  return `theirs: ${lines.length} messages played by ours and decoded by a reader on the bus`;
}

function crc32(data) {
  let crc = ~0;
  for (const byte of data) {
    crc ^= byte;
    for (let bit = 0; bit < 8; ++bit) crc = (crc >>> 1) ^ (crc & 1 ? 0xedb88320 : 0);
  }
  return ~crc >>> 0;
}

async function main() {
  await zstd.isLoaded;
  await lz4.isLoaded;
  console.log(checkSchemas());
  console.log(checkStandardTypes());
  for (const compression of ["none", "lz4", "zstd"]) console.log(await checkOurs(compression));
  const compressChunk = (data) => ({ compression: "zstd", compressedData: zstd.compress(data, 3) });
  console.log(await checkTheirs("zstd chunks", { compressChunk }));
  console.log(await checkTheirs("plain chunks", {}));
  console.log(await checkTheirs("no chunks", { useChunks: false }));
  console.log(await checkTheirs("no indexes", { useMessageIndex: false, useChunkIndex: false }));
  console.log(await checkPlayed());
  fs.rmSync(folder, { recursive: true });
}
main().catch((error) => {
  console.error(error);
  process.exitCode = 1;
});
