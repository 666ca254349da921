# What scripts/package puts into packages. Components: robot (wireposed), dev (the core as a library), tools (wirepose).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(TARGETS wirepose_warnings wirepose_core_rules wirepose_base wirepose_geometry wirepose_model wirepose_stages
                wirepose_pipeline
  EXPORT Wirepose ARCHIVE COMPONENT dev)
install(EXPORT Wirepose NAMESPACE Wirepose:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Wirepose COMPONENT dev)
install(DIRECTORY src/base src/geometry src/model src/stages src/pipeline
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/wirepose COMPONENT dev FILES_MATCHING PATTERN "*.h")
install(FILES src/capacities.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/wirepose COMPONENT dev)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/WireposeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES cmake/WireposeConfig.cmake ${PROJECT_BINARY_DIR}/WireposeConfigVersion.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Wirepose COMPONENT dev)

if(TARGET wireposed)
  install(TARGETS wireposed RUNTIME COMPONENT robot)
  install(FILES config/wireposed.service DESTINATION /lib/systemd/system COMPONENT robot)
  install(FILES config/60-wirepose.rules DESTINATION /lib/udev/rules.d COMPONENT robot)
  install(FILES config/wireposed.yaml DESTINATION ${CMAKE_INSTALL_DATADIR}/wirepose COMPONENT robot)
endif()
if(TARGET wirepose)
  install(TARGETS wirepose RUNTIME COMPONENT tools)
endif()
