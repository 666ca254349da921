// Frames made to cost as much as possible: repetitive, noisy, flat. Deterministic.
#ifndef WIREPOSE_TESTS_PIPELINE_ADVERSARIAL_FRAMES_H_
#define WIREPOSE_TESTS_PIPELINE_ADVERSARIAL_FRAMES_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "hal/dataset/png_image.h"

namespace wirepose::testing {

struct AdversarialFrame {
  std::string name;
  dataset::GrayImage left, right;
};

// Grey level of a pixel of the left image; the right one shows the same `disparity` px farther left, as a wall would.
inline AdversarialFrame MakeFrame(std::string name, int disparity, const std::function<double(double, double)>& grey) {
  constexpr int kWidth = 640, kHeight = 480;
  AdversarialFrame frame{std::move(name), {kWidth, kHeight, {}}, {kWidth, kHeight, {}}};
  for (dataset::GrayImage* image : {&frame.left, &frame.right}) {
    const int shift = image == &frame.left ? 0 : disparity;
    image->pixels.resize(std::size_t{kWidth} * kHeight);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const double value = std::clamp(grey(x + shift, y), 0.0, 255.0);
        image->pixels[static_cast<std::size_t>(y * kWidth + x)] = static_cast<std::uint8_t>(value);
      }
    }
  }
  return frame;
}

inline std::vector<AdversarialFrame> Gratings() {
  std::vector<AdversarialFrame> frames;
  for (const int degrees : {0, 5, 10, 20, 30, 45, 60, 75, 90, 105, 120, 135, 150, 165}) {
    for (const int period : {12, 24, 48}) {
      const double angle = degrees * 3.14159265358979 / 180;
      frames.push_back(MakeFrame("grating " + std::to_string(degrees) + " deg, " + std::to_string(period) + " px", 40,
                                 [=](double x, double y) {
                                   const double along = x * std::cos(angle) + y * std::sin(angle);
                                   return std::fmod(along + 10 * period * 100, period) < 0.5 * period ? 60 : 190;
                                 }));
    }
  }
  return frames;
}

inline std::vector<AdversarialFrame> Boards() {
  std::vector<AdversarialFrame> frames;
  for (const int cell : {6, 13, 16, 20, 26, 32, 48, 64}) {
    for (const double turn : {0.0, 0.1, 0.5}) {
      frames.push_back(MakeFrame("board of " + std::to_string(cell) + " px, turned " + std::to_string(turn), 40,
                                 [=](double x, double y) {
                                   const double u = x * std::cos(turn) + y * std::sin(turn) + 10000;
                                   const double v = y * std::cos(turn) - x * std::sin(turn) + 10000;
                                   return (static_cast<int>(u / cell) + static_cast<int>(v / cell)) % 2 == 0 ? 50 : 200;
                                 }));
    }
  }
  return frames;
}

// Noise, random boxes of all sizes (walls of edges), white and black.
inline std::vector<AdversarialFrame> Clutter() {
  std::vector<AdversarialFrame> frames;
  for (const double grey : {0.0, 128.0, 255.0}) {
    frames.push_back(MakeFrame("flat " + std::to_string(grey), 0, [=](double, double) { return grey; }));
  }
  for (const int size : {1, 2, 4, 8, 16, 24}) {
    frames.push_back(MakeFrame("noise of " + std::to_string(size) + " px", 40, [=](double x, double y) {
      const auto cell =
          static_cast<std::uint32_t>(x / size) * 73856093U ^ static_cast<std::uint32_t>(y / size) * 19349663U;
      return static_cast<double>((cell * 2654435761U) >> 24);
    }));
  }
  for (const unsigned count : {50U, 200U, 1000U}) {
    std::mt19937 random(count);
    std::vector<std::array<double, 5>> boxes;
    for (unsigned i = 0; i < count; ++i) {
      const double w = 20 + random() % 150, h = 20 + random() % 150;
      boxes.push_back({static_cast<double>(random() % 800) - 100, static_cast<double>(random() % 580) - 100, w, h,
                       static_cast<double>(random() % 256)});
    }
    frames.push_back(MakeFrame(std::to_string(count) + " boxes", 40, [=](double x, double y) {
      double grey = 128;
      for (const auto& [bx, by, w, h, level] : boxes) {
        if (x >= bx && x < bx + w && y >= by && y < by + h) grey = level;
      }
      return grey;
    }));
  }
  return frames;
}

}  // namespace wirepose::testing

#endif  // WIREPOSE_TESTS_PIPELINE_ADVERSARIAL_FRAMES_H_
