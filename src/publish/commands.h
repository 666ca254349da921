// What others may ask of the running program, and its answer. Plain data, no DDS.
#ifndef WIREPOSE_PUBLISH_COMMANDS_H_
#define WIREPOSE_PUBLISH_COMMANDS_H_

#include <cstdint>

#include "base/fixed_vector.h"
#include "capacities.h"
#include "pipeline/recognizer.h"
#include "publish/fixed_text.h"

namespace wirepose {

// As on the wire: any number may arrive, only these are accepted.
enum class CommandAction : std::uint8_t {
  kSelectModels = 1,
  kSetRegion = 2,
  kPause = 3,
  kResume = 4,
  kReloadModels = 5,
};

using ModelIds = FixedVector<std::uint32_t, kMaxModels>;

struct Command {
  FixedText<32> sender;
  std::uint64_t request_id = 0;
  CommandAction action{};
  ModelIds model_ids;  // kSelectModels; empty: all that are loaded
  ImageRegion region;  // kSetRegion
};

struct CommandAnswer {
  Command command;         // what was asked
  bool accepted = false;   // false: nothing has changed
  FixedText<256> reason;   // why not
  // What holds from now on.
  bool paused = false;
  ModelIds searched_ids;
  ImageRegion region;
};

}  // namespace wirepose

#endif  // WIREPOSE_PUBLISH_COMMANDS_H_
