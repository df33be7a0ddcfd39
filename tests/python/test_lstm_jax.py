# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""The core against the training framework, on the shipped weights: what was trained is what runs.

tests/golden/lstm_jax.json comes from tests/golden/make_lstm_jax.py (JAX, single precision). Both round differently: the
bounds are some three times the largest difference seen.
"""

from __future__ import annotations

import json
import math
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
from elmopp_tools.weights_image import image_bytes
from elmopp_tools.weights_model import NETWORKS, network, read_tensors

ROOT = Path(__file__).resolve().parents[2]
PROBE = os.environ.get("ELMOPP_LSTM_PROBE", str(ROOT / "build" / "host" / "bin" / "tests" / "lstm_probe"))
GOLDEN = ROOT / "tests" / "golden" / "lstm_jax.json"

STEP_BOUND = 5e-6
FREE_BOUND = 2e-5


def inputs(count: int) -> np.typing.NDArray[np.float32]:
    rows = [[1.0 + 0.9 * math.sin(0.05 * (k + 1) * second + k) for k in range(4)] for second in range(count)]
    return np.array(rows, dtype="<f4")


def said_by_the_core(folder: Path, name: str, count: int, free: int) -> np.typing.NDArray[np.float32]:
    tensors, _ = read_tensors(ROOT / "weights" / "forecast.safetensors")
    (folder / "image").write_bytes(image_bytes(network(tensors, name)))
    (folder / "inputs").write_bytes(inputs(count).tobytes())
    command = [PROBE, str(folder / "image"), str(folder / "inputs"), str(free)]
    done = subprocess.run(command, check=True, capture_output=True)
    return np.frombuffer(done.stdout, dtype="<f4").reshape(-1, 4)


@pytest.mark.parametrize("name", NETWORKS)
def test_the_core_says_what_the_training_framework_says(tmp_path: Path, name: str) -> None:
    golden = json.loads(GOLDEN.read_text(encoding="ascii"))[name]
    said, free = np.array(golden["said"]), np.array(golden["free"])
    core = said_by_the_core(tmp_path, name, len(said), len(free))
    step_error = float(np.max(np.abs(core[: len(said)] - said)))
    free_error = float(np.max(np.abs(core[len(said) :] - free)))
    assert step_error <= STEP_BOUND, f"one step: {step_error:.3g}"
    assert free_error <= FREE_BOUND, f"free run: {free_error:.3g}"
    # A run that says nothing would agree with anything.
    assert float(np.std(free)) > 0.1
