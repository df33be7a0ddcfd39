# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""elmopp-camera, tools/score-counter and tools/draw-lanes on a drawn video."""

import json
import os
import subprocess
from pathlib import Path

import jsonschema
import pytest
from elmopp_tools import draw_lanes, score_counter
from PIL import Image

CAMERA = os.environ["ELMOPP_CAMERA"]
DRAW_SCENE = os.environ["ELMOPP_DRAW_SCENE"]
SECONDS = 16

SHARE = {"type": "number", "minimum": 0, "maximum": 1}
LANE = {
    "type": "object",
    "additionalProperties": False,
    "required": ["arrived_total", "inflow", "present", "occupancy", "valid", "reason", "confidence"],
    "properties": {
        "arrived_total": {"type": "integer", "minimum": 0},
        "inflow": {"type": "integer", "minimum": 0},
        "present": {"type": ["integer", "null"], "minimum": 0},
        "occupancy": SHARE,
        "valid": {"type": "boolean"},
        "reason": {"enum": ["ok", "learning", "black", "white", "frozen", "blurred", "covered", "moved", "lost"]},
        "confidence": SHARE,
    },
}
RECORD = {
    "type": "object",
    "additionalProperties": False,
    "required": ["t_s", "frame", "lanes", "latency_ms", "dropped"],
    "properties": {
        "t_s": {"type": "number"},
        "frame": {"type": "integer"},
        "lanes": {"type": "object", "additionalProperties": LANE},
        "junction": {"type": "object"},
        "latency_ms": {"type": "number"},
        "dropped": {"type": "integer"},
    },
}


