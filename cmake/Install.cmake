include(CMakePackageConfigHelpers)
set(config_directory ${CMAKE_INSTALL_LIBDIR}/cmake/gridlock)

# For programs that do not use CMake. The files find the prefix from where they are.
file(RELATIVE_PATH GRIDLOCK_PREFIX_FROM_PKGCONFIG ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
function(gridlock_install_pkgconfig name)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/${name}.pc.in ${name}.pc @ONLY)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endfunction()

install(TARGETS gridlock_grid EXPORT gridlock-grid-targets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
        FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT gridlock-grid-targets NAMESPACE gridlock:: DESTINATION ${config_directory})
gridlock_install_pkgconfig(gridlock-grid)
if(GRIDLOCK_COMPONENTS STREQUAL "all")
  install(TARGETS gridlock EXPORT gridlock-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/gridlock DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  install(EXPORT gridlock-targets NAMESPACE gridlock:: DESTINATION ${config_directory})
  if(TARGET gridlock_command_line)  # a build of the fuzz targets alone has none
    install(EXPORT gridlock-command-line-targets NAMESPACE gridlock:: DESTINATION ${config_directory})
  endif()
  if(TARGET gridlock_mpi_command_line)
    install(EXPORT gridlock-mpi-command-line-targets NAMESPACE gridlock:: DESTINATION ${config_directory})
  endif()
  gridlock_install_pkgconfig(gridlock)
  # The page serves without a program too: it is opened from a disk.
  install(DIRECTORY ${GRIDLOCK_PAGE}/ DESTINATION ${CMAKE_INSTALL_DATADIR}/gridlock/web COMPONENT page OPTIONAL)
endif()
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/gridlock-config.cmake.in gridlock-config.cmake
                              INSTALL_DESTINATION ${config_directory})
write_basic_package_version_file(gridlock-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/gridlock-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/gridlock-config-version.cmake
        DESTINATION ${config_directory})
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT licences)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/licenses DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT licences)
