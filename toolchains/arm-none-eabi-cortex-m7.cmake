# Cortex-M7 with double-precision FPU.
set(WIREPOSE_CPU_FLAGS "-mcpu=cortex-m7 -mthumb -mfpu=fpv5-d16 -mfloat-abi=hard")
set(WIREPOSE_BOARD an500)  # memory layout of the test images: Arm MPS2 with Cortex-M7, as QEMU models it
set(WIREPOSE_QEMU_MACHINE mps2-an500)
include(${CMAKE_CURRENT_LIST_DIR}/arm-none-eabi.cmake)
