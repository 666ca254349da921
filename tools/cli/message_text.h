// DDS messages for people and for programs.
#ifndef WIREPOSE_TOOLS_CLI_MESSAGE_TEXT_H_
#define WIREPOSE_TOOLS_CLI_MESSAGE_TEXT_H_

#include <nlohmann/json.hpp>
#include <string>

#include "dds_idl/vision_msgs.h"
#include "dds_idl/wirepose.h"

namespace wirepose::cli {

// Lower case: "running".
const char* StateName(wirepose_HealthState state);

// Several lines, the last one ended.
std::string ToText(const vision_msgs_msg_dds__Detection3DArray_& message);
std::string ToText(const wirepose_Recognition& message);
std::string ToText(const wirepose_Health& message);

// The fields under the names of the IDL; sequences and arrays as arrays, enumerations as lower-case
// words.
nlohmann::ordered_json ToJson(const vision_msgs_msg_dds__Detection3DArray_& message);
nlohmann::ordered_json ToJson(const wirepose_Recognition& message);
nlohmann::ordered_json ToJson(const wirepose_Health& message);

}  // namespace wirepose::cli

#endif  // WIREPOSE_TOOLS_CLI_MESSAGE_TEXT_H_
