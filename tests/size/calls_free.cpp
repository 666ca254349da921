#include <cstdlib>

void Offend(void* block) { std::free(block); }
