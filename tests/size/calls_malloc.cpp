#include <cstdlib>

void* Offend(std::size_t size) { return std::malloc(size); }
