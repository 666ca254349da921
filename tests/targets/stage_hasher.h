// Hashes what each stage of a frame left behind.
#ifndef WIREPOSE_TESTS_TARGETS_STAGE_HASHER_H_
#define WIREPOSE_TESTS_TARGETS_STAGE_HASHER_H_

#include <array>

#include "pipeline/recognizer.h"
#include "tests/targets/digest.h"

namespace wirepose::testing {

// Give it to Process as observer. Stages that run once a model are hashed over all models in turn.
// kRefine has no hash of its own: kVerify hashes the refined poses with their evidence. Nor has kSelect, whose output
// is the result.
class StageHasher final : public StageObserver {
 public:
  explicit StageHasher(const Recognizer& recognizer) : recognizer_(recognizer) {}

  void FrameBegins() { digests_ = {}; }
  [[nodiscard]] std::uint64_t Hash(Stage stage) const { return digests_[static_cast<std::size_t>(stage)].value(); }

 private:
  void DoStageDone(Stage stage) override;
  void HashMatches(Digest& digest) const;
  void HashHypotheses(Digest& digest) const;
  void HashCandidates(Digest& digest) const;

  const Recognizer& recognizer_;
  std::array<Digest, kStageCount> digests_;
};

}  // namespace wirepose::testing

#endif  // WIREPOSE_TESTS_TARGETS_STAGE_HASHER_H_
