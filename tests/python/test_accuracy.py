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
from elmopp_tools.inflow_data import TRAINING_SEED, VALIDATION_SEED

ROOT = Path(__file__).resolve().parents[2]
HOST_SIM = os.environ.get("ELMOPP_HOST_SIM", str(ROOT / "build" / "release" / "bin" / "host_sim"))
NETWORKS = ("lstm", "nlstm")


@pytest.fixture(scope="module")
def accuracy(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    file = tmp_path_factory.mktemp("accuracy") / "accuracy.json"
    subprocess.run([HOST_SIM, "accuracy", "--json", str(file)], check=True, capture_output=True)
    found: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
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


@pytest.mark.parametrize("network", NETWORKS)
@pytest.mark.parametrize(("peer", "seconds"), [("persistence", "10"), ("mean", "30"), ("ar8", "30"), ("ar8", "60")])
def test_the_gate_can_fail(accuracy: dict[str, Any], network: str, peer: str, seconds: str) -> None:
    rmse = json.loads(json.dumps(accuracy["rmse"]))
    rmse[network][seconds] = 1.001 * rmse[peer][seconds]
    assert not passes_the_gate(rmse, network)


def test_the_networks_are_far_below_the_regression_at_a_minute(accuracy: dict[str, Any]) -> None:
    """What the documents claim in words: a third of AR(8)'s error."""
    rmse = accuracy["rmse"]
    for network in NETWORKS:
        assert rmse[network]["60"] < rmse["ar8"]["60"] / 3.0
        assert accuracy["distrusted_share"][network] < 0.01


def test_no_evaluation_sees_a_training_seed() -> None:
    """The experiment's seeds are small numbers; the two of the training lie at the far end of what a seed may be."""
    assert min(TRAINING_SEED, VALIDATION_SEED) > 3_999_999_999
    assert max(TRAINING_SEED, VALIDATION_SEED) <= 4_294_967_295
    assert TRAINING_SEED != VALIDATION_SEED


def test_the_tables_are_those_of_a_fresh_measurement() -> None:
    command = [sys.executable, str(ROOT / "tools" / "accuracy"), "--check", "--host-sim", HOST_SIM]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_a_changed_number_in_the_document_is_found(tmp_path: Path) -> None:
    text = (ROOT / "weights" / "README.md").read_text(encoding="utf-8")
    row = next(line for line in text.splitlines() if line.startswith("| `lstm`"))
    document = tmp_path / "README.md"
    document.write_text(text.replace(row, row.rsplit("0.", 1)[0] + "0.999 |"), encoding="utf-8")
    command = [sys.executable, str(ROOT / "tools" / "accuracy"), "--check", "--host-sim", HOST_SIM, str(document)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "0.999" in done.stderr
