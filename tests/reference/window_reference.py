# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""Independent reference of the two networks that see windows of seconds, in double precision.

Written from the equations of a multilayer perceptron and of T. N. Kipf and M. Welling, "Semi-Supervised Classification
with Graph Convolutional Networks" (2017), as the headers elmopp/ann_f32.h and gcn_f32.h give them, and sharing no code
with the C: matrices here, loops there. So that the tests can show that they would notice, a Mistake can be planted.
"""

from __future__ import annotations

import enum
from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Values = Mapping[str, Array]

ANN_WINDOW_S = 16
GCN_WINDOW_S = 32


class Mistake(enum.Enum):
    """What can be planted: of which networks, does a single second show it, and what it is."""

    FORGOTTEN_NEWEST = (("ann", "gcn"), True, "the change alone, without the newest second")
    NEWEST_FIRST = (("ann", "gcn"), True, "windows are newest second first")
    NO_SECOND_TANH = (("ann", "gcn"), True, "the second layer is linear")
    UNCLAMPED_FEEDBACK = (("ann", "gcn"), False, "a free run is fed what the head says, though its rows are clamped")
    SECONDS_BEFORE_INPUTS = (("ann",), True, "rows are all inputs of a second, then of the next")
    SECOND_LAYER_TRANSPOSED = (("ann",), True, "the second layer's matrix is transposed")
    NO_SELF = (("gcn",), True, "A without I")
    ROWS_NORMALISED = (("gcn",), True, "D^-1 (A + I), not D^-1/2 (A + I) D^-1/2")
    NOT_MIXED = (("gcn",), True, "no convolution: every node passes to itself alone")
    ONE_CONVOLUTION = (("gcn",), True, "the second layer mixes nobody")
    OWN_AND_PASSED_SWAPPED = (("gcn",), True, "what is mixed are a node's own weights")

    def __init__(self, networks: tuple[str, ...], shows_in_second: bool, text: str) -> None:
        self.networks = networks
        self.shows_in_second = shows_in_second
        self.text = text


def layer_tanh(sums: Array, second: bool, mistake: Mistake | None) -> Array:
    linear = second and mistake is Mistake.NO_SECOND_TANH
    return sums if linear else np.asarray(np.tanh(sums))


def newest_of(window: Array, mistake: Mistake | None) -> Array:
    return np.zeros_like(window[-1]) if mistake is Mistake.FORGOTTEN_NEWEST else window[-1]


def ann_next(values: Values, window: Array, mistake: Mistake | None = None) -> Array:
    """The next second of each input: window [second, input], oldest first."""
    seen = window[::-1] if mistake is Mistake.NEWEST_FIRST else window
    x = seen.ravel() if mistake is Mistake.SECONDS_BEFORE_INPUTS else seen.T.ravel()
    second_row = values["second_row"]
    if mistake is Mistake.SECOND_LAYER_TRANSPOSED:
        second_row = second_row.T
    a = layer_tanh(x @ values["first_row"] + values["first_bias"], False, mistake)
    b = layer_tanh(a @ second_row + values["second_bias"], True, mistake)
    return np.asarray(newest_of(window, mistake) + b @ values["head_row"] + values["head_bias"])


def mix_of(adjacency: Array, mistake: Mistake | None = None) -> Array:
    """The normalised matrix of a symmetric adjacency [node, node] with an empty diagonal."""
    with_self = adjacency + (0.0 if mistake is Mistake.NO_SELF else 1.0) * np.eye(len(adjacency))
    degree = np.maximum(with_self.sum(axis=1), 1e-9)
    if mistake is Mistake.ROWS_NORMALISED:
        return np.asarray(np.diag(1.0 / degree) @ with_self)
    root = np.diag(1.0 / np.sqrt(degree))
    return np.asarray(root @ with_self @ root)


def gcn_next(values: Values, adjacency: Array, window: Array, mistake: Mistake | None = None) -> Array:
    """The next second of each node: window [second, node], oldest first."""
    nodes = len(adjacency)
    mix = np.eye(nodes) if mistake is Mistake.NOT_MIXED else mix_of(adjacency, mistake)
    own, passed = ("passed", "own") if mistake is Mistake.OWN_AND_PASSED_SWAPPED else ("own", "passed")
    units = (window[::-1] if mistake is Mistake.NEWEST_FIRST else window).T
    for layer in ("first", "second"):
        here = np.eye(nodes) if mistake is Mistake.ONE_CONVOLUTION and layer == "second" else mix
        sums = units @ values[f"{layer}_{own}"] + here @ units @ values[f"{layer}_{passed}"] + values[f"{layer}_bias"]
        units = layer_tanh(sums, layer == "second", mistake)
    return np.asarray(newest_of(window, mistake) + units @ values["head"] + values["head_bias"][0])
