# `cpack` in a build directory makes a Debian package and an archive of what `cmake --install` installs.
set(CPACK_PACKAGE_NAME gridlock)
set(CPACK_PACKAGE_VENDOR "The Gridlock developers")
set(CPACK_PACKAGE_CONTACT "The Gridlock developers <gridlock@example.org>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Simulator of many agents that interact with near neighbours only")
string(REPLACE "-" "~" CPACK_DEBIAN_PACKAGE_VERSION ${GRIDLOCK_VERSION})  # which Debian sorts before the release
set(CPACK_PACKAGE_FILE_NAME "gridlock-${GRIDLOCK_VERSION}-${CMAKE_SYSTEM_NAME}-${CMAKE_SYSTEM_PROCESSOR}")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_GENERATOR TGZ DEB)
set(CPACK_STRIP_FILES ON)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
# The shared libraries are found by dpkg-shlibdeps; programs that are run are named here.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "fonts-dejavu-core")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "ffmpeg")
include(CPack)
