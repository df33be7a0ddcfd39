# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The whole chain over a CAN interface: cameras, elmopp-controller in lockstep, lamps. tests/socketcan/run --lockstep.

Short, with one camera: a picture that is drawn and looked at in an emulated processor takes its time.
"""

import json
import os
import subprocess

from bus import OUT, PROGRAMS, ROOT, controller, interface, wait_for_listener

SITE = os.environ["ELMOPP_ONE_CAMERA_SITE"]


def closed_loop(name: str, link: str) -> tuple[dict[str, object], str]:
    folder = OUT / name
    command = [str(PROGRAMS / "elmopp-closed-loop"), "--site", SITE, "--seconds", "12", "--vehicles", "600"]
    done = subprocess.run(
        [*command, "--link", link, "--out", str(folder)],
        capture_output=True,
        text=True,
        check=False,
        cwd=ROOT,
    )
    assert done.returncode == 0, done.stderr
    result = json.loads((folder / "closed_loop.json").read_text(encoding="utf-8"))
    del result["link"]
    return result, (folder / "street.jsonl").read_text(encoding="utf-8")


def test_the_closed_loop_over_the_bus_is_the_one_in_process() -> None:
    inproc = closed_loop("loop_inproc", "inproc")
    with interface("loop0") as name, controller(name, "--clock", "bus", site=SITE):
        wait_for_listener(name)
        wire = closed_loop("loop_wire", f"can:{name}")
    assert wire == inproc
    assert '"mode":"automatic"' in inproc[1]
