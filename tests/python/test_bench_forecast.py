# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""tools/bench-forecast: ratios, verdict, table and refusals, with made-up numbers; nothing is measured."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from elmopp_tools import bench_forecast
from elmopp_tools.bench_forecast import (
    V3_FLAGS,
    BenchError,
    host_sim_says,
    main,
    missing_flags,
    processor,
    read_ours,
)
from elmopp_tools.bench_report import (
    PORTABLE,
    PRESETS,
    V3,
    Ours,
    Round,
    Theirs,
    json_text,
    lines_of_table,
    lines_of_verdict,
    rollout_ratio,
    step_ratio,
    verdict,
)

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = ROOT / "tools" / "bench-forecast"
ABOUT = {"processor": "made up", "onnxruntime": "1.2.3"}
THEIRS = Theirs(step_ns=300.0, long_step_ns=310.0, run_us=9.0, rollout60_runs_us=600.0, rollout60_unrolled_us=500.0)
OURS = Ours(lstm_step_ns=150.0, nlstm_step_ns=450.0, rollout60_us=10.0, lstm_digest="00ff")


def made_up(portable_ns: float, v3_ns: float, step_ns: float = 300.0) -> Round:
    ours = {PORTABLE: replace(OURS, lstm_step_ns=portable_ns), V3: replace(OURS, lstm_step_ns=v3_ns)}
    return Round(ours, replace(THEIRS, step_ns=step_ns))


def with_digest(found: Round, flags: str, digest: str) -> Round:
    return Round({**found.ours, flags: replace(found.ours[flags], lstm_digest=digest)}, found.theirs)


def only_portable(found: Round) -> Round:
    return Round({PORTABLE: found.ours[PORTABLE]}, found.theirs)


# Ratios


def test_a_ratio_is_that_of_its_round_and_the_median_of_rounds() -> None:
    # The machine ran half as fast in the second round; the ratio does not show it.
    rounds = [made_up(150, 90, 300), made_up(300, 180, 600), made_up(160, 60, 300)]
    assert step_ratio(rounds, V3).median == pytest.approx(0.3)
    assert step_ratio(rounds, V3).low == pytest.approx(0.2)
    assert step_ratio(rounds, PORTABLE).high == pytest.approx(160 / 300)


@pytest.mark.parametrize(("runs_us", "unrolled_us"), [(600.0, 500.0), (500.0, 600.0)])
def test_a_rollout_is_compared_with_the_faster_way(runs_us: float, unrolled_us: float) -> None:
    theirs = replace(THEIRS, rollout60_runs_us=runs_us, rollout60_unrolled_us=unrolled_us)
    assert rollout_ratio([Round({V3: OURS}, theirs)], V3).median == pytest.approx(10 / 500)


# The verdict


@pytest.mark.parametrize(("v3_ns", "exit_code"), [(90.0, 0), (150.0, 0), (150.1, 1), (400.0, 1)])
def test_at_most_half_of_their_step(v3_ns: float, exit_code: int) -> None:
    assert verdict([made_up(200, v3_ns)]).exit_code == exit_code


def test_the_portable_build_may_take_longer() -> None:
    assert verdict([made_up(290, 90)]).exit_code == 0


@pytest.mark.parametrize("flags", list(PRESETS))
def test_other_bits_fail_however_fast(flags: str) -> None:
    rounds = [made_up(100, 50), with_digest(made_up(100, 50), flags, "00fe")]
    assert verdict(rounds).exit_code == 1
    assert "NOT the same bits: digests 00fe, 00ff" in lines_of_verdict(rounds)


def test_without_avx2_nothing_is_claimed() -> None:
    rounds = [only_portable(made_up(100, 50))]
    assert verdict(rounds).exit_code == 2
    assert lines_of_verdict(rounds)[-1] == "x86-64-v3: not measured, this processor cannot run it"
    assert "x86-64-v3" not in "\n".join(lines_of_table(rounds))


@pytest.mark.parametrize(
    ("v3_ns", "words"),
    [
        (90.0, "0.300 of onnxruntime's marginal step; at most 0.5: yes; aim 0.3: yes"),
        (120.0, "0.400 of onnxruntime's marginal step; at most 0.5: yes; aim 0.3: NO"),
        (240.0, "0.800 of onnxruntime's marginal step; at most 0.5: NO; aim 0.3: NO"),
    ],
)
def test_the_last_line_says_limit_and_aim(v3_ns: float, words: str) -> None:
    assert lines_of_verdict([made_up(200, v3_ns)])[-1] == f"x86-64-v3: {words}"


def test_rounds_that_differ_are_said_and_the_median_still_counts() -> None:
    rounds = [made_up(200, 90), made_up(200, 90), made_up(200, 120)]
    assert verdict(rounds).exit_code == 0
    assert "the rounds differ, 0.300 (0.300 to 0.400): leave the machine alone" in "\n".join(lines_of_verdict(rounds))
    assert "differ" not in "\n".join(lines_of_verdict([made_up(200, 90), made_up(200, 100)]))


# What is printed and written


def test_the_table_holds_every_number_under_its_build() -> None:
    lines = lines_of_table([made_up(150, 90)])
    cells = {line[: lines[0].index("portable")].strip() or "head": line.split() for line in lines}
    assert cells["head"] == ["portable", "x86-64-v3", "onnxruntime"]
    text = "\n".join(" ".join(line.split()) for line in lines)
    for row in (
        "LSTM step, ns 150.0 90.0 300.0",
        "nested LSTM step, ns 450.0 450.0 has none",
        "60-step rollout, µs 10.00 10.00 500.00",
        "as 60 runs of one step 600.00",
        "as one run of 60 steps 500.00",
        "ratio of the LSTM step 0.500 (0.500 to 0.500) 0.300 (0.300 to 0.300) 1",
        "ratio of the rollout 0.020 (0.020 to 0.020) 0.020 (0.020 to 0.020) 1",
    ):
        assert row in text
    assert len({len(line) for line in lines}) == 1


