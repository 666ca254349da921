#include "publish/message_parts.h"

#include "publish/messages.h"

namespace wirepose {

std_msgs_msg_dds__Header_ RosHeader(std::chrono::nanoseconds stamp, std::string_view frame_id) {
  const auto seconds = std::chrono::floor<std::chrono::seconds>(stamp);  // nanosec counts forward from sec, also before 0
  std_msgs_msg_dds__Header_ header{};
  header.stamp.sec = static_cast<std::int32_t>(seconds.count());
  header.stamp.nanosec = static_cast<std::uint32_t>((stamp - seconds).count());
  CopyText(frame_id, header.frame_id);
  return header;
}

geometry_msgs_msg_dds__Pose_ RosPose(const Pose& T) {
  const std::array<double, 4> q = QuaternionOf(T.R);
  return {{T.t.x(), T.t.y(), T.t.z()}, {q[0], q[1], q[2], q[3]}};
}

}  // namespace wirepose
