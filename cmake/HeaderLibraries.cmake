# Libraries whose headers are all that is needed, under the names that cmake/Dependencies.cmake gives them, for a compiler
# whose machine the installed libraries are not for. It must not see the other headers of the system, so those
# of the libraries are linked into a folder of their own.
set(header_folder ${PROJECT_BINARY_DIR}/headers)
file(MAKE_DIRECTORY ${header_folder})
set(of_old_compilers "^(fast_float|range|meta|concepts|std)$")  # what the standard library of Emscripten lacks
foreach(entry fmt toml++ nlohmann eigen3 hwy Random123 xxhash.h fast_float range meta concepts std)
  if(NOT EXISTS /usr/include/${entry} AND NOT (GRIDLOCK_COMPONENTS STREQUAL "engines" AND entry MATCHES "${of_old_compilers}"))
    message(FATAL_ERROR "/usr/include/${entry} is missing; ./dev install web gets it")
  endif()
  if(GRIDLOCK_COMPONENTS STREQUAL "engines" AND entry MATCHES "${of_old_compilers}")
    continue()
  endif()
  file(CREATE_LINK /usr/include/${entry} ${header_folder}/${entry} SYMBOLIC)
endforeach()

function(gridlock_header_library name)
  add_library(${name} INTERFACE IMPORTED)
  target_include_directories(${name} SYSTEM INTERFACE ${header_folder})
  target_compile_definitions(${name} INTERFACE ${ARGN})
endfunction()
gridlock_header_library(fmt::fmt FMT_HEADER_ONLY)
gridlock_header_library(tomlplusplus::tomlplusplus)
gridlock_header_library(nlohmann_json::nlohmann_json)
gridlock_header_library(PkgConfig::XXHASH XXH_INLINE_ALL)
gridlock_header_library(Eigen3::Eigen)
target_include_directories(Eigen3::Eigen SYSTEM INTERFACE ${header_folder}/eigen3)
set(HIGHWAY_INCLUDE_DIR ${header_folder})
set(RANDOM123_INCLUDE_DIR ${header_folder})
