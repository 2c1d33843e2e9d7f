# Writes HEADER with the text of version(): VERSION, "+" and the commit of SOURCE_DIRECTORY. Each build runs this; the header is
# written only where its text changes, so that nothing but one source is compiled anew after a commit.
foreach(name VERSION SOURCE_DIRECTORY HEADER)
  if(NOT DEFINED ${name})
    message(FATAL_ERROR "${name} is not given")
  endif()
endforeach()

# The sources may belong to another user, as in a container. A repository around them is not asked.
function(ask_git result_name output_name)
  execute_process(COMMAND git -c safe.directory=* -C ${SOURCE_DIRECTORY} ${ARGN}
                  RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
  set(${result_name} "${result}" PARENT_SCOPE)
  set(${output_name} "${output}" PARENT_SCOPE)
endfunction()

set(commit unknown)
file(READ ${SOURCE_DIRECTORY}/cmake/commit.txt archived)  # `git archive` puts the commit there
if(EXISTS ${SOURCE_DIRECTORY}/.git)
  ask_git(result id rev-parse --short=12 HEAD)
  if(result EQUAL 0)
    set(commit ${id})
    ask_git(result ignored diff --quiet HEAD -- apps cmake include models python src web CMakeLists.txt)
    if(NOT result EQUAL 0)
      string(APPEND commit .modified)
    endif()
  endif()
elseif(archived MATCHES "^[0-9a-f]+")
  string(SUBSTRING ${archived} 0 12 commit)
endif()

set(text "#pragma once
inline constexpr char const* version_text = \"${VERSION}+${commit}\";
")
set(written "")
if(EXISTS ${HEADER})
  file(READ ${HEADER} written)
endif()
if(NOT written STREQUAL text)
  file(WRITE ${HEADER} "${text}")
endif()
