# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
#
# Tests of host_sim, and of the Python tools that belong to it. Included by tests/CMakeLists.txt.

# elmopp_add_host_sim_test(NAME <name> [LIBS <target>...] [LABELS <label>...] [TIMEOUT <seconds>])
#
# A Unity test from tests/host_sim/<name>.cpp that links everything of host_sim but main().
function(elmopp_add_host_sim_test)
    cmake_parse_arguments(PARSE_ARGV 0 arg "" "NAME;TIMEOUT" "LABELS;LIBS")
    elmopp_add_unity_test(
        NAME ${arg_NAME}
        SOURCES ${PROJECT_SOURCE_DIR}/tests/host_sim/${arg_NAME}.cpp ${PROJECT_SOURCE_DIR}/host_files/core_assert.c
        LIBS host_sim_room ${arg_LIBS}
        LABELS ${arg_LABELS}
        TIMEOUT ${arg_TIMEOUT})
endfunction()

find_package(nlohmann_json REQUIRED) # imported targets end with the folder that found them

# Under -Og and under the sanitizers. What the optimizer makes of the same code is judged as a whole, by golden logs: a
# link-time optimization for each of these would take longer than everything else of the preset.
if(NOT CMAKE_INTERPROCEDURAL_OPTIMIZATION)
    elmopp_add_host_sim_test(NAME test_inflow LABELS golden sim)
    elmopp_add_host_sim_test(NAME test_stats LABELS golden sim)
    elmopp_add_host_sim_test(NAME test_traffic LABELS unit sim)
    elmopp_add_host_sim_test(NAME test_streets LABELS unit sim TIMEOUT 300)
    elmopp_add_host_sim_test(NAME test_road_networks LABELS unit sim TIMEOUT 300)
    elmopp_add_host_sim_test(NAME test_rivals LABELS unit sim)
    elmopp_add_host_sim_test(NAME test_rivals_greedy LABELS unit sim)
    elmopp_add_host_sim_test(NAME test_rivals_cyclic LABELS unit sim)
    elmopp_add_host_sim_test(NAME test_rivals_planning LABELS unit sim)
    elmopp_add_host_sim_test(NAME test_rivals_property LABELS property sim TIMEOUT 300)
    elmopp_add_host_sim_test(NAME test_choosers LABELS unit sim)
    elmopp_add_host_sim_test(NAME test_claims LIBS nlohmann_json::nlohmann_json LABELS unit golden sim)
    elmopp_add_host_sim_test(NAME test_jobs LABELS unit sim)
    elmopp_add_host_sim_test(NAME test_slcan_wire LABELS unit sim)
endif()

# elmopp_add_host_sim_python_test(NAME <name> [LABELS <label>...] TIMEOUT <seconds>): tests/python/<name>.py with this
# build's host_sim.
function(elmopp_add_host_sim_python_test)
    cmake_parse_arguments(PARSE_ARGV 0 arg "" "NAME;TIMEOUT" "LABELS")
    set(chosen "")
    if(NOT depends_on_no_build) # under sanitizers
        set(chosen -m "not experiments")
    endif()
    elmopp_add_python_test(
        NAME ${arg_NAME}
        COMMAND -m pytest -q ${chosen} tests/python/${arg_NAME}.py
        LABELS ${arg_LABELS}
        TIMEOUT ${arg_TIMEOUT})
    set_tests_properties(${arg_NAME} PROPERTIES ENVIRONMENT "ELMOPP_HOST_SIM=$<TARGET_FILE:host_sim>")
endfunction()

set(labels sim)
if(NOT depends_on_no_build) # under sanitizers, two minutes of a processor; the rooms' own tests are there by day
    list(APPEND labels nightly)
endif()
elmopp_add_host_sim_python_test(NAME test_reference LABELS golden ${labels} TIMEOUT 600)
elmopp_add_host_sim_python_test(NAME test_host_sim LABELS ${labels} TIMEOUT 900)
set_tests_properties(test_host_sim PROPERTIES COST 90) # the longest first, so that none is left alone at the end
if(CMAKE_BUILD_TYPE STREQUAL "Release")
    # 4,000 trials: seconds in this build, minutes in others.
    elmopp_add_host_sim_python_test(NAME test_spec_checks LABELS golden sim TIMEOUT 300)
endif()

elmopp_add_python_test(NAME claims_golden_is_up_to_date
    COMMAND tests/golden/make_claims.py --check
    LABELS golden sim)

if(depends_on_no_build)
    elmopp_add_python_test(NAME test_plot COMMAND -m pytest -q tests/python/test_plot.py LABELS unit TIMEOUT 300)
    elmopp_add_python_test(NAME test_report COMMAND -m pytest -q tests/python/test_report.py LABELS unit web)
endif()
