# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""The rules of tools/site against those of elmopp_site_check(): two opinions of what makes a junction."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from elmopp_tools.site import load_site
from elmopp_tools.site_image import image_bytes
from elmopp_tools.site_model import Junction, SiteError
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


def group(**values: int) -> Change:
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


def longer_intergreens(site: Junction) -> Junction:
    """All intergreens 3 s longer."""
    return replace(
        site, intergreen_ds=tuple(tuple(time_ds and time_ds + 30 for time_ds in row) for row in site.intergreen_ds)
    )


# Changes of four_way.toml (amber 3 s, red-amber 1 s; groups 0 and 3 conflict) that are still, or no longer, a street.
ALLOWED: dict[str, Change] = {
    "nothing": lambda site: site,
    "amber 6 s": lambda site: group(amber_ds=60)(longer_intergreens(site)),
    "amber 4 s": group(amber_ds=40),
    "minimum green 5 s": group(min_green_ds=50),
    "no maximum green": group(max_green_ds=0),
    "maximum green at minimum": group(min_green_ds=60, max_green_ds=60),
    "intergreen is amber and red-amber": intergreen(0, 3, 40),
    "no storage": movement(capacity_veh=0.0),
    "hold 1 to 1": lambda site: replace(site, hold_min_s=1, hold_max_s=1),
    "hold up to 150": lambda site: replace(site, hold_max_s=150),
    "simulation": lambda site: group(amber_ds=0, min_green_ds=10)(replace(site, simulation_only=True)),
}
FORBIDDEN: dict[str, Change] = {
    "amber 2.9 s": group(amber_ds=29),
    "amber 6.1 s": group(amber_ds=61),
    "minimum green 4.9 s": group(min_green_ds=49),
    "maximum green below minimum": group(min_green_ds=60, max_green_ds=59),
    "red-amber too long for an intergreen": group(red_amber_ds=21),
    "intergreen too short": intergreen(0, 3, 39),
    "intergreen of the reverse too short": intergreen(3, 0, 39),
    "intergreen of a compatible pair": intergreen(0, 1, 1),
    "no flow": movement(saturation_veh_per_s=0.0),
    "negative flow": movement(saturation_veh_per_s=-0.5),
    "flow is no number": movement(saturation_veh_per_s=float("nan")),
    "negative storage": movement(capacity_veh=-1.0),
    "storage is no number": movement(capacity_veh=float("nan")),
    "conflicting groups of a movement": movement(groups=0b1001),
    "hold from 0": lambda site: replace(site, hold_min_s=0),
    "hold backwards": lambda site: replace(site, hold_min_s=61),
    "hold up to 601": lambda site: replace(site, hold_max_s=601),
    "simulation with minimum green 0.9 s": lambda site: group(min_green_ds=9)(replace(site, simulation_only=True)),
    "simulation with short intergreen": lambda site: intergreen(0, 3, 39)(replace(site, simulation_only=True)),
}


@pytest.fixture(scope="module")
def firmware_verdict(tmp_path_factory: pytest.TempPathFactory) -> Callable[[bytes], int]:
    """Loads an image with the firmware's own loader; 0 is ELMOPP_SITE_OK."""
    folder = tmp_path_factory.mktemp("loader")
    (folder / "driver.c").write_text(DRIVER)
    program = folder / "driver"
    compiler = os.environ.get("CC") or shutil.which("gcc") or "cc"
    rooms = [ROOT / "firmware" / "src" / f"{room}.c" for room in ("site", "image", "junction")]
    sources = [str(folder / "driver.c"), *map(str, rooms), str(ROOT / "host_sim" / "core_assert.c")]
    subprocess.run(
        [compiler, "-std=c11", f"-I{ROOT / 'firmware' / 'include'}", *sources, "-o", str(program)], check=True
    )
    return lambda image: int(subprocess.run([str(program)], input=image, capture_output=True, check=True).stdout)


def four_way() -> Junction:
    return load_site(ROOT / "sites" / "four_way.toml")[0]


@pytest.mark.parametrize("path", SITES, ids=lambda path: path.stem)
def test_firmware_loads_every_site_of_the_repository(path: Path, firmware_verdict: Callable[[bytes], int]) -> None:
    assert firmware_verdict(image_bytes(load_site(path)[0])) == 0


def test_firmware_refuses_an_image_with_one_changed_bit(firmware_verdict: Callable[[bytes], int]) -> None:
    image = bytearray(image_bytes(four_way()))
    image[700] ^= 0x10
    assert firmware_verdict(bytes(image)) != 0


@pytest.mark.parametrize("case", ALLOWED)
def test_what_the_tool_allows_the_firmware_loads(case: str, firmware_verdict: Callable[[bytes], int]) -> None:
    junction = ALLOWED[case](four_way())
    check_junction(junction)
    assert firmware_verdict(image_bytes(junction)) == 0


@pytest.mark.parametrize("case", FORBIDDEN)
def test_what_the_tool_forbids_the_firmware_refuses(case: str, firmware_verdict: Callable[[bytes], int]) -> None:
    junction = FORBIDDEN[case](four_way())
    with pytest.raises(SiteError):
        check_junction(junction)
    assert firmware_verdict(image_bytes(junction)) != 0
