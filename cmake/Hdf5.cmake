# gridlock_hdf5: HDF5 for the programs of this build.
#
# Debian's shared HDF5 brings curl, LDAP and Kerberos: the loader takes longer for these 30 libraries than for all else, at
# every start, and nothing here calls them. The static archive needs none of them, so a program takes that where it links;
# where it does not, and in programs of others, the shared library serves as well.
option(GRIDLOCK_STATIC_HDF5 "Link the static archive of HDF5 into the programs where there is one" ${PROJECT_IS_TOP_LEVEL})

pkg_search_module(HDF5 REQUIRED IMPORTED_TARGET hdf5-serial hdf5) # trajectories in H5MD; Debian has several builds of it

add_library(gridlock_hdf5 INTERFACE)
set(GRIDLOCK_HDF5_IS_STATIC FALSE)
if(GRIDLOCK_STATIC_HDF5)
  include(CheckCXXSourceCompiles)
  # What was not there the last time, or is gone since, is looked for again.
  foreach(entry GRIDLOCK_HDF5_ARCHIVE GRIDLOCK_SZIP_ARCHIVE GRIDLOCK_AEC_ARCHIVE)
    if(${entry} AND NOT EXISTS "${${entry}}")
      unset(${entry} CACHE)
    endif()
  endforeach()
  if(NOT GRIDLOCK_STATIC_HDF5_LINKS)
    unset(GRIDLOCK_STATIC_HDF5_LINKS CACHE)
  endif()
  find_library(GRIDLOCK_HDF5_ARCHIVE libhdf5.a HINTS ${HDF5_LIBRARY_DIRS})
  find_library(GRIDLOCK_SZIP_ARCHIVE libsz.a)  # a filter of HDF5, which the archive refers to
  find_library(GRIDLOCK_AEC_ARCHIVE libaec.a)  # what that is made of
  mark_as_advanced(GRIDLOCK_HDF5_ARCHIVE GRIDLOCK_SZIP_ARCHIVE GRIDLOCK_AEC_ARCHIVE)
  if(GRIDLOCK_HDF5_ARCHIVE AND GRIDLOCK_SZIP_ARCHIVE AND GRIDLOCK_AEC_ARCHIVE)
    set(static_hdf5 ${GRIDLOCK_HDF5_ARCHIVE} ${GRIDLOCK_SZIP_ARCHIVE} ${GRIDLOCK_AEC_ARCHIVE} z m ${CMAKE_DL_LIBS})
    set(CMAKE_REQUIRED_INCLUDES ${HDF5_INCLUDE_DIRS})
    set(CMAKE_REQUIRED_LIBRARIES ${static_hdf5})
    check_cxx_source_compiles(
      "#include <hdf5.h>
       int main() { return H5Fclose(H5Fcreate(\"file\", H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT)); }"
      GRIDLOCK_STATIC_HDF5_LINKS)
    unset(CMAKE_REQUIRED_INCLUDES)
    unset(CMAKE_REQUIRED_LIBRARIES)
    set(GRIDLOCK_HDF5_IS_STATIC ${GRIDLOCK_STATIC_HDF5_LINKS})
  endif()
  if(NOT GRIDLOCK_HDF5_IS_STATIC)
    gridlock_leave_out("the quick start of the program" "no static archives of HDF5, libsz and libaec that link" "./dev install program")
  endif()
endif()
if(GRIDLOCK_HDF5_IS_STATIC)
  string(REPLACE ";" "$<SEMICOLON>" static_hdf5_as_list "${static_hdf5}")
  target_include_directories(gridlock_hdf5 SYSTEM INTERFACE ${HDF5_INCLUDE_DIRS})
  # The archive is made for programs alone: a shared object, such as the Python module, takes the shared library.
  target_link_libraries(gridlock_hdf5 INTERFACE
    $<IF:$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>,${static_hdf5_as_list},PkgConfig::HDF5>)
else()
  target_link_libraries(gridlock_hdf5 INTERFACE PkgConfig::HDF5)
endif()
