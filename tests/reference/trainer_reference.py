# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""Independent reference of the trainer, in double precision: errors and slopes of a sample, and Adam.

Written from the equations of the nested LSTM, of back-propagation through time and of Kingma and Ba's Adam, and from
what elmopp/trainer.h promises. The error of a sample can be asked for with one parameter moved, for all parameters at
once: thus its slopes by central differences, which know nothing of the way back.

Parameters are in one vector, in the order of the weights' image: the head's bias [4] and rows [16][4], then for each
level its bias [64] and rows [20 or 32][64], columns by gates i, f, o, g.

So that the tests can show that they would notice, a Mistake can be planted in the way back.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

INPUTS = 4
UNITS = 16
GATES = 4 * UNITS

MEAN_DECAY = 0.9
SQUARE_DECAY = 0.999
NORM_MAX = 1.0
COPIES = 256  # at a time: so many stay in a processor's cache
FLOOR = 1e-16  # under the root, where the paper has 1e-8 beside it


class Mistake(enum.Enum):
    """What can be planted in the way back."""

    NO_SLOPE_THROUGH_FEED = "what is fed back counts as given"
    NO_SLOPE_THROUGH_CELL = "the forget gate's path to the cell before is cut"
    CELL_AFTER_IN_FORGET = "the forget gate's slope takes the cell after the step"
    NO_BEND_OF_CELL = "tanh(c) is passed as if it were c"
    UNSCORED_COUNTS = "the first steps' errors count, too"


@dataclass(frozen=True)
class Sample:
    """As elmopp_trainer_sample_t."""

    hidden: Array  # [16]
    cell: Array  # [level][16]
    seen: Array  # [steps + 1][4]
    fed: int
    unscored: int
    inputs: int
    low: Array
    high: Array

    @property
    def steps(self) -> int:
        return len(self.seen) - 1


@dataclass(frozen=True)
class Parts:
    """The vector of parameters, cut."""

    head_bias: Array
    head_row: Array
    bias: list[Array]
    row: list[Array]


def parts_of(vector: Array, levels: int) -> Parts:
    at = 0

    def take(*shape: int) -> Array:
        nonlocal at
        count = int(np.prod(shape))
        values = vector[at : at + count].reshape(shape)
        at += count
        return values

    head_bias, head_row = take(INPUTS), take(UNITS, INPUTS)
    bias, row = [], []
    for level in range(levels):
        bias.append(take(GATES))
        row.append(take(INPUTS + UNITS if level == 0 else 2 * UNITS, GATES))
    if at != len(vector):
        raise ValueError(f"{len(vector)} parameters, {at} expected")
    return Parts(head_bias, head_row, bias, row)


def sigmoid(z: Array) -> Array:
    return np.asarray(1.0 / (1.0 + np.exp(-z)))


