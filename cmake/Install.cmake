include(CMakePackageConfigHelpers)

install(TARGETS gridlock EXPORT gridlock-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/gridlock DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT gridlock-targets NAMESPACE gridlock:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/gridlock)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/gridlock-config.cmake.in gridlock-config.cmake
                              INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/gridlock)
write_basic_package_version_file(gridlock-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/gridlock-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/gridlock-config-version.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/gridlock)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/licenses DESTINATION ${CMAKE_INSTALL_DOCDIR})
