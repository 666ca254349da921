# Robot board: Debian 12 or Raspberry Pi OS on 64 bit Arm. Compiles against the sysroot that scripts/sysroot makes;
# -DWIREPOSE_SYSROOT=FOLDER names another one.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(triple aarch64-linux-gnu)
set(CMAKE_C_COMPILER ${triple}-gcc)
set(CMAKE_CXX_COMPILER ${triple}-g++)
set(CMAKE_LIBRARY_ARCHITECTURE ${triple})

set(WIREPOSE_SYSROOT ${CMAKE_CURRENT_LIST_DIR}/../build/sysroot-arm64 CACHE PATH "arm64 sysroot")
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES WIREPOSE_SYSROOT)
cmake_path(ABSOLUTE_PATH WIREPOSE_SYSROOT NORMALIZE OUTPUT_VARIABLE sysroot)
if(NOT IS_DIRECTORY ${sysroot}/usr/lib/${triple})
  message(FATAL_ERROR "${sysroot} is no arm64 sysroot; run scripts/sysroot")
endif()
set(CMAKE_SYSROOT ${sysroot})

# Programs (idlc, pkg-config) are the host's, all else the sysroot's.
set(CMAKE_FIND_ROOT_PATH ${sysroot})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${sysroot})
set(ENV{PKG_CONFIG_LIBDIR} ${sysroot}/usr/lib/${triple}/pkgconfig:${sysroot}/usr/share/pkgconfig)
set(ENV{PKG_CONFIG_PATH} "")
# Where the libraries of libraries are.
add_link_options(-Wl,-rpath-link,${sysroot}/usr/lib/${triple} -Wl,-rpath-link,${sysroot}/lib/${triple})

find_program(WIREPOSE_QEMU_AARCH64 NAMES qemu-aarch64-static qemu-aarch64)
if(WIREPOSE_QEMU_AARCH64)
  set(CMAKE_CROSSCOMPILING_EMULATOR ${WIREPOSE_QEMU_AARCH64};-L;${sysroot})
endif()
