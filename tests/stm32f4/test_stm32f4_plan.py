# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""What is worked out when the STM32F405's port is compiled: a crystal that cannot do does not compile, and says why."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

PORT = Path(__file__).resolve().parents[2] / "firmware" / "port" / "stm32f4"


def compiled(*definitions: str, port: Path = PORT) -> tuple[bool, str]:
    """Whether the plan of clocks and bits compiles, and what the compiler says."""
    command = ["cc", "-std=c11", "-fsyntax-only", f"-I{port}", *definitions, "-x", "c", "-"]
    done = subprocess.run(command, input='#include "bit_timing.h"\n', check=False, capture_output=True, text=True)
    return done.returncode == 0, done.stderr


@pytest.mark.parametrize("hertz", [4_000_000, 8_000_000, 12_000_000, 16_000_000, 25_000_000, 26_000_000])
def test_a_usual_crystal_will_do(hertz: int) -> None:
    good, said = compiled(f"-DELMOPP_STM32F4_HSE_HZ={hertz}U")
    assert good, said


@pytest.mark.parametrize(
    ("hertz", "why"),
    [
        (3_000_000, "a crystal of 4 to 26 MHz"),
        (27_000_000, "a crystal of 4 to 26 MHz"),
        (7_372_800, "a crystal of whole megahertz"),
    ],
)
def test_a_crystal_that_cannot_do_is_refused_with_the_reason(hertz: int, why: str) -> None:
    good, said = compiled(f"-DELMOPP_STM32F4_HSE_HZ={hertz}U")
    assert not good
    assert why in said


def test_a_build_without_a_crystal_s_frequency_says_what_would_be_right() -> None:
    good, said = compiled()
    assert not good
    assert "right would be the frequency of the board's crystal" in said


@pytest.mark.parametrize(
    ("megahertz", "why"),
    [(168, ""), (160, ""), (147, "500 kbit/s exactly"), (164, "no bit of 13 to 19 quanta from this clock")],
)
def test_a_processor_clock_from_which_there_is_no_bit_is_refused(tmp_path: Path, megahertz: int, why: str) -> None:
    for name in ("bit_timing.h", "clock_plan.h", "registers.h", "register_access.h"):
        text = (PORT / name).read_text(encoding="utf-8")
        text = text.replace("ELMOPP_SYSCLK_HZ 168000000U", f"ELMOPP_SYSCLK_HZ {megahertz}000000U")
        (tmp_path / name).write_text(text, encoding="utf-8")
    good, said = compiled("-DELMOPP_STM32F4_HSE_HZ=8000000U", port=tmp_path)
    assert good == (not why), said
    assert why in said
