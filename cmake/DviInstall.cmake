# dvi_install(): `cmake --install` puts the program, the libraries and headers of all modules, and a package for find_package(dvi)
# into place.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

function(dvi_install)
  get_property(modules GLOBAL PROPERTY DVI_MODULES)
  set(package ${CMAKE_INSTALL_LIBDIR}/cmake/dvi)
  install(TARGETS dvi RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
  foreach(module ${modules})
    set_target_properties(dvi_${module} PROPERTIES EXPORT_NAME ${module})
    install(TARGETS dvi_${module} EXPORT dvi ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}/dvi COMPONENT development)
  endforeach()
  set_target_properties(dvi_settings PROPERTIES EXPORT_NAME settings)
  install(TARGETS dvi_settings EXPORT dvi)
  install(EXPORT dvi NAMESPACE dvi:: FILE dviTargets.cmake DESTINATION ${package} COMPONENT development)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/dvi DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development
    FILES_MATCHING PATTERN "*.h" PATTERN "testing" EXCLUDE PATTERN "test_*.h" EXCLUDE)

  configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/dviConfig.cmake.in ${PROJECT_BINARY_DIR}/dviConfig.cmake
    INSTALL_DESTINATION ${package})
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/dviConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/dviConfig.cmake ${PROJECT_BINARY_DIR}/dviConfigVersion.cmake
    ${PROJECT_SOURCE_DIR}/cmake/FindOpenCVParts.cmake ${PROJECT_SOURCE_DIR}/cmake/FindOnnxProto.cmake
    ${PROJECT_SOURCE_DIR}/cmake/FindOnnxRuntime.cmake DESTINATION ${package} COMPONENT development)
endfunction()
