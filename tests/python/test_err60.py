# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""The error of a free run over 60 steps on the eight fixed models: the goal, and that what it is measured by is right.

The firmware's runs come from tests/lstm_q15_probe.c, which says the same bits here as on a board
(tests/golden/lstm_digest.txt).
"""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
from elmopp_tools import err60
from elmopp_tools.err60 import Exact, Model, SixteenByEight
from references import load_reference

lstm = load_reference("lstm_reference")

ROOT = Path(__file__).resolve().parents[2]
PROBE = os.environ.get("ELMOPP_LSTM_Q15_PROBE", str(ROOT / "build" / "host" / "bin" / "tests" / "lstm_q15_probe"))
MODELS = err60.read_models()
SD_MIN = 0.3


@pytest.fixture(scope="module")
def errors(tmp_path_factory: pytest.TempPathFactory) -> list[dict[str, float]]:
    file = tmp_path_factory.mktemp("err60") / "model.bin"
    each = []
    for model in MODELS:
        file.write_bytes(model.record())
        written = subprocess.run([PROBE, str(file)], capture_output=True, check=True).stdout
        each.append(err60.errors(model, written))
    return each


def test_whole_numbers_have_a_fiftieth_of_the_error_of_16x8(errors: list[dict[str, float]]) -> None:
    medians = err60.medians(errors)
    assert list(medians) == ["ours_f32", "ours_q15", "ref_16x8"]
    assert medians["ours_q15"] <= 0.02 * medians["ref_16x8"]
    assert medians["ours_f32"] < 1e-4
    assert all(one["ours_q15"] < one["ref_16x8"] for one in errors)


def test_there_are_eight_models_of_two_kinds() -> None:
    assert [model.name for model in MODELS] == [f"{kind}{n}" for kind in ("inflow", "sines") for n in range(4)]


@pytest.mark.parametrize("model", MODELS, ids=lambda model: model.name)
def test_no_model_s_free_run_dies_down(model: Model) -> None:
    assert float(err60.run(model, Exact(model)).std(axis=0).min()) >= SD_MIN


@pytest.mark.parametrize("model", MODELS, ids=lambda model: model.name)
def test_the_exact_run_is_that_of_the_independent_reference(model: Model) -> None:
    level = lstm.LevelWeights(bias=model.bias.astype(np.float64), row=model.weight.astype(np.float64))
    weights = lstm.Weights(
        low=model.low.astype(np.float64),
        high=model.high.astype(np.float64),
        ar8=np.zeros(11),
        head_bias=model.head_bias.astype(np.float64),
        head_row=model.head.astype(np.float64),
        levels=(level,),
    )
    network = lstm.Network(weights)
    state, _ = network.absorb(network.start(), model.absorbed.astype(np.float64))
    rows = network.roll_out(state, err60.FREE_STEPS)
    assert float(np.abs(rows - err60.run(model, Exact(model))).max()) < 1e-8


def test_16x8_is_the_exact_network_but_for_its_words(monkeypatch: pytest.MonkeyPatch) -> None:
    """With nothing rounded it says the same: what it is behind by are its 8 and 16 bits."""
    model = MODELS[0]
    exact = err60.run(model, Exact(model))
    assert float(np.abs(err60.run(model, SixteenByEight(model, 8.0)) - exact).max()) > 1e-3
    monkeypatch.setattr(err60, "to_bits", lambda values, _bits, _scale: values)
    assert float(np.abs(err60.run(model, SixteenByEight(model, 8.0)) - exact).max()) < 1e-8


def test_words_round_to_nearest_and_saturate() -> None:
    values = np.array([0.3, -0.3, 0.2, 5.0, -5.0])
    assert err60.to_bits(values, 8, 0.5).tolist() == [0.5, -0.5, 0.0, 5.0, -5.0]
    assert err60.to_bits(np.array([100.0, -100.0]), 8, 0.5).tolist() == [63.5, -64.0]
