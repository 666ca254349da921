# Cortex-M55 with double-precision FPU and Helium (MVE) vectors. -DWIREPOSE_MVE=OFF leaves the vectors out: emulators
# run such code three times faster.
option(WIREPOSE_MVE "Use Helium vectors" ON)
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES WIREPOSE_MVE)
if(WIREPOSE_MVE)
  set(WIREPOSE_CPU_FLAGS "-mcpu=cortex-m55 -mthumb -mfloat-abi=hard")
else()
  set(WIREPOSE_CPU_FLAGS "-mcpu=cortex-m55+nomve -mthumb -mfloat-abi=hard")
endif()
set(WIREPOSE_BOARD an547)  # memory layout of the test images: Arm MPS3 with SSE-300, as QEMU models it
set(WIREPOSE_QEMU_MACHINE mps3-an547)
include(${CMAKE_CURRENT_LIST_DIR}/arm-none-eabi.cmake)
