# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The generated traffic as tools/train sees it: trajectories of `host_sim inflow` in units of their demand scale."""

import io
import os
import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import numpy.typing as npt

TRAINING_POINTS = 8000  # before second 0: what a forecast may know beforehand
EVALUATED_S = 2000
TRAJECTORY_POINTS = 10150

# The evaluation uses small seeds (1 by default). These are never evaluated.
TRAINING_SEED = 4_000_000_000
VALIDATION_SEED = 4_000_000_001
EVALUATION_SEED = 1

CLAMP_WIDENING = 0.1


class InflowError(Exception):
    """The simulator did not give its traffic; the text is the one line that the user sees."""


Series = npt.NDArray[np.float32]  # [trajectory, second, approach]


def trajectories(host_sim: Path, seed: int, count: int) -> Series:
    """Arrivals of `count` trials in units of the demand scale, the mean of the training points."""
    with ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        vehicles = list(pool.map(lambda trial: _vehicles(host_sim, seed, trial), range(count)))
    stacked = np.stack(vehicles)
    scaled: Series = (stacked / stacked[:, :TRAINING_POINTS].mean(axis=1, keepdims=True)).astype(np.float32)
    return scaled


def _vehicles(host_sim: Path, seed: int, trial: int) -> npt.NDArray[np.float64]:
    command = [str(host_sim), "inflow", "--seed", str(seed), "--trial", str(trial)]
    command += ["--points", str(TRAJECTORY_POINTS), "--csv", "-"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    rows = done.stdout.splitlines()[1:]
    if done.returncode != 0 or len(rows) != TRAJECTORY_POINTS:
        said = (done.stderr.strip() or "no message").splitlines()[-1]
        raise InflowError(
            f"{host_sim} inflow gave {len(rows)} points: {said} ; right would be host_sim of preset release"
        )
    return np.loadtxt(io.StringIO("\n".join(rows)), delimiter=",")[:, 1:]


def clamp(series: Series) -> tuple[Series, Series]:
    """Lowest and highest value of each approach, widened by a tenth of the range, never below 0."""
    low, high = series.min(axis=(0, 1)), series.max(axis=(0, 1))
    widening = CLAMP_WIDENING * (high - low)
    return np.maximum(low - widening, 0.0).astype(np.float32), (high + widening).astype(np.float32)


def fit_ar8(series: Series) -> tuple[float, Series]:
    """Intercept and eight lags, newest first, by least squares over all trajectories and approaches at once."""
    lags = 8
    flat = np.moveaxis(series.astype(np.float64), 2, 1).reshape(-1, series.shape[1])
    columns = [flat[:, lags - 1 - lag : flat.shape[1] - 1 - lag].ravel() for lag in range(lags)]
    design = np.stack([np.ones_like(columns[0]), *columns], axis=1)
    # The lags of a smooth flow are nearly collinear: a decomposition, not the normal equations.
    solution = np.linalg.lstsq(design, flat[:, lags:].ravel(), rcond=None)[0]
    return float(solution[0]), solution[1:].astype(np.float32)
