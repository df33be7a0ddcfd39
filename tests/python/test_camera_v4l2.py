# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""elmopp-camera on /dev/video0: the kernel's virtual camera vivid, in the virtual machine of tools/with-can."""

import fcntl
import json
import os
import struct
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

CAMERA = os.environ["ELMOPP_CAMERA"]
DEVICE = "/dev/video0"
QUERYCTRL, S_CTRL, NEXT = 0xC0445624, 0xC008561C, 0x80000000
PATIENCE_S = 60  # an emulated processor


def lane_file(folder: Path, width: int, height: int) -> Path:
    line = [[width // 3, height * 3 // 4], [width // 2, height * 3 // 4]]
    lanes = folder / "lanes.json"
    content = {"width": width, "height": height, "lanes": [{"name": "a", "line": line, "direction": "down"}]}
    lanes.write_text(json.dumps(content))
    return lanes


def set_control(name: str, value: int) -> None:
    """A control of the virtual camera, by the name that its driver gives it."""
    with Path(DEVICE).open("rb") as device:
        number = 0
        while True:
            asked = bytearray(struct.pack("2I32s7I", number | NEXT, 0, b"", *[0] * 7))
            fcntl.ioctl(device, QUERYCTRL, asked)  # OSError: there is none of that name
            number, _, called = struct.unpack_from("2I32s", asked)
            if called.rstrip(b"\0").decode() == name:
                fcntl.ioctl(device, S_CTRL, struct.pack("Ii", number, value))
                return


def records(file: Path) -> list[dict[str, Any]]:
    lines = file.read_text().splitlines() if file.exists() else []
    return [json.loads(line) for line in lines if line.endswith("}")]


def reason_is(reason: str) -> Callable[[dict[str, Any]], bool]:
    return lambda record: bool(record["lanes"]["a"]["reason"] == reason)


def wait_for(file: Path, wanted: Callable[[dict[str, Any]], bool], after_s: float = 0.0) -> dict[str, Any]:
    end = time.monotonic() + PATIENCE_S
    while time.monotonic() < end:
        for record in records(file):
            if record["t_s"] > after_s and wanted(record):
                return record
        time.sleep(0.2)
    pytest.fail(f"not in {PATIENCE_S} s: {records(file)[-3:]}")


@pytest.mark.parametrize(("source", "width", "height"), [(DEVICE, 640, 360), ("v4l2:0", 320, 180)])
def test_a_device_gives_pictures_of_the_size_of_the_lane_file(
    source: str, width: int, height: int, tmp_path: Path
) -> None:
    command = [CAMERA, "--source", source, "--lanes", str(lane_file(tmp_path, width, height)), "--jsonl", "-"]
    done = subprocess.run([*command, "--seconds", "7"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    said = [json.loads(line) for line in done.stdout.splitlines()]
    assert said[-1]["frame"] > 10
    reasons = [record["lanes"]["a"]["reason"] for record in said]
    assert reasons[-1] == "ok"
    assert set(reasons) <= {"lost", "learning", "ok"}


def test_a_size_that_the_device_does_not_have_is_refused_in_one_line(tmp_path: Path) -> None:
    command = [CAMERA, "--source", DEVICE, "--lanes", str(lane_file(tmp_path, 333, 111)), "--jsonl", "-"]
    done = subprocess.run([*command, "--seconds", "20"], capture_output=True, text=True, check=False)
    lines = [line for line in done.stderr.splitlines() if line.startswith("elmopp-camera: ")]
    assert (done.returncode, len(lines)) == (2, 1), done.stderr
    assert "333 x 111" in lines[0]


def test_a_device_that_falls_silent_or_is_pulled_out_is_lost_and_comes_back(tmp_path: Path) -> None:
    out = tmp_path / "records.jsonl"
    command = [CAMERA, "--source", DEVICE, "--lanes", str(lane_file(tmp_path, 320, 180)), "--jsonl", str(out)]
    camera = subprocess.Popen(command, stderr=subprocess.DEVNULL)
    try:
        seen = wait_for(out, reason_is("ok"))
        set_control("Percentage of Dropped Buffers", 100)
        gone = wait_for(out, reason_is("lost"), seen["t_s"])
        after = wait_for(out, lambda _: True, gone["t_s"])
        assert after["frame"] == gone["frame"]
        set_control("Percentage of Dropped Buffers", 0)
        seen = wait_for(out, reason_is("ok"), after["t_s"])
        set_control("Disconnect", 1)
        pulled_out = records(out)[-1]
        wait_for(out, lambda record: record["frame"] > pulled_out["frame"] + 30, pulled_out["t_s"])
    finally:
        camera.terminate()
    assert camera.wait(timeout=30) == 0
