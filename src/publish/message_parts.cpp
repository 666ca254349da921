#include "publish/message_parts.h"

#include "publish/messages.h"

namespace wirepose {

std_msgs_msg_dds__Header_ RosHeader(std::chrono::nanoseconds stamp, std::string_view frame_id) {
  const auto seconds =
      std::chrono::floor<std::chrono::seconds>(stamp);  // nanosec counts forward from sec, also before 0
  std_msgs_msg_dds__Header_ header{};
  header.stamp.sec = static_cast<std::int32_t>(seconds.count());
  header.stamp.nanosec = static_cast<std::uint32_t>((stamp - seconds).count());
  CopyText(frame_id, header.frame_id);
  return header;
}

void FillMessage(const ImageReport& image, std::string_view frame_id, sensor_msgs_msg_dds__Image_& message) {
  static_assert(kMaxPixels == 307200, "change the bound in dds_idl/sensor_msgs.idl too");
  message.header = RosHeader(image.stamp, frame_id);
  message.height = static_cast<std::uint32_t>(image.height);
  message.width = message.step = static_cast<std::uint32_t>(image.width);
  CopyText("mono8", message.encoding);
  message.is_bigendian = 0;
  const std::uint32_t size = message.width * message.height;
  // The C types of IDL know no const; writing does not change the pixels.
  message.data = {size, size, const_cast<std::uint8_t*>(image.pixels.data()), false};
}

geometry_msgs_msg_dds__Pose_ RosPose(const Pose& T) {
  const std::array<double, 4> q = QuaternionOf(T.R);
  return {{T.t.x(), T.t.y(), T.t.z()}, {q[0], q[1], q[2], q[3]}};
}

}  // namespace wirepose
