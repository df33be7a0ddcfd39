# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
#
# The drivers of the STM32F405: everything that reaches hardware through register_access.h alone. They are built for the
# board and, for the tests at models of the registers, for every other machine.

set(ELMOPP_STM32F4_HSE_HZ 8000000 CACHE STRING "Frequency of the STM32F405 board's crystal in hertz")

add_library(elmopp_stm32f4_drivers STATIC
    ${CMAKE_CURRENT_LIST_DIR}/bxcan.c
    ${CMAKE_CURRENT_LIST_DIR}/bxcan_fifo.c
    ${CMAKE_CURRENT_LIST_DIR}/bxcan_mailbox.c
    ${CMAKE_CURRENT_LIST_DIR}/clocks.c
    ${CMAKE_CURRENT_LIST_DIR}/debounce.c
    ${CMAKE_CURRENT_LIST_DIR}/flash_writer.c
    ${CMAKE_CURRENT_LIST_DIR}/pins.c
    ${CMAKE_CURRENT_LIST_DIR}/reset_cause.c
    ${CMAKE_CURRENT_LIST_DIR}/serial.c
    ${CMAKE_CURRENT_LIST_DIR}/watchdog.c)
target_include_directories(elmopp_stm32f4_drivers PUBLIC ${CMAKE_CURRENT_LIST_DIR})
target_compile_definitions(elmopp_stm32f4_drivers PUBLIC ELMOPP_STM32F4_HSE_HZ=${ELMOPP_STM32F4_HSE_HZ}U)
target_link_libraries(elmopp_stm32f4_drivers PUBLIC elmopp_core PRIVATE elmopp_flags)
