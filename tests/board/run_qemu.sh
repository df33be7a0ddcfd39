#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
#
# run_qemu.sh PROGRAM ARGUMENT...: runs a test program on the emulated board MPS2 AN386 (Cortex-M4). Output and exit
# code are the program's; 99 after a fault (134 if its stack is lost, too), 124 after the time limit. The program opens
# files of the current folder. In QEMU_PLUGIN, if it is set: a plugin of the emulator and its arguments.
set -eu

limit_s=110 # below the 120 s that ctest allows, so that no emulator is left over
if [ $# -eq 0 ]; then
    echo "run_qemu.sh: PROGRAM is missing; usage: run_qemu.sh PROGRAM ARGUMENT..." >&2
    exit 2
fi
program=$1
shift
# newlib cuts the command line at spaces; in QEMU's option a comma is written twice.
config=enable=on,target=native,arg=$(basename "$program")
for argument; do
    config=$config,arg=$(printf '%s' "$argument" | sed 's/,/,,/g')
done

ulimit -c 0
# One instruction is 64 ns of the board's time, on any machine and at any load: tests may count with it. A plugin counts by
# itself and must see no block of instructions cut short. The network leads nowhere; without one the emulator warns of an
# Ethernet chip without a cable.
set -- -M mps2-an386 -nodefaults -display none -monitor none -serial none -nic user,restrict=on,ipv6=off \
    -audiodev none,id=none -semihosting-config "$config" -kernel "$program"
if [ -n "${QEMU_PLUGIN:-}" ]; then
    set -- "$@" -plugin "$QEMU_PLUGIN"
else
    set -- "$@" -icount shift=6
fi
exec timeout --kill-after=5 "$limit_s" qemu-system-arm "$@" </dev/null
