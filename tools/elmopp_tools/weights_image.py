# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Writes a network as a weights image: an envelope and the little-endian bytes of elmopp_weights_t."""

import numpy as np

from elmopp_tools.image import envelope
from elmopp_tools.weights_model import GATES, LEVELS_MAX, UNITS, Level, Network

MAGIC = b"ELMW"
VERSION = 2


def image_bytes(network: Network) -> bytes:
    """The whole image."""
    return envelope(MAGIC, VERSION, body_bytes(network))


def body_bytes(network: Network) -> bytes:
    """elmopp_weights_t as the firmware's compiler lays it out; unused levels are zero."""
    inner_size = 4 * GATES * (1 + 2 * UNITS)
    inner = b"".join(_level(level) for level in network.levels[1:])
    return b"".join(
        [
            *(_floats(part) for part in (network.low, network.high, network.intercept, network.lag, network.lag_range)),
            len(network.levels).to_bytes(4, "little"),
            _level(network.head),
            _level(network.levels[0]),
            inner.ljust((LEVELS_MAX - 1) * inner_size, b"\0"),
            *(_floats(values) for members in network.windows.values() for values in members.values()),
        ]
    )


def _level(level: Level) -> bytes:
    return _floats(level.bias) + _floats(level.weight)


def _floats(values: np.typing.NDArray[np.float32]) -> bytes:
    return values.astype("<f4").tobytes()
