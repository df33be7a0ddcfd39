# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""The stack that tools/budget works out for an image is what the same code uses on the emulated board.

The program that is run is another one (tests/board/count_work.c), of the same objects: a test's printf, which it would
call if a promise of the core were broken, is in no image.
"""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

from elmopp_tools.stack_use import read_calls, read_graph

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("ELMOPP_BOARD_BUILD", ROOT / "build" / "cortex-m4"))


def test_a_tick_with_its_deepest_decision_uses_what_was_worked_out() -> None:
    run = [str(ROOT / "tests" / "board" / "run_qemu.sh"), str(BUILD / "bin" / "tests" / "count_work"), "stack"]
    used = int(subprocess.run(run, capture_output=True, text=True, check=True).stdout)
    calls = read_calls(ROOT / "tools" / "cortex_m4" / "calls.json")
    graph, _ = read_graph(BUILD / "bin" / "elmopp-mps2", BUILD / "firmware", calls)
    depth = graph.deepest(graph.named("elmopp_controller_tick"))
    assert used <= depth.bytes, depth
    # Nearly all of it: to the word where no broken promise is deeper than the way to the network.
    assert used >= 0.9 * depth.bytes, depth
