// Checks for our own bugs. Never on sensor, file or network input: those return errors.
#ifndef WIREPOSE_BASE_CHECK_H_
#define WIREPOSE_BASE_CHECK_H_

namespace wirepose {

// Halts when `condition` is false, in every build type: a broken invariant must not become a pose.
constexpr void Check(bool condition) {
  if (!condition) __builtin_trap();
}

// As Check, but only in builds without NDEBUG: for tests in inner loops.
constexpr void DebugCheck([[maybe_unused]] bool condition) {
#ifndef NDEBUG
  Check(condition);
#endif
}

}  // namespace wirepose

#endif  // WIREPOSE_BASE_CHECK_H_
