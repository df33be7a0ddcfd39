# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
#
# What is counted on the emulated board, and held against budgets. Included by tests/CMakeLists.txt.

# What tools/bench-cortex-m4 counts.
add_executable(count_work board/count_work.c)
set_target_properties(count_work PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/bin/tests")
target_link_libraries(count_work PRIVATE elmopp_test_support elmopp_weights elmopp_flags elmopp_board)
target_link_options(count_work PRIVATE -Wl,--wrap=elmopp_controller_tick)
elmopp_add_python_test(NAME budgets_are_kept COMMAND tools/budget --build "${PROJECT_BINARY_DIR}"
    LABELS generated)
elmopp_add_python_test(NAME test_stack COMMAND -m pytest -q tests/board/test_stack.py)
set_tests_properties(test_stack PROPERTIES ENVIRONMENT "ELMOPP_BOARD_BUILD=${PROJECT_BINARY_DIR}")
elmopp_add_unity_test(NAME test_lstm_kernel SOURCES board/test_lstm_kernel.c board/portable_kernel.c
    LIBS elmopp_test_support)
elmopp_add_unity_test(NAME test_lstm_q15_kernel SOURCES board/test_lstm_q15_kernel.c board/portable_q15_kernel.c
    LIBS elmopp_test_support)
elmopp_add_unity_test(NAME test_trainer_kernel SOURCES board/test_trainer_kernel.c board/portable_trainer_kernel.c
    LIBS elmopp_test_support)
