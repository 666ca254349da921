# Evaluation and overlays.
find_package(fmt REQUIRED)

wirepose_test(eval_metrics_test SOURCES eval_metrics_test.cpp eval_dataset.cpp LIBRARIES wirepose_evaluation fmt::fmt)
target_compile_definitions(eval_metrics_test PRIVATE
  WIREPOSE_SCORE_DEFAULT="${PROJECT_SOURCE_DIR}/../shared/tools/score.py")
