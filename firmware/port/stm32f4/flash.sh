#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
#
# flash.sh IMAGE OBJCOPY: writes a board's program into an STM32F405RG through an ST-LINK, reads it back, and starts it,
# with OpenOCD or, where there is none, st-flash. Stored sites and weights (sectors 10 and 11) and option bytes are left
# alone. Exit code 0: written; 1: the programmer failed; 2: there is no programmer, or no image.
set -u

if [ $# -ne 2 ] || [ ! -r "$1" ]; then
    echo "flash: ${1-IMAGE} cannot be read; right would be flash.sh IMAGE OBJCOPY" >&2
    exit 2
fi
image=$1
objcopy=$2

if command -v openocd >/dev/null; then
    openocd -f interface/stlink.cfg -f target/stm32f4x.cfg -c "program {$image} verify reset exit" || exit 1
elif command -v st-flash >/dev/null; then
    "$objcopy" -O binary "$image" "$image.bin" || exit 1
    st-flash --reset write "$image.bin" 0x08000000 || exit 1
else
    echo "flash: neither openocd nor st-flash is installed; right would be one of them, on Debian apt-get install" \
        "openocd or stlink-tools" >&2
    exit 2
fi
