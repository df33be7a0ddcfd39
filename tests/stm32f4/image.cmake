# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
#
# The image for the STM32F405 in an emulator. Included by tests/CMakeLists.txt where there is such an image.

elmopp_add_python_test(NAME test_stm32f4_image COMMAND -m pytest -q tests/stm32f4/test_stm32f4_image.py LABELS faults TIMEOUT 300)
set_tests_properties(test_stm32f4_image PROPERTIES
    ENVIRONMENT "ELMOPP_IMAGE=$<TARGET_FILE:elmopp-stm32f4>;ELMOPP_OTHER_IMAGE=$<TARGET_FILE:elmopp-mps2>")
