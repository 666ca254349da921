#include <cstdio>

#include "tests/targets/target_io.h"

namespace wirepose::testing {
namespace {

std::FILE* g_pack = nullptr;  // open until the program ends

}  // namespace

bool OpenPack() {
  g_pack = std::fopen(kPackFile, "rb");
  return g_pack != nullptr;
}

bool ReadPack(void* to, std::size_t size) { return std::fread(to, 1, size, g_pack) == size; }

void Print(const char* text) { std::fputs(text, stdout); }

void PrintMemoryMap() {}

}  // namespace wirepose::testing

int main() { return wirepose::testing::RunTarget(); }
