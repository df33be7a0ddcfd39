# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""The core's rollout against the independent one in double precision: the same costs V, the same stage.

The reference (tests/reference/rollout_reference.py) was written from the pseudo-code. What the C says comes out of
tests/rollout_probe.c. Each case is a random junction that lives through random seconds; the last one is compared, as
the core works it out, and as the same sources do with every float a double: what is left then is no rounding.

Where the rule finds two stages about as good, a rounding error can send a modelled future another way; with the counts
of these seeds none does, hence these seeds, for good.
"""

from __future__ import annotations

import math
import os
import random
import re
import struct
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from references import load_reference

ROOT = Path(__file__).resolve().parents[2]
PROBE = os.environ.get("ELMOPP_ROLLOUT_PROBE", str(ROOT / "build" / "host" / "bin" / "tests" / "rollout_probe"))
NONE = 63
CASES = 200
RELATIVE_BOUND = {"f": 3e-4, "d": 1e-9}  # the worst of these cases: 2.6e-4, and below 1e-9 with doubles
ROOMS = ["rollout", "coming", "future", "gaps", "sight", "account", "elementary", "junction"]


REFERENCE = load_reference("rollout_reference")


def single(value: float) -> float:
    """Rounded to what single precision can hold, so that both sides begin with the same numbers."""
    return float(struct.unpack("<f", struct.pack("<f", value))[0])


@dataclass
class Second:
    stage: int
    target: int
    elapsed_s: int
    present: list[float]
    arrived: list[float]
    share: list[float]
    rows: list[list[float]]


@dataclass
class Case:
    site: Any
    setting: Any
    amber_ds: list[int]
    intergreen_ds: list[list[int]]
    seconds: list[Second]


def let_give_way(source: random.Random, site: Any, lanes: int) -> None:
    """Some lanes give way to some others, by shares that a site can say."""
    site.gives_way = [{foe for foe in range(lanes) if foe != j and source.random() < 0.3} for j in range(lanes)]
    site.gives_way_share = [source.choice([0.25, 0.5, 1.0, 1.0]) if foes else 0.0 for foes in site.gives_way]


def junction(source: random.Random, right_of_way: random.Random) -> tuple[Any, list[int], list[list[int]]]:
    lanes = source.randint(2, 8)
    law = source.choice([0, 0, 0, 1, 2])
    amber = [source.choice([0, 30]) for _ in range(lanes)]
    intergreen = [[source.choice([0, 35, 50, 57]) for _ in range(lanes)] for _ in range(lanes)]
    stages = sorted({source.randint(1, 2**lanes - 1) for _ in range(source.randint(2, 6))})
    site = REFERENCE.Site(
        saturation=[single(source.uniform(0.3, 1.2)) for _ in range(lanes)],
        startup=[source.choice([0.0, 1.5, 2.0]) for _ in range(lanes)],
        capacity=[single(source.uniform(9.0, 40.0)) for _ in range(lanes)],
        lanes=[source.randint(1, 2) for _ in range(lanes)],
        approach=[source.randrange(3) for _ in range(lanes)],
        stages=stages,
        change=[[change_s(amber, intergreen, one, other) for other in stages] for one in stages],
        free_flow=10.0 if law else 0.0,
        law=law,
    )
    if not law and right_of_way.random() < 0.6:
        let_give_way(right_of_way, site, lanes)
    return site, amber, intergreen


def change_s(amber: list[int], intergreen: list[list[int]], before: int, after: int) -> int:
    ends = [j for j in range(len(amber)) if before >> j & 1 and not after >> j & 1]
    starts = [j for j in range(len(amber)) if after >> j & 1 and not before >> j & 1]
    return math.ceil(max([amber[j] for j in ends] + [intergreen[j][i] for j in ends for i in starts], default=0) / 10)


def lived(source: random.Random, site: Any, with_rows: bool) -> list[Second]:
    """Seconds in which vehicles come, and leave on green; at last a stage is shown that may be left."""
    count, stages = len(site.saturation), len(site.stages)
    present = [float(source.randint(0, 6)) for _ in range(count)]
    busy = [source.uniform(0.0, 0.4) for _ in range(count)]
    stage, elapsed, clearing, seconds = source.randrange(stages), 1, 0, []
    for t in range(source.randint(40, 150)):
        if clearing > 0:
            clearing -= 1
        elif elapsed > 8 and source.random() < 0.08 and t < 30:
            stage, elapsed, clearing = source.randrange(stages), 0, 5
        else:
            elapsed += 1
        arrived = [round(source.uniform(0.2, 1.9), 2) if source.random() < busy[j] else 0.0 for j in range(count)]
        for j in range(count):
            leaves = not clearing and site.serves(stage, j) and elapsed > 2 and source.random() < 0.8
            present[j] = max(present[j] + arrived[j] - (source.uniform(0.1, 0.9) if leaves else 0.0), 0.0)
            present[j] = single(present[j])
        share = [single(source.random()) for _ in range(count)]
        rows = [[single(source.uniform(0.0, 0.9)) for _ in range(60)] for _ in range(3)] if with_rows else []
        seconds.append(
            Second(
                NONE if clearing else stage,
                stage,
                0 if clearing else elapsed,
                list(present),
                [single(value) for value in arrived],
                share,
                rows,
            )
        )
    return seconds


def let_come_true(source: random.Random, site: Any, seconds: list[Second]) -> None:
    """Writes into the rows who will come, more or less."""
    wrong = source.choice([0.0, 0.1, 0.4])
    came = [
        [sum(second.arrived[j] for j in range(len(site.approach)) if site.approach[j] == i) for second in seconds]
        for i in range(3)
    ]
    for t, second in enumerate(seconds):
        for i in range(3):
            coming = came[i][t + 1 : t + 61]
            second.rows[i][: len(coming)] = [single(max(c + source.gauss(0.0, wrong), 0.0)) for c in coming]


def make_case(seed: int) -> Case:
    source = random.Random(f"rollout {seed}")
    site, amber, intergreen = junction(source, random.Random(f"right of way {seed}"))
    setting = REFERENCE.Setting(
        travel=source.choice([0, 4, 8, 12]),
        horizon=source.choice([120, 120, 60, 150]),
        r_trig=source.choice([0, 60, 120, 1000]),
        f_rows=source.choice([0.5, 1.0]),
        others=source.choice([1, 2, 4]),
        caution=source.choice([0.0, 0.5, 1.0]),
    )
    seconds = lived(source, site, source.random() < 0.4)
    setting.by_skill = source.random() < 0.8
    if seconds[0].rows and source.random() < 0.6:
        let_come_true(source, site, seconds)
    return Case(site, setting, amber, intergreen, seconds)


def numbers_of(case: Case) -> list[float]:
    site, setting = case.site, case.setting
    count = len(site.saturation)
    numbers: list[float] = [3, count, len(site.stages), site.law, site.free_flow]
    for j in range(count):
        numbers += [site.saturation[j], 10 * site.startup[j], site.capacity[j], site.lanes[j], site.approach[j]]
        numbers += [case.amber_ds[j], *case.intergreen_ds[j]]
        foes = site.gives_way[j] if site.gives_way else set()
        numbers += [sum(1 << foe for foe in foes), 100 * site.gives_way_share[j] if foes else 0]
    numbers += site.stages
    numbers += [setting.travel, setting.horizon, setting.r_trig, setting.f_rows, setting.by_skill]
    numbers += [setting.others, setting.caution]
    numbers += [len(case.seconds), len(case.seconds[0].rows[0]) if case.seconds[0].rows else 0]
    for second in case.seconds:
        numbers += [second.stage, second.target, 10 * second.elapsed_s]
        for j in range(count):
            numbers += [second.present[j], second.arrived[j], second.share[j]]
        numbers += [value for row in second.rows for value in row]
    return numbers


def with_doubles(source: str) -> str:
    """Sources in which every float is a double. Layouts, and functions by bits, which no rollout calls, are lost."""
    source = re.sub(r"\bstatic_assert\([^;]*\);", "", source)
    return re.sub(r"(\d\.\d*(?:e-?\d+)?)F\b", r"\1", re.sub(r"\bfloat\b", "double", source))


@pytest.fixture(scope="session")
def probe_in_double(tmp_path_factory: pytest.TempPathFactory) -> str:
    folder = tmp_path_factory.mktemp("double")
    (folder / "elmopp").mkdir()
    for header in (ROOT / "firmware" / "include" / "elmopp").glob("*.h"):
        (folder / "elmopp" / header.name).write_text(with_doubles(header.read_text()))
    sources = [ROOT / "firmware" / "src" / f"{room}.c" for room in ROOMS]
    sources += [ROOT / "tests" / "rollout_probe.c", ROOT / "host_files" / "core_assert.c"]
    for source in sources:
        (folder / source.name).write_text(with_doubles(source.read_text()))
    names = [source.name for source in sources]
    program = folder / "rollout_probe"
    command = ["cc", "-std=c11", "-O1", "-ffp-contract=off", "-w", "-I", ".", "-o", program.name, *names]
    subprocess.run(command, cwd=folder, check=True)
    return str(program)


def said_by(probe: str, kind: str, case: Case) -> tuple[int, list[float], list[int]]:
    numbers = numbers_of(case)
    done = subprocess.run(
        [probe], input=struct.pack(f"<{len(numbers)}{kind}", *numbers), capture_output=True, timeout=60, check=True
    )
    values = struct.unpack(f"<{len(done.stdout) // struct.calcsize(kind)}{kind}", done.stdout)
    stages = len(case.site.stages)
    return int(values[0]), list(values[1 : 1 + stages]), [int(value) for value in values[1 + stages :]]


def said_by_the_reference(case: Case) -> tuple[int, dict[int, float], list[int]]:
    reference = REFERENCE.Rollout(case.site, case.setting)
    for second in case.seconds:
        shown = second.stage != NONE
        stage = second.stage if shown else REFERENCE.NEVER
        going = case.site.stages[stage] if shown else 0
        reference.observe(second.present, second.arrived, stage, second.elapsed_s, going)
        reference.judge(second.arrived, second.rows)
    last = case.seconds[-1]
    stage, values = reference.decide(last.stage, last.elapsed_s, last.rows, last.share)
    return stage, values, reference.red


@pytest.mark.parametrize("seed", range(CASES))
def test_the_core_finds_the_costs_of_the_reference(seed: int, probe_in_double: str) -> None:
    case = make_case(seed)
    wanted, values, red_s = said_by_the_reference(case)
    expected = [-values.get(s, 0.0) for s in range(len(case.site.stages))]
    for probe, kind in ((PROBE, "f"), (probe_in_double, "d")):
        answer, scores, clocks_s = said_by(probe, kind, case)
        assert scores == pytest.approx(expected, rel=RELATIVE_BOUND[kind], abs=10 * RELATIVE_BOUND[kind])
        assert answer == wanted
        assert clocks_s == red_s


def test_most_cases_are_decided_by_costs() -> None:
    tried = [len(said_by_the_reference(make_case(seed))[1]) for seed in range(0, CASES, 4)]
    assert sum(count >= 2 for count in tried) > len(tried) * 0.6


def test_in_some_cases_who_gives_way_decides() -> None:
    """Without the right of way other costs come out, so the cases above have held it."""
    moved = 0
    for seed in range(0, CASES, 4):
        case = make_case(seed)
        if case.site.gives_way:
            values = said_by_the_reference(case)[1]
            case.site.gives_way = []
            moved += values != said_by_the_reference(case)[1]
    assert moved >= 8


def test_in_some_cases_the_rows_have_earned_their_weight() -> None:
    weights = []
    for seed in range(CASES):
        case = make_case(seed)
        reference = REFERENCE.Rollout(case.site, case.setting)
        for second in case.seconds:
            reference.observe(second.present, second.arrived, REFERENCE.NEVER, second.elapsed_s, 0)
            reference.judge(second.arrived, second.rows)
        weights.append(reference.row_weight())
    assert sum(0.1 < weight < 0.99 for weight in weights) >= 5
