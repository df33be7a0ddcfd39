# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""elmopp-camera on a camera that speaks HTTP (pictures one after the other), whose pictures change their size."""

import io
import json
import os
import subprocess
import time
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from itertools import cycle
from pathlib import Path
from threading import Thread

import numpy as np
import pytest
from PIL import Image

CAMERA = os.environ["ELMOPP_CAMERA"]
RIGHT, OTHER = (320, 240), (160, 120)
LANES = {
    "width": RIGHT[0],
    "height": RIGHT[1],
    "lanes": [{"name": "a", "line": [[100, 150], [160, 150]], "direction": "down"}],
    "reference": "road.png",
}


def road() -> Image.Image:
    """Blocks of all greys: texture everywhere."""
    blocks = np.random.default_rng(1).integers(40, 200, (12, 16, 3), dtype=np.uint8)
    return Image.fromarray(np.kron(blocks, np.ones((20, 20, 1), dtype=np.uint8)))


def noisy(picture: Image.Image, seed: int) -> bytes:
    noise = np.random.default_rng(seed).normal(0, 4, (*picture.size[::-1], 3))
    out = io.BytesIO()
    Image.fromarray(np.clip(np.asarray(picture) + noise, 0, 255).astype(np.uint8)).save(out, "JPEG", quality=90)
    return out.getvalue()


class Camera(ThreadingHTTPServer):
    """Sends pictures of `size`, 20 a second, to whoever asks, and hangs up when it changes."""

    daemon_threads = True

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), Stream)
        self.pictures = {size: [noisy(road().resize(size), seed) for seed in range(8)] for size in (RIGHT, OTHER)}
        self.size = RIGHT

    def handle_error(self, request: object, client_address: object) -> None:
        """Who looks goes when he wants."""


class Stream(BaseHTTPRequestHandler):
    server: Camera

    def do_GET(self) -> None:
        self.send_response(200)
        self.send_header("Content-Type", "multipart/x-mixed-replace; boundary=picture")
        self.end_headers()
        size = self.server.size
        for i in cycle(range(8)):
            if self.server.size != size:
                return  # FFmpeg would go on in the old size, within one stream
            jpeg = self.server.pictures[size][i]
            head = f"--picture\r\nContent-Type: image/jpeg\r\nContent-Length: {len(jpeg)}\r\n\r\n"
            self.wfile.write(head.encode() + jpeg + b"\r\n")
            time.sleep(0.05)

    def log_message(self, *_: object) -> None:
        """Nothing is said."""


@pytest.fixture
def server() -> Iterator[Camera]:
    camera = Camera()
    Thread(target=camera.serve_forever, daemon=True).start()
    yield camera
    camera.shutdown()
    camera.server_close()


def command(server: Camera, folder: Path) -> list[str]:
    road().save(folder / "road.png")
    (folder / "lanes.json").write_text(json.dumps(LANES))
    source = f"http://127.0.0.1:{server.server_port}/"
    return [CAMERA, "--source", source, "--lanes", str(folder / "lanes.json"), "--jsonl", "-"]


def test_a_camera_whose_pictures_change_their_size_is_lost_until_the_right_size_is_back(
    server: Camera, tmp_path: Path
) -> None:
    program = subprocess.Popen(command(server, tmp_path), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert program.stdout is not None

    def until(reason: str) -> None:
        assert program.stdout is not None
        for _ in range(10):
            line = program.stdout.readline()
            assert line, "the program has ended"
            if json.loads(line)["lanes"]["a"]["reason"] == reason:
                return
        pytest.fail(f"not {reason} in ten seconds")

    until("ok")
    server.size = OTHER
    until("lost")
    server.size = RIGHT
    until("ok")
    program.terminate()
    _, said = program.communicate(timeout=20)
    assert program.returncode == 0
    assert len(said.splitlines()) == 1
    assert "is for 320 x 240 and the source gives 160 x 120" in said


def test_a_camera_whose_first_picture_has_another_size_is_refused(server: Camera, tmp_path: Path) -> None:
    server.size = OTHER
    done = subprocess.run(command(server, tmp_path), capture_output=True, text=True, check=False, timeout=30)
    assert (done.returncode, len(done.stderr.splitlines())) == (2, 1), done.stderr
    assert "is for 320 x 240 and the source gives 160 x 120" in done.stderr
