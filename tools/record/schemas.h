// The definitions of all topics' types, as recordings carry them.
#ifndef WIREPOSE_TOOLS_RECORD_SCHEMAS_H_
#define WIREPOSE_TOOLS_RECORD_SCHEMAS_H_

#include "publish/bus.h"
#include "record/mcap_writer.h"

namespace wirepose::record {

// The channel of a topic: ROS 2 topics under their ROS name (`rt/` off, `/` before) with their .msg definitions, others
// under their DDS name with the IDL.
McapChannel ChannelOf(TopicId topic, const std::string& name);

}  // namespace wirepose::record

#endif  // WIREPOSE_TOOLS_RECORD_SCHEMAS_H_
