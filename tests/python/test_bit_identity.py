# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""The networks give the same bits from every compiler, level of optimisation and processor.

tests/golden/lstm_digest.txt is what tests/lstm_digest.c prints in any of these builds. It changes only when the
arithmetic is meant to change, and then with the weights that were trained on it.
"""

from __future__ import annotations

import subprocess
from collections.abc import Sequence
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BOARD = ROOT / "tests" / "board"
GOLDEN = ROOT / "tests" / "golden" / "lstm_digest.txt"
ROOMS = ("ann_f32", "elementary", "gcn_f32", "lstm_f32", "lstm_q15", "lstm_q15_table", "lstm_quantize")
SOURCES = ("tests/lstm_digest.c", *(f"firmware/src/{room}.c" for room in ROOMS))
PORTABLE_KERNELS = ("firmware/src/lstm_kernel.c", "firmware/src/lstm_q15_kernel.c")
CORTEX_M4_KERNELS = ("firmware/port/cortex_m/lstm_kernel.S", "firmware/port/cortex_m/lstm_q15_kernel.S")

# The core's own, as in CMakeLists.txt and firmware/CMakeLists.txt; tests of each preset hold those to the same file.
FLAGS = ("-std=c11", "-ffp-contract=off", "-fno-trapping-math", "-fno-math-errno")
LEVELS = ("-O0", "-O1", "-O2", "-O3", "-Os")
AVX2 = ("-O3", "-march=x86-64-v3")
CORTEX_M4 = ("arm-none-eabi-gcc", "-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16")
ON_BOARD = ("--specs=rdimon.specs", f"-T{BOARD / 'mps2_an386.ld'}", "-Wl,--gc-sections", str(BOARD / "start.c"))


def processor_has_avx2() -> bool:
    path = Path("/proc/cpuinfo")
    words = set(path.read_text(encoding="utf-8").split()) if path.exists() else set()
    return {"avx2", "bmi2", "fma"} <= words


needs_avx2 = pytest.mark.skipif(not processor_has_avx2(), reason="this processor cannot run x86-64-v3")


def output_of(command: Sequence[str]) -> str:
    try:
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=120, check=False)
    except FileNotFoundError:
        pytest.fail(f"{command[0]} is not installed: run ./tools/setup check")
    assert done.returncode == 0, f"{' '.join(command)}\nended with {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout


def build(program: Path, compiler: Sequence[str], kernels: Sequence[str], *options: str) -> None:
    folders = ("-Ifirmware/include", "-Itests/support")
    output_of([*compiler, *FLAGS, *folders, *SOURCES, *kernels, *options, "-o", str(program)])


def digest_here(folder: Path, compiler: str, *options: str) -> str:
    program = folder / "lstm_digest"
    build(program, [compiler], PORTABLE_KERNELS, *options)
    return output_of([str(program)])


def digest_on_board(folder: Path, kernels: Sequence[str], *options: str) -> str:
    program = folder / "lstm_digest.elf"
    build(program, CORTEX_M4, kernels, *ON_BOARD, *options)
    return output_of([str(BOARD / "run_qemu.sh"), str(program)])


@pytest.fixture
def golden() -> str:
    return GOLDEN.read_text(encoding="utf-8")


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_every_compiler_and_level_gives_the_same_bits(tmp_path: Path, golden: str, compiler: str, level: str) -> None:
    assert digest_here(tmp_path, compiler, level) == golden


@needs_avx2
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_eight_values_at_a_time_give_the_same_bits(tmp_path: Path, golden: str, compiler: str) -> None:
    assert digest_here(tmp_path, compiler, *AVX2) == golden


def test_sanitizers_find_nothing_and_leave_the_bits(tmp_path: Path, golden: str) -> None:
    sanitizers = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all")
    assert digest_here(tmp_path, "gcc", "-O1", *sanitizers) == golden


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("kernels", [PORTABLE_KERNELS, CORTEX_M4_KERNELS], ids=["portable", "cortex-m4"])
def test_a_cortex_m4_gives_the_same_bits(tmp_path: Path, golden: str, kernels: Sequence[str], level: str) -> None:
    assert digest_on_board(tmp_path, kernels, level) == golden


# The tests above can fail: a build that joins a product and a sum into one rounding gives other bits in every part.


def differing_parts(digest: str, golden: str) -> int:
    pairs = zip(digest.splitlines(), golden.splitlines(), strict=True)
    return sum(ours != theirs for ours, theirs in pairs)


@needs_avx2
def test_a_build_that_contracts_is_found_out(tmp_path: Path, golden: str) -> None:
    digest = digest_here(tmp_path, "gcc", *AVX2, "-ffp-contract=fast")
    assert differing_parts(digest, golden) == len(golden.splitlines())


def test_a_cortex_m4_that_contracts_is_found_out(tmp_path: Path, golden: str) -> None:
    digest = digest_on_board(tmp_path, PORTABLE_KERNELS, "-O2", "-ffp-contract=fast")
    assert differing_parts(digest, golden) == len(golden.splitlines())
