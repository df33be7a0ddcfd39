# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
#
# The pages that people look at: the live page and what feeds it, the lane editor. Driven in a headless Chromium
# (Debian's, which tools/setup check installs) where a browser is what is tested.

find_package(nlohmann_json REQUIRED) # imported targets end with the folder that found them

if(NOT CMAKE_INTERPROCEDURAL_OPTIMIZATION)
    elmopp_add_unity_test(NAME test_live_page_rooms
        SOURCES live_page/test_live_page.cpp
        LIBS elmopp_test_support elmopp_live_page nlohmann_json::nlohmann_json
        LABELS unit web)
    # Threads, sockets, one process after the other: under -Og and under the sanitizers.
    elmopp_add_python_test(NAME test_serve COMMAND -m pytest -q tests/python/test_serve.py LABELS sim web TIMEOUT 300)
    set_tests_properties(test_serve PROPERTIES ENVIRONMENT "ELMOPP_HOST_SIM=$<TARGET_FILE:host_sim>")
endif()

if(depends_on_no_build)
    elmopp_add_python_test(NAME test_live_page COMMAND -m pytest -q tests/python/test_live_page.py LABELS sim web TIMEOUT 600)
    set_tests_properties(test_live_page PROPERTIES ENVIRONMENT "ELMOPP_HOST_SIM=$<TARGET_FILE:host_sim>")
endif()

if(depends_on_no_build AND ELMOPP_PERCEPTION)
    elmopp_add_python_test(NAME test_lane_editor COMMAND -m pytest -q tests/python/test_lane_editor.py LABELS camera web TIMEOUT 600)
    set_tests_properties(test_lane_editor PROPERTIES ENVIRONMENT "ELMOPP_CAMERA=$<TARGET_FILE:elmopp-camera>")
endif()
