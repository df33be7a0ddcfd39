# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The command behind tools/train: trains everything that is learned, and writes what came of it."""

import argparse
import json
import multiprocessing
import os
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import Any

import numpy as np
from safetensors.numpy import load_file, save

from elmopp_tools.inflow_data import (
    EVALUATION_SEED,
    TRAINING_SEED,
    VALIDATION_SEED,
    InflowError,
    Series,
    clamp,
    fit_ar8,
    trajectories,
)
from elmopp_tools.outputs import EXIT_DONE, EXIT_REFUSED, OneLineParser, Outputs, say, why_not_writable, write
from elmopp_tools.weights_model import NETWORKS, Tensor, WeightsError, check_tensors, level_name

ROOT = Path(__file__).resolve().parents[2]
HOST_SIM = ROOT / "build" / "release" / "bin" / "host_sim"

TRAINING_TRIALS = 384
VALIDATION_TRIALS = 24
EVALUATION_TRIALS = 30
UPDATES = {"lstm": 8000, "nlstm": 4000, "ann": 8000, "gcn": 8000}
PARTS = ("forecast", "paper", "long-memory")

# One processor core a part, and the same order of every sum whatever the machine has.
XLA_FLAGS = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"

DESCRIPTION = """\
Trains the networks and writes into the folder weights:

  forecast.safetensors   forecast: the networks lstm, nlstm, ann and gcn, their clamp, the regression ar8; on the
                         traffic of host_sim inflow with seeds that no evaluation uses
  paper_variant.json     paper: errors of the paper's windowed variant, trained as in the paper on the points before
                         second 0 of each evaluation trial
  long_memory.json       long-memory: networks of 1, 2 and 3 levels on eight weeks of made-up demand

Then tools/weights makes the C files and tools/accuracy the tables. Takes a quarter of an hour on two cores."""

EPILOG = """\
Exit codes: 0 done; 2 the request cannot be run, with one line that says what and what would be right.

Examples:
  tools/train                                  everything, into weights/
  tools/train --only forecast --out weights    one part
  tools/train --only forecast --network ann    one network; the others stay as weights/forecast.safetensors has them"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    options = _parser().parse_args(arguments)
    os.environ["XLA_FLAGS"] = XLA_FLAGS
    try:
        return _run(options)
    except (WeightsError, InflowError) as error:
        say("train", str(error))
    except OSError as error:
        say("train", f"{error.filename}: {error.strerror} ; a file that can be read or written")
    return EXIT_REFUSED


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(
        prog="tools/train",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument(
        "--out", type=Path, default=ROOT / "weights", metavar="DIR", help="folder to write to (weights)"
    )
    parser.add_argument("--only", choices=PARTS, action="append", help="only this part; may be given more than once")
    parser.add_argument(
        "--network",
        choices=list(UPDATES),
        action="append",
        help="of forecast only this network, the others kept as the file in the folder has them; may be given more"
        " than once",
    )
    parser.add_argument(
        "--host-sim", type=Path, default=HOST_SIM, metavar="FILE", help="the simulator (preset release)"
    )
    return parser


def _run(options: argparse.Namespace) -> int:
    parts = options.only or PARTS
    if options.network and "forecast" not in parts:
        raise WeightsError(f"--network {options.network[0]} without part forecast", "both, or neither")
    names = {"forecast": "forecast.safetensors", "paper": "paper_variant.json", "long-memory": "long_memory.json"}
    for part in parts:
        reason = why_not_writable(options.out / names[part])
        if reason is not None:
            raise WeightsError(f"{reason[0]} ({options.out / names[part]})", reason[1])
    if parts != ["long-memory"] and not options.host_sim.exists():
        raise WeightsError(f"there is no {options.host_sim}", "cmake --workflow --preset release, or --host-sim FILE")
    if parts != ["long-memory"]:
        trajectories(options.host_sim, TRAINING_SEED, 1)  # what is wrong with it is said before anything is trained
    networks = options.network or list(UPDATES)
    kept = kept_tensors(options.out / names["forecast"], networks) if "forecast" in parts else {}
    trained = train_side_by_side(options.host_sim, parts, networks)
    outputs: Outputs = {}
    if "forecast" in parts:
        outputs[options.out / names["forecast"]] = safetensors_bytes(options.host_sim, kept | trained)
    for part in ("paper", "long-memory"):
        if part in parts:
            outputs[options.out / names[part]] = (json.dumps(trained[part], indent=1) + "\n").encode("ascii")
    write(outputs)
    return EXIT_DONE


def kept_tensors(file: Path, trained: Sequence[str]) -> dict[str, dict[str, Tensor]]:
    """The networks of a file that are not trained anew."""
    kept = [name for name in UPDATES if name not in trained]
    if not kept:
        return {}
    tensors = load_file(file)
    found = {name: {key: values for key, values in tensors.items() if key.startswith(f"{name}.")} for name in kept}
    for name, members in found.items():
        if not members:
            raise WeightsError(f"{file} has no network {name} to keep", f"--network {name} too, or no --network")
    return found


def train_side_by_side(host_sim: Path, parts: Sequence[str], networks: Sequence[str]) -> dict[str, Any]:
    """The results of every job of these parts, one process and one core each."""
    jobs: dict[str, Callable[[Path], Any]] = {}
    if "forecast" in parts:
        every = {"nlstm": train_nlstm, "lstm": train_lstm, "gcn": train_gcn, "ann": train_ann}
        jobs |= {name: job for name, job in every.items() if name in networks}
    if "long-memory" in parts:
        jobs["long-memory"] = run_long_memory
    if "paper" in parts:
        jobs["paper"] = run_paper
    results: dict[str, Any] = {}
    started = time.monotonic()
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(min(len(jobs), len(os.sched_getaffinity(0))), mp_context=spawn) as pool:
        running = {pool.submit(job, host_sim): name for name, job in jobs.items()}
        for done in as_completed(running):
            results[running[done]] = done.result()
            print(f"train: {running[done]} done after {time.monotonic() - started:.0f} s", flush=True)
    return results


def train_lstm(host_sim: Path) -> dict[str, Tensor]:
    return train_network("lstm", host_sim)


def train_nlstm(host_sim: Path) -> dict[str, Tensor]:
    return train_network("nlstm", host_sim)


def train_ann(host_sim: Path) -> dict[str, Tensor]:
    return train_windows("ann", host_sim)


def train_gcn(host_sim: Path) -> dict[str, Tensor]:
    return train_windows("gcn", host_sim)


def train_windows(name: str, host_sim: Path) -> dict[str, Tensor]:
    """The tensors of a network that sees windows, named as in the file."""
    from elmopp_tools.train_windows import train_window, window_rmse

    series = trajectories(host_sim, TRAINING_SEED, TRAINING_TRIALS)
    bounds = window_clamp(name, *clamp(series))
    values = train_window(name, UPDATES[name], series, bounds, _progress(name))
    _say_validation(name, window_rmse(name, values, trajectories(host_sim, VALIDATION_SEED, VALIDATION_TRIALS), bounds))
    return {f"{name}.{member}": np.ascontiguousarray(tensor, dtype=np.float32) for member, tensor in values.items()}


def window_clamp(name: str, low: Series, high: Series) -> tuple[Series, Series]:
    """That of each approach, but one for all of the nodes of gcn, which share their weights: the regression's."""
    return (low, high) if name == "ann" else (np.full_like(low, low.min()), np.full_like(high, high.max()))


