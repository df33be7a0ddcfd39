# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""tools/bench-cortex-m4: what it makes of counts, and what it refuses. The counting itself has probes of its own."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from elmopp_tools.bench_cortex_m4 import (
    Count,
    CountError,
    WrongCountError,
    err60_table,
    json_text,
    main,
    read_counts,
    table,
)

KEYS = ["nothing", "thousand", "step", "tick", "step"]
LINES = ["0 0", "1000 1000", "10 30", "500 700", "12 29"]


def test_the_most_and_the_spread_are_over_all_inputs_of_a_key() -> None:
    assert read_counts(KEYS, LINES) == {"step": Count(12, 30, 2), "tick": Count(500, 700, 0)}


@pytest.mark.parametrize("line", ["1 0", "0 1"])
def test_a_count_of_nothing_that_is_something_is_found_out(line: str) -> None:
    with pytest.raises(WrongCountError, match="'nothing' was not counted as 0 instructions and 0 cycles"):
        read_counts(KEYS, [line, *LINES[1:]])


def test_a_missing_probe_is_found_out() -> None:
    with pytest.raises(WrongCountError, match="'thousand'"):
        read_counts(["nothing", "step"], ["0 0", "10 30"])


def test_keys_and_counts_that_do_not_pair_are_refused() -> None:
    with pytest.raises(CountError, match="names 5 pieces of work, and 4 were counted"):
        read_counts(KEYS, LINES[:4])


def test_the_file_has_the_keys_that_were_agreed_on() -> None:
    errors = {"ours_f32": 0.25, "ours_q15": 0.5, "ref_16x8": 1.0}
    assert json.loads(json_text({"lstm_f32_step": Count(1, 2, 0)}, errors)) == {
        "lstm_f32_step": {"insn": 1, "model_cycles": 2, "spread": 0},
        "err60": errors,
    }
    assert err60_table(errors)[-2:] == ["| `ours_q15` | 0.5 | 0.5 |", "| `ref_16x8` | 1 | 1 |"]


def test_the_table_says_the_share_of_a_second_at_168_mhz() -> None:
    assert table({"tick": Count(1000, 1680000, 0)})[-1] == "| `tick` | 1,000 | 1,680,000 | 0 | 1.000 % |"


def test_what_cannot_be_counted_is_one_line_and_status_2(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--program", str(tmp_path / "none")]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert main(["--json", str(tmp_path / "none" / "x.json")]) == 2
    assert "the folder of the output does not exist" in capsys.readouterr().err
