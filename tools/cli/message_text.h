// DDS messages for people and for programs.
#ifndef WIREPOSE_TOOLS_CLI_MESSAGE_TEXT_H_
#define WIREPOSE_TOOLS_CLI_MESSAGE_TEXT_H_

#include <nlohmann/json.hpp>
#include <string>

#include "dds_idl/diagnostic_msgs.h"
#include "dds_idl/vision_msgs.h"
#include "dds_idl/wirepose.h"

namespace wirepose::cli {

// Lower case: "running".
const char* StateName(wirepose_HealthState state);
const char* StateName(wirepose_RowState state);
// Of a command, as on the command line: "select"; "unknown" for a number without meaning.
const char* ActionName(std::uint8_t action);

// One standard deviation of position [m] and rotation [deg], from a covariance in ROS's order.
double PositionSigma(const double (&covariance)[36]);
double RotationSigma_deg(const double (&covariance)[36]);

// Several lines, the last one ended.
std::string ToText(const vision_msgs_msg_dds__Detection3DArray_& message);
std::string ToText(const wirepose_Recognition& message);
std::string ToText(const wirepose_Health& message);
std::string ToText(const wirepose_CommandStatus& message);
std::string ToText(const diagnostic_msgs_msg_dds__DiagnosticArray_& message);

// The fields under the names of the IDL; sequences and arrays as arrays, enumerations as lower-case
// words.
nlohmann::ordered_json ToJson(const vision_msgs_msg_dds__Detection3DArray_& message);
nlohmann::ordered_json ToJson(const wirepose_Recognition& message);
nlohmann::ordered_json ToJson(const wirepose_Health& message);
nlohmann::ordered_json ToJson(const wirepose_CommandStatus& message);
nlohmann::ordered_json ToJson(const diagnostic_msgs_msg_dds__DiagnosticArray_& message);

}  // namespace wirepose::cli

#endif  // WIREPOSE_TOOLS_CLI_MESSAGE_TEXT_H_
