# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
#
# Tests of the whole chain: its parts by themselves, and the program with everything in it.

if(NOT CMAKE_INTERPROCEDURAL_OPTIMIZATION)
    elmopp_add_host_sim_test(NAME test_places LABELS unit sim)
    elmopp_add_unity_test(NAME test_closed_loop_parts
        SOURCES closed_loop/test_closed_loop_parts.cpp ${PROJECT_SOURCE_DIR}/host_files/core_assert.c
        LIBS closed_loop_room
        LABELS unit camera sim)
endif()

# Minutes of pictures: with the optimizer, once. At night with all cameras, longer, and over a virtual CAN bus.
if(depends_on_no_build)
    set(closed_loop_environment "ELMOPP_CLOSED_LOOP=$<TARGET_FILE:elmopp-closed-loop>")
    elmopp_add_python_test(NAME test_closed_loop
        COMMAND -m pytest -q -m "not others" tests/python/test_closed_loop.py
        LABELS camera sim faults TIMEOUT 300)
    elmopp_add_python_test(NAME closed_loop_all
        COMMAND -m pytest -q -m others tests/python/test_closed_loop.py
        LABELS camera sim faults nightly TIMEOUT 3600)
    elmopp_add_python_test(NAME test_loop_table
        COMMAND -m pytest -q tests/python/test_loop_table.py tests/python/test_loop_troubles.py LABELS unit camera)
    set_tests_properties(test_closed_loop closed_loop_all PROPERTIES ENVIRONMENT "${closed_loop_environment}" COST 40)
endif()
