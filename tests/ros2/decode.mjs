// Decodes raw CDR with a library that is not ours and compares it field by field with what was meant, then encodes it
// again and compares the bytes. Usage: node decode.mjs FOLDER
// FOLDER holds pairs N.cdr and N.json: {"type": "vision_msgs/Detection3DArray", "message": {...}}.
import fs from "node:fs";
import path from "node:path";
import { MessageReader, MessageWriter } from "@foxglove/rosmsg2-serialization";
import { definitionsOf } from "./ros_types.mjs";

const encapsulation = 4; // bytes before the payload

// Calls `differ` with the path of every field that is not the same or not on both sides.
function compare(expected, decoded, at, differ) {
  if (ArrayBuffer.isView(decoded)) decoded = [...decoded];
  if (typeof expected !== "object" || expected === null) {
    if (!Object.is(expected, decoded) && !(expected === 0 && decoded === 0)) differ(`${at}: ${decoded} instead of ${expected}`);
    return;
  }
  if (decoded === null || typeof decoded !== "object") return differ(`${at}: ${decoded} is no message`);
  const keys = new Set([...Object.keys(expected), ...Object.keys(decoded)]);
  for (const key of keys) {
    if (!(key in expected)) differ(`${at}.${key}: decoded, but not meant`);
    else if (!(key in decoded)) differ(`${at}.${key}: meant, but not decoded`);
    else compare(expected[key], decoded[key], `${at}.${key}`, differ);
  }
}

const folder = process.argv[2];
let messages = 0;
let failures = 0;
for (const file of fs.readdirSync(folder).filter((name) => name.endsWith(".cdr"))) {
  const bytes = fs.readFileSync(path.join(folder, file));
  const { type, message } = JSON.parse(fs.readFileSync(path.join(folder, file.replace(/cdr$/, "json"))));
  const fail = (text) => {
    failures += 1;
    if (failures < 20) console.error(`${file}: ${type}: ${text}`);
  };
  if (bytes[0] !== 0 || bytes[1] !== 1) fail("not plain little-endian CDR");
  const definitions = definitionsOf(type);
  const decoded = new MessageReader(definitions).readMessage(bytes);
  compare(message, decoded, "message", fail);
  const again = Buffer.from(new MessageWriter(definitions).writeMessage(decoded));
  const padding = bytes.length - again.length;
  if (padding < 0 || padding > 3) fail(`${again.length} bytes when encoded again, not ${bytes.length}`);
  if (!again.subarray(encapsulation).equals(bytes.subarray(encapsulation, again.length))) fail("other bytes when encoded again");
  messages += 1;
}
console.log(`${messages} messages decoded and encoded again, ${failures} differences`);
process.exit(failures === 0 && messages > 0 ? 0 : 1);
