# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""The rules of tools/site against those of elmopp_site_check(): two opinions of what makes a junction."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from elmopp_tools.site import load_site
from elmopp_tools.site_image import image_bytes
from elmopp_tools.site_model import Junction, Program, SiteError, Step
from elmopp_tools.site_rules import check_junction

ROOT = Path(__file__).resolve().parents[2]
SITES = sorted((ROOT / "sites").glob("*.toml"))

DRIVER = """\
#include "elmopp/site.h"
#include <stdio.h>
int main(void)
{
    static uint8_t image[4096];
    static elmopp_junction_t junction;
    const size_t length = fread(image, 1, sizeof image, stdin);
    printf("%d", (int)elmopp_site_load(image, (uint32_t)length, &junction).fault);
    return 0;
}
"""

Change = Callable[[Junction], Junction]


def group(**values: object) -> Change:
    """Changes the first group."""
    return lambda site: replace(
        site,
        groups=(replace(site.groups[0], **values), *site.groups[1:]),  # type: ignore[arg-type]
    )


def movement(**values: float) -> Change:
    """Changes the first movement."""
    return lambda site: replace(site, movements=(replace(site.movements[0], **values), *site.movements[1:]))  # type: ignore[arg-type]


def intergreen(end: int, start: int, time_ds: int) -> Change:
    def change(site: Junction) -> Junction:
        rows = [list(row) for row in site.intergreen_ds]
        rows[end][start] = time_ds
        return replace(site, intergreen_ds=tuple(tuple(row) for row in rows))

    return change


def whole(**values: object) -> Change:
    """Changes the site itself."""
    return lambda site: replace(site, **values)  # type: ignore[arg-type]


def then(*changes: Change) -> Change:
    """One change after the other."""

    def change(site: Junction) -> Junction:
        for step in changes:
            site = step(site)
        return site

    return change


def rescue(index: int, stage: int) -> Change:
    """Another rescue stage for one movement."""

    def change(site: Junction) -> Junction:
        stages = list(site.rescue_stages)
        stages[index] = stage
        return replace(site, rescue_stages=tuple(stages))

    return change


def least_bound(more_ds: int) -> Change:
    """The shortest possible bound on red, or so much more or less."""
    return lambda site: replace(site, red_bound_ds=site.red_bound_min_ds() + more_ds)


def steps(change: Callable[[tuple[Step, ...]], tuple[Step, ...]]) -> Change:
    """Changes the steps of the last programme."""

    def change_last(site: Junction) -> Junction:
        last = site.programs[-1]
        return replace(site, programs=(*site.programs[:-1], Program(last.name, change(last.steps))))

    return change_last


def step(**values: int) -> Change:
    """Changes the second step of the last programme."""
    return steps(lambda old: (old[0], replace(old[1], **values), *old[2:]))


def line(**values: int) -> Change:
    """Changes the first line of the schedule."""
    return lambda site: replace(site, schedule=(replace(site.schedule[0], **values), *site.schedule[1:]))


def special_day(**values: int) -> Change:
    """Changes the last special day."""
    return lambda site: replace(site, special_days=(*site.special_days[:-1], replace(site.special_days[-1], **values)))


def longer_intergreens(site: Junction) -> Junction:
    """All intergreens 3 s longer."""
    return replace(
        site, intergreen_ds=tuple(tuple(time_ds and time_ds + 30 for time_ds in row) for row in site.intergreen_ds)
    )


SIMULATION = whole(simulation_only=True)
WITHOUT_BOUND = whole(simulation_only=True, red_bound_ds=0)
WITHOUT_HOURS = whole(programs=(), schedule=())

