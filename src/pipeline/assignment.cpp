#include "pipeline/assignment.h"

#include <limits>

namespace wirepose {
namespace {

// One column a track, and one a detection that stands for "none of them".
constexpr std::size_t kColumns = kMaxTracks + kMaxDetections;
constexpr std::size_t kFree = kMaxDetections;  // row of a column that nobody has

class Assigner {
 public:
  explicit Assigner(const MatchCosts& costs) : costs_(costs), columns_(costs.tracks + costs.detections) {
    row_of_.fill(kFree);
  }

  // Finds the shortest alternating path from the detection to a free column and swaps the matches along it.
  void Insert(std::size_t detection) {
    distance_.fill(std::numeric_limits<double>::infinity());
    done_.fill(false);
    std::size_t row = detection, column = kColumns;  // the column that `row` has now; none at the start
    double reached = 0;
    do {
      std::size_t next = 0;
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t c = 0; c < columns_; ++c) {
        if (done_[c]) continue;
        const double d = reached + Cost(row, c) - row_potential_[row] - column_potential_[c];
        if (d < distance_[c]) {
          distance_[c] = d;
          came_from_[c] = column;
        }
        if (distance_[c] < least) {
          least = distance_[c];
          next = c;
        }
      }
      reached = least;
      done_[next] = true;
      column = next;
      row = row_of_[next];
    } while (row != kFree);
    row_potential_[detection] += reached;
    for (std::size_t c = 0; c < columns_; ++c) {
      if (!done_[c] || c == column) continue;
      column_potential_[c] -= reached - distance_[c];
      row_potential_[row_of_[c]] += reached - distance_[c];
    }
    for (;;) {
      const std::size_t before = came_from_[column];
      if (before == kColumns) break;
      row_of_[column] = row_of_[before];
      column = before;
    }
    row_of_[column] = detection;
  }

  [[nodiscard]] std::size_t RowOf(std::size_t column) const { return row_of_[column]; }

 private:
  [[nodiscard]] double Cost(std::size_t row, std::size_t column) const {
    if (column < costs_.tracks) return costs_.cost[row][column];
    return column - costs_.tracks == row ? MatchCosts::kUnmatched : MatchCosts::kNoMatch;
  }

  const MatchCosts& costs_;
  const std::size_t columns_;
  std::array<double, kMaxDetections> row_potential_{};
  std::array<double, kColumns> column_potential_{}, distance_{};
  std::array<std::size_t, kColumns> row_of_{}, came_from_{};
  std::array<bool, kColumns> done_{};
};

}  // namespace

FixedVector<std::size_t, kMaxDetections> AssignTracks(const MatchCosts& costs) {
  Assigner assigner(costs);
  for (std::size_t d = 0; d < costs.detections; ++d) assigner.Insert(d);
  FixedVector<std::size_t, kMaxDetections> track_of;
  for (std::size_t d = 0; d < costs.detections; ++d) track_of.push_back(kNoTrack);
  for (std::size_t t = 0; t < costs.tracks; ++t) {
    const std::size_t d = assigner.RowOf(t);
    if (d != kFree && costs.cost[d][t] < MatchCosts::kNoMatch) track_of[d] = t;
  }
  return track_of;
}

}  // namespace wirepose
