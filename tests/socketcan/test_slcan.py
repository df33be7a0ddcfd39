# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""A controller on the emulated board, behind a serial line that Linux takes for a CAN interface: slcand and slcan0.

tests/socketcan/run --slcan starts it: an emulated Cortex-M4 in an emulated machine, both by the outer one's clock.
"""

import contextlib
import json
import os
import re
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from bus import OUT, PROGRAMS, ROOT, SITE, Bus, ip, lamp_node
from bus_frames import LAMP_COMMAND, LAMP_FEEDBACK

IMAGE = os.environ["ELMOPP_MPS2"]
NAME = "slcan0"
SITE_SLOT = 0x00300000  # firmware/port/mps2/mps2.ld
STEADY = "fixed_time"
GREEN = 3
WAIT_S = 60.0


def wait_for(what: str, path: Path, words: str = "") -> str:
    """The text of a file, as soon as it is there and has these words."""
    end = time.monotonic() + WAIT_S
    while not path.exists() or words not in path.read_text(encoding="utf-8"):
        assert time.monotonic() < end, f"no {what}"
        time.sleep(0.05)
    return path.read_text(encoding="utf-8")


@contextlib.contextmanager
def running(*words: str, said: Path) -> Iterator[subprocess.Popen[bytes]]:
    with said.open("wb") as out, subprocess.Popen(words, stdout=out, stderr=out, stdin=subprocess.DEVNULL) as process:
        try:
            yield process
        finally:
            process.terminate()
            process.wait(timeout=30)


@pytest.fixture
def bus(tmp_path: Path) -> Iterator[Bus]:
    """The interface that has the board behind it."""
    subprocess.run(["modprobe", "slcan"], check=True)
    words = ["qemu-system-arm", "-M", "mps2-an386", "-nodefaults", "-display", "none", "-monitor", "none"]
    words += ["-nic", "user,restrict=on,ipv6=off", "-audiodev", "none,id=none", "-serial", "pty", "-kernel", IMAGE]
    words += ["-device", f"loader,file={SITE},addr={SITE_SLOT:#x},force-raw=on"]
    with contextlib.ExitStack() as stack:
        stack.enter_context(running(*words, said=tmp_path / "qemu.txt"))
        told = wait_for("serial line", tmp_path / "qemu.txt", "label serial0")
        line = re.search(r"/dev/pts/\d+", told)
        assert line is not None
        slcand = ["slcand", "-o", "-c", "-s6", "-F", line[0], NAME]
        stack.enter_context(running(*slcand, said=tmp_path / "slcand.txt"))
        wait_for(NAME, Path("/sys/class/net") / NAME / "address")
        ip("set", NAME, "up")
        yield Bus(NAME)


def test_lamps_follow_the_board_through_slcan0_and_it_flashes_when_they_are_gone(bus: Bus) -> None:
    with lamp_node(NAME) as node:
        bus.mode(STEADY)
        bus.until(LAMP_COMMAND, lambda frame: GREEN in frame.aspects, 120, "a green")
        node.stop()
        assert bus.mode("fail_safe", 5).fault == "feedback_lost"


def test_host_sim_plays_cameras_on_slcan0_and_the_board_lets_vehicles_go(bus: Bus) -> None:
    run = [str(PROGRAMS / "host_sim"), "run", "--site", SITE, "--seconds", "20", "--vehicles", "500"]
    run += ["--link", f"can:{NAME}", "--clock", "real", "--log", str(OUT / "slcan.jsonl")]
    with lamp_node(NAME):
        bus.until(LAMP_FEEDBACK, lambda _: True, 10, "the lamp node")
        done = subprocess.run(run, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    seconds = [json.loads(line) for line in (OUT / "slcan.jsonl").read_text(encoding="utf-8").splitlines()]
    assert len(seconds) == 20
    assert {second["fault"] for second in seconds} == {0}
    assert json.loads(done.stdout)["vehicles_out"] > 0
