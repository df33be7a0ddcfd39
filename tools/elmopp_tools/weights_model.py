# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""What tools/train learns, as tensors with names: which there are, which shapes they have, what their values may be.

The names are those of weights/forecast.safetensors, the shapes and bounds those of firmware/include/elmopp/lstm_f32.h,
ann_f32.h, gcn_f32.h and weights.h.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
from safetensors import SafetensorError
from safetensors.numpy import load

INPUTS = 4
UNITS = 16
GATES = 4 * UNITS
LEVELS_MAX = 3
LAGS = 8
VALUE_MAX = 1000.0  # ELMOPP_WEIGHTS_VALUE_MAX
CLAMP_MAX = 1000.0  # ELMOPP_WEIGHTS_CLAMP_MAX
REACH_MAX = 128.0  # ELMOPP_LSTM_QUANTIZE_REACH_MAX

Tensor = npt.NDArray[np.float32]
Tensors = Mapping[str, Tensor]

# Network: its levels. The first is the paper's evaluation, the second its abstract.
NETWORKS = {"lstm": 1, "nlstm": 3}


# The networks that see windows: seconds of a window, and every member as the firmware has it, in its order.
WINDOW_UNITS = 16
WINDOWS_S = {"ann": 16, "gcn": 32}
WINDOW_SHAPES: dict[str, dict[str, tuple[int, ...]]] = {
    "ann": {
        "first_bias": (WINDOW_UNITS,),
        "first_row": (INPUTS * WINDOWS_S["ann"], WINDOW_UNITS),
        "second_bias": (WINDOW_UNITS,),
        "second_row": (WINDOW_UNITS, WINDOW_UNITS),
        "head_bias": (INPUTS,),
        "head_row": (WINDOW_UNITS, INPUTS),
    },
    "gcn": {
        "first_bias": (WINDOW_UNITS,),
        "first_own": (WINDOWS_S["gcn"], WINDOW_UNITS),
        "first_passed": (WINDOWS_S["gcn"], WINDOW_UNITS),
        "second_bias": (WINDOW_UNITS,),
        "second_own": (WINDOW_UNITS, WINDOW_UNITS),
        "second_passed": (WINDOW_UNITS, WINDOW_UNITS),
        "head_bias": (1,),
        "head": (WINDOW_UNITS,),
    },
}


class WeightsError(Exception):
    """What is wrong with a file of weights, and what would be right."""

    def __init__(self, wrong: str, right: str) -> None:
        super().__init__(f"{wrong} ; {right}")


@dataclass(frozen=True)
class Level:
    """One level: bias [gate] and weight [row, gate]."""

    bias: Tensor
    weight: Tensor


@dataclass(frozen=True)
class Network:
    """One network with what belongs to it: an elmopp_weights_t."""

    name: str
    low: Tensor
    high: Tensor
    intercept: Tensor
    lag: Tensor
    lag_range: Tensor
    head: Level
    levels: list[Level]
    windows: dict[str, dict[str, Tensor]]  # of WINDOW_SHAPES


def shapes() -> dict[str, tuple[int, ...]]:
    """Every tensor of the file and its shape."""
    wanted: dict[str, tuple[int, ...]] = {
        "range.low": (INPUTS,),
        "range.high": (INPUTS,),
        "ar8.intercept": (1,),
        "ar8.lag": (LAGS,),
        "ar8.range": (2,),
    }
    for network, levels in NETWORKS.items():
        wanted |= {f"{network}.head.weight": (UNITS, INPUTS), f"{network}.head.bias": (INPUTS,)}
        for level in range(levels):
            rows = INPUTS + UNITS if level == 0 else 2 * UNITS
            wanted |= {f"{network}.{level_name(level)}.weight": (rows, GATES)}
            wanted |= {f"{network}.{level_name(level)}.bias": (GATES,)}
    for network, members in WINDOW_SHAPES.items():
        wanted |= {f"{network}.{member}": shape for member, shape in members.items()}
    return wanted


def level_name(level: int) -> str:
    return "outer" if level == 0 else f"inner{level}"


