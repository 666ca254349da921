// Official ROS 2 message definitions: those of the common packages from @foxglove/rosmsg-msgs-common, vision_msgs, which
// it does not have, from vision_msgs.mjs.
import common from "@foxglove/rosmsg-msgs-common";
import { visionMsgs } from "./vision_msgs.mjs";

const integers = [{ type: "int32", name: "sec" }, { type: "uint32", name: "nanosec" }];
const all = {
  ...common.ros2humble,
  ...Object.fromEntries(visionMsgs().map((definition) => [definition.name, definition])),
  // Built into the readers under names of their own.
  "builtin_interfaces/Time": { definitions: integers },
  "builtin_interfaces/Duration": { definitions: integers },
};

export function definitionOf(type) {
  if (all[type] === undefined) throw new Error(`no definition of ${type}`);
  return all[type];
}

// The definition of a type and of all it holds, the type itself first and without name, as readers and writers want it.
export function definitionsOf(type) {
  const found = new Map();
  const visit = (name) => {
    if (found.has(name)) return;
    found.set(name, definitionOf(name));
    for (const field of definitionOf(name).definitions) if (field.isComplex) visit(field.type);
  };
  visit(type);
  return [...found.values()].map((definition, i) => (i === 0 ? { definitions: definition.definitions } : definition));
}