# Changes of four_way.toml (amber 3 s, red-amber 1 s; groups 0 and 3 conflict; four rescue stages, two programmes of
# four steps) that are still, or no longer, a street;
# for these the fault that the firmware tells.
ALLOWED: dict[str, Change] = {
    "nothing": lambda site: site,
    "amber 6 s": lambda site: group(amber_ds=60)(longer_intergreens(site)),
    "amber 4 s": group(amber_ds=40),
    "minimum green 5 s": group(min_green_ds=50),
    "maximum green at minimum": group(min_green_ds=60, max_green_ds=60),
    "intergreen is amber and red-amber": intergreen(0, 3, 40),
    "no storage": movement(capacity_veh=0.0),
    "no limit said": movement(limit_km_per_h=0),
    "walking pace": movement(limit_km_per_h=5),
    "limit of 200": movement(limit_km_per_h=200),
    "gives way to one that goes with it": movement(gives_way=0b10, gives_way_percent=100),
    "one in a hundred gives way": movement(gives_way=0b10, gives_way_percent=1),
    "hold 1 to 1": lambda site: replace(site, hold_min_s=1, hold_max_s=1),
    "hold up to 150": lambda site: replace(site, hold_max_s=150),
    "simulation": lambda site: group(amber_ds=0, min_green_ds=10)(replace(site, simulation_only=True)),
    "simulation without maximum green": then(SIMULATION, group(max_green_ds=0)),
    "simulation without bound on red": WITHOUT_BOUND,
    "simulation with the shortest bound on red": then(SIMULATION, least_bound(0)),
    "simulation without programmes": then(SIMULATION, WITHOUT_HOURS),
    "simulation that only flashes": then(
        SIMULATION, line(program=255), lambda s: replace(s, programs=(), schedule=s.schedule[:1])
    ),
    "maximum green 10 min": group(max_green_ds=6000),
    "minimum green 10 min": then(WITHOUT_BOUND, WITHOUT_HOURS, group(min_green_ds=6000, max_green_ds=6000)),
    "intergreen 10 min": then(WITHOUT_BOUND, intergreen(0, 3, 6000)),
    "flashing and red 10 min at the start": whole(start_flash_ds=6000, start_red_ds=6000),
    "wait for the junction 10 s": then(whole(junction_wait_ds=100), least_bound(0)),
    "no start times": whole(start_flash_ds=0, start_red_ds=0),
    "last stage first": whole(first_stage=16),
    "no cameras": whole(cameras=0),
    "all detector limits": whole(no_activity_min=255, max_presence_min=255, erratic_per_min=255),
    "last node": group(node=7, flash="dark"),
    "shortest bound on red": least_bound(0),
    "bound on red 10 min": whole(red_bound_ds=6000),
    "a fifth rescue stage": then(rescue(2, 6), least_bound(0)),
    "shortest bound after a longer green": then(group(min_green_ds=70), least_bound(0)),
    "shortest bound after a longer intergreen": then(intergreen(0, 3, 90), least_bound(0)),
    "one programme": lambda site: replace(site, programs=site.programs[:1], schedule=()),
    "step at minimum green": step(green_ds=50),
    "step of 10 min": step(green_ds=6000),
    "a programme of 16 steps": steps(lambda old: old * 4),
    "line at the last minute": line(from_min=1439),
    "line on all days": line(weekdays=127),
    "line of flashing": line(program=255),
    "no schedule": whole(schedule=()),
    "special Sunday": special_day(weekday=6, day=65535),
    "no special day": whole(special_days=()),
}
FORBIDDEN: dict[str, tuple[str, Change]] = {
    "amber 2.9 s": ("GROUP", group(amber_ds=29)),
    "amber 6.1 s": ("GROUP", group(amber_ds=61)),
    "minimum green 4.9 s": ("GROUP", group(min_green_ds=49)),
    "maximum green below minimum": ("GROUP", group(min_green_ds=60, max_green_ds=59)),
    "red-amber too long for an intergreen": ("INTERGREEN", group(red_amber_ds=21)),
    "intergreen too short": ("INTERGREEN", intergreen(0, 3, 39)),
    "intergreen of the reverse too short": ("INTERGREEN", intergreen(3, 0, 39)),
    "intergreen of a compatible pair": ("INTERGREEN", intergreen(0, 1, 1)),
    "limit below walking pace": ("MOVEMENT", movement(limit_km_per_h=4)),
    "limit above 200": ("MOVEMENT", movement(limit_km_per_h=201)),
    "no flow": ("MOVEMENT", movement(saturation_veh_per_s=0.0)),
    "negative flow": ("MOVEMENT", movement(saturation_veh_per_s=-0.5)),
    "flow is no number": ("MOVEMENT", movement(saturation_veh_per_s=float("nan"))),
    "negative storage": ("MOVEMENT", movement(capacity_veh=-1.0)),
    "storage is no number": ("MOVEMENT", movement(capacity_veh=float("nan"))),
    "conflicting groups of a movement": ("MOVEMENT", movement(groups=0b1001)),
    "gives way to itself": ("GIVES_WAY", movement(gives_way=0b1, gives_way_percent=100)),
    "gives way to one that never goes with it": ("GIVES_WAY", movement(gives_way=0b1000, gives_way_percent=100)),
    "gives way to none that exists": ("GIVES_WAY", movement(gives_way=1 << 23, gives_way_percent=100)),
    "gives way by no share": ("GIVES_WAY", movement(gives_way=0b10)),
    "gives way by more than all": ("GIVES_WAY", movement(gives_way=0b10, gives_way_percent=101)),
    "a share that gives way to nobody": ("GIVES_WAY", movement(gives_way_percent=1)),
    "gives way under a law of the queue": (
        "GIVES_WAY",
        then(
            SIMULATION,
            whole(discharge="nolock", free_flow_m_per_s=10.0),
            movement(gives_way=0b10, gives_way_percent=100),
        ),
    ),
    "hold from 0": ("HOLD", lambda site: replace(site, hold_min_s=0)),
    "hold backwards": ("HOLD", lambda site: replace(site, hold_min_s=61)),
    "hold up to 601": ("HOLD", lambda site: replace(site, hold_max_s=601)),
    "simulation with minimum green 0.9 s": (
        "GROUP",
        lambda site: group(min_green_ds=9)(replace(site, simulation_only=True)),
    ),
    "maximum green missing": ("GROUP", group(max_green_ds=0)),
    "maximum green above 10 min": ("GROUP", group(max_green_ds=6001)),
    "minimum green above 10 min": (
        "GROUP",
        then(WITHOUT_BOUND, WITHOUT_HOURS, group(min_green_ds=6001, max_green_ds=6001)),
    ),
    "red-amber above 10 min": ("GROUP", then(WITHOUT_BOUND, group(red_amber_ds=6001))),
    "intergreen above 10 min": ("INTERGREEN", then(WITHOUT_BOUND, intergreen(0, 3, 6001))),
    "flashing above 10 min at the start": ("START", whole(start_flash_ds=6001)),
    "red above 10 min at the start": ("START", whole(start_red_ds=6001)),
    "wait for the junction above 10 s": ("WAIT", whole(junction_wait_ds=101)),
    "no such first stage": ("START", whole(first_stage=17)),
    "camera at no approach": ("START", whole(cameras=0x10)),
    "no such node": ("GROUP", group(node=8)),
    "fourth movement of an approach": ("APPROACH", movement(approach=1)),
    "rescue stage that does not serve": ("RESCUE", rescue(0, 3)),
    "no such rescue stage": ("RESCUE", rescue(0, 17)),
    "no bound on red": ("RED_BOUND", whole(red_bound_ds=0)),
    "bound on red too short": ("RED_BOUND", least_bound(-1)),
    "bound on red above 10 min": ("RED_BOUND", whole(red_bound_ds=6001)),
    "a fifth rescue stage too many": ("RED_BOUND", then(least_bound(0), rescue(2, 6))),
    "bound too short for a longer green": ("RED_BOUND", then(least_bound(0), group(min_green_ds=51))),
    "bound too short for a longer intergreen": ("RED_BOUND", then(least_bound(0), intergreen(0, 3, 71))),
    "bound too short for a wait": ("RED_BOUND", then(least_bound(0), whole(junction_wait_ds=1))),
    "simulation with a bound too short": ("RED_BOUND", then(SIMULATION, least_bound(-1))),
    "simulation with a bound of a tenth": ("RED_BOUND", then(SIMULATION, whole(red_bound_ds=1))),
    "no programme": ("PROGRAM", WITHOUT_HOURS),
    "programme without steps": ("PROGRAM", steps(lambda _: ())),
    "programme that leaves out movements": ("PROGRAM", steps(lambda old: old[:-1])),
    "step shorter than a minimum green": ("PROGRAM", step(green_ds=49)),
    "step above 10 min": ("PROGRAM", step(green_ds=6001)),
    "step without a stage": ("PROGRAM", step(stage=17)),
    "simulation with a step too short": ("PROGRAM", then(SIMULATION, step(green_ds=49))),
    "line after the last minute": ("SCHEDULE", line(from_min=1440)),
    "line on no day": ("SCHEDULE", line(weekdays=0)),
    "line on an eighth day": ("SCHEDULE", line(weekdays=128)),
    "line of a programme that does not exist": ("SCHEDULE", line(program=2)),
    "line of nearly flashing": ("SCHEDULE", line(program=254)),
    "special eighth day": ("SPECIAL_DAY", special_day(weekday=7)),
    "simulation with short intergreen": (
        "INTERGREEN",
        lambda site: intergreen(0, 3, 39)(replace(site, simulation_only=True)),
    ),
}


