# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""The core's flow through gaps (gaps.h) against gaps that are summed up and gaps that are drawn."""

from __future__ import annotations

import os
import struct
import subprocess
from pathlib import Path

import pytest
from references import load_reference

ROOT = Path(__file__).resolve().parents[2]
PROBE = os.environ.get("ELMOPP_ROLLOUT_PROBE", str(ROOT / "build" / "host" / "bin" / "tests" / "rollout_probe"))
OPPOSING = [step / 500 for step in range(750)]

REFERENCE = load_reference("gaps_reference")


def said_by_the_core(opposing: list[float]) -> list[float]:
    numbers = struct.pack(f"<{len(opposing) + 1}f", len(opposing), *opposing)
    done = subprocess.run([PROBE, "gaps"], input=numbers, capture_output=True, timeout=60, check=True)
    return list(struct.unpack(f"<{len(opposing)}f", done.stdout))


def test_the_core_is_within_its_bound_of_the_sum() -> None:
    for opposing, flow in zip(OPPOSING, said_by_the_core(OPPOSING), strict=True):
        assert flow == pytest.approx(REFERENCE.by_sum(opposing), abs=0.0005)


def test_the_core_has_the_straight_lines() -> None:
    for opposing, flow in zip(OPPOSING, said_by_the_core(OPPOSING), strict=True):
        assert flow == pytest.approx(REFERENCE.by_lines(opposing), abs=2e-6)


@pytest.mark.parametrize("opposing", [0.1, 0.25, 0.5])
def test_the_sum_is_what_drawn_gaps_let_through(opposing: float) -> None:
    drawn = REFERENCE.by_drawing(opposing, 200_000, seed=1)
    assert drawn == pytest.approx(REFERENCE.by_sum(opposing), rel=0.02)


def test_the_first_gap_is_as_long_as_the_header_says() -> None:
    header = (ROOT / "firmware" / "include" / "elmopp" / "gaps.h").read_text()
    assert f"ELMOPP_GAPS_CRITICAL_S {REFERENCE.CRITICAL}F" in header
    assert f"ELMOPP_GAPS_FOLLOW_UP_S {REFERENCE.FOLLOW_UP}F" in header
