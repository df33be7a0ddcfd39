# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The image in the loop: the decision log of host_sim over the emulated board's serial line is the log in process.

ctest's preset cortex-m4 runs it with that build's image and another build's host_sim (ELMOPP_HOST_SIM); without one it
is skipped, which tools/check does not let pass. The chooser comes to the board as a site image in its slot.
"""

import os
import subprocess
from pathlib import Path

import pytest
from emulator import ROOT, Emulator
from images import site_image

HOST_SIM = Path(os.environ.get("ELMOPP_HOST_SIM", ROOT / "build" / "release" / "bin" / "host_sim"))
SECONDS = int(os.environ.get("ELMOPP_BOARD_SECONDS", "200"))
CHOOSERS = ["naive", "cumulative:lstm", "pressure", "priced", "rollout"]
OTHERS = ["cumulative:none", "cumulative:mean", "cumulative:persistence", "cumulative:ewma", "cumulative:ar8"]
OTHERS += ["cumulative:nlstm", "cumulative:lstm-q15", "cumulative:nlstm-q15", "cumulative:ann", "cumulative:gcn"]
OTHERS += ["rollout:lstm", "rollout:nlstm", "rollout:lstm-learn", "rollout:nlstm-q15", "rollout:gcn"]
STREETS = ["one_way", "three_way", "five_way", "left_lanes", "shared_lanes"]


@pytest.fixture(autouse=True, scope="session")
def simulator() -> None:
    """Without one nothing can be compared."""
    if not HOST_SIM.exists():
        pytest.exit(f"{HOST_SIM} is missing; right would be: cmake --workflow --preset release", returncode=77)


def run(site: Path, *words: str) -> None:
    command = [str(HOST_SIM), "run", "--site", str(site), "--seconds", str(SECONDS), "--vehicles", "500", *words]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def compare_logs(folder: Path, site: Path, *, terminal: bool = False) -> None:
    inproc, wire = folder / "inproc.jsonl", folder / "wire.jsonl"
    run(site, "--link", "inproc", "--log", str(inproc), "--summary", str(folder / "inproc.json"))
    with Emulator(site=site, terminal=terminal) as board:
        run(site, "--link", board.link(), "--log", str(wire), "--summary", str(folder / "wire.json"))
    assert len(inproc.read_bytes().splitlines()) == SECONDS
    assert wire.read_bytes() == inproc.read_bytes()
    assert (folder / "wire.json").read_bytes() == (folder / "inproc.json").read_bytes()


@pytest.mark.parametrize("chooser", CHOOSERS)
def test_the_log_of_the_board_is_the_log_in_process_byte_for_byte(tmp_path: Path, chooser: str) -> None:
    compare_logs(tmp_path, site_image(tmp_path, chooser))


@pytest.mark.others
@pytest.mark.parametrize("chooser", OTHERS)
def test_so_it_is_with_every_forecast(tmp_path: Path, chooser: str) -> None:
    compare_logs(tmp_path, site_image(tmp_path, chooser))


@pytest.mark.others
@pytest.mark.parametrize("name", STREETS)
@pytest.mark.parametrize("chooser", ["cumulative:ar8", "rollout:lstm"])
def test_so_it_is_at_every_other_street(tmp_path: Path, chooser: str, name: str) -> None:
    compare_logs(tmp_path, site_image(tmp_path, chooser, name))


@pytest.mark.others
def test_so_it_is_through_a_terminal(tmp_path: Path) -> None:
    compare_logs(tmp_path, site_image(tmp_path, "naive"), terminal=True)
