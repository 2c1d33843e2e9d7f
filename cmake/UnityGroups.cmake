# gridlock_unity_groups(NAME SOURCES…): sources of one room that compile as one, a few of them at a time, so that two cores
# have their share and a compiler does not run out of memory. Kernels are compiled for several processors, each in its own way, and stay
# by themselves.
function(gridlock_unity_groups name)
  set(sources_in_group 9)
  if(GRIDLOCK_UNITY_BUILD STREQUAL "ALL")
    set(sources_in_group 40)  # where most of the time goes into headers
  endif()
  set(count 0)
  list(FILTER ARGN EXCLUDE REGEX "(_highway|_avx512|batched_moves)\\.cpp$")
  foreach(source ${ARGN})
    math(EXPR group "${count} / ${sources_in_group}")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${name}_${group})
    math(EXPR count "${count} + 1")
  endforeach()
endfunction()

# gridlock_unity_groups_by_folder(NAME SOURCES…): the same for sources of several rooms, each room for itself.
function(gridlock_unity_groups_by_folder name)
  set(rooms "")
  foreach(source ${ARGN})
    cmake_path(GET source PARENT_PATH folder)
    cmake_path(GET folder FILENAME room)
    list(APPEND rooms ${room})
    list(APPEND sources_of_${room} ${source})
  endforeach()
  list(REMOVE_DUPLICATES rooms)
  foreach(room ${rooms})
    gridlock_unity_groups(${name}_${room} ${sources_of_${room}})
  endforeach()
endfunction()
