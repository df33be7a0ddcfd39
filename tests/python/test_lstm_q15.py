# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""The LSTM in whole numbers against an independent one, to the bit: the weights made of float ones, and every step.

The reference (tests/reference/lstm_q15_reference.py) was written from the headers; what the C says comes out of
tests/lstm_q15_probe.c. What tools/weights refuses is held against what the C refuses.
"""

from __future__ import annotations

import os
import struct
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from elmopp_tools.weights_model import NETWORKS, WeightsError, check_tensors, network, read_tensors
from references import load_reference

q15 = load_reference("lstm_q15_reference")

ROOT = Path(__file__).resolve().parents[2]
PROBE = os.environ.get("ELMOPP_LSTM_Q15_PROBE", str(ROOT / "build" / "host" / "bin" / "tests" / "lstm_q15_probe"))
SHIPPED = ROOT / "weights" / "forecast.safetensors"
REFUSED = 2

Single = npt.NDArray[np.float32]
Level = tuple[Single, Single]  # weight [row][gate], bias


@dataclass(frozen=True)
class Model:
    """A float network and the range of its inputs."""

    levels: list[Level]  # outermost first
    head: Level
    low: Single
    high: Single

    def layout(self) -> bytes:
        """An elmopp_lstm_f32_weights_t."""
        parts = [struct.pack("<I", len(self.levels)), self.head[1].tobytes(), self.head[0].tobytes()]
        for weight, bias in self.levels:
            parts += [bias.tobytes(), weight.tobytes()]
        unused = 3 - len(self.levels)
        return b"".join(parts) + bytes(unused * 4 * (64 + 32 * 64))


@dataclass(frozen=True)
class Said:
    """What the probe wrote."""

    weights: bytes
    absorbed: Single
    free: Single
    cell: npt.NDArray[np.int32]
    hidden: npt.NDArray[np.int16]


def random_model(seed: int, levels: int, size: float, low: float = 0.0, high: float = 3.0) -> Model:
    random = np.random.default_rng(seed)

    def values(*shape: int) -> Single:
        return np.asarray(random.normal(0.0, size, shape), dtype=np.float32)

    inner = [(values(32, 64), values(64)) for _ in range(levels - 1)]
    ends = (np.full(4, low, dtype=np.float32), np.full(4, high, dtype=np.float32))
    head = (np.asarray(random.normal(0.0, 0.5, (16, 4)), dtype=np.float32), np.full(4, 1.0, dtype=np.float32))
    return Model([(values(20, 64), values(64)), *inner], head, *ends)


def shipped_model(name: str) -> Model:
    net = network(read_tensors(SHIPPED)[0], name)
    levels = [(level.weight, level.bias) for level in net.levels]
    return Model(levels, (net.head.weight, net.head.bias), np.zeros(4, dtype=np.float32), net.high)


def run_probe(folder: Path, model: Model, given: Single, free: int) -> subprocess.CompletedProcess[bytes]:
    file = folder / "model.bin"
    head = struct.pack("<II", len(given), free) + model.low.tobytes() + model.high.tobytes()
    file.write_bytes(head + model.layout() + given.tobytes())
    return subprocess.run([PROBE, str(file)], capture_output=True, check=False, timeout=60)


def said_by_core(folder: Path, model: Model, given: Single, free: int) -> Said:
    done = run_probe(folder, model, given, free)
    assert done.returncode == 0, done.stderr
    made = len(q15.layout(quantized(model)))
    rows = np.frombuffer(done.stdout[made : made + 16 * 2 * (len(given) + free)], dtype="<f4").reshape(-1, 4)
    state = done.stdout[made + rows.nbytes :]
    assert len(state) == 3 * 64 + 32
    cell = np.frombuffer(state[: 3 * 64], dtype="<i4").reshape(3, 16)[: len(model.levels)]
    hidden = np.frombuffer(state[3 * 64 :], dtype="<i2")
    return Said(done.stdout[:made], rows[: len(given)], rows[2 * len(given) :][:free], cell, hidden)


def quantized(model: Model) -> q15.Quantized:  # type: ignore[name-defined]
    return q15.quantize(model.levels, model.head, model.low, model.high)


def inputs(seed: int, count: int, low: float, high: float) -> Single:
    """Some beyond the range, where the network holds them."""
    width = high - low
    drawn = np.random.default_rng(seed).uniform(low - 0.1 * width, high + 0.1 * width, (count, 4))
    return np.asarray(drawn, dtype=np.float32)


def expect_same_bits(folder: Path, model: Model, given: Single, free: int) -> None:
    core = said_by_core(folder, model, given, free)
    made = quantized(model)
    assert core.weights == q15.layout(made)
    reference = q15.Network(made)
    absorbed = np.empty_like(core.absorbed)
    for t, row in enumerate(given):
        reference.step(row)
        absorbed[t] = reference.output()
    assert absorbed.tobytes() == core.absorbed.tobytes()
    said = reference.output() if len(given) else np.zeros(4, dtype=np.float32)
    for row in core.free:
        held = np.clip(said, model.low, model.high)
        assert held.tobytes() == row.tobytes()
        reference.step(held)
        said = reference.output()
    assert np.array_equal(reference.cell, core.cell)
    assert np.array_equal(reference.hidden, core.hidden)


SIZES = (0.0, 1e-6, 0.05, 0.4, 1.5, 2.5)


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("levels", [1, 2, 3])
def test_weights_and_steps_have_the_reference_s_bits(tmp_path: Path, levels: int, size: float) -> None:
    model = random_model(levels, levels, size)
    expect_same_bits(tmp_path, model, inputs(levels, 200, 0.0, 3.0), free=60)


@pytest.mark.parametrize(("low", "high"), [(-2.0, 5.0), (0.0, 1e-9), (0.0, 12.0)])
def test_any_range_of_inputs_has_the_reference_s_bits(tmp_path: Path, low: float, high: float) -> None:
    model = random_model(9, 1, 0.3, low, high)
    expect_same_bits(tmp_path, model, inputs(9, 100, low, high), free=60)


@pytest.mark.parametrize("name", sorted(NETWORKS))
def test_shipped_weights_have_the_reference_s_bits(tmp_path: Path, name: str) -> None:
    model = shipped_model(name)
    expect_same_bits(tmp_path, model, inputs(1, 200, 0.0, 3.0), free=60)


def test_no_row_of_any_model_can_leave_its_word() -> None:
    for size in SIZES:
        for level in quantized(random_model(3, 3, size)).levels:
            assert int(np.abs(level.weight).sum(axis=1).max()) <= 65535
            assert int(np.abs(level.weight).max()) <= 32767
            largest = (np.abs(level.weight).sum(axis=1) * 32768 * level.scale >> 32) + np.abs(level.bias)
            assert int(largest.max()) < 1 << 28
            assert int(level.scale.max()) < 1 << 31


def test_weights_are_as_fine_as_16_bits_allow() -> None:
    """A row uses its bits: the largest weight, or the sum, is near the largest that may be."""
    for level in quantized(random_model(3, 3, 0.4)).levels:
        largest = np.abs(level.weight).max(axis=1) / 32767
        sums = np.abs(level.weight).sum(axis=1) / 65500
        assert float(np.maximum(largest, sums).min()) > 0.999


# Just below and just beyond what a row may reach, at each level, by bias and by weights.
ROWS = [(level, column, part) for level in range(3) for column in (0, 17, 63) for part in ("bias", "weight")]


def near_the_limit(level: int, column: int, part: str, reach: float) -> Model:
    model = random_model(5, 3, 0.01)
    weight, bias = model.levels[level]
    weight[:, column] = 0.0
    bias[column] = reach if part == "bias" else 0.0
    if part == "weight":
        weight[-16:, column] = -reach / 16.0
    return model


@pytest.mark.parametrize(("level", "column", "part"), ROWS)
def test_a_row_that_could_overflow_is_refused_and_named(tmp_path: Path, level: int, column: int, part: str) -> None:
    given = inputs(1, 5, 0.0, 3.0)
    expect_same_bits(tmp_path, near_the_limit(level, column, part, 127.99), given, free=3)
    beyond = near_the_limit(level, column, part, 128.01)
    done = run_probe(tmp_path, beyond, given, free=3)
    assert done.returncode == REFUSED
    assert done.stderr.decode().split()[:2] == [str(level), str(column)]
    with pytest.raises(q15.RefusedError) as refused:
        quantized(beyond)
    assert (refused.value.level, refused.value.column) == (level, column)


def test_what_is_no_number_is_refused(tmp_path: Path) -> None:
    model = random_model(5, 2, 0.1)
    model.levels[1][0][3, 40] = np.nan
    done = run_probe(tmp_path, model, inputs(1, 5, 0.0, 3.0), free=3)
    assert done.returncode == REFUSED
    assert done.stderr.split()[:2] == [b"1", b"40"]


@pytest.mark.parametrize(("level", "column", "part"), ROWS)
def test_the_exporter_refuses_what_the_core_refuses(level: int, column: int, part: str) -> None:
    for reach, refused in ((127.99, False), (128.01, True)):
        tensors = {name: tensor.copy() for name, tensor in read_tensors(SHIPPED)[0].items()}
        name = "nlstm.outer" if level == 0 else f"nlstm.inner{level}"
        made = near_the_limit(level, column, part, reach).levels[level]
        tensors[f"{name}.weight"], tensors[f"{name}.bias"] = made
        if not refused:
            check_tensors(tensors)
            continue
        row = f"{name}: gate {'ifog'[column // 16]} of unit {column % 16}"
        with pytest.raises(WeightsError, match=rf"{row} could reach 128.0.* ; less than 128"):
            check_tensors(tensors)
