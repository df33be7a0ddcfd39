# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The long-memory experiment: do three nested levels remember longer than one?

Networks of one, two and three levels with about as many parameters each forecast the demand of long_memory_data.py.
They see one number a minute, the demand, and no clock: what they know of the hour and the day is in their state, which
is carried from the first minute to the last and never reset. All are trained with the same streams, updates, learning
rate and clipping; nothing is chosen by the test weeks. The networks of all seeds are trained side by side.
"""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import optax
from jax import Array

from elmopp_tools.long_memory_data import (
    HORIZONS,
    SEEDS,
    TRAIN_MINUTES,
    Errors,
    Series,
    fit_scale,
    make_demand,
    make_result,
    origins,
    peer_errors,
    rmse,
)
from elmopp_tools.nested_lstm import Parameters, Shape, State, new_parameters, output, step, zero_state

# Widths with which the numbers of parameters lie within 1 % of each other.
SHAPES = {
    f"lstm{levels}": Shape(inputs=1, outputs=len(HORIZONS), units=units, levels=levels)
    for levels, units in ((1, 38), (2, 22), (3, 17))
}

# One setting for all levels. Of the learning rates 0.001, 0.003 and 0.01 it has the one with the lowest mean RMSE at
# 60 minutes over all three levels, on seeds 101 to 103, which are no seeds of the experiment.
# The training weeks are a ring, as they are whole weeks: each stream starts at its own minute and goes round and round.
STREAMS = 32
WINDOW = 360  # minutes through which gradients go back; the state goes on
UPDATES = 672  # each stream goes four times round
LEARNING_RATE = 1e-2  # at the start; a half cosine leads to 0
CLIP_NORM = 1.0

# State, parameters and the optimizer's memory.
Progress = tuple[State, Parameters, optax.OptState]


def make_optimizer() -> optax.GradientTransformation:
    schedule = optax.cosine_decay_schedule(LEARNING_RATE, UPDATES)
    return optax.chain(optax.clip_by_global_norm(CLIP_NORM), optax.adam(schedule))


def run_through(parameters: Parameters, state: State, given: Array) -> tuple[State, Array]:
    """Given [minutes, batch], scaled demand; the state afterwards and the forecasts [minutes, batch, HORIZONS]."""

    def minute(before: State, now: Array) -> tuple[State, Array]:
        after = step(parameters, before, now[:, None])
        return after, output(parameters, after)

    after: State
    after, forecasts = jax.lax.scan(minute, state, given)
    return after, forecasts


def window_loss(parameters: Parameters, state: State, scaled: Array, at: Array) -> tuple[Array, State]:
    """The mean square error in the minutes `at` [WINDOW, STREAMS] of the training weeks, and the state afterwards.

    A minute whose forecast is for after the training weeks does not count.
    """
    after, forecasts = run_through(parameters, state, scaled[at])
    due = at[..., None] + jnp.asarray(HORIZONS)
    counts = due < TRAIN_MINUTES
    errors = jnp.where(counts, forecasts - scaled[due % TRAIN_MINUTES], 0.0)
    return jnp.sum(errors**2) / jnp.sum(counts), after


def train(shape: Shape, key: Array, scaled: Array) -> Parameters:
    """Scaled demand of the training weeks [TRAIN_MINUTES]."""
    optimizer = make_optimizer()
    starts = jnp.arange(STREAMS) * (TRAIN_MINUTES // STREAMS)

    def update(progress: Progress, number: Array) -> tuple[Progress, None]:
        state, parameters, memory = progress
        at = (starts + number * WINDOW + jnp.arange(WINDOW)[:, None]) % TRAIN_MINUTES
        gradients, after = jax.grad(window_loss, has_aux=True)(parameters, state, scaled, at)
        changes, memory = optimizer.update(gradients, memory)
        return (after, optax.apply_updates(parameters, changes), memory), None

    parameters = new_parameters(key, shape)
    progress = (zero_state(shape, STREAMS), parameters, optimizer.init(parameters))
    trained: Parameters
    (_, trained, _), _ = jax.lax.scan(update, progress, jnp.arange(UPDATES))
    return trained


def train_and_forecast(shape: Shape, key: Array, scaled: Array) -> Array:
    """Scaled demand of all weeks [MINUTES]; forecasts made in each minute [MINUTES, HORIZONS], in the same scale."""
    parameters = train(shape, key, scaled[:TRAIN_MINUTES])
    _, forecasts = run_through(parameters, zero_state(shape, 1), scaled[:, None])
    return forecasts[:, 0]


def network_errors(shape: Shape, demands: list[Series]) -> Errors:
    scales = [fit_scale(demand) for demand in demands]
    scaled = jnp.asarray(np.stack([scale.apply(demand) for scale, demand in zip(scales, demands, strict=True)]))
    keys = jnp.stack([jax.random.key(seed) for seed in SEEDS])
    one_seed = jax.jit(jax.vmap(lambda key, series: train_and_forecast(shape, key, series)))
    found = np.asarray(one_seed(keys, scaled), dtype=np.float64)
    return {
        str(horizon): [
            rmse(demand, scale.undo(forecasts[origins(horizon), place]))
            for demand, scale, forecasts in zip(demands, scales, found, strict=True)
        ]
        for place, horizon in enumerate(HORIZONS)
    }


def run() -> dict[str, Any]:
    """The whole experiment; see make_result for what comes back."""
    demands = [make_demand(seed) for seed in SEEDS]
    errors = {name: network_errors(shape, demands) for name, shape in SHAPES.items()}
    parameters = {name: shape.parameter_count() for name, shape in SHAPES.items()}
    return make_result(parameters, errors | peer_errors(demands))
