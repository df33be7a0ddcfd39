# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
#
# What takes a fast build: the documents against a fresh run of the main experiment, and, nightly, all that is built.

if(CMAKE_BUILD_TYPE STREQUAL "Release")
    elmopp_add_python_test(NAME documents
        COMMAND -m pytest -q tests/python/test_documents.py
        LABELS sim generated TIMEOUT 600)
    set_tests_properties(documents PROPERTIES ENVIRONMENT "ELMOPP_HOST_SIM=$<TARGET_FILE:host_sim>")

    elmopp_add_python_test(NAME test_accuracy
        COMMAND -m pytest -q tests/python/test_accuracy.py
        LABELS sim golden generated TIMEOUT 300)
    set_tests_properties(test_accuracy PROPERTIES ENVIRONMENT "ELMOPP_HOST_SIM=$<TARGET_FILE:host_sim>")

    elmopp_add_python_test(NAME test_learning
        COMMAND -m pytest -q tests/python/test_learning.py
        LABELS sim nightly TIMEOUT 300)
    set_tests_properties(test_learning PROPERTIES ENVIRONMENT "ELMOPP_HOST_SIM=$<TARGET_FILE:host_sim>")

    # Needs ./tools/setup train, which tools/check --all calls.
    elmopp_add_python_test(NAME test_train
        COMMAND -m pytest -q tests/python/test_train.py
        LABELS sim nightly TIMEOUT 3600)
    set_tests_properties(test_train PROPERTIES ENVIRONMENT "ELMOPP_HOST_SIM=$<TARGET_FILE:host_sim>")

    add_test(NAME all_choosers
        COMMAND host_sim experiment --profile paper,saturation,figure,literal --choosers all --no-figures
            --out ${PROJECT_BINARY_DIR}/all_choosers)
    set_tests_properties(all_choosers PROPERTIES LABELS "sim;nightly" TIMEOUT 3600)
endif()
