# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""The main experiment, run afresh: what README.md and docs/algorithm.md say must be what it says."""

from __future__ import annotations

import csv
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
HOST_SIM = os.environ.get("ELMOPP_HOST_SIM", str(ROOT / "build" / "release" / "bin" / "host_sim"))
DOCUMENTS = ("README.md", "docs/algorithm.md")
FORECASTS = ("none", "mean", "persistence", "ar8", "lstm", "nlstm", "oracle")
CLAIMS = [
    "ranking_throughput",
    "curve_falls",
    "elmopp_gt_itlc",
    "elmopp_gt_oaf",
    "itlc_gt_oaf",
    "t_elmopp_itlc",
    "t_elmopp_oaf",
    "t_itlc_oaf",
    "prediction_helps",
    "horizon_417",
    "hyperchaos_euler",
    "literal_works",
    "three_levels",
    "count_accuracy",
]


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("experiment") / "out"
    subprocess.run([HOST_SIM, "experiment", "--out", str(folder)], check=True, capture_output=True)
    return folder


def test_the_tables_are_those_of_a_fresh_run(results: Path) -> None:
    command = [sys.executable, str(ROOT / "tools" / "tables"), "--check", "--results", str(results)]
    done = subprocess.run([*command, *DOCUMENTS], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_a_changed_number_in_a_document_is_found(results: Path, tmp_path: Path) -> None:
    document = tmp_path / "README.md"
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    number = re.search(r"\d\.\d{3} ± ", text)
    assert number is not None
    document.write_text(text.replace(number[0], "9.999 ± ", 1), encoding="utf-8")
    command = [sys.executable, str(ROOT / "tools" / "tables"), "--check", "--results", str(results), str(document)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "9.999" in done.stderr


@pytest.mark.parametrize("name", ["throughput", "delay", "longest_red"])
def test_the_figures_are_those_of_a_fresh_run(results: Path, name: str) -> None:
    assert (ROOT / "docs" / "figures" / f"{name}.svg").read_bytes() == (results / f"{name}.svg").read_bytes()


def test_every_claim_has_a_verdict(results: Path) -> None:
    claims = json.loads((results / "claims.json").read_text(encoding="utf-8"))
    assert [claim["id"] for claim in claims] == CLAIMS
    assert {claim["verdict"] for claim in claims} <= {"reproduced", "not_reproduced", "not_run"}


def test_the_table_is_the_papers(results: Path) -> None:
    with (results / "trials.csv").open(newline="", encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    names = list(dict.fromkeys(f"{row['chooser']}:{row['forecast']}" for row in rows))
    cumulative = [f"cumulative:{forecast}" for forecast in FORECASTS]
    assert names == ["naive:none", *cumulative, "pressure:none", "itlc:none", "oaf:none", "fixed:none"]
    assert len(rows) == 2 * 12 * 5 * 30
