cmake_minimum_required(VERSION 3.25)

# The libraries that a start of PROGRAM loads; none may be one of a network or of HDF5, which take longer than all others.
if(NOT EXISTS "${PROGRAM}")
  message(FATAL_ERROR "there is no program ${PROGRAM}")
endif()
file(GET_RUNTIME_DEPENDENCIES EXECUTABLES ${PROGRAM} RESOLVED_DEPENDENCIES_VAR libraries
     UNRESOLVED_DEPENDENCIES_VAR missing)
list(LENGTH libraries count)
if(count EQUAL 0)
  message(FATAL_ERROR "${PROGRAM} seems to load no library at all")
endif()
message("${PROGRAM} loads ${count} libraries")
foreach(library ${libraries} ${missing})
  if(library MATCHES "/lib(hdf5|curl|ldap|krb5|gnutls|ssl)[^/]*$")
    message(FATAL_ERROR "${PROGRAM} loads ${library}")
  endif()
endforeach()