@pytest.fixture(scope="module")
def firmware_verdict(tmp_path_factory: pytest.TempPathFactory) -> Callable[[bytes], str]:
    """Loads an image with the firmware's own loader and says the fault's name without ELMOPP_SITE_."""
    folder = tmp_path_factory.mktemp("loader")
    (folder / "driver.c").write_text(DRIVER)
    program = folder / "driver"
    compiler = os.environ.get("CC") or shutil.which("gcc") or "cc"
    rooms = [ROOT / "firmware" / "src" / f"{room}.c" for room in ("site", "image", "junction")]
    sources = [str(folder / "driver.c"), *map(str, rooms), str(ROOT / "host_files" / "core_assert.c")]
    subprocess.run(
        [compiler, "-std=c11", f"-I{ROOT / 'firmware' / 'include'}", *sources, "-o", str(program)], check=True
    )
    header = (ROOT / "firmware" / "include" / "elmopp" / "site.h").read_text()
    faults = re.findall(r"^ +ELMOPP_SITE_(\w+)", header[: header.index("elmopp_site_fault_t")], re.MULTILINE)
    return lambda image: faults[
        int(subprocess.run([str(program)], input=image, capture_output=True, check=True).stdout)
    ]


def four_way() -> Junction:
    return load_site(ROOT / "sites" / "four_way.toml")[0]


