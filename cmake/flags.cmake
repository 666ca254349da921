# Compiler settings shared by every room.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_C_STANDARD 11)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
if(NOT CMAKE_SYSTEM_NAME STREQUAL Generic)
  set(CMAKE_POSITION_INDEPENDENT_CODE ON)
endif()

find_program(WIREPOSE_CCACHE ccache)
if(WIREPOSE_CCACHE)
  set(CMAKE_C_COMPILER_LAUNCHER ${WIREPOSE_CCACHE})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${WIREPOSE_CCACHE})
endif()

# Warnings of our own code are errors; generated code links without this target.
add_library(wirepose_warnings INTERFACE)
target_compile_options(wirepose_warnings INTERFACE
  $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wold-style-cast -Wcast-qual
                            -Woverloaded-virtual -Wnull-dereference -Wdouble-promotion -Werror>)

# Rules of the recognizer core. Private to its rooms: the host side may use exceptions and RTTI.
add_library(wirepose_core_rules INTERFACE)
target_compile_options(wirepose_core_rules INTERFACE
  $<$<COMPILE_LANGUAGE:CXX>:-fno-exceptions -fno-rtti -fno-threadsafe-statics -ffunction-sections -fdata-sections
                            # Square roots are one instruction, and vectorize; no value changes.
                            -fno-math-errno -fno-trapping-math>)

# For scripts/stack-depth: a call graph with frame sizes beside each object file. The compiler cache would forget them.
option(WIREPOSE_CALL_GRAPH "Write call graphs of the core (GCC)" OFF)
if(WIREPOSE_CALL_GRAPH)
  target_compile_options(wirepose_core_rules INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-fcallgraph-info=su,da>)
  unset(CMAKE_CXX_COMPILER_LAUNCHER)
endif()

if(WIREPOSE_SANITIZE)
  add_compile_options(-fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
  # Instrumented, GCC 12 warns of libstdc++'s own std::regex.
  add_compile_options($<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  add_link_options(-fsanitize=address,undefined)
endif()

# Most of a source's time at the compiler is Eigen's: with CMAKE_UNITY_BUILD, which the presets of optimised Linux builds
# set, rooms are compiled several sources at a time.
set(CMAKE_UNITY_BUILD_BATCH_SIZE 16)

# For code that runs once a command, like the reading of its options: optimising it further takes longer than it saves.
# Comes after wirepose_warnings: at -O1 GCC 12 sees null pointers in libstdc++'s std::string.
add_library(wirepose_runs_once INTERFACE)
target_compile_options(wirepose_runs_once INTERFACE
  $<$<CONFIG:Release>:-O1> $<$<AND:$<CONFIG:Release>,$<COMPILE_LANGUAGE:CXX>>:-Wno-null-dereference>)
