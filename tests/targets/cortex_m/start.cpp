// Start-up of a Cortex-M test image: floating point on, memory cleared, stack painted, constructors, program, exit
// status.
#include <cstddef>
#include <cstdint>

#include "tests/targets/cortex_m/semihosting.h"
#include "tests/targets/target_io.h"

extern "C" {
extern std::uint32_t __bss_start[], __bss_end[], __stack_bottom[], __stack_top[];
extern void (*__init_array_start[])();
extern void (*__init_array_end[])();

// Needed by the C++ ABI for the address of this program; nothing is ever destroyed.
void* __dso_handle = nullptr;
int __aeabi_atexit(void*, void (*)(void*), void*) { return 0; }

[[noreturn]] void FaultHandler() {
  wirepose::testing::semihosting::Write("processor fault\n");
  wirepose::testing::semihosting::Exit(134);
}

// Runs before all else without a stack frame worth mentioning: the paint ends below the frame at hand.
[[noreturn]] void ResetHandler() {
  *reinterpret_cast<volatile std::uint32_t*>(0xE000ED88) |= 0xFU << 20;  // CPACR: full access to the FPU and MVE
  __asm volatile("dsb\n isb");
  for (std::uint32_t* p = __bss_start; p < __bss_end; ++p) *p = 0;
  auto* const frame = static_cast<std::uint32_t*>(__builtin_frame_address(0));
  for (volatile std::uint32_t* p = __stack_bottom; p < frame - 64; ++p)
    *p = wirepose::testing::semihosting::kStackPaint;
  for (auto constructor = __init_array_start; constructor != __init_array_end; ++constructor) (*constructor)();
  wirepose::testing::semihosting::Exit(wirepose::testing::RunTarget());
}
}

// Stack, reset, then every exception a test image can meet.
__attribute__((section(".vectors"), used)) static const void* const kVectors[16] = {
    __stack_top,
    reinterpret_cast<const void*>(ResetHandler),
    reinterpret_cast<const void*>(FaultHandler),
    reinterpret_cast<const void*>(FaultHandler),
    reinterpret_cast<const void*>(FaultHandler),
    reinterpret_cast<const void*>(FaultHandler),
    reinterpret_cast<const void*>(FaultHandler),
    reinterpret_cast<const void*>(FaultHandler),
    nullptr,
    nullptr,
    nullptr,
    reinterpret_cast<const void*>(FaultHandler),
    reinterpret_cast<const void*>(FaultHandler),
    nullptr,
    reinterpret_cast<const void*>(FaultHandler),
    reinterpret_cast<const void*>(FaultHandler)};
