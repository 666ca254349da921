// Bounded time without a clock: work is counted in steps of known cost, and a search stops when they are spent.
#ifndef WIREPOSE_BASE_WORK_BUDGET_H_
#define WIREPOSE_BASE_WORK_BUDGET_H_

#include <cstdint>

namespace wirepose {

// The same input spends the same steps on every target, so a search that stops gives the same result everywhere.
// Searches go from the most to the least promising, so that what is found by then is the best for its price.
class WorkBudget {
 public:
  explicit WorkBudget(std::uint32_t steps) : left_(steps) {}

  // Takes `steps` away. False, now and from now on, when there are fewer left.
  [[nodiscard]] bool Spend(std::uint32_t steps) {
    if (hit_ || steps > left_) {
      hit_ = true;
      return false;
    }
    left_ -= steps;
    return true;
  }

  // True once a Spend was refused.
  [[nodiscard]] bool hit() const { return hit_; }
  [[nodiscard]] std::uint32_t left() const { return left_; }

 private:
  std::uint32_t left_;
  bool hit_ = false;
};

}  // namespace wirepose

#endif  // WIREPOSE_BASE_WORK_BUDGET_H_
