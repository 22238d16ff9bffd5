// @mcap/core reads the recording of a recorder that was killed, as a stream with its CRC checks, up to shortly before.
// usage: node killed.mjs RECORDING KILLED_AT_MS
import { readFileSync } from "node:fs";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import zstd from "@foxglove/wasm-zstd";
import { McapStreamReader } from "@mcap/core";
import { check } from "./observer.mjs";

const [file, killedAt] = process.argv.slice(2);
await zstd.isLoaded;
const stream = new McapStreamReader({
  validateCrcs: true,
  decompressHandlers: { zstd: (buffer, size) => zstd.decompress(buffer, Number(size)) },
});
stream.append(readFileSync(file));
const readers = new Map(), channels = new Map(), topics = new Set();
let messages = 0, last = 0n;
for (let record; (record = stream.nextRecord()); ) {
  if (record.type === "Schema") {
    readers.set(record.id, new MessageReader(parse(new TextDecoder().decode(record.data), { ros2: true })));
  }
  if (record.type === "Channel") channels.set(record.id, record);
  if (record.type !== "Message") continue;
  const channel = channels.get(record.channelId);
  readers.get(channel.schemaId).readMessage(record.data);
  topics.add(channel.topic);
  last = record.logTime > last ? record.logTime : last;
  ++messages;
}
check(!stream.done(), "the file has an end: the recorder was not killed");
check(topics.has("/depth/points") && topics.has("/map/updates"), `no clouds or map among ${[...topics]}`);
const lost = (Number(killedAt) - Number(last / 1_000_000n)) / 1e3;
check(lost < 1.5, `the last message is from ${lost} s before the kill`);
console.log(`recording: ${messages} messages of ${topics.size} topics read after a kill, to ${lost.toFixed(2)} s before it`);
