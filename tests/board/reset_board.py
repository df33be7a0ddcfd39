# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Pulls an emulated board's plug and puts it in again, for a program that is given a command: reset_board.py SOCKET.

SOCKET: one of the emulator's -qmp. Ends when the emulator says that it has done it.
"""

import json
import socket
import sys


def main() -> None:
    with socket.socket(socket.AF_UNIX) as line, line.makefile("rwb", buffering=0) as qmp:
        line.settimeout(60.0)
        line.connect(sys.argv[1])
        qmp.readline()
        for command in ("qmp_capabilities", "system_reset"):
            qmp.write(json.dumps({"execute": command}).encode() + b"\n")
        while json.loads(qmp.readline()).get("event") != "RESET":
            pass


main()
