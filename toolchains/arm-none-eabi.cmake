# Bare metal with Debian's gcc-arm-none-eabi and newlib. Included by the files that choose the processor in
# WIREPOSE_CPU_FLAGS.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)  # there is no start-up code yet that a program could link

set(CMAKE_C_FLAGS_INIT "${WIREPOSE_CPU_FLAGS}")
set(CMAKE_CXX_FLAGS_INIT "${WIREPOSE_CPU_FLAGS}")

# Eigen and tl::expected are header-only: the host's own will do.
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE NEVER)
