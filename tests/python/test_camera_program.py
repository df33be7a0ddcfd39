# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""elmopp-camera, tools/score-counter and tools/draw-lanes on a drawn video."""

import json
import os
import subprocess
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from elmopp_tools import clip_copies, draw_lanes, score_counter
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
    subprocess.run([DRAW_SCENE, str(folder), "plain", str(SECONDS)], check=True)
    return folder


@pytest.fixture(scope="module")
def lanes(clips: Path) -> Path:
    file = clips / "plain.lanes"
    assert score_counter.main(["--write-lanes", str(clips / "plain.json"), str(file)]) == 0
    return file


def test_records_come_once_a_second_and_keep_their_schema(clips: Path, lanes: Path, tmp_path: Path) -> None:
    records = tmp_path / "r.jsonl"
    done = camera("--source", clips / "plain.avi", "--lanes", lanes, "--jsonl", records)
    assert (done.returncode, done.stderr) == (0, "")
    lines = [json.loads(line) for line in records.read_text().splitlines()]
    for line in lines:
        jsonschema.validate(line, RECORD)
    reasons = [lane["reason"] for line in lines[4:] for lane in line["lanes"].values()]
    assert set(reasons) == {"ok"}, "of the last record, too"
    assert all(lane["valid"] and lane["confidence"] >= 0.5 for lane in lines[-1]["lanes"].values())
    assert [round(line["t_s"]) for line in lines[:SECONDS]] == list(range(SECONDS))
    for lane in ("lane0", "lane1", "lane2"):
        totals = [line["lanes"][lane]["arrived_total"] for line in lines]
        assert totals == sorted(totals)
        assert sum(line["lanes"][lane]["inflow"] for line in lines) == totals[-1] > 0


def test_the_same_video_gives_the_same_bytes(clips: Path, lanes: Path, tmp_path: Path) -> None:
    said = []
    for run in ("a", "b"):
        files = [tmp_path / f"{run}.{kind}" for kind in ("jsonl", "crossings")]
        arguments = ("--source", clips / "plain.avi", "--lanes", lanes, "--jsonl", files[0], "--crossings", files[1])
        assert camera(*arguments).returncode == 0
        said.append([file.read_bytes() for file in files])
    assert said[0] == said[1]
    assert len(said[0][1]) > 100


def test_the_overlay_is_a_video_or_a_picture(clips: Path, lanes: Path, tmp_path: Path) -> None:
    for name in ("o.png", "o.avi"):
        out = tmp_path / name
        assert (
            camera("--source", clips / "plain.avi", "--lanes", lanes, "--overlay", out, "--seconds", 2).returncode == 0
        )
        assert out.stat().st_size > 10_000
    assert Image.open(tmp_path / "o.png").size == (352, 264)
    again = camera("--source", tmp_path / "o.avi", "--lanes", lanes, "--jsonl", "-")  # decodes, and has the right size
    assert again.returncode == 0
    assert json.loads(again.stdout.splitlines()[-1])["frame"] == 25  # every other one of two seconds', and one


def cpu_s_of(video: Path, lanes: Path, folder: Path, *more: object) -> float:
    timing = folder / "timing"
    assert camera("--source", video, "--lanes", lanes, "--timing", timing, *more).returncode == 0
    return float(json.loads(timing.read_text())["cpu_s"])


def test_an_overlay_costs_less_than_a_third_of_the_frames(clips: Path, lanes: Path, tmp_path: Path) -> None:
    video = clips / "plain.avi"
    without = min(cpu_s_of(video, lanes, tmp_path) for _ in range(3))
    drawn = min(cpu_s_of(video, lanes, tmp_path, "--overlay", tmp_path / "o.avi") for _ in range(3))
    assert without / drawn >= 0.7, (without, drawn)