def read_tensors(path: Path) -> tuple[Tensors, bytes]:
    """The checked tensors of a file, and the bytes it was read from."""
    source = path.read_bytes()
    try:
        tensors = load(source)
    except (SafetensorError, ValueError, KeyError) as error:
        raise WeightsError(f"no safetensors file ({error})", "a file of tools/train") from error
    check_tensors(tensors)
    return tensors, source


def check_tensors(tensors: Tensors) -> None:
    """Names, shapes and types, then values."""
    wanted = shapes()
    for name in sorted(set(wanted) | set(tensors)):
        if name not in tensors:
            raise WeightsError(f"tensor {name} is missing", f"float32 of shape {list(wanted[name])}")
        if name not in wanted:
            raise WeightsError(f"tensor {name} is unknown", f"only {', '.join(sorted(wanted))}")
        tensor = tensors[name]
        if tensor.shape != wanted[name] or tensor.dtype != np.float32:
            found = f"{tensor.dtype} of shape {list(tensor.shape)}"
            raise WeightsError(f"tensor {name} is {found}", f"float32 of shape {list(wanted[name])}")
        _check_values(name, tensor)
    for low, high, name in zip(tensors["range.low"], tensors["range.high"], "0123", strict=True):
        _check_range(f"range {name}", float(low), float(high))
    _check_range("ar8.range", float(tensors["ar8.range"][0]), float(tensors["ar8.range"][1]))
    for network, levels in NETWORKS.items():
        for level in range(levels):
            _check_rows(f"{network}.{level_name(level)}", tensors, level == 0)


def _check_values(name: str, tensor: Tensor) -> None:
    good = np.isfinite(tensor) & (np.abs(tensor) <= VALUE_MAX)
    if not good.all():
        place = tuple(int(index) for index in np.argwhere(~good)[0])
        value = float(tensor[place])
        raise WeightsError(
            f"tensor {name}{list(place)} is {value:.9g}", f"a number from -{VALUE_MAX:g} to {VALUE_MAX:g}"
        )


def _check_rows(name: str, tensors: Tensors, is_outer: bool) -> None:
    """In whole numbers no sum may overflow, whatever is fed: inputs from 0 to the clamp's end, all else within +-1."""
    weight = tensors[f"{name}.weight"].astype(np.float64)
    bias = tensors[f"{name}.bias"].astype(np.float64)
    if is_outer:
        half = 0.5 * tensors["range.high"].astype(np.float64)
        bias = bias + half @ weight[:INPUTS]
        weight = np.concatenate([weight[:INPUTS] * half[:, None], weight[INPUTS:]])
    reach = np.abs(bias) + np.abs(weight).sum(axis=0)
    for column in np.flatnonzero(reach >= REACH_MAX):
        row = f"gate {'ifog'[column // UNITS]} of unit {column % UNITS}"
        raise WeightsError(f"{name}: {row} could reach {reach[column]:g}", f"less than {REACH_MAX:g}, row by row")


def _check_range(name: str, low: float, high: float) -> None:
    if not 0.0 <= low < high <= CLAMP_MAX:
        raise WeightsError(f"{name} is {low:g} to {high:g}", f"0 <= low < high <= {CLAMP_MAX:g}")


def network(tensors: Tensors, name: str) -> Network:
    """One of NETWORKS out of checked tensors."""
    parts = [level_name(level) for level in range(NETWORKS[name])]
    return Network(
        name=name,
        low=tensors["range.low"],
        high=tensors["range.high"],
        intercept=tensors["ar8.intercept"],
        lag=tensors["ar8.lag"],
        lag_range=tensors["ar8.range"],
        head=_level(tensors, f"{name}.head"),
        levels=[_level(tensors, f"{name}.{part}") for part in parts],
        windows={
            window: {member: tensors[f"{window}.{member}"] for member in members}
            for window, members in WINDOW_SHAPES.items()
        },
    )


def _level(tensors: Tensors, name: str) -> Level:
    return Level(bias=tensors[f"{name}.bias"], weight=tensors[f"{name}.weight"])
