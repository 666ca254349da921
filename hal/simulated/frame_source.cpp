#include "hal/simulated/frame_source.h"

#include <utility>

#include "sim/random.h"

namespace wirepose::hal {

Result<const CachedFrame*, std::string> FrameSource::Make(std::uint64_t sequence, const FramePlan& plan) {
  if (plan.repeats_last && !last_.images.left.pixels.empty()) return &last_;
  StereoImages before;
  if (!plan.image_faults.empty()) before = last_.images;
  Result<CachedFrame, std::string> made = FromMemory(sequence, plan.change);
  if (!made) return unexpected(made.error());
  last_ = *std::move(made);
  ApplyImageFaults(plan.image_faults, sim::Mix(spec_.seed, sequence), before, last_.images);
  return &last_;
}

// A frame that is changed is made for itself.
Result<CachedFrame, std::string> FrameSource::FromMemory(std::uint64_t sequence, const sim::ShotChange& change) {
  if (loop_.empty() || !(change == sim::ShotChange{})) return LoadOrShoot(sequence, change);
  std::optional<CachedFrame>& kept = loop_[sequence % loop_.size()];
  if (!kept) {
    Result<CachedFrame, std::string> made = LoadOrShoot(sequence % loop_.size(), change);
    if (!made) return made;
    kept = *std::move(made);
  }
  return *kept;
}

Result<CachedFrame, std::string> FrameSource::LoadOrShoot(std::uint64_t sequence, const sim::ShotChange& change) {
  const bool may_keep = cache_.has_value() && change == sim::ShotChange{};
  if (may_keep) {
    if (std::optional<CachedFrame> kept = cache_->Load(sequence)) return *std::move(kept);
  }
  sim::StereoShot shot = video_.Shoot(sequence, change);
  CachedFrame frame{{std::move(shot.left), std::move(shot.right)}, {}};
  for (const sim::ObjectTruth& object : shot.truth.objects) {
    frame.objects.push_back({object.obj_id, object.name, object.T_camera_object, object.visib_fract});
  }
  if (may_keep) {
    if (const Result<void, std::string> stored = cache_->Store(sequence, frame); !stored)
      return unexpected(stored.error());
  }
  return frame;
}

}  // namespace wirepose::hal
