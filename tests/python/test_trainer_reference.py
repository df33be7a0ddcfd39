# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""The core's trainer in single precision against the independent one in double, and that against central differences.

Slopes are compared tensor by tensor: the largest difference over the tensor's largest slope.
"""

from __future__ import annotations

import os
import struct
import subprocess
import zlib
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from references import load_reference

REFERENCE = load_reference("trainer_reference")
Array = npt.NDArray[np.float64]

SEEDS = (1, 2, 3)
LEVELS = (1, 2, 3)
STEPS = 30
BODY_BYTES = 34484
WINDOW_NETWORKS_FLOATS = 1380 + 1585

DIFFERENCES_BOUND = 1e-6  # reference against central differences
SLOPE_BOUND = 2e-6  # float32 against float64
ERROR_BOUND = 1e-6
WEIGHT_BOUND = 5e-4  # of the longest way that a weight went in ten updates


@dataclass(frozen=True)
class Case:
    """A network and a sample."""

    vector: Array
    levels: int
    sample: Any


def single(values: Array) -> Array:
    """As float32 has them: what both sides begin with."""
    return np.asarray(values.astype(np.float32).astype(np.float64))


def case(seed: int, levels: int, fed: int = 10, unscored: int = 4, inputs: int = 4, steps: int = STEPS) -> Case:
    random = np.random.default_rng([seed, levels])
    size = 4 + 64 + 64 + 20 * 64 + (levels - 1) * (64 + 32 * 64)
    vector = single(random.normal(0.0, 0.35, size))
    t = np.arange(steps + 1)[:, None]
    waves = 1.0 + 0.7 * np.sin(2 * np.pi * t / random.uniform(15, 60, 4) + random.uniform(0, 6, 4))
    seen = single(np.maximum(waves + random.normal(0, 0.05, waves.shape), 0.0))
    seen[:, inputs:] = 0.0
    cell = np.zeros((3, 16))
    cell[:levels] = random.normal(0.0, 0.6, (levels, 16))
    sample = REFERENCE.Sample(
        hidden=single(random.uniform(-0.6, 0.6, 16)),
        cell=single(cell),
        seen=seen,
        fed=fed,
        unscored=unscored,
        inputs=inputs,
        low=np.zeros(4) - 0.0,
        high=np.full(4, 900.0),
    )
    # Nothing at the clamp, where the two derivatives differ: the head says about 1.
    vector[:4] = single(np.array([3.0, 3.1, 2.9, 3.2]))
    vector[4:68] *= 0.25
    return Case(single(vector), levels, sample)


def image_of(case: Case) -> bytes:
    vector = case.vector.astype("<f4").tobytes()
    ar8 = struct.pack("<11f", *([0.0] * 10), 1.0)
    body: bytes = case.sample.low.astype("<f4").tobytes() + case.sample.high.astype("<f4").tobytes() + ar8
    body += struct.pack("<I", case.levels) + vector
    body += bytes(BODY_BYTES - 4 * WINDOW_NETWORKS_FLOATS - len(body)) + bytes(4 * WINDOW_NETWORKS_FLOATS)
    assert len(body) == BODY_BYTES
    return struct.pack("<4sIII", b"ELMW", 2, len(body), zlib.crc32(body)) + body


@dataclass(frozen=True)
class Answer:
    error: float
    slopes: Array
    weights: Array


def ask_probe(folder: Path, case: Case, rate: float = 1e-3, updates: int = 0) -> Answer:
    sample = case.sample
    raw = np.concatenate([sample.hidden, sample.cell.ravel(), sample.seen.ravel()]).astype("<f4")
    (folder / "image").write_bytes(image_of(case))
    (folder / "sample").write_bytes(raw.tobytes())
    numbers = [sample.steps, sample.fed, sample.unscored, sample.inputs, rate, updates]
    command = [os.environ["ELMOPP_TRAINER_PROBE"], str(folder / "image"), str(folder / "sample"), *map(str, numbers)]
    done = subprocess.run(command, capture_output=True, check=False, timeout=60)
    assert done.returncode == 0, done.stderr.decode()
    values = np.frombuffer(done.stdout, dtype="<f4").astype(np.float64)
    size = len(case.vector)
    assert len(values) == 1 + 2 * size
    return Answer(float(values[0]), values[1 : 1 + size], values[1 + size :])


def tensors(vector: Array, levels: int) -> list[Array]:
    parts = REFERENCE.parts_of(vector, levels)
    return [parts.head_bias, parts.head_row, *parts.bias, *parts.row]


def worst(ours: Array, right: Array, levels: int) -> float:
    pairs = zip(tensors(ours, levels), tensors(right, levels), strict=True)
    return max(float(np.max(np.abs(a - b)) / np.max(np.abs(b))) for a, b in pairs)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("levels", LEVELS)
def test_the_reference_agrees_with_central_differences_in_every_parameter(levels: int, seed: int) -> None:
    made = case(seed, levels)
    slopes = REFERENCE.error_and_slopes(made.vector, levels, made.sample)[1]
    by_differences = REFERENCE.slopes_by_differences(made.vector, levels, made.sample)
    assert worst(slopes, by_differences, levels) < DIFFERENCES_BOUND


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("levels", LEVELS)
@pytest.mark.parametrize(
    ("fed", "unscored", "inputs", "steps"),
    [(10, 4, 4, 30), (30, 0, 4, 30), (1, 0, 3, 30), (30, 29, 4, 30), (1, 0, 1, 1)],
)
def test_every_slope_is_the_references(
    tmp_path: Path, levels: int, seed: int, fed: int, unscored: int, inputs: int, steps: int
) -> None:
    made = case(seed, levels, fed, unscored, inputs, steps)
    error, slopes = REFERENCE.error_and_slopes(made.vector, levels, made.sample)
    answer = ask_probe(tmp_path, made)
    assert answer.error == pytest.approx(error, rel=ERROR_BOUND)
    assert worst_of_used(answer.slopes, slopes, levels) < SLOPE_BOUND


def worst_of_used(ours: Array, right: Array, levels: int) -> float:
    """Over tensors that have a slope at all: with one step from a given state nothing flows back."""
    pairs = zip(tensors(ours, levels), tensors(right, levels), strict=True)
    return max(float(np.max(np.abs(a - b)) / max(np.max(np.abs(b)), 1e-30)) for a, b in pairs)


@pytest.mark.parametrize("levels", LEVELS)
def test_ten_updates_go_where_the_references_go(tmp_path: Path, levels: int) -> None:
    made = case(1, levels)
    right = REFERENCE.adam(made.vector, levels, made.sample, 1e-3, 10)
    answer = ask_probe(tmp_path, made, 1e-3, 10)
    way = np.max(np.abs(right - made.vector))
    assert 5e-3 < way < 2e-2
    assert np.max(np.abs(answer.weights - right)) < WEIGHT_BOUND * way


def test_a_held_answer_passes_the_slope_and_counts_as_held(tmp_path: Path) -> None:
    """The clamp's other side: errors of what is held, slopes as if nothing were held."""
    made = case(1, 1)
    held = replace(made, sample=replace(made.sample, high=np.full(4, 1.5)))
    error, slopes = REFERENCE.error_and_slopes(held.vector, 1, held.sample)
    answer = ask_probe(tmp_path, held)
    assert error != pytest.approx(REFERENCE.error_and_slopes(made.vector, 1, made.sample)[0], rel=1e-3)
    assert answer.error == pytest.approx(error, rel=ERROR_BOUND)
    assert worst(answer.slopes, slopes, 1) < SLOPE_BOUND


@pytest.mark.parametrize("mistake", REFERENCE.Mistake)
@pytest.mark.parametrize("levels", LEVELS)
def test_a_planted_mistake_is_caught(tmp_path: Path, mistake: Any, levels: int) -> None:
    made = case(1, levels)
    slopes = REFERENCE.error_and_slopes(made.vector, levels, made.sample, mistake)[1]
    assert worst(ask_probe(tmp_path, made).slopes, slopes, levels) > 100 * SLOPE_BOUND
