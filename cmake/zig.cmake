# The toolchain of zig, a clang with libc++ and the C libraries of many systems: ./dev portable and ./dev wheel get it from PyPI into
# build-zig. GRIDLOCK_ZIG_TARGET names the system, as x86_64-linux-gnu.2.28; GRIDLOCK_EMULATOR runs what was built;
# GRIDLOCK_LIBRARIES is a root with the libraries for it, as packaging/libraries_for makes one.
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES GRIDLOCK_ZIG_TARGET GRIDLOCK_LIBRARIES)
string(REGEX MATCH "^[a-z0-9_]+" CMAKE_SYSTEM_PROCESSOR ${GRIDLOCK_ZIG_TARGET})
if(NOT GRIDLOCK_ZIG_TARGET MATCHES "^${CMAKE_HOST_SYSTEM_PROCESSOR}-linux")
  set(CMAKE_SYSTEM_NAME Linux)
endif()
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

if(GRIDLOCK_LIBRARIES)
  set(CMAKE_FIND_ROOT_PATH ${GRIDLOCK_LIBRARIES})
  set(CMAKE_LIBRARY_ARCHITECTURE ${CMAKE_SYSTEM_PROCESSOR}-linux-gnu)
  set(ENV{PKG_CONFIG_SYSROOT_DIR} ${GRIDLOCK_LIBRARIES})
  file(GLOB folders_of_pkgconfig ${GRIDLOCK_LIBRARIES}/usr/lib/pkgconfig ${GRIDLOCK_LIBRARIES}/usr/lib/*/pkgconfig)
  list(JOIN folders_of_pkgconfig ":" folders_of_pkgconfig)
  set(ENV{PKG_CONFIG_LIBDIR} ${folders_of_pkgconfig}:${GRIDLOCK_LIBRARIES}/usr/share/pkgconfig)
  set(ENV{PKG_CONFIG_ALLOW_SYSTEM_CFLAGS} 1)  # the compiler looks by itself into no folder of this root
  set(ENV{PKG_CONFIG_ALLOW_SYSTEM_LIBS} 1)
  set(PKG_CONFIG_ARGN --static)  # archives do not say what else they need
  # A module of Python takes archives that were made for programs: nobody puts other functions in the place of theirs.
  # The linker leaves out names that nobody needs: the tool that does so later is this machine's.
  set(CMAKE_MODULE_LINKER_FLAGS_INIT "-Wl,-Bsymbolic -s")
  set(CMAKE_EXE_LINKER_FLAGS_INIT "-s")
endif()

# Programs of this machine, all else of the other one.
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