def test_a_video_that_is_cut_short_is_counted_as_far_as_it_goes(clips: Path, lanes: Path, tmp_path: Path) -> None:
    cut = tmp_path / "cut.avi"
    whole = (clips / "plain.avi").read_bytes()
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
    video = clips / "plain.avi"
    requests = [
        (
            ("--source", video, "--lanes", Path(__file__).resolve().parents[2] / "README.md"),
            "README.md: parse error at line 1, column 1",
        ),
        (("--source", "nowhere.avi", "--lanes", lanes), "nowhere.avi"),
        (("--source", empty, "--lanes", lanes), "empty.avi"),
        (("--source", typo, "--lanes", lanes), "typo.lanes"),
        (("--source", video, "--lanes", wrong), "640 x 264"),
        (("--source", video, "--lanes", typo), "direktion"),
        (("--source", video, "--lanes", "nowhere.lanes"), "nowhere.lanes"),
        (("--source", video, "--lanes", lanes, "--overlay", "x.gif"), "x.gif"),
        (("--source", video, "--lanes", lanes, "--jsonl", "no/folder/x"), "no/folder/x"),
        (("--source", video, "--lanes", lanes, "--can", "nocan9"), "nocan9"),
        (("--source", video, "--lanes", lanes, "--try", "nek=0.7"), "nek=0.7"),
        (("--source", video, "--lanes", lanes, "--seconds", 0), "--seconds 0: right would be a number above 0"),
        (("--source", video, "--lanes", lanes, "--seconds", "soon"), "--seconds soon: right would be a number above 0"),
        (("--lanes", lanes), "--source"),
    ]
    for arguments, word in requests:
        done = camera(*arguments)
        lines = [line for line in done.stderr.splitlines() if line.startswith("elmopp-camera: ")]
        assert (done.returncode, len(lines)) == (2, 1), (arguments, done.stderr)
        assert word in lines[0]
        assert "[json" not in lines[0]


def test_a_source_that_can_never_run_is_refused_in_one_line(lanes: Path) -> None:
    sources = [
        ("gst:", "appsink"),
        ("gst:videotestsrc ! fakesink", "appsink"),
        ("gst:nonsense ! appsink", 'no element "nonsense"'),
        ("gst:videotestsrc ! appsink !", "syntax"),
        ("v4l2:x", "v4l2:0"),
        ("/dev/videos", "v4l2:0"),
        ("rtsp://", "names no host"),
        ("http://:80/stream", "names no host"),
        ("udp://", "names no port"),
    ]
    for source, word in sources:
        done = camera("--source", source, "--lanes", lanes, "--jsonl", "-", "--seconds", 1)
        assert (done.returncode, done.stdout, len(done.stderr.splitlines())) == (2, "", 1), (source, done.stderr)
        assert source in done.stderr
        assert word in done.stderr
    done = camera("--source", "rtsp://me:secret@/stream", "--lanes", lanes)
    assert done.returncode == 2
    assert "secret" not in done.stderr


def test_a_camera_that_is_not_there_yet_is_said_once_and_lost(lanes: Path) -> None:
    done = camera("--source", "/dev/video77", "--lanes", lanes, "--jsonl", "-", "--seconds", 2.2)
    assert (done.returncode, len(done.stderr.splitlines())) == (0, 1), done.stderr
    assert "/dev/video77: does not open" in done.stderr
    records = [json.loads(line) for line in done.stdout.splitlines()]
    assert {lane["reason"] for record in records for lane in record["lanes"].values()} == {"lost"}


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full")
def test_a_line_that_cannot_be_written_ends_the_run(clips: Path, lanes: Path) -> None:
    for option in ("--jsonl", "--crossings", "--timing"):
        done = camera("--source", clips / "plain.avi", "--lanes", lanes, option, "/dev/full")
        assert (done.returncode, len(done.stderr.splitlines())) == (1, 1), (option, done.stderr)
        assert f"{option} /dev/full: could not be written: No space left" in done.stderr
    with Path("/dev/full").open("w") as full:
        command = [CAMERA, "--source", str(clips / "plain.avi"), "--lanes", str(lanes), "--jsonl", "-"]
        assert subprocess.run(command, stdout=full, stderr=subprocess.DEVNULL, check=False).returncode == 1


