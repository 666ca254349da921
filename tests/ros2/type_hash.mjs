// ROS 2 type hashes (REP-2016, RIHS01) from the official definitions. Usage: node type_hash.mjs
// Prints "TYPE HASH" for each type that is published, after having checked itself on hashes that ROS 2 generated.
import { createHash } from "node:crypto";
import { definitionOf } from "./ros_types.mjs";

// Of type_description_interfaces/msg/FieldType.
const typeIds = { int8: 2, uint8: 3, int16: 4, uint16: 5, int32: 6, uint32: 7, int64: 8, uint64: 9, float32: 10,
                  float64: 11, char: 13, bool: 15, byte: 16, string: 17 };
const nested = 1, array = 48, unboundedSequence = 144;
// What the definitions' package calls by a name of its own.
const builtin = { time: "builtin_interfaces/Time", duration: "builtin_interfaces/Duration" };
// Fields whose type it has changed: `byte` has become uint8.
const bytes = new Set(["diagnostic_msgs/DiagnosticStatus.level"]);

const fullName = (type) => type.replace("/", "/msg/");

function fieldOf(type, field) {
  const inner = builtin[field.type] ?? (field.isComplex ? field.type : undefined);
  let id = inner ? nested : bytes.has(`${type}.${field.name}`) ? typeIds.byte : typeIds[field.type];
  if (id === undefined) throw new Error(`${type}.${field.name}: unknown type ${field.type}`);
  if (field.isArray) id += field.arrayLength === undefined ? unboundedSequence : array;
  return { name: field.name,
           type: { type_id: id, capacity: field.arrayLength ?? 0, string_capacity: 0,
                   nested_type_name: inner ? fullName(inner) : "" } };
}

function descriptionOf(type) {
  const fields = definitionOf(type).definitions.filter((field) => !field.isConstant);
  return { type_name: fullName(type), fields: fields.map((field) => fieldOf(type, field)) };
}

function referencedBy(type, found = new Set()) {
  for (const field of definitionOf(type).definitions) {
    const inner = builtin[field.type] ?? (field.isComplex ? field.type : undefined);
    if (inner === undefined || found.has(inner)) continue;
    found.add(inner);
    referencedBy(inner, found);
  }
  return found;
}

// As Python's json.dumps writes it: a blank after each comma and colon.
function canonical(value) {
  if (Array.isArray(value)) return `[${value.map(canonical).join(", ")}]`;
  if (typeof value === "object") {
    return `{${Object.entries(value).map(([key, v]) => `${JSON.stringify(key)}: ${canonical(v)}`).join(", ")}}`;
  }
  return JSON.stringify(value);
}

export function typeHash(type) {
  const referenced = [...referencedBy(type)].map(descriptionOf);
  referenced.sort((a, b) => (a.type_name < b.type_name ? -1 : 1));
  const text = canonical({ type_description: descriptionOf(type), referenced_type_descriptions: referenced });
  return `RIHS01_${createHash("sha256").update(text).digest("hex")}`;
}

// As they stand in ROS 2's own generated code.
const known = {
  "std_msgs/String": "df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18",
  "std_msgs/Header": "f49fb3ae2cf070f793645ff749683ac6b06203e41c891e17701b1cb597ce6a01",
  "builtin_interfaces/Time": "b106235e25a4c5ed35098aa0a61a3ee9c9b18d197f398b0e4206cea9acf9c197",
  "geometry_msgs/Point": "6963084842a9b04494d6b2941d11444708d892da2f4b09843b9c43f42a7f6881",
};
for (const [type, hash] of Object.entries(known)) {
  if (typeHash(type) !== `RIHS01_${hash}`) {
    console.error(`${type}: ${typeHash(type)}, but ROS 2 says RIHS01_${hash}`);
    process.exit(1);
  }
}
for (const type of ["vision_msgs/Detection3DArray", "visualization_msgs/MarkerArray", "diagnostic_msgs/DiagnosticArray"]) {
  console.log(`${type} ${typeHash(type)}`);
}
