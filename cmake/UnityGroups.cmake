# gridlock_unity_groups(NAME SOURCES…): sources of one room that compile as one, a few of them at a time, so that two cores
# have their share and a compiler does not run out of memory.
function(gridlock_unity_groups name)
  set(sources_in_group 9)
  set(count 0)
  foreach(source ${ARGN})
    math(EXPR group "${count} / ${sources_in_group}")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${name}_${group})
    math(EXPR count "${count} + 1")
  endforeach()
endfunction()
