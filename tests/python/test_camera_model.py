# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""A detector of the user's: the layouts of the usual ones, what is refused, and elmopp-camera with one."""

import json
import os
import subprocess
from pathlib import Path

import pytest
import small_onnx
from elmopp_tools import score_counter
from PIL import Image

CAMERA = os.environ["ELMOPP_CAMERA"]
DRAW_SCENE = os.environ["ELMOPP_DRAW_SCENE"]
FIND_VEHICLES = os.environ["ELMOPP_FIND_VEHICLES"]
MODELS = {"yolo8": small_onnx.yolo8, "yolo5": small_onnx.yolo5, "ssd": small_onnx.ssd}


def found_by(model: Path, picture: Path) -> list[list[float]]:
    done = subprocess.run([FIND_VEHICLES, str(model), str(picture)], capture_output=True, text=True, check=True)
    return sorted([float(word) for word in line.split()] for line in done.stdout.splitlines())


@pytest.mark.parametrize("layout", MODELS)
def test_each_layout_gives_the_boxes_that_are_there(layout: str, tmp_path: Path) -> None:
    model = tmp_path / "model.onnx"
    model.write_bytes(MODELS[layout]())
    # Twice as wide as the input, and half as high as wide: YOLO's picture has grey bars above and below.
    picture = Image.new("RGB", (192, 96), (0, 0, 0))
    picture.paste((255, 255, 255), (64, 16, 96, 48))
    picture.save(tmp_path / "picture.png")
    boxes = [[round(value) for value in box] for box in found_by(model, tmp_path / "picture.png")]
    if layout == "ssd":  # stretched: a cell is 32 x 16 here
        assert boxes == [[64, 16, 32, 16], [64, 32, 32, 16]]
    else:
        assert boxes == [[64, 16, 32, 32]]


def refused(model: Path, lanes: Path, video: Path, tmp_path: Path) -> str:
    spoilt = tmp_path / "spoilt.lanes"
    spoilt.write_text(json.dumps({**json.loads(lanes.read_text()), "model": str(model)}))
    command = [CAMERA, "--source", str(video), "--lanes", str(spoilt), "--jsonl", str(tmp_path / "r.jsonl")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    lines = [line for line in done.stderr.splitlines() if line.startswith("elmopp-camera: ")]
    assert (done.returncode, len(lines)) == (2, 1), done.stderr
    return lines[0]


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("drawn")
    subprocess.run([DRAW_SCENE, str(folder), "blocks", "12"], check=True)
    score_counter.main(["--write-lanes", str(folder / "blocks.json"), str(folder / "blocks.lanes")])
    return folder


def test_what_is_no_detector_is_refused_in_one_line(drawn: Path, tmp_path: Path) -> None:
    whole = small_onnx.yolo5()
    models = {
        "missing.onnx": (None, "cannot be read"),
        "text.onnx": (b"no model at all", "is no ONNX model"),
        "empty.onnx": (b"", "is no ONNX model"),
        "cut.onnx": (whole[: len(whole) // 2], "is no ONNX model"),
        "other.onnx": (small_onnx.no_detector(), "[1, 36]"),
    }
    for name, (content, word) in models.items():
        model = tmp_path / name
        if content is not None:
            model.write_bytes(content)
        line = refused(model, drawn / "blocks.lanes", drawn / "blocks.avi", tmp_path)
        assert name in line
        assert word in line


def test_a_model_counts_through_the_whole_program(drawn: Path, tmp_path: Path) -> None:
    """White blocks on a dark road, which the model finds by their light."""
    (tmp_path / "model.onnx").write_bytes(small_onnx.yolo8())
    lanes = tmp_path / "model.lanes"
    lanes.write_text(json.dumps({**json.loads((drawn / "blocks.lanes").read_text()), "model": "model.onnx"}))
    command = [CAMERA, "--source", str(drawn / "blocks.avi"), "--lanes", str(lanes), "--jsonl", "-"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    last = json.loads(done.stdout.splitlines()[-1])["lanes"]
    truth = json.loads((drawn / "blocks.json").read_text())
    counted = sum(lane["arrived_total"] for lane in last.values())
    assert abs(counted - truth["total"]) <= 2, (counted, truth["totals"])
    assert all(lane["valid"] for lane in last.values())
