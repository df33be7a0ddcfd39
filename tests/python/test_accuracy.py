# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""How good the shipped forecasts are, measured afresh by the core: the gate that they passed, and what documents say.

The gate (docs/algorithm.md): over the 30 evaluation trials the root mean squared error of each network is below that of
persistence and of the mean at 10, 30 and 60 s, and at most AR(8)'s at 30 and 60 s.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from elmopp_tools.inflow_data import EVALUATION_SEED, TRAINING_SEED, VALIDATION_SEED

ROOT = Path(__file__).resolve().parents[2]
HOST_SIM = os.environ.get("ELMOPP_HOST_SIM", str(ROOT / "build" / "release" / "bin" / "host_sim"))
RECURRENT = ("lstm", "nlstm")
NETWORKS = (*RECURRENT, "lstm-q15", "nlstm-q15", "ann", "gcn")


@pytest.fixture(scope="module")
def measured(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("accuracy") / "accuracy.json"
    subprocess.run([HOST_SIM, "accuracy", "--json", str(file)], check=True, capture_output=True)
    return file


@pytest.fixture(scope="module")
def accuracy(measured: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(measured.read_text(encoding="utf-8"))
    return found


def passes_the_gate(rmse: dict[str, dict[str, float]], network: str) -> bool:
    ours = rmse[network]
    beats_the_simple = all(
        ours[seconds] < rmse[peer][seconds] for peer in ("persistence", "mean") for seconds in ("10", "30", "60")
    )
    return beats_the_simple and all(ours[seconds] <= rmse["ar8"][seconds] for seconds in ("30", "60"))


@pytest.mark.parametrize("network", NETWORKS)
def test_the_shipped_network_passes_the_gate(accuracy: dict[str, Any], network: str) -> None:
    assert accuracy["trials"] == 30
    assert passes_the_gate(accuracy["rmse"], network), accuracy["rmse"]


def just_passing() -> dict[str, dict[str, float]]:
    seconds = ("10", "30", "60")
    return {name: dict.fromkeys(seconds, 1.0) for name in ("persistence", "mean", "ar8")} | {
        "lstm": dict.fromkeys(seconds, 0.99)
    }


def test_each_clause_of_the_gate_can_fail() -> None:
    assert passes_the_gate(just_passing(), "lstm")
    for peer in ("persistence", "mean", "ar8"):
        for seconds in ("10", "30", "60"):
            rmse = just_passing()
            rmse[peer][seconds] = 0.98
            assert passes_the_gate(rmse, "lstm") == (peer == "ar8" and seconds == "10")


def test_what_the_documents_say_in_words(accuracy: dict[str, Any]) -> None:
    """A quarter of AR(8)'s error at a minute; one level and three are alike; behind persistence at a second. The plain
    network is ahead of the LSTM up to 10 s and behind it from 30 s on; the graph's is behind both from 10 s on.
    """
    rmse = accuracy["rmse"]
    for network in RECURRENT:
        assert rmse[network]["60"] < 0.25 * rmse["ar8"]["60"]
        assert rmse[network]["1"] > rmse["persistence"]["1"]
    for network in NETWORKS:
        assert accuracy["distrusted_share"][network] == 0.0
    for network in RECURRENT:
        for seconds, error in rmse[network].items():
            assert abs(rmse[f"{network}-q15"][seconds] / error - 1.0) < 0.01
    for seconds in ("1", "10"):
        assert rmse["ann"][seconds] < rmse["lstm"][seconds]
    for seconds, least, most in (("30", 1.05, 1.15), ("60", 1.15, 1.3)):
        assert least < rmse["ann"][seconds] / rmse["lstm"][seconds] < most
    for seconds, least, most in (("1", 0.3, 0.45), ("10", 1.2, 1.5), ("30", 2.1, 2.5), ("60", 2.6, 3.0)):
        assert least < rmse["gcn"][seconds] / rmse["lstm"][seconds] < most
    for seconds, most in (("10", 0.06), ("30", 0.02), ("60", 0.02)):
        assert abs(rmse["nlstm"][seconds] / rmse["lstm"][seconds] - 1.0) < most


def test_learning_on_is_no_worse_and_the_papers_way_ruins_the_forecast(accuracy: dict[str, Any]) -> None:
    rmse = accuracy["rmse"]
    for seconds in ("1", "10", "30", "60"):
        assert rmse["lstm-learn"][seconds] < 1.02 * rmse["lstm"][seconds]
    for seconds in ("30", "60"):
        assert rmse["lstm-literal"][seconds] > 6.0 * rmse["lstm"][seconds]
        assert rmse["lstm-literal"][seconds] > rmse["mean"][seconds]


def test_no_evaluation_sees_a_training_seed(accuracy: dict[str, Any]) -> None:
    assert accuracy["seed"] == EVALUATION_SEED
    assert len({EVALUATION_SEED, TRAINING_SEED, VALIDATION_SEED}) == 3
    assert min(TRAINING_SEED, VALIDATION_SEED) >= 4_000_000_000


def test_the_tables_are_those_of_a_fresh_measurement(measured: Path) -> None:
    command = [sys.executable, str(ROOT / "tools" / "accuracy"), "--check", "--measured", str(measured)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_the_simulator_is_asked_where_no_measurement_is_given(tmp_path: Path) -> None:
    command = [sys.executable, str(ROOT / "tools" / "accuracy"), "--check", "--host-sim", str(tmp_path / "none")]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert str(tmp_path / "none") in done.stderr


def test_a_changed_number_in_the_document_is_found(measured: Path, tmp_path: Path) -> None:
    text = (ROOT / "weights" / "README.md").read_text(encoding="utf-8")
    row = next(line for line in text.splitlines() if line.startswith("| `lstm`"))
    document = tmp_path / "README.md"
    document.write_text(text.replace(row, row.rsplit("0.", 1)[0] + "0.999 |"), encoding="utf-8")
    command = [sys.executable, str(ROOT / "tools" / "accuracy"), "--check", "--measured", str(measured), str(document)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "0.999" in done.stderr
