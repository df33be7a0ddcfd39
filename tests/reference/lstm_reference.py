# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""Independent reference of the plain and the nested LSTM, in double precision.

Written from the equations of S. Hochreiter and J. Schmidhuber, "Long Short-Term Memory" (1997), with the forget gate of
Gers, and of J. R. A. Moniz and D. Krueger, "Nested LSTMs" (2017), and from the layout in elmopp/weights.h. It shares no
code with the C and was written without a look at it, so that agreement between the two is evidence.

Words: a level is one LSTM cell with its four gates; level 0 is the outermost, and each level may have another inside. A
level sees an input x and a hidden input h, remembers a cell, and gives something back.

So that the tests can show that they would notice, a Mistake can be planted in it.
"""

from __future__ import annotations

import enum
import struct
import zlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

INPUTS = 4  # and outputs
UNITS = 16
LEVELS_MAX = 3
LAGS = 8

# Columns of a level's matrix and bias: 16 of each gate, in this order.
GATE_ORDER = "ifog"

MAGIC = b"ELMW"
VERSION = 2
WINDOW_NETWORKS_FLOATS = 1380 + 1585  # ann and gcn, which are not read here
HEADER = struct.Struct("<4sIII")  # magic, version, bytes of the body, CRC-32 of the body


class Mistake(enum.Enum):
    """What can be planted: fewest levels at which it changes anything, does a single step show it, and what it is."""

    SUM_AS_INNER_INPUT = (2, True, "inner x is i + g, not i * g")
    OUTPUT_AS_INNER_HIDDEN = (2, True, "inner h is what the inner level gave back last, not f * c")
    INNER_ROWS_SWAPPED = (2, True, "rows of an inner level are h then x")
    INNER_LEVELS_SWAPPED = (3, True, "the two inner levels have each other's weights")
    FORGET_BIAS_ON_CANDIDATE = (1, True, "biases of f and g are swapped")
    GATE_ORDER_SWAPPED = (1, True, "columns of o and g are swapped")
    NO_TANH_OF_OUTER_CELL = (1, True, "the outermost level gives back o * c")
    HARD_SIGMOID = (1, True, "gates are 0.2 z + 0.5, cut at 0 and 1")
    UNCLAMPED_FEEDBACK = (1, False, "a rollout is fed what the head says, though its rows are clamped")
    LATE_ROWS = (1, False, "row t of a rollout is the output after step t, not before")

    def __init__(self, levels_min: int, shows_in_step: bool, text: str) -> None:
        self.levels_min = levels_min
        self.shows_in_step = shows_in_step
        self.text = text


@dataclass(frozen=True)
class LevelWeights:
    """One level: rows are x, then h; columns as GATE_ORDER."""

    bias: Array  # [64]
    row: Array  # [20][64] of the outermost, [32][64] of an inner level


@dataclass(frozen=True)
class Weights:
    """A weights image but for the networks that see windows. Unused inner levels are not kept."""

    low: Array  # [4]
    high: Array  # [4]
    ar8: Array  # [11] intercept, eight lags, low, high
    head_bias: Array  # [4]
    head_row: Array  # [16][4]
    levels: tuple[LevelWeights, ...]  # [0] is the outermost


class _Body:
    """Reads little-endian words from front to back."""

    def __init__(self, body: bytes) -> None:
        self._body = body
        self._at = 0

    def floats(self, *shape: int) -> Array:
        count = int(np.prod(shape))
        values = np.frombuffer(self._body, dtype="<f4", count=count, offset=self._at)
        self._at += 4 * count
        return values.astype(np.float64).reshape(shape)

    def word(self) -> int:
        value = int.from_bytes(self._body[self._at : self._at + 4], "little")
        self._at += 4
        return value

    def level(self, rows: int) -> LevelWeights:
        return LevelWeights(bias=self.floats(4 * UNITS), row=self.floats(rows, 4 * UNITS))

    def end(self) -> None:
        if self._at != len(self._body):
            raise ValueError(f"{len(self._body)} bytes of body, {self._at} expected")


def read_image(image: bytes) -> Weights:
    """The weights in an ELMW image. ValueError if it is none."""
    if len(image) < HEADER.size:
        raise ValueError("shorter than its header")
    magic, version, length, checksum = HEADER.unpack_from(image)
    content = image[HEADER.size :]
    if magic != MAGIC or version != VERSION or length != len(content) or checksum != zlib.crc32(content):
        raise ValueError("not an ELMW image of this version, or damaged")
    body = _Body(content)
    low, high = body.floats(INPUTS), body.floats(INPUTS)
    ar8 = body.floats(1 + LAGS + 2)
    level_count = body.word()
    if not 1 <= level_count <= LEVELS_MAX:
        raise ValueError(f"{level_count} levels")
    head_bias, head_row = body.floats(INPUTS), body.floats(UNITS, INPUTS)
    levels = [body.level(INPUTS + UNITS)]
    levels += [body.level(2 * UNITS) for _ in range(LEVELS_MAX - 1)]
    body.floats(WINDOW_NETWORKS_FLOATS)
    body.end()
    return Weights(low, high, ar8, head_bias, head_row, tuple(levels[:level_count]))


def sigmoid(z: Array) -> Array:
    """1 / (1 + exp(-z)), without overflow."""
    return np.asarray(np.exp(-np.logaddexp(0.0, -z)))


def hard_sigmoid(z: Array) -> Array:
    return np.clip(0.2 * z + 0.5, 0.0, 1.0)


@dataclass(frozen=True)
class State:
    """What a network remembers. Of `given` only level 0 matters, the hidden state; a Mistake looks at the others."""

    cell: Array  # [level][16]
    given: Array  # [level][16] what each level gave back last

    @property
    def hidden(self) -> Array:
        """The outermost level's h of the next step. Without a copy."""
        return np.asarray(self.given[0])


