# Writes the test of one header: it is included twice, and of a public header the example, the first block of C++ in its
# comments, is compiled. An example that begins with "struct" or "int main" stands outside of functions.
#
#     cmake -DINCLUDE_DIRECTORY=… -DHEADER=gridlock/core/box.hpp -DSOURCE=… -P header_test.cmake
file(READ ${INCLUDE_DIRECTORY}/${HEADER} text)
set(source "#include \"${HEADER}\"\n#include \"${HEADER}\"\n")
set(without_example "/(engine|observe|simulation)/|/(state|disks|world|observations|model_engine|run_directory)\\.hpp$")
if(NOT HEADER MATCHES "/detail/" AND NOT HEADER MATCHES "${without_example}")
  string(FIND "${text}" "\n/// ```cpp\n" start)
  if(start EQUAL -1)
    message(FATAL_ERROR "${HEADER}: a public header shows an example, \"/// ```cpp …\", or lies in a folder detail/")
  endif()
  math(EXPR start "${start} + 12")
  string(SUBSTRING "${text}" ${start} -1 text)
  string(FIND "${text}" "/// ```\n" end)
  string(SUBSTRING "${text}" 0 ${end} example)
  string(REGEX REPLACE "(^|\n)///? ?" "\\1" example "${example}")
  if(NOT example MATCHES "^(struct|int main)")
    set(example "inline void example() {\n${example}}\n")
  endif()
  string(APPEND source "#include <utility>\n#include <variant>\n#include <vector>\n\nnamespace example {\n\nusing namespace gridlock;\n\n${example}\n}  // namespace example\n")
endif()
file(WRITE ${SOURCE} "${source}")
