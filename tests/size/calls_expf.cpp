// For the test of scripts/check-no-heap: calls a function whose last bit is the C library's choice.
#include <cmath>

float CallsExpf(float x) { return std::exp(x); }