def _progress(name: str) -> Callable[[str], None]:
    return lambda line: print(f"train: {name}: {line}", flush=True)


def _say_validation(name: str, errors: dict[int, float]) -> None:
    print(
        f"train: {name}: validation RMSE " + ", ".join(f"{h} s {value:.4f}" for h, value in errors.items()), flush=True
    )


def train_network(name: str, host_sim: Path) -> dict[str, Tensor]:
    """The tensors of one network, named as in the file."""
    from elmopp_tools.nested_lstm import Shape
    from elmopp_tools.train_forecast import Course, rmse, train

    series = trajectories(host_sim, TRAINING_SEED, TRAINING_TRIALS)
    shape = Shape(inputs=4, outputs=4, units=16, levels=NETWORKS[name])
    parameters = train(Course(shape, UPDATES[name]), series, clamp(series), _progress(name))
    errors = rmse(parameters, shape, trajectories(host_sim, VALIDATION_SEED, VALIDATION_TRIALS), clamp(series))
    _say_validation(name, errors)
    tensors: dict[str, Tensor] = {}
    named = {"head": parameters.head} | {level_name(k): level for k, level in enumerate(parameters.levels)}
    for part, level in named.items():
        for what, values in level.items():
            tensors[f"{name}.{part}.{what}"] = np.ascontiguousarray(values, dtype=np.float32)
    return tensors


def run_paper(host_sim: Path) -> dict[str, Any]:
    from elmopp_tools import train_paper

    series = trajectories(host_sim, EVALUATION_SEED, EVALUATION_TRIALS)
    errors = train_paper.rmse(series)
    return {"trials": EVALUATION_TRIALS, "seed": EVALUATION_SEED, "window_s": train_paper.WINDOW_S, "rmse": errors}


def run_long_memory(_: Path) -> dict[str, Any]:
    from elmopp_tools.long_memory import run

    return run()


def safetensors_bytes(host_sim: Path, trained: dict[str, Any]) -> bytes:
    """The checked file: the networks and what is fitted to the same data."""
    series = trajectories(host_sim, TRAINING_SEED, TRAINING_TRIALS)
    low, high = clamp(series)
    intercept, lag = fit_ar8(series)
    tensors: dict[str, Tensor] = {
        "range.low": low,
        "range.high": high,
        "ar8.intercept": np.array([intercept], np.float32),
        "ar8.lag": lag,
        "ar8.range": np.array([low.min(), high.max()], np.float32),
    }
    for name in UPDATES:
        tensors |= trained[name]
    check_tensors(tensors)
    return save(tensors)
