# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""Requests that the programs of the port refuse before they ask for a bus, so that none is needed here."""

from __future__ import annotations

from pathlib import Path

import pytest
from bus import SITE, refused

BOTH = ("elmopp-controller", "elmopp-lamp-node")
BREAKS = ("stuck:N1:green", "stuck:X:green@5", "lose:0@5", "late:x@5", "melt@5", "stuck:0:blue@5", "")


@pytest.mark.parametrize("program", BOTH)
def test_a_site_that_never_drives_lamps(program: str) -> None:
    assert "simulation_only" in refused(program, "--can", "vcan77", "--site", "sites/paper.toml")


@pytest.mark.parametrize("program", BOTH)
def test_a_misspelt_option_is_named_before_the_one_that_is_missing(program: str) -> None:
    assert "--sit" in refused(program, "--can", "vcan77", "--sit", SITE)
    assert "--site is required" in refused(program, "--can", "vcan77")


@pytest.mark.parametrize("program", BOTH)
def test_a_site_that_is_not_there(program: str) -> None:
    assert "cannot be read" in refused(program, "--can", "vcan77", "--site", "none.bin")


def test_another_clock() -> None:
    said = refused("elmopp-controller", "--can", "vcan77", "--site", SITE, "--clock", "wall")
    assert "right would be real or bus" in said


def test_a_node_without_groups() -> None:
    assert "--node 5" in refused("elmopp-lamp-node", "--can", "vcan77", "--site", SITE, "--node", "5")


def test_a_page_without_a_bus() -> None:
    assert "nowhere" in refused("elmopp-view", "--can", "nowhere", "--site", SITE)
    assert "cannot be read" in refused("elmopp-view", "--can", "vcan77", "--site", "none.bin")
    for port in ("65536", "x"):
        said = refused("elmopp-view", "--can", "vcan77", "--site", SITE, "--port", port)
        assert f'--port "{port}": right would be a whole number from 0 to 65535' in said


@pytest.mark.parametrize("text", BREAKS)
def test_what_does_not_break(text: str) -> None:
    said = refused("elmopp-lamp-node", "--can", "vcan77", "--site", SITE, "--break", text)
    assert "--break" in said and "right would be" in said


def test_a_store_that_is_no_folder(tmp_path: Path) -> None:
    said = refused("elmopp-controller", "--can", "vcan77", "--site", SITE, "--store", str(tmp_path / "none"))
    assert "is no folder; right would be" in said


@pytest.mark.parametrize(
    ("words", "what"),
    [
        ((), "--weights FILE or --site FILE, one of them"),
        (("--weights", "a.bin", "--site", SITE), "--weights FILE or --site FILE, one of them"),
        (("--site", "sites/paper.toml"), "simulation_only"),
        (("--site", "none.bin"), "cannot be read"),
        (("--weights", "none.bin"), "none.bin"),
        (("--weights", "sites/four_way.toml"), "not an ELMW image"),
        (("--site", SITE), "vcan77"),
    ],
)
def test_what_cannot_be_sent(words: tuple[str, ...], what: str) -> None:
    assert what in refused("elmopp-send", "--can", "vcan77", *words)
