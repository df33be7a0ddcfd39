# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
#
# The image for the STM32F405 in an emulator. Included by tests/CMakeLists.txt where there is such an image.

# QEMU 7.2 has no core-coupled memory, so what lies there lies in the RAM that it has too much; nothing else is different.
set(port "${PROJECT_SOURCE_DIR}/firmware/port/stm32f4")
elmopp_add_board_image(NAME elmopp-stm32f4-emulated MEMORY "${port}/stm32f4.ld"
    SOURCES "${port}/stm32f4_port.c" "${port}/register_access.c" "${port}/../cortex_m/own_pace.c"
    LIBS elmopp_stm32f4_drivers)
target_link_options(elmopp-stm32f4-emulated PRIVATE -Wl,--defsym=elmopp_aside=0x20020000)

elmopp_add_python_test(NAME test_stm32f4_image COMMAND -m pytest -q tests/stm32f4/test_stm32f4_image.py LABELS faults TIMEOUT 300)
set_tests_properties(test_stm32f4_image PROPERTIES
    ENVIRONMENT "ELMOPP_IMAGE=$<TARGET_FILE:elmopp-stm32f4-emulated>;ELMOPP_FLASHED=$<TARGET_FILE:elmopp-stm32f4>;ELMOPP_OTHER_IMAGE=$<TARGET_FILE:elmopp-mps2>")
