# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The whole chain with the image in it: cameras look at the drawn road, the emulated board decides.

What comes of it is what comes of it with the controller in the process, also when a camera fails and when the board's
plug is pulled in mid-green: the emulated processor begins at its reset vector then. What the lamps show after that is
judged in tests/python/test_closed_loop.py. One camera: pictures are most of the work.
"""

import json
import os
import re
import subprocess
from pathlib import Path

import pytest
from emulator import ROOT, Emulator
from images import tool

PROGRAM = Path(os.environ.get("ELMOPP_HOST_SIM", ROOT / "build" / "release" / "bin" / "host_sim")).with_name(
    "elmopp-closed-loop"
)
SECONDS = 60


@pytest.fixture(autouse=True, scope="session")
def program() -> None:
    """Without it nothing can be compared."""
    if not PROGRAM.exists():
        pytest.exit(f"{PROGRAM} is missing; right would be: cmake --workflow --preset release", returncode=77)


def image_with_one_camera(folder: Path) -> Path:
    text = (ROOT / "sites" / "four_way.toml").read_text(encoding="utf-8")
    quick = 'forecast = "none"\nstart_flash_s = 1\nstart_red_s = 1\ncameras = ["N"]'
    toml = folder / "site.toml"
    toml.write_text(re.sub(r"^forecast = .*$", quick, text, flags=re.MULTILINE), encoding="utf-8")
    tool("site", str(toml), "--image", str(folder / "site.bin"))
    return folder / "site.bin"


def run(site: Path, folder: Path, *words: str) -> tuple[dict[str, object], str]:
    command = [str(PROGRAM), "--site", str(site), "--seconds", str(SECONDS), "--vehicles", "400", "--out", str(folder)]
    done = subprocess.run([*command, *words], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    result = json.loads((folder / "closed_loop.json").read_text(encoding="utf-8"))
    del result["link"]
    return result, (folder / "street.jsonl").read_text(encoding="utf-8")


def test_the_board_in_the_loop_is_the_controller_in_process(tmp_path: Path) -> None:
    site = image_with_one_camera(tmp_path)
    faults = ["--faults", "black:N@10-18,reset@28-30"]
    inproc = run(site, tmp_path / "inproc", *faults)
    with Emulator(site=site) as board:
        wire = run(site, tmp_path / "wire", *faults, "--link", board.link(), "--reset-command", board.reset_command())
        board.hears("elmopp-mps2 starts\r\nelmopp-mps2 starts")  # SimTime 0 alone makes nobody say this
    assert '"mode":"fixed_time"' in inproc[1]
    assert '"reset":true' in inproc[1]
    assert wire == inproc