class _Gate:
    """W, U and b of one gate: W x + U h + b."""

    def __init__(self, w: Array, u: Array, b: Array) -> None:
        self._w, self._u, self._b = w, u, b

    def __call__(self, x: Array, h: Array) -> Array:
        return np.asarray(self._w @ x + self._u @ h + self._b)


class Network:
    """An LSTM of one to three levels with a linear head."""

    def __init__(self, weights: Weights, mistake: Mistake | None = None) -> None:
        self._weights = weights
        self._mistake = mistake
        levels = weights.levels
        if mistake is Mistake.INNER_LEVELS_SWAPPED:
            levels = (levels[0], *reversed(levels[1:]))
        self._gates = [self._gates_of(depth, level) for depth, level in enumerate(levels)]

    def _gates_of(self, depth: int, level: LevelWeights) -> dict[str, _Gate]:
        row_order = "ifgo" if self._mistake is Mistake.GATE_ORDER_SWAPPED else GATE_ORDER
        bias_order = "igof" if self._mistake is Mistake.FORGET_BIAS_ON_CANDIDATE else row_order
        x_rows, h_rows = level.row[:-UNITS], level.row[-UNITS:]
        if self._mistake is Mistake.INNER_ROWS_SWAPPED and depth > 0:
            x_rows, h_rows = h_rows, x_rows
        gates = {}
        for gate in GATE_ORDER:
            column = UNITS * row_order.index(gate)
            bias = UNITS * bias_order.index(gate)
            w = x_rows[:, column : column + UNITS].T
            u = h_rows[:, column : column + UNITS].T
            gates[gate] = _Gate(w, u, level.bias[bias : bias + UNITS])
        return gates

    def start(self) -> State:
        """Nothing seen yet."""
        zero = np.zeros((len(self._gates), UNITS))
        return State(cell=zero, given=zero)

    def step(self, state: State, x: Array) -> State:
        """The state after one more input."""
        after = State(cell=np.empty_like(state.cell), given=np.empty_like(state.given))
        self._step_level(0, x, state.hidden, state, after)
        return after

    def _step_level(self, depth: int, x: Array, h: Array, before: State, after: State) -> Array:
        """What the level gives back; fills its part, and that of those inside, of `after`."""
        gates = self._gates[depth]
        s = hard_sigmoid if self._mistake is Mistake.HARD_SIGMOID else sigmoid
        i = s(gates["i"](x, h))
        f = s(gates["f"](x, h))
        o = s(gates["o"](x, h))
        g = np.tanh(gates["g"](x, h))
        kept = f * before.cell[depth]
        if depth + 1 == len(self._gates):
            cell = kept + i * g
        else:
            inner_x = i + g if self._mistake is Mistake.SUM_AS_INNER_INPUT else i * g
            inner_h = before.given[depth + 1] if self._mistake is Mistake.OUTPUT_AS_INNER_HIDDEN else kept
            cell = self._step_level(depth + 1, inner_x, inner_h, before, after)
        bare = self._mistake is Mistake.NO_TANH_OF_OUTER_CELL and depth == 0
        given = o * (cell if bare else np.tanh(cell))
        after.cell[depth] = cell
        after.given[depth] = given
        return np.asarray(given)

    def output(self, state: State) -> Array:
        """What it expects as the next input, not clamped."""
        return np.asarray(self._weights.head_bias + self._weights.head_row.T @ state.hidden)

    def absorb(self, state: State, inputs: Sequence[Array] | Array) -> tuple[State, Array]:
        """The state after all inputs, and the output after each, not clamped."""
        outputs = np.empty((len(inputs), INPUTS))
        for row, x in enumerate(inputs):
            state = self.step(state, np.asarray(x))
            outputs[row] = self.output(state)
        return state, outputs

    def roll_out(self, state: State, steps: int) -> Array:
        """Runs freely: each row is the clamped output of the state before the step, and that step's input."""
        rows = np.empty((steps, INPUTS))
        for t in range(steps):
            said = self.output(state)
            row = np.clip(said, self._weights.low, self._weights.high)
            state = self.step(state, said if self._mistake is Mistake.UNCLAMPED_FEEDBACK else row)
            if self._mistake is Mistake.LATE_ROWS:
                row = np.clip(self.output(state), self._weights.low, self._weights.high)
            rows[t] = row
        return rows
