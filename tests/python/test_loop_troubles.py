# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""tools/closed-loop-troubles with a program that plays the closed loop: what is run, and the table done by hand."""

from __future__ import annotations

from pathlib import Path

import pytest
from elmopp_tools.loop_troubles import TROUBLES, main

# Delay 20 and 22 s at seeds 1 and 2, with a reset 4 and 8 s more and one short amber; a word in a file for each run.
PLAYED = """#!/bin/bash
while [ $# -gt 0 ]; do declare "${1#--}=$2"; shift 2; done
mkdir -p "$out"
echo run >>"$(dirname "$out")/runs"
delay=$((18 + 2 * seed)) amber=0 mode=automatic
case $faults in reset*) delay=$((delay + 4 * seed)) amber=1 mode=silent ;; esac
cat >"$out/closed_loop.json" <<END
{"seconds": $seconds, "vehicles": $vehicles, "seed": $seed, "faults": "$faults", "delay_camera_s": $delay,
 "longest_red_camera_s": $((60 + seed)), "conflicts": 0, "early_greens": 0, "short_ambers": $amber}
END
cat >"$out/street.jsonl" <<END
{"mode": "automatic", "fault": "none", "cameras": {"N": "ok"}}
{"mode": "automatic", "fault": "none", "cameras": {"N": "black"}}
{"mode": "$mode", "fault": "lamp node", "cameras": {"N": "ok"}}
END
exit "$amber"
"""


def asked(folder: Path, *words: str, played: str = PLAYED) -> int:
    program = folder / "played"
    program.write_text(played, encoding="utf-8")
    program.chmod(0o755)
    return main(["--out", str(folder / "out"), "--program", str(program), "--seeds", "1", "2", *words])


def test_each_trouble_has_its_row_and_what_it_costs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert asked(tmp_path) == 1  # the witness had something to say
    said = capsys.readouterr()
    rows = said.out.splitlines()[2:]
    assert len(rows) == len(TROUBLES) == 8
    assert rows[0] == "| none | 21.0 | - | 62 | automatic 3 | black, fault lamp node | 0/0/0 |"
    # Differences 4 and 8: mean 6, 12.706 * sqrt(8) / sqrt(2) about it.
    assert rows[7] == (
        "| `reset@60-63` | 27.0 | +6.0 [-19.4, +31.4] | 62 | automatic 2, silent 1 | black, fault lamp node | 0/0/2 |"
    )
    assert "reset@60-63, seed 2" in said.err


def test_one_seed_has_a_difference_and_no_interval(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert asked(tmp_path, "--seeds", "1") == 1
    rows = capsys.readouterr().out.splitlines()[2:]
    assert rows[0].startswith("| none | 20.0 | - | 61 |")
    assert rows[7].startswith("| `reset@60-63` | 24.0 | +4.0 | 61 |")


def test_it_goes_on_where_it_was_broken_off(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    asked(tmp_path)
    first = capsys.readouterr().out
    assert asked(tmp_path) == 1  # also of a run of before
    said = capsys.readouterr()
    assert said.out == first
    assert "16 of 16 runs were there before, of this program" in said.err
    runs = tmp_path / "out" / "runs"
    assert len(runs.read_text(encoding="utf-8").splitlines()) == 16
    asked(tmp_path, "--vehicles", "500")  # another request
    assert len(runs.read_text(encoding="utf-8").splitlines()) == 32


def test_runs_of_another_program_do_not_answer(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    asked(tmp_path)
    first = capsys.readouterr().out
    asked(tmp_path, played=PLAYED.replace("18 + 2 * seed", "19 + 2 * seed"))
    said = capsys.readouterr()
    assert "there before" not in said.err
    assert said.out.splitlines()[2].startswith("| none | 22.0 |")
    assert said.out != first
    runs = tmp_path / "out" / "runs"
    assert len(runs.read_text(encoding="utf-8").splitlines()) == 32


def test_what_cannot_be_run_is_refused_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert asked(tmp_path, "--seconds", "100") == 2
    assert main(["--out", str(tmp_path), "--program", str(tmp_path / "nobody")]) == 2
    first, second = capsys.readouterr().err.splitlines()
    assert "--seconds 100: right would be 180 or more" in first
    assert "nobody is missing" in second
    with pytest.raises(SystemExit) as stop:
        main([])
    assert stop.value.code == 2
    said = capsys.readouterr().err
    assert said.startswith("closed-loop-troubles: the following arguments are required: --out")
    assert said.count("\n") == 1
