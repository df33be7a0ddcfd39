# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""elmopp-camera on a real RTSP server that dies and comes back, on loopback."""

import json
import os
import socket
import subprocess
import time
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest

CAMERA = os.environ["ELMOPP_CAMERA"]
# GStreamer's server has its Python bindings in the system's Python only.
SERVER = Path(__file__).resolve().parents[1] / "perception" / "rtsp_server.py"
VALID_AGAIN_S = 10  # after the camera is back
LANES = {
    "width": 320,
    "height": 240,
    "lanes": [{"name": "a", "line": [[100, 150], [160, 150]], "direction": "down"}],
}


def free_port() -> int:
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return int(listener.getsockname()[1])


def start_server(port: int) -> subprocess.Popen[bytes]:
    server = subprocess.Popen(["/usr/bin/python3", str(SERVER), str(port)])
    for _ in range(100):
        with socket.socket() as client:
            if client.connect_ex(("127.0.0.1", port)) == 0:
                return server
        time.sleep(0.1)
    server.kill()
    pytest.fail("the RTSP server does not listen")


def stop(process: subprocess.Popen[bytes]) -> None:
    process.kill()
    process.wait()


@pytest.fixture
def port() -> Iterator[int]:
    yield free_port()


def records(file: Path) -> list[dict[str, object]]:
    if not file.exists():
        return []
    return [json.loads(line) for line in file.read_text().splitlines() if line.endswith("}")]


def wait_for(file: Path, valid: bool, after: int, seconds: float) -> int:
    """Records until the lane is (in)valid; returns how many there are."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        lines = records(file)
        for i, line in enumerate(lines[after:], start=after):
            if line["lanes"]["a"]["valid"] is valid:  # type: ignore[index]
                return i + 1
        time.sleep(0.2)
    pytest.fail(f"not {'valid' if valid else 'invalid'} in {seconds} s: {records(file)[-3:]}")


def test_a_camera_that_dies_is_said_and_comes_back_and_the_records_go_on(port: int, tmp_path: Path) -> None:
    lanes = tmp_path / "lanes.json"
    lanes.write_text(json.dumps(LANES))
    out = tmp_path / "records.jsonl"
    server = start_server(port)
    command = [CAMERA, "--source", f"rtsp://127.0.0.1:{port}/test", "--lanes", str(lanes), "--jsonl", str(out)]
    camera = subprocess.Popen(command, stderr=subprocess.DEVNULL)
    try:
        seen = wait_for(out, valid=True, after=0, seconds=40)
        stop(server)
        seen = wait_for(out, valid=False, after=seen, seconds=8)
        reason = records(out)[seen - 1]["lanes"]["a"]["reason"]  # type: ignore[index]
        assert reason in {"lost", "frozen"}
        time.sleep(3)
        gone = len(records(out))
        server = start_server(port)
        wait_for(out, valid=True, after=gone, seconds=VALID_AGAIN_S)
    finally:
        camera.terminate()
        stop(server)
    assert camera.wait(timeout=20) == 0
    times = [float(str(line["t_s"])) for line in records(out)]
    gaps = [b - a for a, b in pairwise(times)]
    assert max(gaps) < 3.0, "the records stopped"


def test_a_camera_that_is_not_there_is_lost_from_the_start(port: int, tmp_path: Path) -> None:
    lanes = tmp_path / "lanes.json"
    lanes.write_text(json.dumps(LANES))
    command = [
        CAMERA,
        "--source",
        f"rtsp://127.0.0.1:{port}/test",
        "--lanes",
        str(lanes),
        "--jsonl",
        "-",
        "--seconds",
        "4",
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    assert done.returncode == 0
    assert len(lines) >= 3
    assert all(line["lanes"]["a"]["reason"] == "lost" for line in lines)
