// Reads a recording with MCAP's own library and decodes every message with what the file says about its type.
// Usage: node mcap_check.mjs FILE; prints one line of JSON.
import fs from "node:fs/promises";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import rosmsg from "@foxglove/rosmsg";
import rosSerialization from "@foxglove/rosmsg2-serialization";
import idl from "@foxglove/omgidl-parser";
import idlSerialization from "@foxglove/omgidl-serialization";
import { definitionsOf } from "./ros_types.mjs";

const bytes = new Uint8Array(await fs.readFile(process.argv[2]));
const readable = {
  size: async () => BigInt(bytes.length),
  read: async (offset, length) => bytes.subarray(Number(offset), Number(offset + length)),
};
const fail = (text) => {
  console.error(text);
  process.exit(1);
};

// Fields and types of definitions, without what only some parsers tell.
const shape = (definitions) =>
  JSON.stringify(definitions.map(({ name, definitions: fields }) => [
    name ?? "", fields.filter((f) => !f.isConstant).map((f) => [f.name, f.type, f.isArray ?? false, f.arrayLength ?? null]),
  ]).sort());

function readerOf(schema) {
  if (schema.encoding === "ros2msg") {
    const definitions = rosmsg.parse(new TextDecoder().decode(schema.data), { ros2: true });
    const official = definitionsOf(schema.name.replace("/msg/", "/"));
    const unnamed = (list, root) => list.map((d) => (d.name === root ? { ...d, name: undefined } : d));
    const ours = shape(unnamed(definitions, undefined)).replaceAll("/msg/", "/");
    if (ours !== shape(official)) fail(`${schema.name}: not the official definition\n${ours}\n${shape(official)}`);
    return { reader: new rosSerialization.MessageReader(definitions), writer: new rosSerialization.MessageWriter(definitions) };
  }
  if (schema.encoding !== "omgidl") fail(`${schema.name}: encoding ${schema.encoding}`);
  const definitions = idl.parseIDL(new TextDecoder().decode(schema.data));
  return { reader: new idlSerialization.MessageReader(schema.name, definitions) };
}

const file = await McapIndexedReader.Initialize({ readable });
if (file.chunkIndexes.length === 0) fail("no chunk index: viewers cannot seek");
if (Number(file.footer.summaryCrc) === 0) fail("no summary checksum");
const readers = new Map([...file.schemasById.values()].map((schema) => [schema.id, readerOf(schema)]));

const topics = {};
let last = 0n;
const times = [];
for await (const message of file.readMessages({ validateCrcs: true })) {
  const channel = file.channelsById.get(message.channelId);
  const { reader, writer } = readers.get(channel.schemaId);
  const decoded = reader.readMessage(message.data);
  if (writer) {
    const again = writer.writeMessage(decoded).subarray(4);
    if (Buffer.compare(Buffer.from(again), Buffer.from(message.data.subarray(4, 4 + again.length))) !== 0) fail(`${channel.topic}: other bytes`);
  }
  if (message.logTime < last) fail("messages out of order");
  last = message.logTime;
  times.push(message.logTime);
  const topic = (topics[channel.topic] ??= { schema: file.schemasById.get(channel.schemaId).name, messages: 0 });
  topic.messages += 1;
  if (decoded.frame_sequence !== undefined) topic.last_sequence = Number(decoded.frame_sequence);
  if (decoded.accepted !== undefined) topic.accepted = decoded.accepted;
  if (decoded.models !== undefined) topic.models = decoded.models.map((model) => model.name);
}

// Seeking: from the middle on there is exactly what comes after it.
const middle = times[Math.floor(times.length / 2)];
let after = 0;
for await (const message of file.readMessages({ startTime: middle })) after += message.logTime >= middle ? 1 : NaN;
if (after !== times.filter((time) => time >= middle).length) fail(`${after} messages after the middle`);

// Reading without the index, checksums on.
const stream = new McapStreamReader({ validateCrcs: true });
stream.append(bytes);
let streamed = 0;
for (let record; (record = stream.nextRecord()) !== undefined; ) streamed += record.type === "Message" ? 1 : 0;
if (!stream.done()) fail("the stream does not end");
if (streamed !== times.length || Number(file.statistics.messageCount) !== streamed) fail("the statistics are wrong");
console.log(JSON.stringify({ messages: streamed, chunks: file.chunkIndexes.length, topics }));
