// What the messages have in common. For the sources of this room.
#ifndef WIREPOSE_PUBLISH_MESSAGE_PARTS_H_
#define WIREPOSE_PUBLISH_MESSAGE_PARTS_H_

#include <algorithm>
#include <chrono>
#include <string_view>

#include "dds_idl/ros_common.h"
#include "geometry/se3.h"
#include "publish/fixed_text.h"

namespace wirepose {

// Gives a DDS sequence a buffer that stays ours.
template <typename Sequence, typename Buffer>
void Attach(Sequence& sequence, Buffer& buffer) {
  sequence._maximum = static_cast<std::uint32_t>(buffer.size());
  sequence._length = 0;
  sequence._buffer = buffer.data();
  sequence._release = false;
}

// Cuts at the end of a whole character.
template <std::size_t kSize>
void CopyText(std::string_view text, char (&out)[kSize]) {
  const FixedText<kSize> cut(text);
  std::copy_n(cut.c_str(), kSize, out);
}

// `stamp` in nanoseconds since the Unix epoch, or whatever epoch the configuration chose.
std_msgs_msg_dds__Header_ RosHeader(std::chrono::nanoseconds stamp, std::string_view frame_id);

geometry_msgs_msg_dds__Pose_ RosPose(const Pose& T);

}  // namespace wirepose

#endif  // WIREPOSE_PUBLISH_MESSAGE_PARTS_H_
