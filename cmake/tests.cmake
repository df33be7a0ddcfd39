# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
#
# How a test is added. Every test runs in the project's root, so tests/golden/x.json is a path that works, and
# says "skipped" with exit code 77; tools/check fails on a skip that tools/allowed-skips.txt does not name.
# Where there is a target elmopp_board (tests/board), programs are built for that board, run in its emulator and have
# the label qemu besides their own.

# elmopp_add_unity_test(NAME <name> SOURCES <file>... [LIBS <target>...] [LABELS <label>...] [TIMEOUT <seconds>])
#
# Builds bin/tests/<name> from C or C++ sources with Unity and adds it to ctest. Default label: unit.
function(elmopp_add_unity_test)
    cmake_parse_arguments(PARSE_ARGV 0 arg "" "NAME;TIMEOUT" "SOURCES;LIBS;LABELS")
    _elmopp_check_test_arguments(elmopp_add_unity_test "${arg_NAME}" "${arg_UNPARSED_ARGUMENTS}")
    if(NOT arg_SOURCES)
        message(FATAL_ERROR "elmopp_add_unity_test(NAME ${arg_NAME}): SOURCES is missing.")
    endif()
    add_executable(${arg_NAME} ${arg_SOURCES})
    set_target_properties(${arg_NAME} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/bin/tests")
    target_link_libraries(${arg_NAME} PRIVATE ${arg_LIBS} elmopp_flags unity $<TARGET_NAME_IF_EXISTS:elmopp_board>)
    add_test(NAME ${arg_NAME} COMMAND ${arg_NAME} WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}")
    _elmopp_set_test_properties("${arg_NAME}" "${arg_LABELS}" "${arg_TIMEOUT}")
endfunction()

# elmopp_add_python_test(NAME <name> COMMAND <argument>... [LABELS <label>...] [TIMEOUT <seconds>])
#
# Adds a test that runs the Python of build/venv/check with these arguments: a script and its options, or
# `-m pytest tests/test_x.py`. Without that environment the test fails and says how to make it.
function(elmopp_add_python_test)
    cmake_parse_arguments(PARSE_ARGV 0 arg "" "NAME;TIMEOUT" "COMMAND;LABELS")
    _elmopp_check_test_arguments(elmopp_add_python_test "${arg_NAME}" "${arg_UNPARSED_ARGUMENTS}")
    if(NOT arg_COMMAND)
        message(FATAL_ERROR "elmopp_add_python_test(NAME ${arg_NAME}): COMMAND is missing.")
    endif()
    add_test(NAME ${arg_NAME}
        COMMAND "${PROJECT_SOURCE_DIR}/cmake/venv_python.sh" ${arg_COMMAND}
        WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}")
    _elmopp_set_test_properties("${arg_NAME}" "${arg_LABELS}" "${arg_TIMEOUT}")
endfunction()

function(_elmopp_check_test_arguments function_name test_name unparsed)
    if(test_name STREQUAL "")
        message(FATAL_ERROR "${function_name}: NAME is missing.")
    endif()
    if(unparsed)
        message(FATAL_ERROR "${function_name}(NAME ${test_name}): unknown argument '${unparsed}'.")
    endif()
endfunction()

function(_elmopp_set_test_properties test_name labels timeout)
    if(NOT labels)
        set(labels unit)
    endif()
    if(TARGET elmopp_board)
        list(APPEND labels qemu)
    endif()
    if(NOT timeout)
        set(timeout 120)
    endif()
    set_tests_properties(${test_name} PROPERTIES
        LABELS "${labels}"
        TIMEOUT "${timeout}"
        SKIP_RETURN_CODE 77)
endfunction()
