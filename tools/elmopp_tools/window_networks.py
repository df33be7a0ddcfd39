# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The two networks that see windows of seconds, in JAX: what tools/train trains beside the LSTMs.

The equations are those of firmware/include/elmopp/ann_f32.h and gcn_f32.h. Windows are [second, batch, input], oldest
first; a trained matrix is the firmware's as it is.
"""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax import Array

from elmopp_tools.nested_lstm import glorot
from elmopp_tools.weights_model import INPUTS, WINDOW_SHAPES, WINDOWS_S

# As the firmware's members are called.
Values = dict[str, Array]

HEAD_SHARE = 0.1  # small at first: the change from the newest second is small


class WindowNetwork(NamedTuple):
    """What one of them is."""

    window_s: int
    next_second: Callable[[Values, Array], Array]  # [second, batch, input] to [batch, input]


def new_values(key: Array, name: str) -> Values:
    """Glorot for every matrix, 0 for every bias."""
    values = {}
    for member, shape in WINDOW_SHAPES[name].items():
        key, mine = jax.random.split(key)
        if "bias" in member:
            values[member] = jnp.zeros(shape)
        else:
            rows, columns = shape if len(shape) == 2 else (shape[0], 1)
            share = HEAD_SHARE if member.startswith("head") else 1.0
            values[member] = share * glorot(mine, rows, columns).reshape(shape)
    return values


def ann_next(values: Values, window: Array) -> Array:
    seen = jnp.transpose(window, (1, 2, 0)).reshape(window.shape[1], INPUTS * WINDOWS_S["ann"])
    first = jnp.tanh(seen @ values["first_row"] + values["first_bias"])
    second = jnp.tanh(first @ values["second_row"] + values["second_bias"])
    return window[-1] + second @ values["head_row"] + values["head_bias"]


def mix_of(joined: Array) -> Array:
    """Kipf and Welling's normalised A + I of a symmetric A [node, node]."""
    with_self = joined + jnp.eye(joined.shape[0])
    root = 1.0 / jnp.sqrt(with_self.sum(axis=1))
    return root[:, None] * with_self * root[None, :]


def gcn_next(values: Values, window: Array, mix: Array | None = None) -> Array:
    """`mix` is that of a complete graph of all inputs, as in the paper's junction, unless given."""
    nodes = window.shape[2]
    mixed = mix_of(jnp.ones((nodes, nodes)) - jnp.eye(nodes)) if mix is None else mix

    def convolve(seen: Array, layer: str) -> Array:
        own, passed = seen @ values[f"{layer}_own"], seen @ values[f"{layer}_passed"]
        return jnp.tanh(own + mixed @ passed + values[f"{layer}_bias"])

    units = convolve(convolve(jnp.transpose(window, (1, 2, 0)), "first"), "second")
    return window[-1] + units @ values["head"] + values["head_bias"]


WINDOW_NETWORKS = {
    "ann": WindowNetwork(WINDOWS_S["ann"], ann_next),
    "gcn": WindowNetwork(WINDOWS_S["gcn"], gcn_next),
}


def free_run(network: WindowNetwork, values: Values, window: Array, steps: int, clamp: tuple[Array, Array]) -> Array:
    """What the network says on its own output, held in the clamp: [step, batch, input]."""

    def advance(before: Array, _: None) -> tuple[Array, Array]:
        said = network.next_second(values, before)
        held = said + jax.lax.stop_gradient(jnp.clip(said, *clamp) - said)
        return jnp.concatenate([before[1:], held[None]]), held

    return jax.lax.scan(advance, window, None, length=steps)[1]
