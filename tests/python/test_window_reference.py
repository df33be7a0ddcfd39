# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""The core's networks that see windows in single precision against the independent ones in double, and JAX.

The reference (tests/reference/window_reference.py) was written from the equations. What the C says comes out of
tests/window_probe.c, on images that are written from the layout in elmopp/weights.h (test_lstm_reference.py).

Errors are largest absolute differences of outputs, whose unit is the demand scale; the bounds are about three times the
largest seen. A free run is one of 60 s; it can make a rounding error grow without end, hence these seeds, for good.
"""

from __future__ import annotations

import json
import os
import random
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from references import load_reference
from test_lstm_reference import LAYOUT, image_of, random_weights, read_safetensors, single

Array = npt.NDArray[np.float64]

ROOT = Path(__file__).resolve().parents[2]
PROBE = os.environ.get("ELMOPP_WINDOW_PROBE", str(ROOT / "build" / "host" / "bin" / "tests" / "window_probe"))
SHIPPED = ROOT / "weights" / "forecast.safetensors"
GOLDEN = ROOT / "tests" / "golden" / "lstm_jax.json"

REFERENCE = load_reference("window_reference")

SEEDS = tuple(range(1, 9))
SECONDS = 100
FREE = 60

ONE_SECOND_BOUND = 4e-7
FREE_BOUND = 4e-6
JAX_BOUND = 2e-5

# A planted mistake is caught if its error is so many times the bound.
WIDE = 1000.0

SHAPES = {
    "ann": {"first_row": (64, 16), "second_row": (16, 16), "head_row": (16, 4)},
    "gcn": dict.fromkeys(("first_own", "first_passed"), (32, 16))
    | dict.fromkeys(("second_own", "second_passed"), (16, 16)),
}
WINDOW_S = {"ann": 16, "gcn": 32}

# Adjacencies: a path, a star, a complete graph, a node alone, eight nodes in a ring, and one that is not connected.
PATH = [(0, 1), (1, 2), (2, 3)]
GRAPHS = {
    "path": (4, PATH),
    "star": (5, [(0, k) for k in range(1, 5)]),
    "complete": (4, [(a, b) for a in range(4) for b in range(a)]),
    "alone": (1, []),
    "ring": (8, [(k, (k + 1) % 8) for k in range(8)]),
    "apart": (6, [(0, 1), (1, 2), (0, 2), (4, 5)]),
}


def adjacency_of(name: str) -> Array:
    nodes, edges = GRAPHS[name]
    adjacency = np.zeros((nodes, nodes))
    for a, b in edges:
        adjacency[a, b] = adjacency[b, a] = 1.0
    return adjacency


def random_windows(seed: int) -> dict[str, Array]:
    """Both networks: small changes, so that a free run is no explosion, and units that are neither shut nor linear."""
    source = random.Random(f"windows {seed}")
    sizes = {"first": 0.25, "second": 0.4, "head": 0.03}
    members = {}
    for member, words in LAYOUT:
        network, _, name = member.partition(".")
        if network in SHAPES:
            values = single([source.gauss(0.0, sizes[name.split("_")[0]]) for _ in range(words)])
            members[member] = values.reshape(SHAPES[network].get(name, (words,)))
    return members


def network_of(windows: dict[str, Array], network: str) -> dict[str, Array]:
    return {name.partition(".")[2]: values for name, values in windows.items() if name.startswith(f"{network}.")}


def noise(width: int, seed: int) -> Array:
    source = random.Random(f"seconds {seed} {width}")
    return single([[source.uniform(0.3, 1.8) for _ in range(width)] for _ in range(SECONDS)])


def ask_probe(folder: Path, network: str, image: bytes, inputs: Array, adjacency: Array | None) -> Array:
    """What comes after every full window, then the free run."""
    image_path, inputs_path = folder / "image.elmw", folder / "inputs.f32"
    image_path.write_bytes(image)
    inputs_path.write_bytes(inputs.astype("<f4").tobytes())
    masks = [] if adjacency is None else [sum(1 << k for k in np.flatnonzero(row)) for row in adjacency]
    command = [PROBE, str(image_path), network, str(inputs_path), str(FREE), *map(str, masks)]
    done = subprocess.run(command, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr.decode()
    return np.frombuffer(done.stdout, dtype="<f4").astype(np.float64).reshape(-1, inputs.shape[1])


def ask_reference(
    network: str,
    values: dict[str, Array],
    clamp: tuple[Array, Array],
    inputs: Array,
    adjacency: Array | None,
    mistake: Any = None,
) -> Array:
    def say(window: Array) -> Array:
        if network == "ann":
            return np.asarray(REFERENCE.ann_next(values, window, mistake))
        return np.asarray(REFERENCE.gcn_next(values, adjacency, window, mistake))

    window_s = WINDOW_S[network]
    said = [say(inputs[end - window_s : end]) for end in range(window_s, len(inputs) + 1)]
    window = inputs[-window_s:]
    for _ in range(FREE):
        bare = say(window)
        held = np.clip(bare, *clamp)
        said.append(held)
        window = np.vstack([window[1:], bare if mistake is REFERENCE.Mistake.UNCLAMPED_FEEDBACK else held])
    return np.array(said)


def errors(core: Array, reference: Array) -> tuple[float, float]:
    """Of single seconds, and of the free run."""
    assert core.shape == reference.shape
    wrong = np.abs(core - reference)
    return float(wrong[:-FREE].max()), float(wrong[-FREE:].max())


def clamp_of(network: str, weights: Any, width: int) -> tuple[Array, Array]:
    if network == "ann":
        return weights.low, weights.high
    return np.full(width, weights.ar8[9]), np.full(width, weights.ar8[10])


def compare(folder: Path, network: str, graph: str, seed: int, mistake: Any = None) -> tuple[float, float]:
    weights, windows = random_weights(seed, 1), random_windows(seed)
    adjacency = adjacency_of(graph) if network == "gcn" else None
    inputs = noise(4 if adjacency is None else len(adjacency), seed)
    core = ask_probe(folder, network, image_of(weights, windows), inputs, adjacency)
    clamp = clamp_of(network, weights, inputs.shape[1])
    return errors(core, ask_reference(network, network_of(windows, network), clamp, inputs, adjacency, mistake))


@pytest.mark.parametrize("seed", SEEDS)
def test_random_plain_networks_agree(tmp_path: Path, seed: int) -> None:
    second, free = compare(tmp_path, "ann", "", seed)
    assert second < ONE_SECOND_BOUND
    assert free < FREE_BOUND


@pytest.mark.parametrize("seed", SEEDS[:4])
@pytest.mark.parametrize("graph", GRAPHS)
def test_random_graph_networks_agree(tmp_path: Path, graph: str, seed: int) -> None:
    second, free = compare(tmp_path, "gcn", graph, seed)
    assert second < ONE_SECOND_BOUND
    assert free < FREE_BOUND


CASES = [(mistake, network) for mistake in REFERENCE.Mistake for network in mistake.networks]


@pytest.mark.parametrize(
    ("mistake", "network"), [pytest.param(*case, id=f"{case[0].name}-{case[1]}") for case in CASES]
)
def test_a_planted_mistake_is_caught(tmp_path: Path, mistake: Any, network: str) -> None:
    """By every model if a single second shows it, else by one of them: not every free run touches its range."""
    caught = []
    for seed in SEEDS:
        second, free = compare(tmp_path, network, "path", seed, mistake)
        if mistake.shows_in_second:
            assert second > WIDE * ONE_SECOND_BOUND
        else:
            assert second < ONE_SECOND_BOUND
        caught.append(free > WIDE * FREE_BOUND)
    assert any(caught)


def shipped() -> tuple[Any, dict[str, Array]]:
    tensors = read_safetensors(SHIPPED)
    weights = random_weights(1, 1)
    ar8 = np.concatenate([tensors["ar8.intercept"], tensors["ar8.lag"], tensors["ar8.range"]])
    weights = type(weights)(
        tensors["range.low"], tensors["range.high"], ar8, weights.head_bias, weights.head_row, weights.levels
    )
    return weights, {name: values for name, values in tensors.items() if name.split(".")[0] in SHAPES}


def waves(count: int) -> Array:
    """Four smooth flows around 1: those of tests/golden/make_lstm_jax.py."""
    angle = 0.05 * np.arange(count)[:, None] * np.arange(1, 5) + np.arange(4)
    return single(1.0 + 0.9 * np.sin(angle))


@pytest.mark.parametrize("network", SHAPES)
def test_shipped_weights_agree_with_the_reference(tmp_path: Path, network: str) -> None:
    weights, windows = shipped()
    adjacency = adjacency_of("complete") if network == "gcn" else None
    core = ask_probe(tmp_path, network, image_of(weights, windows), waves(SECONDS), adjacency)
    clamp = clamp_of(network, weights, 4)
    second, free = errors(core, ask_reference(network, network_of(windows, network), clamp, waves(SECONDS), adjacency))
    assert second < ONE_SECOND_BOUND
    assert free < FREE_BOUND


@pytest.mark.parametrize("network", SHAPES)
def test_the_core_says_what_the_training_framework_says(tmp_path: Path, network: str) -> None:
    golden = np.array(json.loads(GOLDEN.read_text(encoding="ascii"))[network]["free"])
    weights, windows = shipped()
    adjacency = adjacency_of("complete") if network == "gcn" else None
    core = ask_probe(tmp_path, network, image_of(weights, windows), waves(120), adjacency)
    assert float(np.max(np.abs(core[-FREE:] - golden))) < JAX_BOUND
    assert float(np.std(golden)) > 0.1  # a run that says nothing would agree with anything
