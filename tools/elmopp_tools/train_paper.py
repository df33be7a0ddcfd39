# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The paper's own variant, for a row of the accuracy table: one network a trial, trained on windows of that trial.

16 units, a linear head with 4 outputs, 100 epochs, batches of 10, Adam 1e-3, mean squared error, forget bias 1,
orthogonal recurrent weights, gradient clip 1.0 (paper, appendix, "LSTM Prediction Model"); the window is 8 s, the paper
gives none. Each network sees the 8,000 points before second 0 of its own trial and starts every window from an empty
state. For a free run its output becomes the window's newest second. All trials are trained side by side.
"""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import optax
from jax import Array

from elmopp_tools.inflow_data import CLAMP_WIDENING, EVALUATED_S, TRAINING_POINTS, Series
from elmopp_tools.nested_lstm import Parameters, Shape, new_parameters, output, step, zero_state

SHAPE = Shape(inputs=4, outputs=4, units=16, levels=1)
WINDOW_S = 8
EPOCHS = 100
BATCH = 10
LEARNING_RATE = 1e-3
GRADIENT_NORM = 1.0
HORIZONS_S = (1, 10, 30, 60)
OPTIMIZER = optax.chain(optax.clip_by_global_norm(GRADIENT_NORM), optax.adam(LEARNING_RATE))


def next_second(parameters: Parameters, window: Array) -> Array:
    """What is said after a window [second, sample, input], from an empty state: [sample, output]."""
    state = zero_state(SHAPE, window.shape[1])
    for second in window:
        state = step(parameters, state, second)
    return output(parameters, state)


def epoch(
    parameters: Parameters, memory: optax.OptState, key: Array, known: Array
) -> tuple[Parameters, optax.OptState]:
    """Every window of known [second, input] once, in random order."""
    windows = known.shape[0] - WINDOW_S
    order = jax.random.permutation(key, windows)[: windows // BATCH * BATCH].reshape(-1, BATCH)

    def update(
        carried: tuple[Parameters, optax.OptState], starts: Array
    ) -> tuple[tuple[Parameters, optax.OptState], None]:
        parameters, memory = carried
        batch = known[starts[None, :] + jnp.arange(WINDOW_S + 1)[:, None]]

        def error(parameters: Parameters) -> Array:
            return jnp.mean((next_second(parameters, batch[:WINDOW_S]) - batch[WINDOW_S]) ** 2)

        change, memory = OPTIMIZER.update(jax.grad(error)(parameters), memory)
        return (optax.apply_updates(parameters, change), memory), None

    return jax.lax.scan(update, (parameters, memory), order)[0]


def free_run(parameters: Parameters, window: Array, low: Array, high: Array) -> Array:
    """[step, sample, output] from windows [second, sample, input]."""

    def advance(window: Array, _: None) -> tuple[Array, Array]:
        said = jnp.clip(next_second(parameters, window), low, high)
        return jnp.concatenate([window[1:], said[None]]), said

    return jax.lax.scan(advance, window, None, length=HORIZONS_S[-1])[1]


def squared_errors(parameters: Parameters, trial: Array) -> Array:
    """Mean squared error of one trial [second, input] at each horizon, over all simulated seconds."""
    known = trial[:TRAINING_POINTS]
    widening = CLAMP_WIDENING * (known.max(axis=0) - known.min(axis=0))
    low, high = jnp.maximum(known.min(axis=0) - widening, 0.0), known.max(axis=0) + widening
    now = TRAINING_POINTS + jnp.arange(EVALUATED_S)
    window = trial[now[None, :] + jnp.arange(1 - WINDOW_S, 1)[:, None]]
    said = free_run(parameters, window, low, high)
    return jnp.stack([jnp.mean((said[h - 1] - trial[now + h]) ** 2) for h in HORIZONS_S])


def rmse(series: Series, epochs: int = EPOCHS, seed: int = 0) -> dict[str, float]:
    """Trains a network for each trial of series [trial, second, input]; their pooled errors by horizon in seconds."""
    trials = jnp.asarray(series)
    for_weights, for_order = jax.random.split(jax.random.key(seed))
    parameters = jax.vmap(partial(new_parameters, shape=SHAPE))(jax.random.split(for_weights, len(trials)))
    memory = jax.vmap(OPTIMIZER.init)(parameters)
    every_trial = jax.jit(jax.vmap(epoch))
    for key in jax.random.split(for_order, epochs):
        keys = jax.random.split(key, len(trials))
        parameters, memory = every_trial(parameters, memory, keys, trials[:, :TRAINING_POINTS])
    # One trial at a time: side by side their windows would take gigabytes.
    judge = jax.jit(squared_errors)
    errors = [judge(jax.tree.map(lambda part, k=k: part[k], parameters), trial) for k, trial in enumerate(trials)]
    pooled = np.sqrt(np.mean(np.asarray(errors), axis=0))
    return {str(h): float(value) for h, value in zip(HORIZONS_S, pooled, strict=True)}
