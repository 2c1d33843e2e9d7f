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

# The programs are those that the README and the page on models show.
foreach(document README.md docs/models.md)
  file(READ ${SOURCE_DIRECTORY}/${document} text)
  string(FIND "${text}" "```cpp\n" start)
  string(SUBSTRING "${text}" ${start} -1 text)
  string(SUBSTRING "${text}" 7 -1 text)
  string(FIND "${text}" "```" end)
  string(SUBSTRING "${text}" 0 ${end} program)
  get_filename_component(name ${document} NAME_WE)
  file(WRITE ${WORK_DIRECTORY}/consumer/${name}.cpp "${program}")
endforeach()
configure_file(${SOURCE_DIRECTORY}/tests/package/consumer.cmake ${WORK_DIRECTORY}/consumer/CMakeLists.txt COPYONLY)

run_step(${CMAKE_COMMAND} --install ${BUILD_DIRECTORY} --prefix ${WORK_DIRECTORY}/prefix)
run_step(${CMAKE_COMMAND} -G ${GENERATOR} -S ${WORK_DIRECTORY}/consumer -B ${WORK_DIRECTORY}/build
         -DCMAKE_PREFIX_PATH=${WORK_DIRECTORY}/prefix -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_BUILD_TYPE=Release
         -DCMAKE_EXE_LINKER_FLAGS=${LINKER_FLAGS})
run_step(${CMAKE_COMMAND} --build ${WORK_DIRECTORY}/build)
run_step(${WORK_DIRECTORY}/build/consumer_README)
run_step(${WORK_DIRECTORY}/build/consumer_models)
run_step(${WORK_DIRECTORY}/prefix/bin/gridlock --version)
