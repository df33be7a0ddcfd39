# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
#
# Tests on a bare-metal Cortex-M4: each is an ordinary C program for QEMU's board MPS2 AN386 (Debian package
# qemu-system-arm), with newlib's files and output by semihosting. Included by tests/CMakeLists.txt.

# Every test program links this one: start-up file, memory, newlib for an emulator.
add_library(elmopp_board OBJECT board/start.c)
target_link_libraries(elmopp_board PRIVATE elmopp_flags)
set(board_memory "${CMAKE_CURRENT_LIST_DIR}/mps2_an386.ld")
target_link_options(elmopp_board INTERFACE --specs=rdimon.specs "-T${board_memory}")
set_target_properties(elmopp_board PROPERTIES INTERFACE_LINK_DEPENDS "${board_memory}")

# What ctest starts test programs with.
set(CMAKE_CROSSCOMPILING_EMULATOR "${CMAKE_CURRENT_LIST_DIR}/run_qemu.sh")