@pytest.mark.parametrize("path", SITES, ids=lambda path: path.stem)
def test_firmware_loads_every_site_of_the_repository(path: Path, firmware_verdict: Callable[[bytes], str]) -> None:
    assert firmware_verdict(image_bytes(load_site(path)[0])) == "OK"


def test_firmware_refuses_an_image_with_one_changed_bit(firmware_verdict: Callable[[bytes], str]) -> None:
    image = bytearray(image_bytes(four_way()))
    image[700] ^= 0x10
    assert firmware_verdict(bytes(image)) == "IMAGE_CRC"


@pytest.mark.parametrize("case", ALLOWED)
def test_what_the_tool_allows_the_firmware_loads(case: str, firmware_verdict: Callable[[bytes], str]) -> None:
    junction = ALLOWED[case](four_way())
    check_junction(junction)
    assert firmware_verdict(image_bytes(junction)) == "OK"


@pytest.mark.parametrize("case", FORBIDDEN)
def test_what_the_tool_forbids_the_firmware_refuses(case: str, firmware_verdict: Callable[[bytes], str]) -> None:
    fault, change = FORBIDDEN[case]
    junction = change(four_way())
    with pytest.raises(SiteError):
        check_junction(junction)
    assert firmware_verdict(image_bytes(junction)) == fault
