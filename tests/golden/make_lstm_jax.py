#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""Writes tests/golden/lstm_jax.json: what the training framework says with the shipped weights, for the core to say.

tests/golden/make_lstm_jax.py           writes it anew, after a training; needs ./tools/setup train
tests/golden/make_lstm_jax.py --check   compares within 1e-5: the last bits differ between processors
"""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from elmopp_tools.venv import enter  # noqa: E402  the tools' folder had to be named first

enter("train")

import jax.numpy as jnp  # noqa: E402  these need the environment
import numpy as np  # noqa: E402
from elmopp_tools import window_networks  # noqa: E402
from elmopp_tools.nested_lstm import Parameters, Shape, output, zero_state  # noqa: E402
from elmopp_tools.train import window_clamp  # noqa: E402
from elmopp_tools.train_forecast import absorb, free_run  # noqa: E402
from elmopp_tools.weights_model import NETWORKS, Network, network, read_tensors  # noqa: E402

GOLDEN = ROOT / "tests" / "golden" / "lstm_jax.json"
ABSORBED_S = 120
FREE_S = 60
TOLERANCE = 1e-5


def inputs() -> list[list[float]]:
    """Four smooth flows around 1, as a formula: the test has the same one."""
    return [
        [1.0 + 0.9 * math.sin(0.05 * (approach + 1) * second + approach) for approach in range(4)]
        for second in range(ABSORBED_S)
    ]


def parameters_of(net: Network) -> Parameters:
    levels = [{"weight": jnp.asarray(level.weight), "bias": jnp.asarray(level.bias)} for level in net.levels]
    return Parameters(levels, {"weight": jnp.asarray(net.head.weight), "bias": jnp.asarray(net.head.bias)})


def said_by(net: Network) -> dict[str, Any]:
    shape = Shape(inputs=4, outputs=4, units=16, levels=len(net.levels))
    parameters = parameters_of(net)
    given = jnp.asarray(np.array(inputs(), dtype=np.float32))[:, None, :]
    state, said = absorb(parameters, zero_state(shape, 1), given)
    free = free_run(parameters, state, FREE_S, jnp.asarray(net.low), jnp.asarray(net.high))
    assert bool(jnp.all(output(parameters, state) == said[-1]))
    return {"said": np.asarray(said)[:, 0].tolist(), "free": np.asarray(free)[:, 0].tolist()}


def said_from_windows(name: str, net: Network) -> dict[str, Any]:
    kind = window_networks.WINDOW_NETWORKS[name]
    values = {member: jnp.asarray(tensor) for member, tensor in net.windows[name].items()}
    given = jnp.asarray(np.array(inputs(), dtype=np.float32))[:, None, :]
    low, high = window_clamp(name, net.low, net.high)
    bounds = (jnp.asarray(low), jnp.asarray(high))
    free = window_networks.free_run(kind, values, given[-kind.window_s :], FREE_S, bounds)
    return {"free": np.asarray(free)[:, 0].tolist()}


def main(arguments: list[str]) -> int:
    if arguments not in ([], ["--check"]):
        print(f"make_lstm_jax: unknown argument {arguments[0]!r}; right would be --check or none", file=sys.stderr)
        return 2
    tensors, _ = read_tensors(ROOT / "weights" / "forecast.safetensors")
    made = {name: said_by(network(tensors, name)) for name in NETWORKS}
    made |= {name: said_from_windows(name, network(tensors, "lstm")) for name in window_networks.WINDOW_NETWORKS}
    if arguments != ["--check"]:
        GOLDEN.write_text(json.dumps(made, indent=0) + "\n", encoding="ascii")
        return 0
    golden = json.loads(GOLDEN.read_text(encoding="ascii"))
    worst = max(
        float(np.max(np.abs(np.array(golden[name][part]) - np.array(made[name][part]))))
        for name, parts in made.items()
        for part in parts
    )
    print(f"make_lstm_jax: largest difference {worst:.3g}")
    return 0 if worst <= TOLERANCE else 1


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
