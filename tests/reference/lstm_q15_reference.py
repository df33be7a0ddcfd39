# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""Independent reference of the LSTM in whole numbers: its weights, its tables' reading and its steps, to the bit.

Written from what elmopp/lstm_q15_kernel.h, lstm_q15_table.h, lstm_q15.h and lstm_quantize.h say, with NumPy's 64-bit
whole numbers and single-precision floats. It shares no code with the C; of the tables it takes the numbers.
"""

from __future__ import annotations

import re
import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

Whole = npt.NDArray[np.int64]
Single = npt.NDArray[np.float32]

INPUTS, UNITS, GATES, BAND, RUN, LEVELS_MAX = 4, 16, 64, 4, 8, 3
FIRST_TANH = 3 * UNITS
ZERO_ENTRY = 512
REACH_MAX = np.float32(128.0)
TABLE_FILE = Path(__file__).resolve().parents[2] / "firmware" / "src" / "lstm_q15_table.c"


def read_table(name: str) -> Whole:
    """The entries of one of the two tables."""
    text = TABLE_FILE.read_text(encoding="ascii")
    found = re.search(rf"elmopp_lstm_q15_{name}\[[A-Z0-9_]+\] = \{{(.*?)\}};", text, re.DOTALL)
    if found is None:
        raise ValueError(f"{TABLE_FILE} has no table {name}")
    return np.array([int(word) for word in found[1].split(",")], dtype=np.int64)


SIGMOID, TANH = read_table("sigmoid"), read_table("tanh")


def lower_half(words: Whole) -> Whole:
    """With its sign."""
    return ((words & 0xFFFF) ^ 0x8000) - 0x8000


def activate(table: Whole, reach: Whole) -> Whole:
    entry = table[ZERO_ENTRY + np.clip(reach >> 15, -512, 511)]
    return np.asarray(entry + lower_half(entry) * lower_half(reach))


def high(a: Whole, b: Whole) -> Whole:
    return (a * b + (1 << 31)) >> 32


class RefusedError(Exception):
    """A row could overflow: its level and gate."""

    def __init__(self, level: int, column: int, reach: float) -> None:
        super().__init__(f"level {level}, gate {column} could reach {reach}")
        self.level, self.column, self.reach = level, column, reach


@dataclass(frozen=True)
class Level:
    """Weights [gate][fed], as they are fed, scales and biases."""

    weight: Whole
    scale: Whole
    bias: Whole


@dataclass(frozen=True)
class Quantized:
    head_bias: Single
    head_row: Single  # [unit][output]
    middle: Single
    gain: Single
    levels: tuple[Level, ...]


def _nearest(value: Single) -> Whole:
    half = np.where(value < 0, np.float32(-0.5), np.float32(0.5)).astype(np.float32)
    return np.trunc((value + half).astype(np.float32)).astype(np.int64)


def _in_order(values: Single) -> Single:
    """Single-precision sums along the last axis, each rounded, from left to right."""
    total = np.zeros(values.shape[:-1], dtype=np.float32)
    for k in range(values.shape[-1]):
        total = (total + values[..., k]).astype(np.float32)
    return total


def _level(number: int, weight: Single, bias: Single) -> Level:
    """`weight`: [gate][fed]."""
    sums = _in_order(np.abs(weight))
    reach = (np.abs(bias) + sums).astype(np.float32)
    for column in range(GATES):
        if not reach[column] < REACH_MAX:
            raise RefusedError(number, column, float(reach[column]))
    largest = (np.abs(weight).max(axis=1) / np.float32(32767.0)).astype(np.float32)
    step = np.maximum(np.maximum(largest, (sums / np.float32(65500.0)).astype(np.float32)), np.float32(2.0**-22))
    factor = (np.float32(1.0) / step).astype(np.float32)
    part = np.where(np.arange(GATES) < FIRST_TANH, np.float32(0.5), np.float32(1.0)).astype(np.float32)
    scale = _nearest(((part * np.float32(2.0**38)).astype(np.float32) * step).astype(np.float32))
    return Level(
        weight=_nearest((weight * factor[:, None]).astype(np.float32)),
        scale=scale,
        bias=_nearest((bias * (part * np.float32(2.0**21))).astype(np.float32)),
    )


def quantize(
    levels: list[tuple[Single, Single]], head: tuple[Single, Single], low: Single, high_end: Single
) -> Quantized:
    """Of (weight [row][gate], bias) a level, outermost first, rows x then h; head (weight [unit][output], bias)."""
    width = np.maximum(np.float32(1e-6), (high_end - low).astype(np.float32))
    middle = (low + np.float32(0.5) * width).astype(np.float32)
    ratio = np.float32(np.float32(32768.0) / np.float32(32767.0))
    half = ((np.float32(0.5) * width).astype(np.float32) * ratio).astype(np.float32)
    rows, bias = levels[0]
    shifted = bias.copy()
    for k in range(INPUTS):
        shifted = (shifted + (rows[k] * middle[k]).astype(np.float32)).astype(np.float32)
    outer = np.concatenate([rows[INPUTS:], (rows[:INPUTS] * half[:, None]).astype(np.float32)]).T
    made = [_level(0, outer, shifted)]
    made += [_level(number, inner.T, inner_bias) for number, (inner, inner_bias) in enumerate(levels[1:], 1)]
    return Quantized(
        head_bias=head[1],
        head_row=(head[0] / np.float32(32768.0)).astype(np.float32),
        middle=middle,
        gain=(np.float32(32768.0) / half).astype(np.float32),
        levels=tuple(made),
    )


def _bands(level: Level, runs: list[int]) -> bytes:
    """A level as the firmware lays it out: bands of four rows, `runs` values of each row at a time."""
    parts = []
    for first in range(0, GATES, BAND):
        at = 0
        for run in runs:
            parts.append(level.weight[first : first + BAND, at : at + run].astype("<i2").tobytes())
            at += run
        parts += [values[first : first + BAND].astype("<i4").tobytes() for values in (level.scale, level.bias)]
    return b"".join(parts)


def layout(quantized: Quantized) -> bytes:
    """The bytes of elmopp_lstm_q15_weights_t."""
    floats = (quantized.head_bias, quantized.head_row, quantized.middle, quantized.gain)
    parts = [struct.pack("<I", len(quantized.levels)), *(values.astype("<f4").tobytes() for values in floats)]
    parts.append(_bands(quantized.levels[0], [RUN, RUN, INPUTS]))
    parts += [_bands(level, [RUN] * 4) for level in quantized.levels[1:]]
    unused = LEVELS_MAX - len(quantized.levels)
    inner_bytes = (GATES // BAND) * (2 * BAND * 2 * UNITS + 8 * BAND)
    return b"".join(parts) + bytes(unused * inner_bytes)


class Network:
    """Steps, from a state of nothing."""

    def __init__(self, quantized: Quantized) -> None:
        self._weights = quantized
        self.cell = np.zeros((len(quantized.levels), UNITS), dtype=np.int64)
        self.hidden = np.zeros(UNITS, dtype=np.int64)

    def step(self, given: Single) -> None:
        weights = self._weights
        scaled = ((given - weights.middle).astype(np.float32) * weights.gain).astype(np.float32)
        lifted = np.clip(scaled, np.float32(-32767.0), np.float32(32767.0)) + np.float32(32768.5)
        fed_inputs = np.floor(lifted.astype(np.float32)).astype(np.int64) - 32768
        back = self._inside(0, np.concatenate([self.hidden, fed_inputs]))
        self.hidden = (back + (1 << 14)) >> 15

    def _inside(self, number: int, fed: Whole) -> Whole:
        """What this level gives back, Q30."""
        level = self._weights.levels[number]
        reach = level.bias + high(level.scale, level.weight @ fed)
        opened = activate(SIGMOID, reach[:FIRST_TANH])
        i, f, o = np.split(opened, 3)
        g = activate(TANH, reach[FIRST_TANH:])
        cell = self.cell[number]
        if number + 1 == len(self._weights.levels):
            new = np.clip((high(i, g) >> 9) + 2 * high(f, cell), -(1 << 31), (1 << 31) - 1)
            self.cell[number] = new
            return high(o, activate(TANH, new))
        inner = np.concatenate([(i * g + (1 << 46)) >> 47, (f * cell + (1 << 45)) >> 46])
        self.cell[number] = self._inside(number + 1, inner)
        return high(o, activate(TANH, self.cell[number] >> 9))

    def output(self) -> Single:
        total = self._weights.head_bias
        for r in range(UNITS):
            product = (self._weights.head_row[r] * np.float32(self.hidden[r])).astype(np.float32)
            total = (total + product).astype(np.float32)
        return total
