# What scripts/package puts into packages. Components: robot (wireposed), dev (the core and the message types as libraries,
# examples), tools (wirepose).
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

# The types on the bus: as a library, and as IDL for other languages and DDS implementations.
if(TARGET wirepose_idl)
  set_target_properties(wirepose_idl PROPERTIES EXPORT_NAME idl)
  install(TARGETS wirepose_idl EXPORT WireposeIdl ARCHIVE COMPONENT dev)
  install(EXPORT WireposeIdl NAMESPACE Wirepose:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Wirepose COMPONENT dev)
  file(GLOB idl_files RELATIVE ${PROJECT_SOURCE_DIR}/dds_idl CONFIGURE_DEPENDS dds_idl/*.idl)
  foreach(file IN LISTS idl_files)
    string(REGEX REPLACE "\\.idl$" ".h" header ${file})
    install(FILES ${PROJECT_BINARY_DIR}/dds_idl/${header}
      DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/wirepose/dds_idl COMPONENT dev)
    install(FILES dds_idl/${file} DESTINATION ${CMAKE_INSTALL_DATADIR}/wirepose/idl COMPONENT dev)
  endforeach()
  install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DATADIR}/wirepose COMPONENT dev)
endif()

if(TARGET wireposed)
  install(TARGETS wireposed RUNTIME COMPONENT robot)
  install(FILES config/wireposed.service DESTINATION /lib/systemd/system COMPONENT robot)
  install(FILES config/60-wirepose.rules DESTINATION /lib/udev/rules.d COMPONENT robot)
  install(FILES config/wireposed.yaml DESTINATION ${CMAKE_INSTALL_DATADIR}/wirepose COMPONENT robot)
endif()
if(TARGET wirepose)
  install(TARGETS wirepose RUNTIME COMPONENT tools)
endif()
