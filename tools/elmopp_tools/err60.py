# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The error of a free run over 60 steps, on fixed models: the firmware's two arithmetics and a simulation of 16x8.

A model absorbs its traffic and then runs on its own output, held in its range (tests/golden/q15_models.safetensors).
The error of a run is the largest difference of any output from the same run in double precision; that of an arithmetic
the median over the models. What the firmware says comes from tests/lstm_q15_probe.c.

16x8 is simulated as integer kernels for microcontrollers have it: weights of 8 bits with one scale for each gate's
input and recurrent matrix, inputs and hidden values of 16 bits, sums before an activation in Q12 and held to 16 bits,
gates in Q15, a cell of 16 bits whose scale is the power of two that its double-precision run needs. The head is a float
one.
"""

import struct
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
from safetensors.numpy import load_file

MODELS = Path(__file__).resolve().parents[2] / "tests" / "golden" / "q15_models.safetensors"
FREE_STEPS = 60
INPUTS, UNITS, GATES = 4, 16, 64
ROW_BYTES = 4 * INPUTS

Array = npt.NDArray[np.float64]
Single = npt.NDArray[np.float32]
Step = Callable[[Array], Array]  # an input; the output after it


@dataclass(frozen=True)
class Model:
    """One level: weight [x, then h][gate]; head [unit][output]; and what it absorbs [second][input]."""

    name: str
    weight: Single
    bias: Single
    head: Single
    head_bias: Single
    low: Single
    high: Single
    absorbed: Single

    def record(self) -> bytes:
        """What tests/lstm_q15_probe.c reads."""
        parts = [struct.pack("<II", len(self.absorbed), FREE_STEPS), self.low.tobytes(), self.high.tobytes()]
        parts += [struct.pack("<I", 1), self.head_bias.tobytes(), self.head.tobytes()]
        parts += [self.bias.tobytes(), self.weight.tobytes(), bytes(2 * 4 * GATES * (1 + 2 * UNITS))]
        return b"".join([*parts, self.absorbed.tobytes()])


def read_models(path: Path = MODELS) -> list[Model]:
    tensors = load_file(path)
    names = sorted({name.split(".")[0] for name in tensors})
    parts = ("outer.weight", "outer.bias", "head.weight", "head.bias", "low", "high", "absorbed")
    return [Model(name, *(tensors[f"{name}.{part}"] for part in parts)) for name in names]


def run(model: Model, step: Step) -> Array:
    """The free run [step][output]: what is said, held, and fed back."""
    said = np.zeros(INPUTS)
    for row in model.absorbed:
        said = step(row.astype(np.float64))
    rows = np.empty((FREE_STEPS, INPUTS))
    for t in range(FREE_STEPS):
        rows[t] = np.clip(said, model.low, model.high)
        said = step(rows[t])
    return rows


class Exact:
    """The network in double precision; `largest_cell` is that of all steps so far."""

    def __init__(self, model: Model) -> None:
        self._weight, self._bias = model.weight.astype(np.float64), model.bias.astype(np.float64)
        self._head, self._head_bias = model.head.astype(np.float64), model.head_bias.astype(np.float64)
        self._hidden, self._cell = np.zeros(UNITS), np.zeros(UNITS)
        self.largest_cell = 0.0

    def __call__(self, given: Array) -> Array:
        sums = np.concatenate([given, self._hidden]) @ self._weight + self._bias
        i, f, o = np.split(0.5 + 0.5 * np.tanh(0.5 * sums[: 3 * UNITS]), 3)
        self._cell = f * self._cell + i * np.tanh(sums[3 * UNITS :])
        self._hidden = o * np.tanh(self._cell)
        self.largest_cell = max(self.largest_cell, float(np.abs(self._cell).max()))
        return np.asarray(self._hidden @ self._head + self._head_bias)


def to_bits(values: Array, bits: int, scale: float) -> Array:
    """Rounded to whole steps of `scale`, held to a signed word of so many bits."""
    most = float(2 ** (bits - 1))
    return np.asarray(np.clip(np.round(values / scale), -most, most - 1.0) * scale)


class SixteenByEight:
    """The simulation of 16x8."""

    def __init__(self, model: Model, largest_cell: float) -> None:
        weight = model.weight.astype(np.float64)
        self._weight = np.concatenate([self._of_8_bits(weight[:INPUTS]), self._of_8_bits(weight[INPUTS:])])
        self._bias = model.bias.astype(np.float64)
        self._head, self._head_bias = model.head.astype(np.float64), model.head_bias.astype(np.float64)
        self._input_scale = float(np.abs([model.low, model.high]).max()) / 32767.0
        self._cell_scale = 2.0 ** (np.ceil(np.log2(largest_cell)) - 15.0)
        self._hidden, self._cell = np.zeros(UNITS), np.zeros(UNITS)

    @staticmethod
    def _of_8_bits(weight: Array) -> Array:
        gates = np.split(weight, 4, axis=1)
        return np.concatenate([to_bits(gate, 8, float(np.abs(gate).max()) / 127.0) for gate in gates], axis=1)

    def __call__(self, given: Array) -> Array:
        fed = np.concatenate([to_bits(given, 16, self._input_scale), self._hidden])
        sums = to_bits(fed @ self._weight + self._bias, 16, 2.0**-12)
        opened = to_bits(0.5 + 0.5 * np.tanh(0.5 * sums[: 3 * UNITS]), 16, 2.0**-15)
        i, f, o = np.split(opened, 3)
        g = to_bits(np.tanh(sums[3 * UNITS :]), 16, 2.0**-15)
        self._cell = to_bits(f * self._cell + i * g, 16, self._cell_scale)
        self._hidden = to_bits(o * to_bits(np.tanh(self._cell), 16, 2.0**-15), 16, 2.0**-15)
        return np.asarray(self._hidden @ self._head + self._head_bias)


def free_runs(model: Model, written: bytes) -> tuple[Array, Array]:
    """Those in whole numbers and in float, of what the probe wrote for a model."""
    rows_bytes = 2 * ROW_BYTES * (len(model.absorbed) + FREE_STEPS)
    end = len(written) - (3 * UNITS * 4 + UNITS * 2)  # the state in whole numbers
    rows = np.frombuffer(written[end - rows_bytes : end], dtype="<f4").astype(np.float64).reshape(-1, INPUTS)
    free = rows[2 * len(model.absorbed) :]
    return free[:FREE_STEPS], free[FREE_STEPS:]


def errors(model: Model, written: bytes) -> dict[str, float]:
    """Of one model."""
    exact = Exact(model)
    right = run(model, exact)
    whole, single = free_runs(model, written)
    simulated = run(model, SixteenByEight(model, exact.largest_cell))
    runs = {"ours_f32": single, "ours_q15": whole, "ref_16x8": simulated}
    return {name: float(np.abs(rows - right).max()) for name, rows in runs.items()}


def medians(each: list[dict[str, float]]) -> dict[str, float]:
    return {name: float(np.median([one[name] for one in each])) for name in each[0]}
