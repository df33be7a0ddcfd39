# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""The core's LSTM in single precision against the independent one in double: the same outputs, step by step.

The reference (tests/reference/lstm_reference.py) was written from the equations without a look at the C. What the C
says comes out of tests/lstm_probe.c. Images are written here, from the layout in elmopp/weights.h.

Errors are largest absolute differences of outputs, whose unit is the demand scale; the bounds are about three times the
largest seen. One step: the error of the output after each of the absorbed inputs. Free: that of 60 rows of free running
after 40 inputs. The dynamics of a random model can make a rounding error grow without end: hence these seeds, for good.
"""

from __future__ import annotations

import json
import math
import os
import random
import struct
import subprocess
import zlib
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from references import load_reference

Array = npt.NDArray[np.float64]

ROOT = Path(__file__).resolve().parents[2]
PROBE = os.environ.get("ELMOPP_LSTM_PROBE", str(ROOT / "build" / "host" / "bin" / "tests" / "lstm_probe"))
SHIPPED = ROOT / "weights" / "forecast.safetensors"


REFERENCE = load_reference("lstm_reference")

LEVELS = (1, 2, 3)
SEEDS = tuple(range(1, 9))
WARM_UP = 40
FREE = 60

# Of all models, the shipped ones too; absorbing does not grow errors, so it holds for any number of inputs.
ONE_STEP_BOUND = 3e-6
STEEP_BOUND = 2e-5
# By levels: what a level gives back is smaller for every level inside, and so are the errors.
FREE_BOUND = {1: 2e-5, 2: 3e-6, 3: 3e-6}
SHIPPED_FREE_BOUND = 2e-5

# A planted mistake is caught if its error is so many times the bound.
WIDE = 1000.0

# --------------------------------------------------------------------------------------------------------------------
# Images, as elmopp/weights.h lays them out
# --------------------------------------------------------------------------------------------------------------------

HEADER_BYTES = 16
# Member, 4-byte words. All are floats but `levels`.
LAYOUT = (
    ("low", 4),
    ("high", 4),
    ("ar8.intercept", 1),
    ("ar8.lag", 8),
    ("ar8.low", 1),
    ("ar8.high", 1),
    ("levels", 1),
    ("head_bias", 4),
    ("head_row", 16 * 4),
    ("outer.bias", 64),
    ("outer.row", 20 * 64),
    ("inner0.bias", 64),
    ("inner0.row", 32 * 64),
    ("inner1.bias", 64),
    ("inner1.row", 32 * 64),
    ("ann.first_bias", 16),
    ("ann.first_row", 4 * 16 * 16),
    ("ann.second_bias", 16),
    ("ann.second_row", 16 * 16),
    ("ann.head_bias", 4),
    ("ann.head_row", 16 * 4),
    ("gcn.first_bias", 16),
    ("gcn.first_own", 32 * 16),
    ("gcn.first_passed", 32 * 16),
    ("gcn.second_bias", 16),
    ("gcn.second_own", 16 * 16),
    ("gcn.second_passed", 16 * 16),
    ("gcn.head_bias", 1),
    ("gcn.head", 16),
)
RANGES = ("low", "high", "ar8.low", "ar8.high")
WORDS = dict(LAYOUT)
BODY_BYTES = 4 * sum(WORDS.values())

NOT_ELMW = "not an ELMW image"
OTHER_VERSION = "an ELMW image of another version"
OTHER_LENGTH = "an ELMW image of another length"
BAD_CHECKSUM = "an ELMW image whose checksum does not fit"
BAD_LEVELS = "weights of another number of levels"
BAD_CLAMP = "weights whose clamp is no range"
BAD_VALUE = "weights of which one is no number or out of range"


def member_at(member: str) -> int:
    """Offset of a member in the body."""
    names = [name for name, _ in LAYOUT]
    return 4 * sum(words for _, words in LAYOUT[: names.index(member)])


def body_of(weights: Any, windows: dict[str, Array] | None = None) -> bytes:
    """`windows` are the members of ann and gcn by their names in LAYOUT; zeros if there are none."""
    values: dict[str, Array] = {
        "low": weights.low,
        "high": weights.high,
        "ar8.intercept": weights.ar8[:1],
        "ar8.lag": weights.ar8[1:9],
        "ar8.low": weights.ar8[9:10],
        "ar8.high": weights.ar8[10:],
        "head_bias": weights.head_bias,
        "head_row": weights.head_row,
        **(windows or {}),
    }
    for name, level in zip(("outer", "inner0", "inner1"), weights.levels, strict=False):
        values[f"{name}.bias"] = level.bias
        values[f"{name}.row"] = level.row
    body = b""
    for member, words in LAYOUT:
        if member == "levels":
            body += struct.pack("<I", len(weights.levels))
        else:
            content = np.asarray(values.get(member, np.zeros(words)), dtype="<f4")
            assert content.size == words, member
            body += content.tobytes()
    return body


def seal(body: bytes) -> bytes:
    return struct.pack("<4sIII", b"ELMW", 2, len(body), zlib.crc32(body)) + body


def image_of(weights: Any, windows: dict[str, Array] | None = None) -> bytes:
    return seal(body_of(weights, windows))


# --------------------------------------------------------------------------------------------------------------------
# Models
# --------------------------------------------------------------------------------------------------------------------


def single(values: Any) -> Array:
    """Rounded to what single precision can hold, so that both sides begin with the same numbers."""
    return np.asarray(values, dtype=np.float32).astype(np.float64)


def random_weights(seed: int, levels: int, w_sd: float = 0.5, u_sd: float = 0.35) -> Any:
    """Python's generator, not NumPy's: its stream does not change between releases."""
    source = random.Random(f"weights {seed} {levels}")

    def normal(mean: float, sd: float, *shape: int) -> Array:
        return single([source.gauss(mean, sd) for _ in range(math.prod(shape))]).reshape(shape)

    def uniform(low: float, high: float, count: int) -> Array:
        return single([source.uniform(low, high) for _ in range(count)])

    stack = []
    for depth in range(levels):
        bias = np.concatenate([normal(0.0, 0.3, 16), normal(1.0, 0.3, 16), normal(0.0, 0.3, 32)])
        w = normal(0.0, w_sd, 4 if depth == 0 else 16, 64)
        u = normal(0.0, u_sd, 16, 64)
        stack.append(REFERENCE.LevelWeights(bias=bias, row=np.concatenate([w, u])))
    return REFERENCE.Weights(
        low=uniform(0.2, 0.5, 4),
        high=uniform(1.6, 2.2, 4),
        ar8=single([0.1, *([0.1] * 8), 0.0, 3.0]),
        head_bias=normal(1.0, 0.2, 4),
        head_row=normal(0.0, 1.0, 16, 4),
        levels=tuple(stack),
    )


def noise(weights: Any, count: int, seed: int = 0) -> Array:
    """Inputs anywhere within the range."""
    source = random.Random(f"inputs {seed}")
    share = np.array([[source.random() for _ in range(4)] for _ in range(count)])
    return single(weights.low + (weights.high - weights.low) * share)


def waves(weights: Any, count: int) -> Array:
    """Inputs that change slowly, each with its own period."""
    angle = 0.05 * np.arange(count)[:, None] * np.arange(1, 5) + np.arange(4)
    return single(weights.low + (weights.high - weights.low) * (0.5 + 0.45 * np.sin(angle)))


def read_safetensors(path: Path) -> dict[str, Array]:
    """A safetensors file of F32 only: length of the header, header as JSON, data."""
    content = path.read_bytes()
    (length,) = struct.unpack_from("<Q", content)
    header: dict[str, Any] = json.loads(content[8 : 8 + length])
    data = content[8 + length :]
    tensors: dict[str, Array] = {}
    for name, entry in header.items():
        if name == "__metadata__":
            continue
        assert entry["dtype"] == "F32", name
        begin, end = entry["data_offsets"]
        tensors[name] = np.frombuffer(data[begin:end], dtype="<f4").astype(np.float64).reshape(entry["shape"])
    return tensors


def weights_of_tensors(tensors: dict[str, Array], network: str) -> Any:
    """`network` is lstm, the plain one, or nlstm."""
    inside = [f"{network}.inner{n}" for n in (1, 2) if f"{network}.inner{n}.weight" in tensors]
    names = [f"{network}.outer", *inside]
    levels = tuple(REFERENCE.LevelWeights(bias=tensors[f"{n}.bias"], row=tensors[f"{n}.weight"]) for n in names)
    return REFERENCE.Weights(
        low=tensors["range.low"],
        high=tensors["range.high"],
        ar8=np.concatenate([tensors["ar8.intercept"], tensors["ar8.lag"], tensors["ar8.range"]]),
        head_bias=tensors[f"{network}.head.bias"],
        head_row=tensors[f"{network}.head.weight"],
        levels=levels,
    )


def shipped_weights(network: str) -> Any:
    assert SHIPPED.is_file(), f"{SHIPPED} is missing: there are no weights to ship"
    return weights_of_tensors(read_safetensors(SHIPPED), network)


# --------------------------------------------------------------------------------------------------------------------
# Both sides
# --------------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Answer:
    outputs: Array  # after each input
    rows: Array  # of free running


@dataclass(frozen=True)
class Errors:
    first: float
    one_step: float
    free: float


def start_probe(folder: Path, image: bytes, inputs: Array, free: int) -> subprocess.CompletedProcess[bytes]:
    image_path, inputs_path = folder / "image.elmw", folder / "inputs.f32"
    image_path.write_bytes(image)
    inputs_path.write_bytes(inputs.astype("<f4").tobytes())
    return subprocess.run([PROBE, str(image_path), str(inputs_path), str(free)], capture_output=True, check=False)


def ask_probe(folder: Path, weights: Any, inputs: Array, free: int = FREE) -> Answer:
    done = start_probe(folder, image_of(weights), inputs, free)
    assert done.returncode == 0, done.stderr.decode()
    rows = np.frombuffer(done.stdout, dtype="<f4").astype(np.float64).reshape(-1, 4)
    assert len(rows) == len(inputs) + free
    return Answer(rows[: len(inputs)], rows[len(inputs) :])


def ask_reference(weights: Any, inputs: Array, free: int = FREE, mistake: Any = None) -> Answer:
    network = REFERENCE.Network(weights, mistake)
    state, outputs = network.absorb(network.start(), inputs)
    return Answer(outputs, network.roll_out(state, free))


def errors_between(one: Answer, other: Answer) -> Errors:
    def largest(a: Array, b: Array) -> float:
        return float(np.max(np.abs(a - b), initial=0.0))

    return Errors(
        first=largest(one.outputs[:1], other.outputs[:1]),
        one_step=largest(one.outputs, other.outputs),
        free=largest(one.rows, other.rows),
    )


def errors_of(folder: Path, weights: Any, inputs: Array, free: int = FREE) -> Errors:
    return errors_between(ask_probe(folder, weights, inputs, free), ask_reference(weights, inputs, free))


# --------------------------------------------------------------------------------------------------------------------
# The reference itself
# --------------------------------------------------------------------------------------------------------------------


def test_the_reference_reads_back_what_the_layout_wrote() -> None:
    assert BODY_BYTES == 34484
    for levels in LEVELS:
        wrote = random_weights(1, levels)
        read = REFERENCE.read_image(image_of(wrote))
        for member in ("low", "high", "ar8", "head_bias", "head_row"):
            assert np.array_equal(getattr(read, member), getattr(wrote, member)), member
        assert len(read.levels) == levels
        for got, put in zip(read.levels, wrote.levels, strict=True):
            assert np.array_equal(got.bias, put.bias)
            assert np.array_equal(got.row, put.row)


def test_the_reference_refuses_what_is_no_image() -> None:
    image = image_of(random_weights(1, 1))
    for bad in (b"", image[:-1], image + b"\0", b"X" + image[1:], image[:-1] + b"\1"):
        with pytest.raises(ValueError, match=r"header|ELMW"):
            REFERENCE.read_image(bad)


def alike_weights(gates: list[tuple[tuple[float, float, float], ...]]) -> Any:
    """All units of a level alike: (w, u, b) of i, f, o, g for each level. Then a level is four scalar equations."""
    stack = []
    for depth, gate in enumerate(gates):
        w, u, b = (np.repeat([triple[n] for triple in gate], 16) for n in range(3))
        x_rows = 4 if depth == 0 else 16
        stack.append(REFERENCE.LevelWeights(bias=b, row=np.concatenate([np.tile(w, (x_rows, 1)), np.tile(u, (16, 1))])))
    plain = random_weights(1, 1)
    return replace(plain, head_bias=np.zeros(4), head_row=np.eye(16, 4), levels=tuple(stack))


def test_the_reference_is_the_equations_written_out_for_one_unit() -> None:
    def s(z: float) -> float:
        return 1.0 / (1.0 + math.exp(-z))

    # i, f, o, g of the outer level, then of the inner one. Sums run over 4 inputs and 16 alike units.
    outer = ((0.3, 0.02, 0.1), (-0.2, 0.03, 0.9), (0.1, -0.05, -0.3), (0.4, 0.01, 0.2))
    inner = ((0.05, 0.04, -0.1), (0.02, -0.03, 0.8), (-0.06, 0.05, 0.4), (0.07, 0.08, -0.2))
    inputs = np.array([[0.5, 1.0, 0.25, 0.75], [1.5, 0.5, 0.0, 1.0], [0.2, 0.1, 0.9, 1.1]])
    network = REFERENCE.Network(alike_weights([outer, inner]))
    _, outputs = network.absorb(network.start(), inputs)
    h = c = inner_c = 0.0
    for t, x in enumerate(inputs.sum(axis=1)):
        i, f, o = (s(w * x + u * 16.0 * h + b) for w, u, b in outer[:3])
        g = math.tanh(outer[3][0] * x + outer[3][1] * 16.0 * h + outer[3][2])
        inner_x, inner_h = i * g, f * c
        j, e, p = (s(w * 16.0 * inner_x + u * 16.0 * inner_h + b) for w, u, b in inner[:3])
        k = math.tanh(inner[3][0] * 16.0 * inner_x + inner[3][1] * 16.0 * inner_h + inner[3][2])
        inner_c = e * inner_c + j * k
        c = p * math.tanh(inner_c)
        h = o * math.tanh(c)
        assert outputs[t] == pytest.approx([h] * 4, rel=1e-13)


# --------------------------------------------------------------------------------------------------------------------
# The C against it
# --------------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("levels", LEVELS)
def test_random_models_agree(tmp_path: Path, levels: int, seed: int) -> None:
    weights = random_weights(seed, levels)
    errors = errors_of(tmp_path, weights, noise(weights, WARM_UP, seed))
    assert errors.one_step < ONE_STEP_BOUND
    assert errors.free < FREE_BOUND[levels]


@pytest.mark.parametrize("levels", LEVELS)
def test_errors_do_not_add_up_over_an_hour(tmp_path: Path, levels: int) -> None:
    weights = random_weights(1, levels)
    assert errors_of(tmp_path, weights, noise(weights, 3600), free=0).one_step < ONE_STEP_BOUND


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("levels", LEVELS)
def test_steep_models_agree_for_two_steps(tmp_path: Path, levels: int, seed: int) -> None:
    """Most gates are all but shut or open."""
    weights = random_weights(seed, levels, w_sd=3.0, u_sd=2.0)
    assert errors_of(tmp_path, weights, noise(weights, 2, seed), free=0).one_step < STEEP_BOUND


@pytest.mark.parametrize("levels", LEVELS)
def test_without_an_input_it_runs_freely_from_nothing(tmp_path: Path, levels: int) -> None:
    weights = random_weights(1, levels)
    answer = ask_probe(tmp_path, weights, np.empty((0, 4)))
    assert np.array_equal(answer.rows[0], np.clip(weights.head_bias, weights.low, weights.high))
    assert errors_between(answer, ask_reference(weights, np.empty((0, 4)))).free < FREE_BOUND[levels]


@pytest.mark.parametrize("levels", LEVELS)
def test_unused_levels_do_not_matter(tmp_path: Path, levels: int) -> None:
    """Their weights are there, but not their number."""
    deep, flat = random_weights(1, 3), random_weights(1, levels)
    full = bytearray(body_of(replace(flat, levels=flat.levels + deep.levels[levels:])))
    struct.pack_into("<I", full, member_at("levels"), levels)
    inputs = noise(flat, WARM_UP)
    done = start_probe(tmp_path, seal(bytes(full)), inputs, FREE)
    assert done.stdout == start_probe(tmp_path, image_of(flat), inputs, FREE).stdout
    assert done.returncode == 0


@pytest.mark.parametrize("levels", LEVELS)
def test_the_range_is_touched_but_not_always(levels: int) -> None:
    """Or the test of clamping would be none."""
    shares = []
    for seed in SEEDS:
        weights = random_weights(seed, levels)
        rows = ask_reference(weights, noise(weights, WARM_UP, seed)).rows
        shares.append(np.mean((rows == weights.low) | (rows == weights.high)))
    assert 0.05 < np.mean(shares) < 0.9


@pytest.mark.parametrize(
    ("mistake", "levels"),
    [
        pytest.param(mistake, levels, id=f"{mistake.name}-{levels}")
        for mistake in REFERENCE.Mistake
        for levels in LEVELS
        if levels >= mistake.levels_min
    ],
)
def test_a_planted_mistake_is_caught(tmp_path: Path, mistake: Any, levels: int) -> None:
    """By every model if a step shows it, else by one of them: not every rollout touches its range."""
    caught = []
    for seed in SEEDS:
        weights = random_weights(seed, levels)
        inputs = noise(weights, WARM_UP, seed)
        errors = errors_between(ask_probe(tmp_path, weights, inputs), ask_reference(weights, inputs, mistake=mistake))
        if mistake.shows_in_step:
            assert errors.one_step > WIDE * ONE_STEP_BOUND
        else:
            assert errors.one_step < ONE_STEP_BOUND
        caught.append(errors.free > WIDE * FREE_BOUND[levels])
    assert any(caught)


@pytest.mark.parametrize("series", [noise, waves])
@pytest.mark.parametrize(("network", "levels"), [("lstm", 1), ("nlstm", 3)])
def test_shipped_weights_agree(tmp_path: Path, network: str, levels: int, series: Callable[[Any, int], Array]) -> None:
    weights = shipped_weights(network)
    assert len(weights.levels) == levels
    errors = errors_of(tmp_path, weights, series(weights, WARM_UP))
    assert errors.one_step < ONE_STEP_BOUND
    assert errors.free < SHIPPED_FREE_BOUND


def test_tensors_are_read_as_they_were_written(tmp_path: Path) -> None:
    """The reader of shipped weights, on a file of the same names."""
    weights = random_weights(1, 3)
    tensors = {
        "nlstm.head.weight": weights.head_row,
        "nlstm.head.bias": weights.head_bias,
        "range.low": weights.low,
        "range.high": weights.high,
        "ar8.intercept": weights.ar8[:1],
        "ar8.lag": weights.ar8[1:9],
        "ar8.range": weights.ar8[9:],
    }
    for name, level in zip(("outer", "inner1", "inner2"), weights.levels, strict=True):
        tensors[f"nlstm.{name}.weight"] = level.row
        tensors[f"nlstm.{name}.bias"] = level.bias
    header: dict[str, Any] = {"__metadata__": {"made-by": "a test"}}
    data = b""
    for name, tensor in tensors.items():
        content = tensor.astype("<f4").tobytes()
        offsets = [len(data), len(data) + len(content)]
        header[name] = {"dtype": "F32", "shape": list(tensor.shape), "data_offsets": offsets}
        data += content
    text = json.dumps(header).encode()
    path = tmp_path / "weights.safetensors"
    path.write_bytes(struct.pack("<Q", len(text)) + text + data)
    assert image_of(weights_of_tensors(read_safetensors(path), "nlstm")) == image_of(weights)


# --------------------------------------------------------------------------------------------------------------------
# Bad images
# --------------------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def good_body() -> bytes:
    return body_of(random_weights(1, 3))


def expect_refused(folder: Path, image: bytes, fault: str) -> None:
    done = start_probe(folder, image, np.ones((1, 4)), FREE)
    assert done.returncode == 2
    assert done.stdout == b""
    assert done.stderr.decode() == f"lstm_probe: {fault}\n"


HEADER_REGIONS = ((0, NOT_ELMW), (4, OTHER_VERSION), (8, OTHER_LENGTH), (12, BAD_CHECKSUM))
REGIONS = [(f"header+{at}", at, 4, fault) for at, fault in HEADER_REGIONS]
REGIONS += [(member, HEADER_BYTES + member_at(member), 4 * words, BAD_CHECKSUM) for member, words in LAYOUT]


@pytest.mark.parametrize(("begin", "count", "fault"), [pytest.param(*region[1:], id=region[0]) for region in REGIONS])
def test_a_flipped_bit_is_refused(tmp_path: Path, good_body: bytes, begin: int, count: int, fault: str) -> None:
    for at in (begin, begin + count // 2, begin + count - 1):
        for bit in (0, 7):
            image = bytearray(seal(good_body))
            image[at] ^= 1 << bit
            expect_refused(tmp_path, bytes(image), fault)


@pytest.mark.parametrize("length", [0, 3, 4, 15, 16, 17, HEADER_BYTES + BODY_BYTES - 4, HEADER_BYTES + BODY_BYTES - 1])
def test_a_cut_image_is_refused(tmp_path: Path, good_body: bytes, length: int) -> None:
    expect_refused(tmp_path, seal(good_body)[:length], NOT_ELMW if length < HEADER_BYTES else OTHER_LENGTH)


def test_a_longer_image_is_refused(tmp_path: Path, good_body: bytes) -> None:
    expect_refused(tmp_path, seal(good_body) + b"\0", OTHER_LENGTH)
    expect_refused(tmp_path, seal(good_body + bytes(4)), OTHER_LENGTH)
    expect_refused(tmp_path, seal(good_body[:-4]), OTHER_LENGTH)


@pytest.mark.parametrize("version", [0, 1, 3, 0x01000000, 0xFFFFFFFF])
def test_another_version_is_refused(tmp_path: Path, good_body: bytes, version: int) -> None:
    image = bytearray(seal(good_body))
    struct.pack_into("<I", image, 4, version)
    expect_refused(tmp_path, bytes(image), OTHER_VERSION)


@pytest.mark.parametrize("levels", [0, 4, 0x01000000, 0x3F800000, 0xFFFFFFFF])
def test_another_number_of_levels_is_refused(tmp_path: Path, good_body: bytes, levels: int) -> None:
    body = bytearray(good_body)
    struct.pack_into("<I", body, member_at("levels"), levels)
    expect_refused(tmp_path, seal(bytes(body)), BAD_LEVELS)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 1000.5, -1000.5])
@pytest.mark.parametrize("member", [member for member in WORDS if member != "levels"])
def test_a_value_that_is_no_number_or_too_large_is_refused(
    tmp_path: Path, good_body: bytes, member: str, value: float
) -> None:
    words = WORDS[member]
    for word in {0, words // 2, words - 1}:
        body = bytearray(good_body)
        struct.pack_into("<f", body, member_at(member) + 4 * word, value)
        expect_refused(tmp_path, seal(bytes(body)), BAD_CLAMP if member in RANGES else BAD_VALUE)


@pytest.mark.parametrize(("low", "high"), [(1.0, 1.0), (1.5, 1.0), (-0.1, 1.0)])
@pytest.mark.parametrize(("low_member", "high_member", "word"), [("low", "high", 3), ("ar8.low", "ar8.high", 0)])
def test_a_clamp_that_is_no_range_is_refused(
    tmp_path: Path, good_body: bytes, low_member: str, high_member: str, word: int, low: float, high: float
) -> None:
    body = bytearray(good_body)
    struct.pack_into("<f", body, member_at(low_member) + 4 * word, low)
    struct.pack_into("<f", body, member_at(high_member) + 4 * word, high)
    expect_refused(tmp_path, seal(bytes(body)), BAD_CLAMP)