def camera(*arguments: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run([CAMERA, *map(str, arguments)], capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def clips(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("clips")
    subprocess.run([DRAW_SCENE, str(folder), "drawn", str(SECONDS)], check=True)
    return folder


@pytest.fixture(scope="module")
def lanes(clips: Path) -> Path:
    file = clips / "drawn.lanes"
    assert score_counter.main(["--write-lanes", str(clips / "drawn.json"), str(file)]) == 0
    return file


def test_records_come_once_a_second_and_keep_their_schema(clips: Path, lanes: Path, tmp_path: Path) -> None:
    records = tmp_path / "r.jsonl"
    done = camera("--source", clips / "drawn.avi", "--lanes", lanes, "--jsonl", records)
    assert (done.returncode, done.stderr) == (0, "")
    lines = [json.loads(line) for line in records.read_text().splitlines()]
    for line in lines:
        jsonschema.validate(line, RECORD)
    assert [round(line["t_s"]) for line in lines[:SECONDS]] == list(range(SECONDS))
    for lane in ("lane0", "lane1", "lane2"):
        totals = [line["lanes"][lane]["arrived_total"] for line in lines]
        assert totals == sorted(totals)
        assert sum(line["lanes"][lane]["inflow"] for line in lines) == totals[-1] > 0


def test_the_same_video_gives_the_same_bytes(clips: Path, lanes: Path, tmp_path: Path) -> None:
    said = []
    for run in ("a", "b"):
        files = [tmp_path / f"{run}.{kind}" for kind in ("jsonl", "crossings")]
        arguments = ("--source", clips / "drawn.avi", "--lanes", lanes, "--jsonl", files[0], "--crossings", files[1])
        assert camera(*arguments).returncode == 0
        said.append([file.read_bytes() for file in files])
    assert said[0] == said[1]
    assert len(said[0][1]) > 100


def test_the_overlay_is_a_video_or_a_picture(clips: Path, lanes: Path, tmp_path: Path) -> None:
    for name in ("o.png", "o.avi"):
        out = tmp_path / name
        assert (
            camera("--source", clips / "drawn.avi", "--lanes", lanes, "--overlay", out, "--seconds", 2).returncode == 0
        )
        assert out.stat().st_size > 10_000
    assert Image.open(tmp_path / "o.png").size == (352, 264)
    again = camera("--source", tmp_path / "o.avi", "--lanes", lanes, "--jsonl", "-")  # decodes, and has the right size
    assert again.returncode == 0
    assert json.loads(again.stdout.splitlines()[-1])["frame"] > 40


def test_a_video_that_is_cut_short_is_counted_as_far_as_it_goes(clips: Path, lanes: Path, tmp_path: Path) -> None:
    cut = tmp_path / "cut.avi"
    whole = (clips / "drawn.avi").read_bytes()
    cut.write_bytes(whole[: len(whole) // 2])
    done = camera("--source", cut, "--lanes", lanes, "--jsonl", "-")
    assert done.returncode == 0
    assert json.loads(done.stdout.splitlines()[-1])["frame"] > 100
    assert len(done.stderr.splitlines()) <= 3


def test_what_cannot_be_run_is_refused_in_one_line(clips: Path, lanes: Path, tmp_path: Path) -> None:
    empty = tmp_path / "empty.avi"
    empty.write_bytes(b"")
    wrong = tmp_path / "wrong.lanes"
    wrong.write_text(lanes.read_text().replace('"width": 352', '"width": 640'))
    typo = tmp_path / "typo.lanes"
    typo.write_text(lanes.read_text().replace('"direction"', '"direktion"', 1))
    video = clips / "drawn.avi"
    requests = [
        (("--source", "nowhere.avi", "--lanes", lanes), "nowhere.avi"),
        (("--source", empty, "--lanes", lanes), "empty.avi"),
        (("--source", typo, "--lanes", lanes), "typo.lanes"),
        (("--source", video, "--lanes", wrong), "640 x 264"),
        (("--source", video, "--lanes", typo), "direktion"),
        (("--source", video, "--lanes", "nowhere.lanes"), "nowhere.lanes"),
        (("--source", video, "--lanes", lanes, "--overlay", "x.gif"), "x.gif"),
        (("--source", video, "--lanes", lanes, "--jsonl", "no/folder/x"), "no/folder/x"),
        (("--source", video, "--lanes", lanes, "--can", "nocan9"), "nocan9"),
        (("--lanes", lanes), "--source"),
    ]
    for arguments, word in requests:
        done = camera(*arguments)
        lines = [line for line in done.stderr.splitlines() if line.startswith("elmopp-camera: ")]
        assert (done.returncode, len(lines)) == (2, 1), (arguments, done.stderr)
        assert word in lines[0]


def test_the_drawn_clip_is_scored(clips: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "scores.json"
    assert score_counter.main(["--clips", str(clips), "--json", str(out), "--camera", CAMERA, "--events"]) == 0
    report = json.loads(out.read_text())
    clip = report["clips"]["drawn"]
    assert list(clip) == [
        "truth", "counted", "count_error", "lane_error", "f1", "wrong_events", "presence_error", "learning", "flags",
        "fps", "p99_ms", "rss_mb",
    ]  # fmt: skip
    assert clip["wrong_events"] <= 2, capsys.readouterr().out
    assert clip["learning"] is True
    assert clip["flags"] == []
    assert clip["presence_error"] is None
    assert report["pooled"]["f1"] > 0.9
    assert clip["rss_mb"] < 150


def test_score_counter_refuses_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bad = tmp_path / "bad"
    bad.mkdir()
    (bad / "x.json").write_text('{"format": "else"}')
    out = str(tmp_path / "s.json")
    for arguments, word in [
        (["--clips", "nowhere", "--json", out], "nowhere"),
        (["--clips", str(bad), "--json", out], "lane-count-truth/1"),
        (["--clips", str(tmp_path / "bad"), "--json", out, "--camera", "none"], "none"),
        (["--json", out], "--clips"),
        (["--write-lanes", "no.json", out], "no.json"),
    ]:
        assert score_counter.main(arguments) == 2
        error = capsys.readouterr().err
        assert word in error
        assert len(error.splitlines()) == 1
    assert not (tmp_path / "s.json").exists()


def test_lanes_are_drawn_on_a_frame(lanes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    frame = tmp_path / "frame.png"
    out = tmp_path / "out.png"
    Image.new("RGB", (352, 264), (90, 90, 90)).save(frame)
    assert draw_lanes.main(["--lanes", str(lanes), "--frame", str(frame), "--out", str(out)]) == 0
    drawn = Image.open(out)
    assert drawn.size == (352, 264)
    line = json.loads(lanes.read_text())["lanes"][1]["line"]
    x, y = (line[0][0] * 3 + line[1][0]) / 4, line[0][1]
    assert drawn.getpixel((round(x), round(y) - 1)) == (80, 220, 80)
    small = tmp_path / "small.png"
    Image.new("RGB", (100, 100)).save(small)
    assert draw_lanes.main(["--lanes", str(lanes), "--frame", str(small), "--out", str(out)]) == 2
    assert "100 x 100" in capsys.readouterr().err
    typo = tmp_path / "typo.lanes"
    typo.write_text(lanes.read_text().replace('"direction"', '"direktion"', 1))
    assert draw_lanes.main(["--lanes", str(typo), "--frame", str(frame), "--out", str(out)]) == 2
    assert "direction" in capsys.readouterr().err
