# dvi_install(): `cmake --install` puts the program, the libraries and headers of all rooms, and a package for find_package(dvi)
# into place.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

function(dvi_install)
  get_property(rooms GLOBAL PROPERTY DVI_ROOMS)
  set(package ${CMAKE_INSTALL_LIBDIR}/cmake/dvi)
  install(TARGETS dvi RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
  foreach(room ${rooms})
    set_target_properties(dvi_${room} PROPERTIES EXPORT_NAME ${room})
    install(TARGETS dvi_${room} EXPORT dvi ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}/dvi COMPONENT development)
  endforeach()
  set_target_properties(dvi_settings PROPERTIES EXPORT_NAME settings)
  install(TARGETS dvi_settings EXPORT dvi)
  install(EXPORT dvi NAMESPACE dvi:: FILE dviTargets.cmake DESTINATION ${package} COMPONENT development)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/dvi DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development
    FILES_MATCHING PATTERN "*.h")

  configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/dviConfig.cmake.in ${PROJECT_BINARY_DIR}/dviConfig.cmake
    INSTALL_DESTINATION ${package})
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/dviConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/dviConfig.cmake ${PROJECT_BINARY_DIR}/dviConfigVersion.cmake
    ${PROJECT_SOURCE_DIR}/cmake/FindOpenCVParts.cmake DESTINATION ${package} COMPONENT development)
endfunction()
