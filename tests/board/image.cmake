# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
#
# Tests of the image elmopp-mps2 on its emulated board, from Python. Included by tests/CMakeLists.txt.
#
# Those of the image in the loop need a host_sim of another preset, which tools/check builds before; without one they are
# skipped, and tools/check fails.

set(ELMOPP_HOST_SIM "${PROJECT_SOURCE_DIR}/build/release/bin/host_sim" CACHE FILEPATH "The host_sim that drives the image")

function(_elmopp_add_image_test name labels timeout seconds)
    elmopp_add_python_test(NAME ${name} COMMAND -m pytest -q ${ARGN} LABELS ${labels} TIMEOUT ${timeout})
    set_tests_properties(${name} PROPERTIES ENVIRONMENT
        "ELMOPP_MPS2=$<TARGET_FILE:elmopp-mps2>;ELMOPP_HOST_SIM=${ELMOPP_HOST_SIM};ELMOPP_BOARD_SECONDS=${seconds}")
endfunction()

elmopp_add_python_test(NAME layers_of_symbols
    COMMAND tools/layers --library $<TARGET_FILE:elmopp_core> --nm "${CMAKE_NM}"
    LABELS layers)

_elmopp_add_image_test(test_image faults 900 0 tests/board/test_image.py)
set_tests_properties(test_image PROPERTIES COST 60)

_elmopp_add_image_test(test_image_learning faults 900 0 -k "not after_a_reset" tests/board/test_image_learning.py)
_elmopp_add_image_test(test_image_learns "faults;nightly" 1800 0 -k after_a_reset tests/board/test_image_learning.py)

# One a chooser, so that they run beside each other.
foreach(chooser IN ITEMS naive cumulative:lstm pressure priced rollout)
    string(REPLACE ":" "_" name "${chooser}")
    set(test "tests/board/test_loop.py::test_the_log_of_the_board_is_the_log_in_process_byte_for_byte[${chooser}]")
    _elmopp_add_image_test(test_loop_${name} sim 900 100 "${test}")
    set_tests_properties(test_loop_${name} PROPERTIES COST 40)
    _elmopp_add_image_test(test_loop_${name}_2000_s "sim;nightly" 3600 2000 "${test}")
endforeach()
_elmopp_add_image_test(test_closed_loop_board "camera;sim;nightly" 900 0 tests/board/test_closed_loop_board.py)
_elmopp_add_image_test(test_loop_others "sim;nightly" 3600 200 -m others tests/board/test_loop.py)

# Behind slcand in the virtual machine, an emulator in an emulator: with programs of the same other preset.
get_filename_component(programs "${ELMOPP_HOST_SIM}" DIRECTORY)
add_test(NAME test_slcan_chain
    COMMAND tests/socketcan/run "${programs}" "${PROJECT_BINARY_DIR}/socketcan" --slcan "$<TARGET_FILE:elmopp-mps2>"
    WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}")
_elmopp_set_test_properties(test_slcan_chain "socketcan;nightly" 1800)
