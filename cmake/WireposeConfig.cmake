# find_package(Wirepose): the recognizer core. Link Wirepose::wirepose_pipeline.
include(CMakeFindDependencyMacro)
find_dependency(Eigen3 3.4)
find_dependency(tl-expected)
include(${CMAKE_CURRENT_LIST_DIR}/Wirepose.cmake)
