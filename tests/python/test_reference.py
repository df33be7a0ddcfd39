# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""host_sim on the C core against the independent implementation: the same seconds, stage by stage and queue by queue.

The reference (tests/reference/elmopp_reference.py) was written from the equations without a look at the C. It works in
double precision throughout, the core in single: stages and reds must be equal, queues equal to 1e-6, scores to 1e-5.
"""

from __future__ import annotations

import dataclasses
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from references import load_reference

ROOT = Path(__file__).resolve().parents[2]
HOST_SIM = os.environ.get("ELMOPP_HOST_SIM", str(ROOT / "build" / "host" / "bin" / "host_sim"))


REFERENCE = load_reference("elmopp_reference")


def run_host_sim(profile: str, chooser: str, vehicles: int, trial: int) -> tuple[list[dict[str, Any]], dict[str, Any]]:
    """The decision log (without its last line, the metrics) and the metrics."""
    command = [HOST_SIM, "run", "--profile", profile, "--chooser", chooser, "--vehicles", str(vehicles)]
    command += ["--seed", "1", "--trial", str(trial), "--full", "--log", "-", "--summary", "/dev/stderr"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return [json.loads(line) for line in done.stdout.splitlines()], json.loads(done.stderr)


# In all of these the smallest margin of a deciding comparison lies above single precision (the reference records it).
CASES = [
    ("paper", "naive", 200, 3),
    ("paper", "naive", 800, 0),
    ("paper", "naive", 800, 1),
    ("paper", "naive@frozen", 800, 0),
    ("paper", "naive@hysteresis=1.2", 800, 2),
    ("paper", "cumulative:none", 800, 0),
    ("paper", "cumulative:mean", 600, 1),
    ("paper", "cumulative:persistence", 800, 2),
    ("paper", "cumulative:ar8", 800, 0),
    ("paper", "cumulative:ar8", 1000, 4),
    ("paper", "cumulative:oracle", 800, 0),
    ("paper", "cumulative@constant-age:oracle", 800, 0),
    ("paper", "cumulative@printed-sign:none", 800, 0),
    ("paper", "pressure", 800, 0),
    ("paper", "pressure", 1000, 2),
    ("paper", "itlc", 800, 0),
    ("paper", "itlc@ready=60", 800, 1),
    ("paper", "oaf", 800, 0),
    ("paper", "fixed", 800, 0),
    ("saturation", "naive", 600, 0),
    ("saturation", "cumulative:ar8", 600, 1),
    ("saturation", "pressure", 600, 0),
    ("saturation", "itlc", 800, 0),
    ("figure", "naive", 800, 0),
    ("figure", "cumulative:ar8", 400, 1),
    ("literal", "naive", 800, 0),
    ("literal", "cumulative:none", 800, 0),
]

METRICS = ("throughput_veh_per_s", "served_share", "mean_delay_s", "longest_red_s", "switches")


def reference_settings(profile: str, chooser: str) -> tuple[str, str, Any]:
    """Name, forecast and settings of the reference for a chooser as host_sim writes it."""
    words, _, forecast = chooser.partition(":")
    name, *options = words.split("@")
    settings = REFERENCE.settings_for(profile, name)
    values: dict[str, Any] = {}
    for option in options:
        key, _, value = option.partition("=")
        known: dict[str, dict[str, Any]] = {
            "frozen": {"frozen": True},
            "hysteresis": {"hysteresis": float(value or 1)},
            "constant-age": {"constant_t": True},
            "printed-sign": {"printed_sign": True},
            "ready": {"ready_veh": float(value or 0)},
        }
        values.update(known[key])
    if profile == "literal" and name == "naive":
        values["literal_clock"] = "lane"
    return name, forecast or "none", dataclasses.replace(settings, **values)


@pytest.mark.parametrize(("profile", "chooser", "vehicles", "trial"), CASES)
def test_every_second_agrees_with_the_reference(profile: str, chooser: str, vehicles: int, trial: int) -> None:
    name, forecast, settings = reference_settings(profile, chooser)
    theirs = REFERENCE.simulate(profile, name, forecast, float(vehicles), 1, trial, 2000, settings)
    log, metrics = run_host_sim(profile, chooser, vehicles, trial)
    assert len(log) == len(theirs.records) == 2000
    for ours, reference in zip(log, theirs.records, strict=True):
        where = f"second {ours['t_s']}, margin {reference['margin_relative']}"
        assert ours["stage"] == reference["stage"], where
        assert np.allclose(ours["queue_veh"], reference["queue_veh"], rtol=1e-6, atol=1e-6), where
        assert np.allclose(ours["outside_veh"], reference["outside_veh"], rtol=1e-6, atol=1e-6), where
        assert np.allclose(ours["out_veh"], reference["out_veh"], rtol=1e-6, atol=1e-6), where
        assert ours["red_s"] == reference["red_s"], where
        if name in ("naive", "cumulative"):
            # The lags of a smooth flow are nearly collinear: 60 iterations in single precision cost a digit.
            tolerance = 1e-4 if forecast == "ar8" else 1e-5
            assert np.allclose(ours["urgency"], reference["score"], rtol=tolerance, atol=1e-6), where
    for metric in METRICS:
        assert metrics[metric] == pytest.approx(theirs.metrics[metric], rel=1e-6), metric


def test_the_reference_holds_its_own_golden_values() -> None:
    script = ROOT / "tests" / "reference" / "elmopp_reference.py"
    subprocess.run([sys.executable, str(script), "--self-test"], check=True, capture_output=True)