def test_the_json_holds_verdict_ratios_and_rounds() -> None:
    rounds = [made_up(150, 90), made_up(150, 120), made_up(150, 60)]
    whole = json.loads(json_text(rounds, ABOUT))
    assert whole["processor"] == "made up"
    assert (whole["met"], whole["digests_equal"]) == (True, True)
    assert whole["step_ratio"][V3] == pytest.approx({"median": 0.3, "low": 0.2, "high": 0.4})
    assert [each["ours"][V3]["lstm_step_ns"] for each in whole["rounds"]] == [90, 120, 60]
    assert whole["rounds"][0]["theirs"]["step_ns"] == 300


# What host_sim says


def test_what_host_sim_writes_is_read_and_more_is_no_matter() -> None:
    text = json.dumps({"lstm_step_ns": 90, "nlstm_step_ns": 450.5, "rollout60_us": 6.5, "lstm_digest": "a0", "x": 1})
    assert read_ours(text) == Ours(90, 450.5, 6.5, "a0")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"lstm_step_ns": None}, "lstm_step_ns is null"),
        ({"nlstm_step_ns": 0}, "nlstm_step_ns is 0"),
        ({"rollout60_us": "7"}, 'rollout60_us is "7"'),
        ({"lstm_digest": 7}, "lstm_digest is 7"),
    ],
)
def test_a_wrong_measurement_is_named(change: dict[str, object], words: str) -> None:
    right = {"lstm_step_ns": 90.0, "nlstm_step_ns": 450.0, "rollout60_us": 6.5, "lstm_digest": "a0"}
    with pytest.raises(ValueError, match=words):
        read_ours(json.dumps(right | change))


def program(folder: Path, body: str) -> Path:
    file = folder / "host_sim"
    file.write_text(f"#!/bin/sh\n{body}\n", encoding="utf-8")
    file.chmod(0o755)
    return file


def test_host_sim_is_run_for_the_forecast_only(tmp_path: Path) -> None:
    answer = json.dumps({"lstm_step_ns": 9, "nlstm_step_ns": 8, "rollout60_us": 7, "lstm_digest": "6"})
    body = f"[ \"$1 $2 $3\" = 'bench --forecast-only --json' ] && echo '{answer}' >\"$4\""
    assert host_sim_says(program(tmp_path, body)) == Ours(9, 8, 7, "6")


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("echo first >&2; echo last >&2; exit 3", "ended with 3: last"),
        ("exit 1", "ended with 1: no message"),
        ("exit 0", "wrote no measurement"),
        ("echo '[]' >\"$4\"", "wrote no measurement: no object"),
        ("echo '{' >\"$4\"", "wrote no measurement"),
    ],
)
def test_a_host_sim_that_fails_is_one_line(tmp_path: Path, body: str, words: str) -> None:
    with pytest.raises(BenchError, match=words):
        host_sim_says(program(tmp_path, body))


def test_no_host_sim_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(BenchError, match="No such file or directory ; a program"):
        host_sim_says(tmp_path / "host_sim")


# The processor


def cpuinfo(flags: set[str]) -> str:
    return f"processor\t: 0\nmodel name\t: Some CPU\nflags\t\t: fpu {' '.join(sorted(flags))} sse2\n\nprocessor\t: 1\n"


def test_a_processor_of_x86_64_v3_lacks_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("platform.machine", lambda: "x86_64")
    assert missing_flags(cpuinfo(V3_FLAGS)) == []
    assert missing_flags(cpuinfo(V3_FLAGS - {"avx2", "fma"})) == ["avx2", "fma"]
    assert missing_flags("") == sorted(V3_FLAGS)


def test_another_architecture_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("platform.machine", lambda: "aarch64")
    assert missing_flags(cpuinfo(V3_FLAGS)) == ["x86-64"]
    assert processor("") == "aarch64"
    assert processor(cpuinfo(set())) == "Some CPU"


# Requests


def test_help_says_exit_codes_and_installs_nothing() -> None:
    done = subprocess.run([sys.executable, PROGRAM, "--help"], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert "Exit codes: 0" in done.stdout
    assert "setup:" not in done.stdout


@pytest.mark.parametrize(
    ("request_", "words"),
    [
        (["--rounds", "0"], "'0' is no number of rounds; right would be 1 or more"),
        (["--rounds", "x"], "'x' is no number of rounds"),
        (["--quick"], "unrecognized arguments: --quick"),
        (["--json"], "expected one argument"),
    ],
)
def test_a_wrong_request_is_one_line(capsys: pytest.CaptureFixture[str], request_: list[str], words: str) -> None:
    with pytest.raises(SystemExit) as ended:
        main(request_)
    assert ended.value.code == 2
    assert_one_line(capsys, words)


def test_a_file_that_cannot_be_written_is_said_before_anything_is_done(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert main(["--json", str(tmp_path / "none" / "x.json")]) == 2
    assert_one_line(capsys, "the folder of the output does not exist")


def test_a_set_up_that_fails_is_one_line(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(bench_forecast, "ROOT", tmp_path)
    (tmp_path / "tools").mkdir()
    program(tmp_path / "tools", "exit 2").rename(tmp_path / "tools" / "setup")
    assert main([]) == 2
    assert_one_line(capsys, "tools/setup bench failed")


def assert_one_line(capsys: pytest.CaptureFixture[str], words: str) -> None:
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("bench-forecast: ") and err.endswith("\n") and err.count("\n") == 1
    assert words in err
