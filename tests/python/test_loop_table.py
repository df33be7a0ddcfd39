# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""tools/closed-loop-table: sums and intervals worked out by hand."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from elmopp_tools.loop_table import main


def written(folder: Path, scene: str, seed: int, delays: tuple[float, float], counted: tuple[int, int]) -> str:
    lanes = [{"lane": "N.L", "true": 10, "counted": counted[0]}, {"lane": "N.M", "true": 30, "counted": counted[1]}]
    result = {"scene": scene, "lanes": lanes, "delay_camera_s": delays[0], "delay_perfect_s": delays[1]}
    path = folder / f"{scene}-{seed}"
    path.mkdir()
    (path / "closed_loop.json").write_text(json.dumps({**result, "present_error_veh": 0.5}), encoding="utf-8")
    return str(path)


def test_a_scene_has_its_lane_error_and_the_interval_of_what_counting_costs(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folders = [
        written(tmp_path, "day", 1, (21.0, 20.0), (11, 29)),
        written(tmp_path, "day", 2, (33.0, 30.0), (10, 32)),
        written(tmp_path, "rain", 1, (25.0, 20.0), (5, 20)),
    ]
    assert main(folders) == 0
    lines = capsys.readouterr().out.splitlines()
    # |1| + |-1| + 0 + |2| of 80; differences 1 and 3: mean 2, 12.706 * sqrt(2) / sqrt(2) about it.
    assert lines[2] == "| day | 2 | 80 | 82 | 5.0 % | 0.50 ± 0.00 | 25.0 | 27.0 | +2.00 [-10.71, +14.71] |"
    assert lines[3] == "| rain | 1 | 40 | 25 | 37.5 % | 0.50 ± 0.00 | 20.0 | 25.0 | - |"
    assert lines[7:] == ["| crossed | 30 | 90 |", "| counted | 26 | 81 |"]


def test_a_folder_without_a_result_is_refused_by_name(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([str(tmp_path / "none")]) == 2
    said = capsys.readouterr().err
    assert f"{tmp_path / 'none' / 'closed_loop.json'}: No such file" in said
    assert "Errno" not in said


def test_no_folder_is_refused_in_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        main([])
    assert stop.value.code == 2
    said = capsys.readouterr().err
    assert said.startswith("closed-loop-table: the following arguments are required: DIR")
    assert said.count("\n") == 1