class _Moved:
    """One parameter moved by `by` in each of many copies of the network; nothing moved in a single one."""

    def __init__(self, which: npt.NDArray[np.int64] | None, by: float, levels: int) -> None:
        self.count = 1 if which is None else len(which)
        self._by = by
        self._blocks: dict[str, tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]] = {}
        if which is None:
            return
        start = 0
        blocks = [("head_bias", INPUTS), ("head_row", UNITS * INPUTS)]
        for level in range(levels):
            rows = INPUTS + UNITS if level == 0 else 2 * UNITS
            blocks += [(f"bias{level}", GATES), (f"row{level}", rows * GATES)]
        for name, size in blocks:
            copies = np.flatnonzero((which >= start) & (which < start + size))
            self._blocks[name] = (copies, which[copies] - start)
            start += size

    def add(self, bias: str, row: str, fed: Array, sums: Array) -> None:
        """To sums [copy][column], what the moved bias or weight makes of what is fed [copy][row]."""
        columns = sums.shape[1]
        if bias in self._blocks:
            copies, at = self._blocks[bias]
            sums[copies, at] += self._by
            copies, at = self._blocks[row]
            sums[copies, at % columns] += self._by * fed[copies, at // columns]


def errors(vector: Array, levels: int, sample: Sample, which: npt.NDArray[np.int64] | None, by: float) -> Array:
    """The error of the sample for each copy of the network, in copy k the parameter which[k] moved."""
    parts = parts_of(vector, levels)
    moved = _Moved(which, by, levels)
    hidden = np.tile(sample.hidden, (moved.count, 1))
    cell = np.repeat(sample.cell[:levels, None, :], moved.count, axis=1)
    said = np.zeros((moved.count, INPUTS))
    total = np.zeros(moved.count)
    for t in range(sample.steps):
        given = np.tile(sample.seen[t], (moved.count, 1))
        x = given if t < sample.fed else said
        hidden, cell = _step(parts, moved, x, hidden, cell)
        said = hidden @ parts.head_row + parts.head_bias
        moved.add("head_bias", "head_row", hidden, said)
        said = np.clip(said, sample.low, sample.high)
        said[:, sample.inputs :] = 0.0
        if t >= sample.unscored:
            total += np.sum((said - sample.seen[t + 1])[:, : sample.inputs] ** 2, axis=1)
    return np.asarray(total / ((sample.steps - sample.unscored) * sample.inputs))


def _step(parts: Parts, moved: _Moved, x: Array, h: Array, cells: Array) -> tuple[Array, Array]:
    """Hidden state and cells [level] after a step."""
    after = np.empty_like(cells)
    opened = []
    for level in range(len(parts.row)):
        fed = np.concatenate([x, h], axis=1)
        sums = fed @ parts.row[level] + parts.bias[level]
        moved.add(f"bias{level}", f"row{level}", fed, sums)
        i, f, o = (sigmoid(sums[:, k * UNITS : (k + 1) * UNITS]) for k in range(3))
        g = np.tanh(sums[:, 3 * UNITS :])
        opened.append(o)
        x, h = i * g, f * cells[level]
    back = x + h
    for level in reversed(range(len(parts.row))):
        after[level] = back
        back = opened[level] * np.tanh(back)
    return back, after


def slopes_by_differences(vector: Array, levels: int, sample: Sample, by: float = 1e-5) -> Array:
    """Central differences of every parameter."""
    slopes = []
    for start in range(0, len(vector), COPIES):
        which = np.arange(start, min(start + COPIES, len(vector)))
        above, below = (errors(vector, levels, sample, which, way) for way in (by, -by))
        slopes.append((above - below) / (2.0 * by))
    return np.concatenate(slopes)


@dataclass
class _Level:
    """One level in one step."""

    fed: Array
    i: Array
    f: Array
    o: Array
    g: Array
    before: Array
    after: Array


def error_and_slopes(vector: Array, levels: int, sample: Sample, mistake: Mistake | None = None) -> tuple[float, Array]:
    """The error of the sample, and its slopes by the way back."""
    parts = parts_of(vector, levels)
    tape, said = _record(parts, sample)
    slope = np.zeros_like(vector)
    out = parts_of(slope, levels)
    unscored = 0 if mistake is Mistake.UNSCORED_COUNTS else sample.unscored
    scale = 1.0 / ((sample.steps - sample.unscored) * sample.inputs)
    total = 0.0
    d_hidden, d_said = np.zeros(UNITS), np.zeros(INPUTS)
    d_cell = np.zeros((levels, UNITS))
    for t in reversed(range(sample.steps)):
        error = np.zeros(INPUTS)
        if t >= unscored:
            error[: sample.inputs] = (said[t] - sample.seen[t + 1])[: sample.inputs]
        total += float(error @ error)
        d_said = d_said + 2.0 * scale * error
        d_said[sample.inputs :] = 0.0
        hidden = tape[t][0].o * np.tanh(tape[t][0].after)
        out.head_bias[:] += d_said
        out.head_row[:] += np.outer(hidden, d_said)
        d_fed = _back(parts, out, tape[t], parts.head_row @ d_said + d_hidden, d_cell, mistake)
        d_hidden = d_fed[INPUTS:]
        cut = mistake is Mistake.NO_SLOPE_THROUGH_FEED
        d_said = d_fed[:INPUTS] if t >= sample.fed and not cut else np.zeros(INPUTS)
    return total * scale, slope


def _record(parts: Parts, sample: Sample) -> tuple[list[list[_Level]], Array]:
    hidden, cells = sample.hidden, [row.copy() for row in sample.cell]
    said = np.zeros((sample.steps, INPUTS))
    tape = []
    for t in range(sample.steps):
        x, h = (sample.seen[t] if t < sample.fed else said[t - 1]), hidden
        step = []
        for level in range(len(parts.row)):
            fed = np.concatenate([x, h])
            z = parts.row[level].T @ fed + parts.bias[level]
            i, f, o = sigmoid(z[:16]), sigmoid(z[16:32]), sigmoid(z[32:48])
            g = np.tanh(z[48:])
            step.append(_Level(fed, i, f, o, g, cells[level], np.empty(UNITS)))
            x, h = i * g, f * cells[level]
        back = x + h
        for level in reversed(range(len(parts.row))):
            step[level].after = cells[level] = back
            back = step[level].o * np.tanh(back)
        hidden = back
        tape.append(step)
        said[t] = np.clip(parts.head_row.T @ hidden + parts.head_bias, sample.low, sample.high)
        said[t, sample.inputs :] = 0.0
    return tape, said


def _back(
    parts: Parts, out: Parts, step: list[_Level], d_back: Array, d_cell: Array, mistake: Mistake | None, depth: int = 0
) -> Array:
    """Through one level and those inside it; returns the slope of what the level was fed."""
    level = step[depth]
    bent = np.tanh(level.after)
    d_o = d_back * bent
    d_after = d_cell[depth] + d_back * level.o * (1.0 if mistake is Mistake.NO_BEND_OF_CELL else 1.0 - bent**2)
    if depth + 1 == len(step):
        d_x = d_h = d_after
    else:
        d_fed = _back(parts, out, step, d_after, d_cell, mistake, depth + 1)
        d_x, d_h = d_fed[:UNITS], d_fed[UNITS:]
    cell = level.after if mistake is Mistake.CELL_AFTER_IN_FORGET else level.before
    d_cell[depth] = 0.0 if mistake is Mistake.NO_SLOPE_THROUGH_CELL else d_h * level.f
    d_z = np.concatenate(
        [
            d_x * level.g * level.i * (1 - level.i),
            d_h * cell * level.f * (1 - level.f),
            d_o * level.o * (1 - level.o),
            d_x * level.i * (1 - level.g**2),
        ]
    )
    out.bias[depth][:] += d_z
    out.row[depth][:] += np.outer(level.fed, d_z)
    return np.asarray(parts.row[depth] @ d_z)


def adam(vector: Array, levels: int, sample: Sample, rate: float, updates: int) -> Array:
    """The parameters after so many updates by the same sample."""
    vector = vector.copy()
    mean, square = np.zeros_like(vector), np.zeros_like(vector)
    for n in range(1, updates + 1):
        slope = error_and_slopes(vector, levels, sample)[1]
        slope *= min(1.0, NORM_MAX / float(np.sqrt(slope @ slope)))
        mean = MEAN_DECAY * mean + (1 - MEAN_DECAY) * slope
        square = SQUARE_DECAY * square + (1 - SQUARE_DECAY) * slope**2
        late = np.sqrt(1 - SQUARE_DECAY**n) / (1 - MEAN_DECAY**n)
        vector -= rate * late * mean / np.sqrt(square + FLOOR)
    return vector
