# Parts of Gridlock that nothing else needs, each with a library of its own. Such a library may be there by half, as MPI is without
# its headers where another package brought it, and CMake's search for it may then end the configuration. So a little project of its
# own, cmake/probe, looks for it, compiles and links with it. What is found comes here as an imported target. What is not found leaves
# nothing in the cache, and the next configuration looks again.

# gridlock_look_for(LIBRARY FOUND PROBLEM): makes the target of a library that cmake/probe knows, and says in FOUND whether it did, in PROBLEM
# why not. MPIEXEC_OF_PROBE is the starter of MPI.
macro(gridlock_look_for library found problem)
  gridlock_probe(${library} ${found} ${problem})
  if(${found})
    include(${PROJECT_BINARY_DIR}/probe/${library}/found.cmake)
  endif()
endmacro()

function(gridlock_probe library found problem)
  set(directory ${PROJECT_BINARY_DIR}/probe/${library})
  # Where a user says that the library is; what the search itself enters is in the cache of the probe.
  set(hints "")
  foreach(entry CMAKE_CXX_COMPILER CMAKE_PREFIX_PATH CMAKE_TOOLCHAIN_FILE CMAKE_MAKE_PROGRAM PKG_CONFIG_EXECUTABLE
                GRIDLOCK_ZIG_TARGET GRIDLOCK_LIBRARIES
                MPI_HOME MPI_CXX_COMPILER MPI_EXECUTABLE_SUFFIX MPI_GUESS_LIBRARY_NAME MPIEXEC_EXECUTABLE)
    if(${entry})
      string(REPLACE ";" "\\;" value "${${entry}}")
      list(APPEND hints "-D${entry}=${value}")
    endif()
  endforeach()
  set(result 1)
  set(known_hints "")
  if(EXISTS ${directory}/found.cmake)
    file(READ ${directory}/hints.txt known_hints)
  endif()
  if(known_hints STREQUAL "${hints}")
    # What was found before may be gone, or be there by half.
    execute_process(COMMAND ${CMAKE_COMMAND} --build ${directory} --clean-first RESULT_VARIABLE result OUTPUT_QUIET ERROR_QUIET)
  endif()
  if(NOT result EQUAL 0)
    file(REMOVE_RECURSE ${directory})
    file(WRITE ${directory}/hints.txt "${hints}")
    execute_process(COMMAND ${CMAKE_COMMAND} -G ${CMAKE_GENERATOR} -S ${PROJECT_SOURCE_DIR}/cmake/probe -B ${directory}
                            -DLIBRARY=${library} ${hints}
                    RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
    if(result EQUAL 0)
      execute_process(COMMAND ${CMAKE_COMMAND} --build ${directory} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
    endif()
  endif()
  set(${found} FALSE PARENT_SCOPE)
  if(result EQUAL 0)
    set(${found} TRUE PARENT_SCOPE)
    return()
  endif()
  file(REMOVE ${directory}/found.cmake)
  file(WRITE ${directory}/log.txt "${output}")
  string(REGEX REPLACE "[ \n]+" " " output "${output}")
  set(reason "the search for it failed, see ${directory}/log.txt")
  if(output MATCHES "includes non-existent path \"([^\"]+)\"")
    set(reason "its headers are missing, ${CMAKE_MATCH_1}")
  elseif(output MATCHES "[a-z]+\\.h is missing|cannot find -l[^ :]+|Could NOT find [A-Za-z_]+|No package '[^']+' found")
    set(reason "${CMAKE_MATCH_0}")
  endif()
  set(${problem} "${reason}" PARENT_SCOPE)
endfunction()

# gridlock_leave_out(PART REASON COMMAND): notes a part that this build lacks, why, and the command that gets what it needs. ./dev
# prints these notes beneath the tests.
function(gridlock_leave_out part reason command)
  message(STATUS "${part}: left out (${reason}); ${command} gets what is missing")
  set_property(GLOBAL APPEND_STRING PROPERTY GRIDLOCK_LEFT_OUT "${part}: left out (${reason}); ${command} gets what is missing\n")
endfunction()

function(gridlock_write_left_out)
  get_property(parts GLOBAL PROPERTY GRIDLOCK_LEFT_OUT)
  file(WRITE ${PROJECT_BINARY_DIR}/left_out.txt "${parts}")
endfunction()
