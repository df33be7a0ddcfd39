# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Trains the shipped networks: stateful, on sequences, by what they say when they run on their own output.

A sample is a stretch of one trajectory. The network absorbs WARM_S seconds, then runs freely over the horizon. The loss
is the mean squared error of the free run plus that of the next second during the later part of the absorption; the
gradient runs through all of it. The horizon grows during the training. What is fed back is held in the clamp as the
firmware holds it; the gradient passes the clamp as if it were not there.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TypeVar

import jax
import jax.numpy as jnp
import numpy as np
import optax
from jax import Array

from elmopp_tools.inflow_data import Series
from elmopp_tools.nested_lstm import Parameters, Shape, State, new_parameters, output, step, zero_state

WARM_S = 96
LOSS_AFTER_S = 40  # the state has to settle before its errors count
HORIZONS_S = (10, 20, 40, 60)
BATCH = 128
UPDATES_A_CALL = 50
LEARNING_RATE = 5e-3
LAST_RATE_SHARE = 0.01
GRADIENT_NORM = 1.0

Say = Callable[[str], None]
P = TypeVar("P")  # everything that is trained of a network


@dataclass(frozen=True)
class Course:
    """How long a network is trained."""

    shape: Shape
    updates: int
    seed: int = 0


def free_run(parameters: Parameters, state: State, steps: int, low: Array, high: Array) -> Array:
    """What the network says on its own output: [step, batch, output]."""

    def advance(before: State, _: None) -> tuple[State, Array]:
        said = output(parameters, before)
        held = said + jax.lax.stop_gradient(jnp.clip(said, low, high) - said)
        return step(parameters, before, held), held

    return jax.lax.scan(advance, state, None, length=steps)[1]


def absorb(parameters: Parameters, state: State, given: Array) -> tuple[State, Array]:
    """Sees given [second, batch, input]; returns the state and what was said after each second."""

    def advance(before: State, now: Array) -> tuple[State, Array]:
        after = step(parameters, before, now)
        return after, output(parameters, after)

    return jax.lax.scan(advance, state, given)


def loss(parameters: Parameters, given: Array, shape: Shape, horizon_s: int, low: Array, high: Array) -> Array:
    """Of one batch [second, sample, input]."""
    state, said = absorb(parameters, zero_state(shape, given.shape[1]), given[:WARM_S])
    following = given[LOSS_AFTER_S + 1 : WARM_S + 1]
    free = free_run(parameters, state, horizon_s, low, high)
    free_error = jnp.mean((free - given[WARM_S : WARM_S + horizon_s]) ** 2)
    return free_error + jnp.mean((said[LOSS_AFTER_S:] - following) ** 2)


def draw(key: Array, series: Array) -> Array:
    """A batch of stretches: [second, sample, input]."""
    length = WARM_S + HORIZONS_S[-1] + 1
    which, where = jax.random.split(key)
    trajectory = jax.random.randint(which, (BATCH,), 0, series.shape[0])
    start = jax.random.randint(where, (BATCH,), 0, series.shape[1] - length)
    return series[trajectory[None, :], start[None, :] + jnp.arange(length)[:, None]]


def train(course: Course, series: Series, clamp: tuple[Series, Series], say: Say) -> Parameters:
    """Trains one network on series [trajectory, second, input]; float32 throughout, the same on the same processor."""
    low, high = (jnp.asarray(bound) for bound in clamp)
    key, for_weights = jax.random.split(jax.random.key(course.seed))
    parameters = new_parameters(for_weights, course.shape, head_bias=1.0)

    def error(parameters: Parameters, batch: Array, horizon_s: int) -> Array:
        return loss(parameters, batch, course.shape, horizon_s, low, high)

    return descend(error, parameters, key, course.updates, series, say)


def descend(
    error: Callable[[P, Array, int], Array], parameters: P, key: Array, updates: int, series: Series, say: Say
) -> P:
    """Adam on batches of stretches; `error` is that of (parameters, batch, horizon)."""
    data = jnp.asarray(series)
    rate = optax.cosine_decay_schedule(LEARNING_RATE, updates, alpha=LAST_RATE_SHARE)
    optimizer = optax.chain(optax.clip_by_global_norm(GRADIENT_NORM), optax.adam(rate))
    memory = optimizer.init(parameters)

    @partial(jax.jit, static_argnames="horizon_s")
    def many_updates(
        parameters: P, memory: optax.OptState, key: Array, horizon_s: int
    ) -> tuple[P, optax.OptState, Array]:
        def update(carried: tuple[P, optax.OptState], key: Array) -> tuple[tuple[P, optax.OptState], Array]:
            parameters, memory = carried
            now, gradient = jax.value_and_grad(error)(parameters, draw(key, data), horizon_s)
            change, memory = optimizer.update(gradient, memory)
            return (optax.apply_updates(parameters, change), memory), now

        (parameters, memory), errors = jax.lax.scan(update, (parameters, memory), jax.random.split(key, UPDATES_A_CALL))
        return parameters, memory, jnp.mean(errors)

    calls = updates // UPDATES_A_CALL
    for call in range(calls):
        key, now = jax.random.split(key)
        # Five eighths of the updates see the whole horizon, the first three eighths shorter ones.
        horizon_s = HORIZONS_S[min(8 * call // calls, len(HORIZONS_S) - 1)]
        parameters, memory, last = many_updates(parameters, memory, now, horizon_s)
        if call % 10 == 9:
            say(f"{(call + 1) * UPDATES_A_CALL} updates, horizon {horizon_s} s, loss {float(last):.5f}")
    return parameters


def rmse(parameters: Parameters, shape: Shape, series: Series, clamp: tuple[Series, Series]) -> dict[int, float]:
    """Of the free run at 1, 10, 30 and 60 s, over every tenth of the evaluated seconds: a glance after training."""
    low, high = (jnp.asarray(bound) for bound in clamp)
    stride, first, known_s = 10, 8000, 900
    given = jnp.swapaxes(jnp.asarray(series), 0, 1)

    @jax.jit
    def forecasts(parameters: Parameters, given: Array) -> Array:
        state, _ = absorb(parameters, zero_state(shape, given.shape[1]), given[first - known_s : first])

        def advance(before: State, now: Array) -> tuple[State, State]:
            after = step(parameters, before, now)
            return after, after

        _, states = jax.lax.scan(advance, state, given[first : first + 2000])
        kept = jax.tree.map(lambda part: part[::stride].reshape(-1, shape.units), states)
        return free_run(parameters, kept, HORIZONS_S[-1], low, high)

    said = np.asarray(forecasts(parameters, given)).reshape(HORIZONS_S[-1], -1, series.shape[0], series.shape[2])
    seconds = np.arange(first, first + 2000, stride)
    true = np.asarray(given)
    return {h: float(np.sqrt(np.mean((said[h - 1] - true[seconds + h]) ** 2))) for h in (1, 10, 30, 60)}