def test_a_reference_is_refused_for_what_it_is(clips: Path, lanes: Path, tmp_path: Path) -> None:
    (tmp_path / "text.png").write_text("no picture")
    Image.new("RGB", (100, 50)).save(tmp_path / "small.png")
    words = {"gone.png": "is missing", "text.png": "no picture", "small.png": "100 x 50"}
    for name, word in words.items():
        spoilt = tmp_path / "spoilt.lanes"
        spoilt.write_text(json.dumps({**json.loads(lanes.read_text()), "reference": name}))
        done = camera("--source", clips / "plain.avi", "--lanes", spoilt)
        assert (done.returncode, len(done.stderr.splitlines())) == (2, 1), done.stderr
        assert name in done.stderr
        assert word in done.stderr


def test_the_drawn_clip_is_scored(clips: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "scores.json"
    assert score_counter.main(["--clips", str(clips), "--json", str(out), "--camera", CAMERA, "--events"]) == 0
    report = json.loads(out.read_text())
    clip = report["clips"]["plain"]
    assert list(clip) == [
        "truth", "counted", "count_error", "lane_error", "f1", "wrong_events", "presence_error", "learning", "flags",
        "fps", "p99_ms", "rss_mb",
    ]  # fmt: skip
    assert clip["wrong_events"] <= 2, capsys.readouterr().out
    assert clip["learning"] is False
    assert clip["flags"] == []
    assert clip["presence_error"] is None
    assert report["pooled"]["f1"] > 0.9
    assert clip["rss_mb"] < 150


def said_by(reasons: list[str]) -> dict[str, Any]:
    """Records of a camera with one lane, one a second."""
    lanes = [{"a": {"reason": reason, "present": None}} for reason in reasons]
    return {
        "jsonl": [{"t_s": 7.0 + i, "frame": 25 * i, "lanes": lane} for i, lane in enumerate(lanes)],
        "crossings": [],
        "timing": [{"frames": 100, "cpu_s": 1.0, "p99_ms": 1.0, "rss_mb": 1.0}],
    }


def test_learning_is_of_who_still_learns_after_three_seconds(clips: Path) -> None:
    truth = json.loads((clips / "plain.json").read_text())
    start = ["learning"] * 4
    for reasons, learning, flags in (
        ([*start, "ok", "ok"], False, []),
        ([*start, "learning", "ok"], True, []),
        ([*start, "ok", "learning"], True, []),
        ([*start, "ok", "moved", "lost"], False, ["lost", "moved"]),
    ):
        entry, _ = score_counter.score_clip(truth, said_by(reasons))
        assert (entry["learning"], entry["flags"]) == (learning, flags)


def changed(truth: dict[str, Any], path: list[Any], value: object) -> dict[str, Any]:
    """A truth with one value in place of another."""
    new: dict[str, Any] = json.loads(json.dumps(truth))
    at: Any = new
    for key in path[:-1]:
        at = at[key]
    at[path[-1]] = value
    return new


def test_a_spoilt_truth_file_is_refused_before_anything_runs(
    clips: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    truth = json.loads((clips / "plain.json").read_text())
    out = tmp_path / "out"
    cases: list[tuple[list[Any], object, list[str]]] = [
        (["lanes"], 7, ["lanes is 7", "a list"]),
        (["lanes"], [{}], ["lanes[0]", "name is missing"]),
        (["lanes", 0], 7, ["lanes[0] is 7"]),
        (["lanes", 1, "line"], [[1, 2]], ["lanes[1].line", "two points"]),
        (["lanes", 1, "line"], [[1, 2], [900, 2]], ["lanes[1].line[1]", "outside"]),
        (["lanes", 1, "name"], truth["lanes"][0]["name"], ["comes twice"]),
        (["lanes", 0, "direction"], "left", ["lanes[0].direction"]),
        (["lanes", 0, "direction"], "north", ["lanes[0].direction", "up, down"]),
        (["width"], 1, ["width is 1", "from 16 to"]),
        (["total"], "many", ["total", "whole number"]),
        (["totals"], {"nobody": 1}, ["totals"]),
        (["crossings", 0], {"frame": 3, "lane": "nobody"}, ["crossings[0]"]),
        (["present"], [{"frame": 0, "nobody": 1}], ["present[0]"]),
        (["frame_tolerance"], None, ["frame_tolerance"]),
    ]
    for path, value, words in cases:
        spoilt = tmp_path / "spoilt"
        spoilt.mkdir(exist_ok=True)
        (spoilt / "z.json").write_text(json.dumps(changed(truth, path, value)))
        for arguments in (
            ["--write-lanes", str(spoilt / "z.json"), str(out)],
            ["--clips", str(spoilt), "--json", str(out)],
        ):
            assert score_counter.main([*arguments, "--camera", "/bin/false"]) == 2, path
            error = capsys.readouterr().err
            assert len(error.splitlines()) == 1
            assert all(word in error for word in ["z.json", *words]), error
    assert not out.exists()
    # The whole folder is read first; /bin/false would end with 1.
    (spoilt / "a.json").write_text(json.dumps({**truth, "video": str(clips / "plain.avi")}))
    assert score_counter.main(["--clips", str(spoilt), "--json", str(out), "--camera", "/bin/false"]) == 2
    (spoilt / "z.json").unlink()
    assert score_counter.main(["--clips", str(spoilt), "--json", str(out), "--camera", "/bin/false"]) == 1


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
        (["--clips", str(bad), "--json", str(tmp_path / "no" / "s.json")], "folder of the output does not exist"),
        (["--clips", str(bad), "--json", str(tmp_path)], "is no regular file"),
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


def in_time(crossing: dict[str, Any]) -> tuple[int, str]:
    return crossing["frame"], crossing["lane"]


def test_copies_of_a_clip_have_the_truth_of_what_they_show(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Two clips, as a pool needs."""
    folder = tmp_path / "clips"
    folder.mkdir()
    for name in ("plain", "up"):
        subprocess.run([DRAW_SCENE, str(folder), name, "12"], check=True)
    out = tmp_path / "copies.json"
    asked = ["--clips", str(folder), "--json", str(out), "--camera", CAMERA]
    assert score_counter.main([*asked, "--copies", "third,mirrored,turned,shake"]) == 0
    said = capsys.readouterr().out.splitlines()
    for line, (kind, pool) in zip(said, json.loads(out.read_text())["copies"].items(), strict=True):
        assert pool["f1"] > 0.8, (kind, pool)
        assert pool["flags"] == {}, kind
        assert line.startswith(kind)
        assert line.endswith("flags none")
    assert score_counter.main([*asked, "--copies", "against"]) == 0
    against = json.loads(out.read_text())["copies"]["against"]
    assert against["counted"] == 0
    assert against["of"] > 10
    assert score_counter.main([*asked, "--copies", "upside"]) == 2
    assert "upside" in capsys.readouterr().err
    truth = json.loads((folder / "up.json").read_text())
    backwards = clip_copies.changed_truth(truth, "reversed")
    assert backwards["lanes"][0]["direction"] == "down"
    forwards = clip_copies.changed_truth(backwards, "reversed")["crossings"]
    assert sorted(forwards, key=in_time) == sorted(truth["crossings"], key=in_time)
    assert clip_copies.changed_truth(truth, "against")["lanes"] == truth["lanes"]
    stopped = clip_copies.changed_truth(truth, "stopped")
    assert stopped["crossings"][-1]["frame"] == truth["crossings"][-1]["frame"] + clip_copies.STOPPED_FRAMES
