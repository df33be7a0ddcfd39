#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""Trains the eight fixed models of the error of a free run, and writes tests/golden/q15_models.safetensors.

tests/golden/make_q15_models.py HOST_SIM     needs ./tools/setup train; HOST_SIM is that of the preset release

Four models are trained on the hyperchaotic inflow, each on trajectories of its own, four on sums of two sines, each on
periods of its own, all as tools/train trains the shipped LSTM but shorter. With each go ABSORBED_S seconds of traffic
that it was not trained on, where that moves most. A model whose free run dies down would hide errors: it is refused
here, and by the test that reads the file. The file is made once: other processors round otherwise, and then the models
are others.
"""

from __future__ import annotations

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from elmopp_tools.venv import enter  # noqa: E402  the tools' folder had to be named first

enter("train")

import jax.numpy as jnp  # noqa: E402  these need the environment
import numpy as np  # noqa: E402
from elmopp_tools.inflow_data import Series, clamp, trajectories  # noqa: E402
from elmopp_tools.nested_lstm import Shape, zero_state  # noqa: E402
from elmopp_tools.train_forecast import Course, absorb, free_run, train  # noqa: E402
from safetensors.numpy import save_file  # noqa: E402

GOLDEN = ROOT / "tests" / "golden" / "q15_models.safetensors"
SHAPE = Shape(inputs=4, outputs=4, units=16, levels=1)
UPDATES = 1000
MODELS_EACH = 4
TRAJECTORIES_EACH = 24
INFLOW_SEED = 4_000_000_002
ABSORBED_S = 60
FREE_S = 60
SD_MIN = 0.3
STARTS_EVERY_S = 20
STARTS_TRIED = 50


def two_sines(seed: int) -> Series:
    """Four inputs of the same two periods, around 1.2. The seed's are periods, amplitudes and how far the inputs are
    apart, a trajectory's own where each sine begins.
    """
    random = np.random.default_rng(seed)
    periods_s = np.array([[random.uniform(25.0, 50.0)], [random.uniform(60.0, 110.0)]])
    amplitudes = np.stack([random.uniform(0.5, 0.7, 4), random.uniform(0.3, 0.5, 4)])
    phases = random.uniform(0.0, 2.0 * np.pi, (2, 4)) + random.uniform(0.0, 2.0 * np.pi, (TRAJECTORIES_EACH, 2, 1))
    second = np.arange(10_000.0)[None, :, None, None]
    waves = amplitudes * np.sin(2.0 * np.pi * second / periods_s + phases[:, None])
    return np.asarray(np.maximum(1.2 + waves.sum(axis=2), 0.0), dtype=np.float32)


def liveliest_starts(series: Series) -> list[int]:
    """Of a trajectory [second, input], liveliest first: how much the calmest input moves after the absorbed seconds."""
    starts = range(0, len(series) - ABSORBED_S - FREE_S, STARTS_EVERY_S)

    def movement(at: int) -> float:
        return float(series[at + ABSORBED_S : at + ABSORBED_S + FREE_S].std(axis=0).min())

    return sorted(starts, key=movement, reverse=True)


def make(name: str, series: Series, seed: int) -> dict[str, np.ndarray]:
    """One model's tensors, `name` before each, with the liveliest traffic on which its own free run lives, too."""
    bounds = clamp(series)
    parameters = train(Course(SHAPE, UPDATES, seed), series[:-1], bounds, lambda text: print(f"{name}: {text}"))
    for start in liveliest_starts(series[-1])[:STARTS_TRIED]:
        absorbed = series[-1, start : start + ABSORBED_S]
        state, _ = absorb(parameters, zero_state(SHAPE, 1), jnp.asarray(absorbed)[:, None, :])
        free = np.asarray(free_run(parameters, state, FREE_S, jnp.asarray(bounds[0]), jnp.asarray(bounds[1])))
        print(f"{name}: free run's standard deviation {free.std(axis=0).min():.3f} to {free.std(axis=0).max():.3f}")
        if free.std(axis=0).min() >= SD_MIN:
            break
    else:
        raise SystemExit(f"make_q15_models: {name} dies down; right would be a standard deviation of {SD_MIN}")
    tensors = {
        "outer.weight": parameters.levels[0]["weight"],
        "outer.bias": parameters.levels[0]["bias"],
        "head.weight": parameters.head["weight"],
        "head.bias": parameters.head["bias"],
        "low": bounds[0],
        "high": bounds[1],
        "absorbed": absorbed,
    }
    return {f"{name}.{part}": np.ascontiguousarray(tensor, dtype=np.float32) for part, tensor in tensors.items()}


def main(arguments: list[str]) -> int:
    if len(arguments) != 1:
        print("make_q15_models: right would be one argument, host_sim", file=sys.stderr)
        return 2
    inflow = trajectories(Path(arguments[0]), INFLOW_SEED, MODELS_EACH * TRAJECTORIES_EACH)
    tensors: dict[str, np.ndarray] = {}
    for number in range(MODELS_EACH):
        own = inflow[number * TRAJECTORIES_EACH : (number + 1) * TRAJECTORIES_EACH]
        tensors |= make(f"sines{number}", two_sines(number), seed=MODELS_EACH + number)
        tensors |= make(f"inflow{number}", own, seed=number)
    save_file(tensors, GOLDEN)
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
