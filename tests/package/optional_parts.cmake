cmake_minimum_required(VERSION 3.25)

# Optional libraries that are there by half, and that come or go between two configurations of one build directory.
foreach(name SOURCE_DIRECTORY WORK_DIRECTORY GENERATOR COMPILER)
  if(NOT DEFINED ${name})
    message(FATAL_ERROR "${name} is not given")
  endif()
endforeach()
file(REMOVE_RECURSE ${WORK_DIRECTORY})
set(build ${WORK_DIRECTORY}/build)

# configure(OPTION…): a configuration of the program, of which `result`, `output` and `left_out` are left.
macro(configure)
  execute_process(COMMAND ${CMAKE_COMMAND} -G ${GENERATOR} -S ${SOURCE_DIRECTORY} -B ${build} -DCMAKE_CXX_COMPILER=${COMPILER}
                          -DGRIDLOCK_BUILD_TESTS=OFF -DGRIDLOCK_BUILD_BENCHMARKS=OFF ${ARGN}
                  RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  # CMake breaks its messages into lines, which depend on the length of the path.
  string(REGEX REPLACE "[ \n]+" " " output "${output}")
  set(left_out "")
  if(result EQUAL 0)
    file(READ ${build}/left_out.txt left_out)
  endif()
endmacro()

function(require_success situation)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${situation} ends the configuration:\n${output}")
  endif()
endfunction()

# require_left_out(SITUATION TEXT…): the notes have every text.
function(require_left_out situation)
  require_success("${situation}")
  foreach(text ${ARGN})
    string(FIND "${left_out}" "${text}" place)
    if(place EQUAL -1)
      message(FATAL_ERROR "${situation}: no note says \"${text}\", but there are\n${left_out}")
    endif()
  endforeach()
endfunction()

# require_built(SITUATION PROGRAM)
function(require_built situation program)
  require_success("${situation}")
  if(left_out MATCHES "${program}" OR NOT EXISTS ${build}/apps/${program}/cmake_install.cmake)
    message(FATAL_ERROR "${situation}: ${program} is left out:\n${left_out}")
  endif()
endfunction()

# A compiler of MPI that comes first on the path and whose headers another package has: as openmpi-bin without libopenmpi-dev.
set(mpi ${WORK_DIRECTORY}/mpi)
file(WRITE ${mpi}/mpicxx "#!/bin/sh
case \"$1\" in
-showme:compile) echo -I${mpi}/include ;;
-showme:link) echo -lm ;;
-show*) echo ${COMPILER} -I${mpi}/include -lm ;;
*) exec ${COMPILER} -I${mpi}/include \"$@\" ;;
esac\n")
file(WRITE ${mpi}/mpiexec "#!/bin/sh\n")
file(CHMOD ${mpi}/mpicxx ${mpi}/mpiexec PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE)
set(path_before "$ENV{PATH}")
set(ENV{PATH} "${mpi}:${path_before}")
# A library of the viewer that pkg-config describes and that is not there.
set(descriptions ${WORK_DIRECTORY}/pkgconfig)
file(WRITE ${descriptions}/cpp-httplib.pc "Name: cpp-httplib\nDescription: of a test\nVersion: 0.11\nLibs: -lcpp-httplib-that-is-gone\n")
set(ENV{PKG_CONFIG_PATH} ${descriptions})
# An archive that nothing can be linked with.
set(archive ${WORK_DIRECTORY}/libsz.a)
file(WRITE ${archive} "!<arch>\n")

configure(-DGRIDLOCK_SZIP_ARCHIVE=${archive})
require_left_out("libraries that are there by half" "gridlock-mpi: left out" "${mpi}/include" "./dev install mpi"
                 "gridlock-view: left out" "cpp-httplib-that-is-gone" "./dev install program" "static archives of HDF5")
configure(-DGRIDLOCK_MPI=ON)
if(result EQUAL 0 OR NOT output MATCHES "GRIDLOCK_MPI is ON, but gridlock-mpi cannot be built" OR NOT output MATCHES "./dev install mpi")
  message(FATAL_ERROR "MPI without headers, which was asked for, is not refused with a hint:\n${output}")
endif()

# All of them come, into the same build directory.
file(WRITE ${mpi}/include/mpi.h "#define MPI_VERSION 3
#define MPI_SUBVERSION 1
#define MPI_MAX_LIBRARY_VERSION_STRING 8
inline int MPI_Init(int*, char***) { return 0; }
inline int MPI_Finalize() { return 0; }
inline int MPI_Get_library_version(char*, int*) { return 0; }\n")
set(ENV{PKG_CONFIG_PATH} "")
file(REMOVE ${archive})
configure(-DGRIDLOCK_MPI=AUTO)
require_built("an MPI whose headers came later" gridlock-mpi)
require_built("a cpp-httplib that came later" gridlock-view)
if(left_out MATCHES "HDF5")
  message(FATAL_ERROR "static archives that came later are not taken:\n${left_out}")
endif()

# MPI goes again, all but its compiler.
file(REMOVE ${mpi}/include/mpi.h)
configure()
require_left_out("an MPI whose headers are gone" "gridlock-mpi: left out" "./dev install mpi")
