# Compiles a program with one mistake and looks at what the compiler says: one error, in words that say what to do.
execute_process(COMMAND ${COMPILER} -std=c++20 -fsyntax-only -I ${INCLUDE_DIRECTORY} ${SOURCE}
                RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(result EQUAL 0)
  message(FATAL_ERROR "${SOURCE} compiles")
endif()
string(REGEX MATCHALL "[^\n]*error:[^\n]*" errors "${output}")
list(LENGTH errors count)
list(GET errors 0 first)
string(FIND "${first}" "${EXPECTED}" place)
if(place EQUAL -1 OR NOT count EQUAL 1)
  message(FATAL_ERROR "${count} errors, the first is\n${first}\nand not \"${EXPECTED}\" alone; all of them:\n${output}")
endif()
