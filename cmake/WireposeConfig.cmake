# find_package(Wirepose): the recognizer core; link Wirepose::wirepose_pipeline.
# find_package(Wirepose COMPONENTS idl): the types on the bus as well, for Cyclone DDS; link Wirepose::idl.
include(CMakeFindDependencyMacro)
find_dependency(Eigen3 3.4)
find_dependency(tl-expected)
include(${CMAKE_CURRENT_LIST_DIR}/Wirepose.cmake)

if("idl" IN_LIST Wirepose_FIND_COMPONENTS)
  find_dependency(CycloneDDS 0.10)
  include(${CMAKE_CURRENT_LIST_DIR}/WireposeIdl.cmake OPTIONAL RESULT_VARIABLE Wirepose_idl_FOUND)
endif()
foreach(component IN LISTS Wirepose_FIND_COMPONENTS)
  if(Wirepose_FIND_REQUIRED_${component} AND NOT Wirepose_${component}_FOUND)
    set(Wirepose_FOUND FALSE)
    set(Wirepose_NOT_FOUND_MESSAGE "this installation of Wirepose has no component ${component}")
  endif()
endforeach()
