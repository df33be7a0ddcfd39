# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""`host_sim learning`: learning pays where the demand is another one and does no harm where it is not; the paper's way
ruins the forecast. In few trials; docs/measurements.md has thirty.
"""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]
HOST_SIM = os.environ.get("ELMOPP_HOST_SIM", str(ROOT / "build" / "release" / "bin" / "host_sim"))
QUICK = ("--trials", "2", "--updates", "300")
ERRORS = ("rmse_10_s", "rmse_30_s", "rmse_60_s")


def learning(folder: Path, *options: str) -> dict[str, Any]:
    file = folder / "learning.json"
    subprocess.run([HOST_SIM, "learning", *QUICK, *options, "--json", str(file)], check=True, capture_output=True)
    found: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
    return found


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    return learning(tmp_path_factory.mktemp("learning"))


def test_every_demand_has_every_player(found: dict[str, Any]) -> None:
    assert list(found["demands"]) == ["trained", "scale", "dynamics", "shift"]
    for demand in found["demands"].values():
        for measure in ERRORS:
            assert set(demand[measure]) == {"mean", "frozen", "learn", "literal", "oracle"}
        assert set(demand["delay_s"]) == {"none", "mean", "frozen", "learn", "literal", "oracle"}


@pytest.mark.parametrize("demand", ["scale", "dynamics"])
@pytest.mark.parametrize("measure", ERRORS)
def test_learning_pays_where_the_demand_is_another_one(found: dict[str, Any], demand: str, measure: str) -> None:
    errors = found["demands"][demand][measure]
    assert errors["learn"] < 0.8 * errors["frozen"]
    assert found["demands"][demand]["in_use_share"] > 0.95
    assert found["demands"][demand]["given_up"] == 0


def test_on_the_traffic_of_the_training_learning_does_no_harm(found: dict[str, Any]) -> None:
    errors = found["demands"]["trained"]
    for measure in ERRORS:
        assert errors[measure]["learn"] < 1.05 * errors[measure]["frozen"]


def test_after_a_shift_learning_is_ahead_within_the_same_trial(found: dict[str, Any]) -> None:
    for measure in ERRORS:
        errors = found["demands"]["shift"][measure]
        assert errors["learn"] < errors["frozen"]


def test_the_papers_way_ruins_the_forecast(found: dict[str, Any]) -> None:
    errors = found["demands"]["trained"]["rmse_60_s"]
    assert errors["literal"] > 4.0 * errors["frozen"]
    assert errors["literal"] > errors["mean"]


def test_pairs_are_differences_to_the_shipped_weights(found: dict[str, Any]) -> None:
    for demand in found["demands"].values():
        for measure, pairs in demand["paired"].items():
            for player, pair in pairs.items():
                difference = demand[measure][player] - demand[measure]["frozen"]
                assert pair["mean"] == pytest.approx(difference, abs=1e-12)
                assert pair["low"] <= pair["mean"] <= pair["high"]


def test_an_oracle_of_what_was_trained_is_what_is_shipped(found: dict[str, Any]) -> None:
    for measure in (*ERRORS, "delay_s"):
        assert found["demands"]["trained"]["paired"][measure]["oracle"] == {"mean": 0.0, "low": 0.0, "high": 0.0}


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--chooser", "naive"), ['--chooser "naive"', "rollout or cumulative"]),
        (("--chooser", "rollout:lstm"), ['--chooser "rollout:lstm"', "without one"]),
        (("--updates", "0"), ['--updates "0"', "from 1 to"]),
        (("--trials", "none"), ['--trials "none"']),
    ],
)
def test_a_request_that_cannot_be_run_is_one_line_and_status_2(options: tuple[str, ...], words: list[str]) -> None:
    done = subprocess.run([HOST_SIM, "learning", *options], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    for word in words:
        assert word in done.stderr
