# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
#
# Toolchain: bare-metal Arm Cortex-M4 with the single-precision FPU (Debian packages gcc-arm-none-eabi and
# libnewlib-arm-none-eabi).

set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR cortex-m4)

set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_ASM_COMPILER arm-none-eabi-gcc)

# No start-up code is known here, so CMake's compiler check must not link a program.
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)

set(cortex_m4_flags "-mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16 -ffunction-sections -fdata-sections")
set(CMAKE_C_FLAGS_INIT "${cortex_m4_flags}")
set(CMAKE_CXX_FLAGS_INIT "${cortex_m4_flags} -fno-exceptions -fno-rtti")
set(CMAKE_ASM_FLAGS_INIT "${cortex_m4_flags}")
set(CMAKE_EXE_LINKER_FLAGS_INIT "-Wl,--gc-sections")

set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
