# The toolchain of zig, a clang with libc++ and the C libraries of many systems: ./dev portable gets it from PyPI into
# build-zig. GRIDLOCK_ZIG_TARGET names the system, as x86_64-linux-gnu.2.28; GRIDLOCK_EMULATOR runs what was built.
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES GRIDLOCK_ZIG_TARGET)
string(REGEX MATCH "^[a-z0-9_]+" CMAKE_SYSTEM_PROCESSOR ${GRIDLOCK_ZIG_TARGET})
set(CMAKE_SYSTEM_NAME Linux)
if(GRIDLOCK_ZIG_TARGET MATCHES "macos")
  set(CMAKE_SYSTEM_NAME Darwin)
elseif(GRIDLOCK_ZIG_TARGET MATCHES "windows")
  set(CMAKE_SYSTEM_NAME Windows)
endif()
cmake_path(GET CMAKE_CURRENT_LIST_DIR PARENT_PATH source_directory)
set(zig ${source_directory}/build-zig/bin)
set(CMAKE_C_COMPILER ${zig}/clang)
set(CMAKE_CXX_COMPILER ${zig}/clang++)
set(flags "-target ${GRIDLOCK_ZIG_TARGET}")
if(CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
  # Functions that ask for AVX-512 get its wide registers; others have the first 64-bit processor as ever.
  string(APPEND flags " -mcpu=baseline+evex512")
endif()
if(CMAKE_SYSTEM_PROCESSOR STREQUAL "riscv64")
  # Random123 does not know the processor by itself.
  string(APPEND flags " -DR123_USE_GNU_UINT128=1")
endif()
set(CMAKE_C_FLAGS_INIT "${flags}")
set(CMAKE_CXX_FLAGS_INIT "${flags}")
set(CMAKE_AR ${zig}/ar CACHE FILEPATH "")
set(CMAKE_RANLIB ${zig}/ranlib CACHE FILEPATH "")
set(CMAKE_CROSSCOMPILING_EMULATOR ${GRIDLOCK_EMULATOR})

# Programs of this machine, all else of the other one.
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
