# Evaluation and overlays.
find_package(fmt REQUIRED)

wirepose_test(eval_metrics_test SOURCES eval_metrics_test.cpp eval_dataset.cpp LIBRARIES wirepose_metrics fmt::fmt)
target_compile_definitions(eval_metrics_test PRIVATE
  WIREPOSE_SCORE_DEFAULT="${PROJECT_SOURCE_DIR}/../shared/tools/score.py")

find_package(OpenCV REQUIRED COMPONENTS core imgcodecs)
wirepose_test(overlay_test SOURCES overlay_test.cpp LIBRARIES wirepose_overlay opencv_core opencv_imgcodecs)

find_package(nlohmann_json REQUIRED)
wirepose_test(eval_cli_test SOURCES eval_cli_test.cpp eval_dataset.cpp
  LIBRARIES wirepose_evaluation nlohmann_json::nlohmann_json fmt::fmt)
target_compile_definitions(eval_cli_test PRIVATE WIREPOSE_PROGRAM="$<TARGET_FILE:wirepose>")
add_dependencies(eval_cli_test wirepose)

wirepose_test(eval_streams_test SOURCES eval_streams_test.cpp eval_dataset.cpp
  LIBRARIES wirepose_evaluation fmt::fmt nlohmann_json::nlohmann_json)
