# The toolchain for WebAssembly: Debian's Emscripten, and what its standard library lacks.
find_program(EMCC emcc REQUIRED)
execute_process(COMMAND em-config EMSCRIPTEN_ROOT OUTPUT_VARIABLE emscripten_root OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
include(${emscripten_root}/cmake/Modules/Platform/Emscripten.cmake)
cmake_path(GET CMAKE_CURRENT_LIST_DIR PARENT_PATH source_directory)
# Exceptions are those of WebAssembly: a try costs nothing where nothing is thrown.
set(CMAKE_CXX_FLAGS_INIT "-fwasm-exceptions -include ${source_directory}/web/engine/compatibility.hpp")
set(CMAKE_EXE_LINKER_FLAGS_INIT "-fwasm-exceptions")
