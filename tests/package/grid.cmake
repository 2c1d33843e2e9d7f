cmake_minimum_required(VERSION 3.25)

# The neighbour search alone in a stranger's project, three ways: built with that project, found by CMake, found by
# pkg-config. None of them may look for another library.
foreach(name SOURCE_DIRECTORY WORK_DIRECTORY GENERATOR COMPILER)
  if(NOT DEFINED ${name})
    message(FATAL_ERROR "${name} is not given")
  endif()
endforeach()
file(REMOVE_RECURSE ${WORK_DIRECTORY})
set(here ${SOURCE_DIRECTORY}/tests/package/grid)
set(sources ${here}/compare.cpp ${SOURCE_DIRECTORY}/examples/neighbour_search.cpp)

include(${CMAKE_CURRENT_LIST_DIR}/run_step.cmake)

# A project is found wanting where its cache knows of a package but ours, or of pkg-config. The headers of Highway may serve it where they are.
function(require_nothing_else_in build)
  file(STRINGS ${build}/CMakeCache.txt found REGEX "^(PKG_CONFIG|[A-Za-z0-9_]+_DIR:)")
  list(FILTER found EXCLUDE REGEX "^(gridlock_DIR|HIGHWAY_INCLUDE_DIR|[A-Za-z0-9_]*(BINARY|SOURCE)_DIR|FETCHCONTENT_[A-Z_]*DIR|CMAKE_[A-Z_]*DIR):")
  if(found)
    message(FATAL_ERROR "${build} looked for other packages: ${found}")
  endif()
endfunction()

function(run_programs directory)
  run_step(${directory}/compare)
  execute_process(COMMAND ${directory}/neighbour_search RESULT_VARIABLE result OUTPUT_VARIABLE output)
  file(READ ${SOURCE_DIRECTORY}/examples/neighbour_search.txt expected)
  if(NOT result EQUAL 0 OR NOT output STREQUAL expected)
    message(FATAL_ERROR "neighbour_search prints\n${output}and not\n${expected}")
  endif()
endfunction()

set(fetch ${WORK_DIRECTORY}/fetch)
file(COPY ${sources} DESTINATION ${fetch})
configure_file(${here}/fetch.cmake ${fetch}/CMakeLists.txt COPYONLY)
run_step(${CMAKE_COMMAND} -G ${GENERATOR} -S ${fetch} -B ${fetch}/build -DGRIDLOCK=${SOURCE_DIRECTORY}
         -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_BUILD_TYPE=Debug)
require_nothing_else_in(${fetch}/build)
run_step(${CMAKE_COMMAND} --build ${fetch}/build)
run_programs(${fetch}/build)

# The library that was built there, installed, serves the other two.
file(GLOB_RECURSE libraries ${fetch}/build/*.a)
list(LENGTH libraries count)
if(NOT count EQUAL 1)
  message(FATAL_ERROR "more is built than the neighbour search: ${libraries}")
endif()
set(prefix ${WORK_DIRECTORY}/prefix)
run_step(${CMAKE_COMMAND} --install ${fetch}/build --prefix ${prefix})

set(find ${WORK_DIRECTORY}/find)
file(COPY ${sources} DESTINATION ${find})
configure_file(${here}/find.cmake ${find}/CMakeLists.txt COPYONLY)
run_step(${CMAKE_COMMAND} -G ${GENERATOR} -S ${find} -B ${find}/build -DCMAKE_PREFIX_PATH=${prefix}
         -DCMAKE_CXX_COMPILER=${COMPILER})
require_nothing_else_in(${find}/build)
run_step(${CMAKE_COMMAND} --build ${find}/build)
run_programs(${find}/build)

# All of Gridlock is not there, and that is said.
file(WRITE ${WORK_DIRECTORY}/all/CMakeLists.txt
     "cmake_minimum_required(VERSION 3.25)\nproject(all LANGUAGES CXX)\nfind_package(gridlock REQUIRED)\n")
execute_process(COMMAND ${CMAKE_COMMAND} -G ${GENERATOR} -S ${WORK_DIRECTORY}/all -B ${WORK_DIRECTORY}/all/build
                        -DCMAKE_PREFIX_PATH=${prefix} -DCMAKE_CXX_COMPILER=${COMPILER}
                RESULT_VARIABLE result ERROR_VARIABLE error OUTPUT_QUIET)
if(result EQUAL 0 OR NOT error MATCHES "only the component grid is installed")
  message(FATAL_ERROR "find_package(gridlock) takes an installation of the component grid for all:\n${error}")
endif()

find_program(pkg_config pkg-config REQUIRED)
file(GLOB_RECURSE description ${prefix}/*/gridlock-grid.pc)
get_filename_component(directory ${description} DIRECTORY)
set(ENV{PKG_CONFIG_PATH} ${directory})
execute_process(COMMAND ${pkg_config} --static --cflags --libs gridlock-grid OUTPUT_VARIABLE flags
                OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
separate_arguments(flags UNIX_COMMAND "${flags}")
foreach(source ${sources})
  get_filename_component(name ${source} NAME_WE)
  run_step(${COMPILER} -std=c++20 ${source} ${flags} -o ${WORK_DIRECTORY}/${name})
endforeach()
run_programs(${WORK_DIRECTORY})
