# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""A plain or nested LSTM with a linear head in JAX: what tools/train trains.

The equations are those of firmware/include/elmopp/lstm_f32.h. Gates lie side by side in the order i, f, o, g; matrices
are [row, gate * unit], rows first the input, then the hidden input: a trained matrix is the firmware's as it is.
"""

from dataclasses import dataclass
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax import Array

GATES = 4

# {"weight": [inputs + units, 4 units], "bias": [4 units]}; of the head [units, outputs] and [outputs].
Level = dict[str, Array]

# Hidden state [batch, units], and each level's cell, outermost first.
State = tuple[Array, list[Array]]


class Parameters(NamedTuple):
    """Everything that is trained."""

    levels: list[Level]  # outermost first
    head: Level


@dataclass(frozen=True)
class Shape:
    """How large a network is."""

    inputs: int
    outputs: int
    units: int
    levels: int

    def parameter_count(self) -> int:
        """Of the levels, without the head."""
        outer = GATES * self.units * (self.inputs + self.units + 1)
        inner = GATES * self.units * (2 * self.units + 1)
        return outer + (self.levels - 1) * inner


def glorot(key: Array, rows: int, columns: int) -> Array:
    limit = (6.0 / (rows + columns)) ** 0.5
    return jax.random.uniform(key, (rows, columns), minval=-limit, maxval=limit)


def new_level(key: Array, inputs: int, units: int) -> Level:
    """Glorot for the input, orthogonal for the hidden input, forget bias 1."""
    for_input, *for_gates = jax.random.split(key, 1 + GATES)
    recurrent = [jax.random.orthogonal(gate, units) for gate in for_gates]
    weight = jnp.concatenate([glorot(for_input, inputs, GATES * units), jnp.concatenate(recurrent, axis=1)])
    bias = jnp.zeros(GATES * units).at[units : 2 * units].set(1.0)
    return {"weight": weight, "bias": bias}


def new_parameters(key: Array, shape: Shape, head_bias: float = 0.0) -> Parameters:
    for_head, *for_levels = jax.random.split(key, 1 + shape.levels)
    inputs = [shape.inputs] + [shape.units] * (shape.levels - 1)
    levels = [new_level(each, count, shape.units) for each, count in zip(for_levels, inputs, strict=True)]
    head = {"weight": glorot(for_head, shape.units, shape.outputs), "bias": jnp.full(shape.outputs, head_bias)}
    return Parameters(levels, head)


def zero_state(shape: Shape, batch: int) -> State:
    return jnp.zeros((batch, shape.units)), [jnp.zeros((batch, shape.units)) for _ in range(shape.levels)]


def _inside(levels: list[Level], given: Array, hidden: Array, cells: list[Array]) -> State:
    """What the outermost of these levels gives back, and all their new cells."""
    sums = jnp.concatenate([given, hidden], axis=-1) @ levels[0]["weight"] + levels[0]["bias"]
    i, f, o, g = jnp.split(sums, GATES, axis=-1)
    i, f, o, g = jax.nn.sigmoid(i), jax.nn.sigmoid(f), jax.nn.sigmoid(o), jnp.tanh(g)
    if len(levels) == 1:
        return o * jnp.tanh(f * cells[0] + i * g), [f * cells[0] + i * g]
    cell, inner = _inside(levels[1:], i * g, f * cells[0], cells[1:])
    return o * jnp.tanh(cell), [cell, *inner]


def step(parameters: Parameters, state: State, given: Array) -> State:
    """One step for a batch: given [batch, inputs]."""
    return _inside(parameters.levels, given, state[0], state[1])


def output(parameters: Parameters, state: State) -> Array:
    """The head: [batch, outputs]."""
    return state[0] @ parameters.head["weight"] + parameters.head["bias"]
