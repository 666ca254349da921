// Errors as values: the recognizer core throws nothing and ignores nothing.
#ifndef WIREPOSE_BASE_RESULT_H_
#define WIREPOSE_BASE_RESULT_H_

#include <tl/expected.hpp>

namespace wirepose {

// A small value, or the reason why there is none. `E` is the error enum of the room that returns it.
template <typename T, typename E>
using Result = tl::expected<T, E>;

using tl::unexpected;

}  // namespace wirepose

#endif  // WIREPOSE_BASE_RESULT_H_
