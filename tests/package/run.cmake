# Installs the library to a fresh prefix, builds a stranger's program against it with find_package, and runs it.
foreach(name BUILD_DIRECTORY SOURCE_DIRECTORY WORK_DIRECTORY GENERATOR COMPILER)
  if(NOT DEFINED ${name})
    message(FATAL_ERROR "${name} is not given")
  endif()
endforeach()
file(REMOVE_RECURSE ${WORK_DIRECTORY})

function(run_step)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${ARGN} failed:\n${output}")
  endif()
  message("${output}")
endfunction()

# The program is the one the README shows.
file(READ ${SOURCE_DIRECTORY}/README.md readme)
string(FIND "${readme}" "```cpp\n" start)
string(SUBSTRING "${readme}" ${start} -1 readme)
string(SUBSTRING "${readme}" 7 -1 readme)
string(FIND "${readme}" "```" end)
string(SUBSTRING "${readme}" 0 ${end} program)
file(WRITE ${WORK_DIRECTORY}/consumer/main.cpp "${program}")
configure_file(${SOURCE_DIRECTORY}/tests/package/consumer.cmake ${WORK_DIRECTORY}/consumer/CMakeLists.txt COPYONLY)

run_step(${CMAKE_COMMAND} --install ${BUILD_DIRECTORY} --prefix ${WORK_DIRECTORY}/prefix)
run_step(${CMAKE_COMMAND} -G ${GENERATOR} -S ${WORK_DIRECTORY}/consumer -B ${WORK_DIRECTORY}/build
         -DCMAKE_PREFIX_PATH=${WORK_DIRECTORY}/prefix -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_BUILD_TYPE=Release
         -DCMAKE_EXE_LINKER_FLAGS=${LINKER_FLAGS})
run_step(${CMAKE_COMMAND} --build ${WORK_DIRECTORY}/build)
run_step(${WORK_DIRECTORY}/build/consumer)
run_step(${WORK_DIRECTORY}/prefix/bin/gridlock --version)
