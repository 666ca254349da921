#include "hal/simulated/feed_faults.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/random.h"

namespace wirepose::hal {
namespace {

using sim::FaultKind;

bool IsActive(const sim::FaultSpec& fault, std::uint64_t sequence) {
  return sequence >= fault.at && (fault.kind == FaultKind::kClockStep || sequence - fault.at < fault.frames);
}

// The lower part of the frame before: the transfer was cut short.
void Tear(const dataset::GrayImage& last, dataset::GrayImage& image) {
  if (last.pixels.size() != image.pixels.size()) return;
  const auto cut = static_cast<std::ptrdiff_t>(image.height * 3 / 5) * image.width;
  std::copy(last.pixels.begin() + cut, last.pixels.end(), image.pixels.begin() + cut);
}

void FlipBits(double share, std::uint64_t seed, dataset::GrayImage& image) {
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const std::uint64_t h = sim::Mix(seed, i);
    if (double{sim::UnitFloat(h)} < share) image.pixels[i] ^= static_cast<std::uint8_t>(1U << (h & 7U));
  }
}

// Grease on the lens: blurred and brightened in a disc right of the middle.
void Smear(dataset::GrayImage& image) {
  const dataset::GrayImage sharp = image;
  const int radius = image.width / 5, cx = image.width * 3 / 5, cy = image.height / 2,
            reach = std::max(2, image.width / 64);
  for (int y = std::max(0, cy - radius); y < std::min(image.height, cy + radius); ++y) {
    for (int x = std::max(0, cx - radius); x < std::min(image.width, cx + radius); ++x) {
      if ((x - cx) * (x - cx) + (y - cy) * (y - cy) > radius * radius) continue;
      int sum = 0, count = 0;
      for (int dy = -reach; dy <= reach; dy += 2) {
        for (int dx = -reach; dx <= reach; dx += 2) {
          const int qx = std::clamp(x + dx, 0, image.width - 1), qy = std::clamp(y + dy, 0, image.height - 1);
          sum += sharp.pixels[static_cast<std::size_t>(qy * image.width + qx)];
          ++count;
        }
      }
      image.pixels[static_cast<std::size_t>(y * image.width + x)] =
          static_cast<std::uint8_t>(std::min(255, sum / count + 20));
    }
  }
}

// A finger: the left three quarters are dark, with a soft edge.
void Cover(dataset::GrayImage& image) {
  const double edge = 0.75 * image.width, soft = 0.05 * image.width;
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const double x = static_cast<double>(i % static_cast<std::size_t>(image.width));
    const double open = std::clamp(0.5 + (x - edge) / (2 * soft), 0.0, 1.0);
    image.pixels[i] = static_cast<std::uint8_t>(std::lround(12 + open * (image.pixels[i] - 12)));
  }
}

}  // namespace

FramePlan PlanFrame(const sim::FeedSpec& feed, std::uint64_t sequence, std::uint64_t seed) {
  FramePlan plan;
  plan.told_lag_s = 1e-6 * feed.stamp_jitter_us * double{sim::NormalFloat(sim::Mix(seed, sequence))};
  double hidden_lag_s = 0;
  for (const sim::FaultSpec& fault : feed.faults) {
    if (!IsActive(fault, sequence)) continue;
    switch (fault.kind) {
      case FaultKind::kDrop:
        plan.is_dropped = true;
        break;
      case FaultKind::kDisconnect:
        plan.is_disconnected = true;
        break;
      case FaultKind::kDuplicate:
      case FaultKind::kFreeze:
        plan.repeats_last = true;
        break;
      case FaultKind::kOffset:
        plan.told_lag_s += 1e-3 * fault.amount;
        break;
      case FaultKind::kHiddenOffset:
        hidden_lag_s += 1e-3 * fault.amount;
        break;
      case FaultKind::kExposure:
        plan.change.light *= fault.amount;
        break;
      case FaultKind::kDrift:
        plan.change.drift_rad += fault.amount * std::numbers::pi / 180;
        break;
      case FaultKind::kClockStep:
        plan.stamp_shift += std::chrono::nanoseconds(std::llround(1e6 * fault.amount));
        break;
      default:
        plan.image_faults.push_back(fault);
        break;
    }
  }
  plan.change.right_lag_s = plan.told_lag_s + hidden_lag_s;
  return plan;
}

void ApplyImageFaults(const std::vector<sim::FaultSpec>& faults, std::uint64_t seed, const StereoImages& last,
                      StereoImages& images) {
  for (const sim::FaultSpec& fault : faults) {
    switch (fault.kind) {
      case FaultKind::kSwap:
        std::swap(images.left, images.right);
        break;
      case FaultKind::kTear:
        Tear(last.left, images.left);
        Tear(last.right, images.right);
        break;
      case FaultKind::kBitFlip:
        FlipBits(fault.amount, sim::Mix(seed, 1), images.left);
        FlipBits(fault.amount, sim::Mix(seed, 2), images.right);
        break;
      case FaultKind::kSmear:
        Smear(images.left);
        break;
      case FaultKind::kCover:
        Cover(images.left);
        break;
      default:
        break;  // PlanFrame has seen to the others
    }
  }
}

}  // namespace wirepose::hal
