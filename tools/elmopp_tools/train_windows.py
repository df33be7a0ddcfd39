# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Trains the networks that see windows, on the stretches, horizons and rates of the LSTMs (train_forecast.py).

The window is the end of what an LSTM would have absorbed. The loss is the mean squared error of the free run plus that
of its first second; the gradient runs through all of it.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from elmopp_tools.inflow_data import EVALUATED_S, TRAINING_POINTS, Series
from elmopp_tools.train_forecast import HORIZONS_S, WARM_S, Say, descend
from elmopp_tools.window_networks import WINDOW_NETWORKS, Values, free_run, new_values

STRIDE_S = 10


def train_window(name: str, updates: int, series: Series, clamp: tuple[Series, Series], say: Say) -> Values:
    """One of WINDOW_NETWORKS on series [trajectory, second, input]; the same on the same processor."""
    network = WINDOW_NETWORKS[name]
    bounds = (jnp.asarray(clamp[0]), jnp.asarray(clamp[1]))
    key, for_weights = jax.random.split(jax.random.key(0))

    def error(values: Values, batch: Array, horizon_s: int) -> Array:
        said = free_run(network, values, batch[WARM_S - network.window_s : WARM_S], horizon_s, bounds)
        wrong = (said - batch[WARM_S : WARM_S + horizon_s]) ** 2
        return jnp.mean(wrong) + jnp.mean(wrong[0])

    return descend(error, new_values(for_weights, name), key, updates, series, say)


def window_rmse(name: str, values: Values, series: Series, clamp: tuple[Series, Series]) -> dict[int, float]:
    """Of the free run at 1, 10, 30 and 60 s, over every tenth of the evaluated seconds: a glance after training."""
    network = WINDOW_NETWORKS[name]
    seconds = np.arange(TRAINING_POINTS, TRAINING_POINTS + EVALUATED_S, STRIDE_S)
    places = seconds[None, :] - np.arange(network.window_s)[::-1, None]
    windows = np.moveaxis(series[:, places], 0, 2).reshape(network.window_s, -1, series.shape[2])
    bounds = (jnp.asarray(clamp[0]), jnp.asarray(clamp[1]))
    run = jax.jit(lambda window: free_run(network, values, window, HORIZONS_S[-1], bounds))
    said = np.asarray(run(jnp.asarray(windows)))

    def error(ahead_s: int) -> float:
        came = np.moveaxis(series[:, seconds + ahead_s], 0, 1).reshape(-1, series.shape[2])
        return float(np.sqrt(np.mean((said[ahead_s - 1] - came) ** 2)))

    return {ahead_s: error(ahead_s) for ahead_s in (1, 10, 30, 60)}
