# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""Independent reference of the ELMOPP traffic-light experiment.

This file is written from the equations of the paper (F. Sheriff, "ELMOPP: An Application of Graph Theory and
Machine Learning to Traffic Light Coordination") and from the written specification of the experiment. It stands
independent of the C implementation on purpose: it shares no code, no tables and no intermediate files with it, so
that agreement between the two is evidence. It favours plainness over speed and uses float64 throughout.

Words: an approach is the paper's inroad, a movement is its subedge, a stage is its configuration.

The inflow is hyperchaotic: over a trajectory a rounding error grows by a factor of about 1e13 (median; up to 1e15).
Agreement to many digits in the simulated seconds therefore needs bit-identical trajectories, that is, the same order
of operations:

* derivatives `a * (y - x) - e * w`, `x * z - h * y`, `b - x * y - c * z`, `k * y - d * w`, left to right;
* Euler `s + step * k1`;
* RK4 midpoints `s + (0.5 * step) * k`, end point `s + step * k3`, and the step
  `s + (step / 6.0) * (k1 + 2.0 * k2 + 2.0 * k3 + k4)`, left to right;
* no fused multiply-add.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Literal, TypedDict

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]
State = tuple[float, float, float, float]

# --------------------------------------------------------------------------------------------------------------------
# Constants of the experiment
# --------------------------------------------------------------------------------------------------------------------

APPROACH_COUNT = 4  # N, E, S, W
LANES_PER_APPROACH = 3  # left, middle, right
LANE_COUNT = APPROACH_COUNT * LANES_PER_APPROACH

POINT_COUNT = 10_150
TRAINING_POINT_COUNT = 8_000
FIRST_SIMULATED_POINT = 8_000
SIMULATED_POINT_COUNT = 2_000
INTEGRATOR_STEP = 0.01
DIVERGENCE_LIMIT = 1e6

CAPACITY_VEH = 1000.0 / 3.0
INITIAL_QUEUE_VEH = 200.0 / 3.0
FREE_FLOW_SPEED = 10.0
JAM_DENSITY = 1.0
SATURATION_FLOW_VEH_PER_S = 0.5

STARTUP_FACTORS = (0.0, 0.5)  # share of the discharge in the first and second second of green
STARTUP_LOSS_S = 1.5

AR_ORDER = 8
CLAMP_WIDENING = 0.1
CONSERVATION_TOLERANCE_VEH = 1e-6
PARCEL_TOLERANCE_VEH = 1e-9

FIXED_GREEN_S = 20
FIXED_STAGE_COUNT = 4
ITLC_GREEN_MIN_S = 5.0
ITLC_GREEN_MAX_S = 60.0
OAF_GREEN_MIN_S = 1.0
OAF_GREEN_MAX_S = 60.0
PRESSURE_T_MIN_S = 5
PRESSURE_T_MAX_S = 120
PRESSURE_HYSTERESIS = 3.0


def lane_index(approach: str, movement: str) -> int:
    """Index 3 * approach + movement, approaches N E S W, movements L M R."""
    return LANES_PER_APPROACH * "NESW".index(approach) + "LMR".index(movement)


def _stage(*lanes: str) -> tuple[int, ...]:
    return tuple(lane_index(lane[0], lane[1]) for lane in lanes)


STAGES: tuple[tuple[int, ...], ...] = (
    _stage("NL", "SL"),
    _stage("NM", "NR", "SM", "SR"),
    _stage("EL", "WL"),
    _stage("EM", "ER", "WM", "WR"),
    _stage("NL", "NM", "NR"),
    _stage("EL", "EM", "ER"),
    _stage("SL", "SM", "SR"),
    _stage("WL", "WM", "WR"),
)
STAGE_COUNT = len(STAGES)


def stage_lanes(stage: int | None) -> BoolArray:
    """Mask of the lanes that a stage shows green; none without a stage."""
    mask = np.zeros(LANE_COUNT, dtype=np.bool_)
    if stage is not None:
        mask[list(STAGES[stage])] = True
    return mask


# --------------------------------------------------------------------------------------------------------------------
# Random initial conditions and the hyperchaotic flow
# --------------------------------------------------------------------------------------------------------------------

MASK64 = (1 << 64) - 1


class SplitMix64:
    """SplitMix64 of Steele, Lea and Flood."""

    def __init__(self, state: int) -> None:
        self.state = state & MASK64

    def next_u64(self) -> int:
        self.state = (self.state + 0x9E3779B97F4A7C15) & MASK64
        mixed = self.state
        mixed = ((mixed ^ (mixed >> 30)) * 0xBF58476D1CE4E5B9) & MASK64
        mixed = ((mixed ^ (mixed >> 27)) * 0x94D049BB133111EB) & MASK64
        return mixed ^ (mixed >> 31)

    def next_unit(self) -> float:
        """Uniform in [0, 1) with 53 bits."""
        return float(self.next_u64() >> 11) * 2.0**-53


A, B, C, D, E, H, K = 5.0, 20.0, 1.0, 0.1, 20.6, 1.0, 0.1
Integrator = Literal["rk4", "euler"]


def derivative(state: State) -> State:
    """The hyperchaotic system of the paper's appendix."""
    x, y, z, w = state
    return (A * (y - x) - E * w, x * z - H * y, B - x * y - C * z, K * y - D * w)


def jacobian(state: State) -> Array:
    x, y, z, _ = state
    return np.array([[-A, A, 0.0, -E], [z, -H, x, 0.0], [-y, -x, -C, 0.0], [0.0, K, 0.0, -D]])


def _advance(state: State, scale: float, slope: State) -> State:
    return (
        state[0] + scale * slope[0],
        state[1] + scale * slope[1],
        state[2] + scale * slope[2],
        state[3] + scale * slope[3],
    )


def euler_step(state: State, step: float = INTEGRATOR_STEP) -> State:
    return _advance(state, step, derivative(state))


def _rk4_mean_slope_times_six(k1: State, k2: State, k3: State, k4: State) -> State:
    return (
        k1[0] + 2.0 * k2[0] + 2.0 * k3[0] + k4[0],
        k1[1] + 2.0 * k2[1] + 2.0 * k3[1] + k4[1],
        k1[2] + 2.0 * k2[2] + 2.0 * k3[2] + k4[2],
        k1[3] + 2.0 * k2[3] + 2.0 * k3[3] + k4[3],
    )


def rk4_step(state: State, step: float = INTEGRATOR_STEP) -> State:
    k1 = derivative(state)
    k2 = derivative(_advance(state, 0.5 * step, k1))
    k3 = derivative(_advance(state, 0.5 * step, k2))
    k4 = derivative(_advance(state, step, k3))
    return _advance(state, step / 6.0, _rk4_mean_slope_times_six(k1, k2, k3, k4))


STEPPERS: dict[str, Callable[[State], State]] = {"rk4": rk4_step, "euler": euler_step}


def integrate(start: State, point_count: int = POINT_COUNT, integrator: Integrator = "rk4") -> Array | None:
    """Points 0 (the start itself) to point_count - 1; None when the trajectory leaves the allowed range."""
    stepper = STEPPERS[integrator]
    points = np.empty((point_count, APPROACH_COUNT))
    state = start
    for index in range(point_count):
        if not all(abs(value) <= DIVERGENCE_LIMIT for value in state):  # also catches not-a-number
            return None
        points[index] = state
        state = stepper(state)
    return points


@lru_cache(maxsize=64)
def draw_trajectory(seed: int, trial: int, integrator: Integrator = "rk4") -> Array:
    """The trajectory of one trial; diverging ones are redrawn from the same stream. The result is read-only."""
    stream = SplitMix64((seed << 32) + trial)
    while True:
        start = (stream.next_unit(), stream.next_unit(), stream.next_unit(), stream.next_unit())
        points = integrate(start, integrator=integrator)
        if points is not None:
            points.flags.writeable = False
            return points


def _rk4_tangent_step(state: State, tangent: Array, step: float) -> tuple[State, Array]:
    k1 = derivative(state)
    s2 = _advance(state, 0.5 * step, k1)
    k2 = derivative(s2)
    s3 = _advance(state, 0.5 * step, k2)
    k3 = derivative(s3)
    s4 = _advance(state, step, k3)
    k4 = derivative(s4)
    m1 = jacobian(state) @ tangent
    m2 = jacobian(s2) @ (tangent + 0.5 * step * m1)
    m3 = jacobian(s3) @ (tangent + 0.5 * step * m2)
    m4 = jacobian(s4) @ (tangent + step * m3)
    next_state = _advance(state, step / 6.0, _rk4_mean_slope_times_six(k1, k2, k3, k4))
    return next_state, tangent + (step / 6.0) * (m1 + 2.0 * m2 + 2.0 * m3 + m4)


def _euler_tangent_step(state: State, tangent: Array, step: float) -> tuple[State, Array]:
    return euler_step(state, step), tangent + step * (jacobian(state) @ tangent)


def lyapunov_exponents(
    integrator: Integrator = "rk4",
    start: State = (0.5, 0.5, 0.5, 0.5),
    transient_step_count: int = 20_000,
    step_count: int = 200_000,
    steps_per_qr: int = 10,
    step: float = INTEGRATOR_STEP,
) -> list[float]:
    """Exponents per unit of flow time of the *discrete* map, by repeated QR of the tangent map; largest first."""
    tangent_step = _rk4_tangent_step if integrator == "rk4" else _euler_tangent_step
    stepper = STEPPERS[integrator]
    state = start
    for _ in range(transient_step_count):
        state = stepper(state)
    tangent = np.eye(APPROACH_COUNT)
    log_growth = np.zeros(APPROACH_COUNT)
    block_count = step_count // steps_per_qr
    for _ in range(block_count):
        for _ in range(steps_per_qr):
            state, tangent = tangent_step(state, tangent, step)
        tangent, upper = np.linalg.qr(tangent)
        log_growth += np.log(np.abs(np.diag(upper)))
    exponents = log_growth / (block_count * steps_per_qr * step)
    return sorted((float(value) for value in exponents), reverse=True)


# --------------------------------------------------------------------------------------------------------------------
# Inflow
# --------------------------------------------------------------------------------------------------------------------

Mapping = Literal["abs", "shift", "raw"]
Scope = Literal["per_inroad", "total"]


def scale_inflow(points: Array, vehicles: float, mapping: Mapping = "abs", scope: Scope = "per_inroad") -> Array:
    """Inflow in vehicles per second of all points; component i feeds approach i.

    The sum over the simulated points is `vehicles` an approach (`per_inroad`) or a quarter of it (`total`). `shift`
    subtracts the minimum over the simulated points (the window of the normalisation), so that training points may
    come out negative; `raw` returns the states themselves, unscaled, for the comparison of trajectories.
    """
    if mapping == "raw":
        return points.copy()
    window = slice(FIRST_SIMULATED_POINT, FIRST_SIMULATED_POINT + SIMULATED_POINT_COUNT)
    magnitude = np.abs(points) if mapping == "abs" else points - points[window].min(axis=0)
    approach_vehicles = vehicles if scope == "per_inroad" else vehicles / APPROACH_COUNT
    scaled: Array = magnitude * approach_vehicles / magnitude[window].sum(axis=0)
    return scaled


# --------------------------------------------------------------------------------------------------------------------
# Load, urgency, kernel, discharge
# --------------------------------------------------------------------------------------------------------------------


def load(quantity_veh: npt.ArrayLike, capacity_veh: npt.ArrayLike) -> Array:
    """Hadamard quotient Q / C; zero where the capacity is zero."""
    quantity = np.asarray(quantity_veh, dtype=np.float64)
    capacity = np.broadcast_to(np.asarray(capacity_veh, dtype=np.float64), quantity.shape)
    quotient = np.zeros(quantity.shape)
    np.divide(quantity, capacity, out=quotient, where=capacity != 0.0)
    return quotient


def time_factor(red_s: npt.ArrayLike, t_max_s: int, printed_sign: bool = False) -> Array:
    """exp(T / t_max - 1), or exp(1 - T / t_max) with the sign as printed."""
    exponent = np.asarray(red_s, dtype=np.float64) / t_max_s - 1.0
    return np.asarray(np.exp(-exponent if printed_sign else exponent), dtype=np.float64)


def urgency(lane_load: npt.ArrayLike, red_s: npt.ArrayLike, t_max_s: int = 60, printed_sign: bool = False) -> Array:
    """Naive urgency of equation 2."""
    return np.asarray(lane_load, dtype=np.float64) * time_factor(red_s, t_max_s, printed_sign)


def kernel(t_max_s: int) -> Array:
    """Triangle weights k_t = 2 (1 / t_max - t / t_max^2), t = 0 .. t_max."""
    steps = np.arange(t_max_s + 1, dtype=np.float64)
    return 2.0 * (1.0 / t_max_s - steps / (t_max_s * t_max_s))


def cumulative_urgencies(
    queue_veh: Array,
    red_s: Array,
    green: BoolArray,
    future_veh: Array,
    t_max_s: int,
    constant_t: bool = False,
    printed_sign: bool = False,
    capacity_veh: float = CAPACITY_VEH,
) -> Array:
    """Cumulative urgency of every lane.

    `future_veh[lane, t]` is the sum of the forecast inflow of the next t seconds (t = 0 .. t_max, zero at t = 0).
    """
    future_load = load(np.minimum(queue_veh[:, None] + future_veh, capacity_veh), capacity_veh)
    elapsed_s = np.zeros(t_max_s + 1) if constant_t else np.arange(t_max_s + 1, dtype=np.float64)
    lane_red_s = np.where(green[:, None], 0.0, red_s[:, None] + elapsed_s[None, :])
    terms = kernel(t_max_s)[None, :] * urgency(future_load, lane_red_s, t_max_s, printed_sign)
    return np.asarray(terms.sum(axis=1), dtype=np.float64)


def cumulative_urgency(
    queue_veh: float,
    red_s: float,
    inflow_veh_per_s: Sequence[float] = (),
    t_max_s: int = 60,
    green: bool = False,
    constant_t: bool = False,
    printed_sign: bool = False,
    capacity_veh: float = CAPACITY_VEH,
) -> float:
    """Cumulative urgency of one lane; inflow_veh_per_s[0] is the forecast of the next second, missing ones are 0."""
    steps = np.zeros(t_max_s + 1)
    known = np.asarray(inflow_veh_per_s, dtype=np.float64)[:t_max_s]
    steps[1 : 1 + len(known)] = known
    result = cumulative_urgencies(
        np.array([queue_veh]),
        np.array([red_s]),
        np.array([green]),
        np.cumsum(steps)[None, :],
        t_max_s,
        constant_t,
        printed_sign,
        capacity_veh,
    )
    return float(result[0])


def greenshields(queue_veh: npt.ArrayLike, capacity_veh: float = CAPACITY_VEH, nolock: bool = False) -> Array:
    """Discharge in vehicles per second, q = k v_f (1 - k / k_j), never more than the queue."""
    queue = np.asarray(queue_veh, dtype=np.float64)
    density = queue / capacity_veh
    if nolock:
        density = np.minimum(density, 0.5)
    flow = density * FREE_FLOW_SPEED * (1.0 - density / JAM_DENSITY)
    return np.asarray(np.minimum(flow, queue), dtype=np.float64)


def saturation_discharge(queue_veh: npt.ArrayLike) -> Array:
    queue = np.asarray(queue_veh, dtype=np.float64)
    return np.asarray(np.minimum(queue, SATURATION_FLOW_VEH_PER_S), dtype=np.float64)


# --------------------------------------------------------------------------------------------------------------------
# Profiles and options
# --------------------------------------------------------------------------------------------------------------------

DischargeName = Literal["greenshields", "nolock", "saturation"]
ChooserName = Literal["naive", "cumulative", "pressure", "itlc", "oaf", "fixed"]
ForecastName = Literal["none", "mean", "persistence", "ar8", "oracle"]
# The T of the literal rule: seconds since the stage was last active (Algorithm 1); the same with T = 0 for lanes that
# are green at the moment; or seconds since the lane was last green (equation 2).
LiteralClock = Literal["stage", "stage_green_zero", "lane"]
CHOOSERS: tuple[ChooserName, ...] = ("naive", "cumulative", "pressure", "itlc", "oaf", "fixed")
FORECASTS: tuple[ForecastName, ...] = ("none", "mean", "persistence", "ar8", "oracle")


@dataclass(frozen=True)
class Settings:
    """Everything that a profile or an option can change."""

    integrator: Integrator = "rk4"
    mapping: Mapping = "abs"
    scope: Scope = "per_inroad"
    split: tuple[float, float, float] = (1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0)
    initial_queue_veh: float = INITIAL_QUEUE_VEH
    discharge: DischargeName = "greenshields"
    t_min_s: int = 10
    t_max_s: int = 60
    literal_rule: bool = False  # argmax each second, no hold window
    literal_clock: LiteralClock = "stage"  # used with literal_rule only
    frozen: bool = False
    hysteresis: float = 1.0
    constant_t: bool = False
    printed_sign: bool = False
    ready_veh: float = 30.0
    platoon_veh: float = 10.0


PROFILES: dict[str, Settings] = {
    "paper": Settings(),
    "literal": Settings(integrator="euler", t_min_s=1, literal_rule=True),
    "figure": Settings(scope="total", t_min_s=5, t_max_s=20),
    "saturation": Settings(discharge="saturation", initial_queue_veh=0.0),
}


def settings_for(profile: str, chooser: ChooserName) -> Settings:
    """Profile settings with the defaults of the chooser on top."""
    settings = PROFILES[profile]
    if chooser == "pressure":
        settings = replace(settings, t_min_s=PRESSURE_T_MIN_S, t_max_s=PRESSURE_T_MAX_S, hysteresis=PRESSURE_HYSTERESIS)
    if profile == "literal" and chooser == "cumulative":
        settings = replace(settings, printed_sign=True, constant_t=True)
    return settings


def discharge_rate(queue_veh: Array, discharge: DischargeName) -> Array:
    """Discharge of lanes that are green and past their start-up, vehicles per second."""
    if discharge == "saturation":
        return saturation_discharge(queue_veh)
    return greenshields(queue_veh, nolock=discharge == "nolock")


# --------------------------------------------------------------------------------------------------------------------
# Forecasts (they depend on the inflow only, so they are computed for all seconds at once)
# --------------------------------------------------------------------------------------------------------------------


def fit_ar(training: Array, order: int = AR_ORDER) -> Array:
    """Least squares of one approach: [intercept, weight of lag 1, .. weight of lag `order`]."""
    count = len(training)
    columns = [np.ones(count - order)]
    columns += [training[order - lag : count - lag] for lag in range(1, order + 1)]
    coefficients = np.linalg.lstsq(np.column_stack(columns), training[order:], rcond=None)[0]
    return np.asarray(coefficients, dtype=np.float64)


def clamp_range(training: Array) -> tuple[float, float]:
    """Training range widened by 10 % on both sides, not below zero."""
    low, high = float(training.min()), float(training.max())
    widening = CLAMP_WIDENING * (high - low)
    return max(0.0, low - widening), high + widening


def forecast_ar(series: Array, seconds: int, horizon_s: int) -> Array:
    """Iterated AR forecast of one approach, [second, step]; each prediction is clamped and fed back."""
    training = series[:TRAINING_POINT_COUNT]
    coefficients = fit_ar(training)
    low, high = clamp_range(training)
    newest = FIRST_SIMULATED_POINT + np.arange(seconds)
    lags = np.stack([series[newest - lag] for lag in range(AR_ORDER)], axis=1)  # newest first
    result = np.empty((seconds, horizon_s))
    for step in range(horizon_s):
        prediction = np.clip(coefficients[0] + lags @ coefficients[1:], low, high)
        result[:, step] = prediction
        lags = np.column_stack([prediction, lags[:, :-1]])
    return result


def forecast_inflow(inflow: Array, forecast: ForecastName, seconds: int, horizon_s: int) -> Array:
    """Forecast inflow [second, step - 1, approach] in vehicles per second, steps 1 .. horizon ahead."""
    shape = (seconds, horizon_s, APPROACH_COUNT)
    if forecast == "none":
        return np.zeros(shape)
    if forecast == "mean":
        return np.broadcast_to(inflow[:TRAINING_POINT_COUNT].mean(axis=0), shape).copy()
    now = FIRST_SIMULATED_POINT + np.arange(seconds)
    if forecast == "persistence":
        return np.broadcast_to(inflow[now][:, None, :], shape).copy()
    if forecast == "oracle":
        return np.asarray(inflow[now[:, None] + np.arange(1, horizon_s + 1)[None, :]], dtype=np.float64)
    per_approach = [forecast_ar(inflow[:, approach], seconds, horizon_s) for approach in range(APPROACH_COUNT)]
    return np.stack(per_approach, axis=2)


def future_lane_vehicles(
    inflow: Array, forecast: ForecastName, seconds: int, t_max_s: int, split: Sequence[float]
) -> Array:
    """Vehicles forecast to arrive within the next t seconds, [second, lane, t], t = 0 .. t_max.

    The weight of the kernel at t = t_max is zero, so t_max - 1 forecasts matter; the last one repeats the sum.
    """
    steps = forecast_inflow(inflow, forecast, seconds, t_max_s - 1)
    sums = np.zeros((seconds, t_max_s + 1, APPROACH_COUNT))
    sums[:, 1:t_max_s, :] = np.cumsum(steps, axis=1)
    sums[:, t_max_s, :] = sums[:, t_max_s - 1, :]
    return lanes_from_approaches(sums, split).transpose(0, 2, 1)


def lanes_from_approaches(values: Array, split: Sequence[float]) -> Array:
    """Splits the last axis (approach) over left, middle and right."""
    spread = values[..., :, None] * np.asarray(split, dtype=np.float64)
    return np.asarray(spread.reshape(*values.shape[:-1], LANE_COUNT), dtype=np.float64)


# --------------------------------------------------------------------------------------------------------------------
# World
# --------------------------------------------------------------------------------------------------------------------


class ArrivalClock:
    """First-in first-out arrival times of the fluid of one lane (inside and outside queue together)."""

    def __init__(self, initial_veh: float) -> None:
        self.parcels: deque[tuple[int, float]] = deque()
        self.add(0, initial_veh)

    def add(self, arrival_s: int, amount_veh: float) -> None:
        if amount_veh > 0.0:
            self.parcels.append((arrival_s, amount_veh))

    def remove(self, amount_veh: float) -> None:
        left_veh = amount_veh
        while self.parcels:
            arrival_s, parcel_veh = self.parcels[0]
            if parcel_veh - left_veh > PARCEL_TOLERANCE_VEH:
                self.parcels[0] = (arrival_s, parcel_veh - left_veh)
                return
            self.parcels.popleft()
            left_veh = max(0.0, left_veh - parcel_veh)

    def head_arrival_s(self, now_s: int) -> int:
        return self.parcels[0][0] if self.parcels else now_s


@dataclass
class World:
    """Queues, clocks and signal of the intersection."""

    settings: Settings
    queue_veh: Array = field(init=False)
    outside_veh: Array = field(init=False)
    red_s: Array = field(init=False)  # seconds since the lane was last green
    stage_idle_s: Array = field(init=False)  # seconds since the stage was last active
    green_age_s: Array = field(init=False)  # seconds since the lane turned green, in green lanes
    clocks: list[ArrivalClock] = field(init=False)
    now_s: int = 0
    stage: int | None = None
    elapsed_s: int = 0  # ticks since the activation of the stage
    switches: int = 0

    def __post_init__(self) -> None:
        self.queue_veh = np.full(LANE_COUNT, self.settings.initial_queue_veh)
        self.outside_veh = np.zeros(LANE_COUNT)
        self.red_s = np.zeros(LANE_COUNT)
        self.stage_idle_s = np.zeros(STAGE_COUNT)
        self.green_age_s = np.zeros(LANE_COUNT)
        self.clocks = [ArrivalClock(self.settings.initial_queue_veh) for _ in range(LANE_COUNT)]

    def arrive(self, arrived_veh: Array) -> None:
        self.outside_veh = self.outside_veh + arrived_veh
        entering_veh = np.minimum(self.outside_veh, CAPACITY_VEH - self.queue_veh)
        self.queue_veh = self.queue_veh + entering_veh
        self.outside_veh = self.outside_veh - entering_veh
        for clock, amount_veh in zip(self.clocks, arrived_veh.tolist(), strict=True):
            clock.add(self.now_s, amount_veh)

    def rate(self) -> Array:
        return discharge_rate(self.queue_veh, self.settings.discharge)

    def show(self, stage: int, restart: bool) -> None:
        """Activates a stage. `restart` restarts the elapsed time of a stage that follows itself."""
        previous = stage_lanes(self.stage)
        current = stage_lanes(stage)
        self.green_age_s = np.where(current & previous, self.green_age_s + 1.0, 0.0)
        changed = stage != self.stage
        if changed and self.stage is not None:
            self.switches += 1
        self.elapsed_s = 0 if changed or restart else self.elapsed_s
        self.stage = stage

    def discharge(self) -> Array:
        factor = np.ones(LANE_COUNT)
        for age_s, share in enumerate(STARTUP_FACTORS):
            factor[self.green_age_s == age_s] = share
        factor[~stage_lanes(self.stage)] = 0.0
        out_veh = self.rate() * factor
        self.queue_veh = self.queue_veh - out_veh
        for clock, amount_veh in zip(self.clocks, out_veh.tolist(), strict=True):
            if amount_veh > 0.0:
                clock.remove(amount_veh)
        return out_veh

    def update_clocks(self) -> None:
        self.red_s = np.where(stage_lanes(self.stage), 0.0, self.red_s + 1.0)
        self.stage_idle_s = self.stage_idle_s + 1.0
        if self.stage is not None:
            self.stage_idle_s[self.stage] = 0.0

    def next_tick(self) -> None:
        self.now_s += 1
        self.elapsed_s += 1


# --------------------------------------------------------------------------------------------------------------------
# Choosers
# --------------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Decision:
    """What a chooser decided in one tick.

    margin is the smallest gap between two scores whose order decided the tick (None when scores decided nothing, for
    instance before t_min); margin_relative is the same gap over the larger of the two. rounding_gap is the smallest
    distance to a threshold other than an order of scores: the argument of a ceiling to a whole second, or a queue
    to the one vehicle that OAF asks for.
    """

    stage: int
    score: list[float]
    margin: float | None = None
    margin_relative: float | None = None
    restart: bool = False
    rounding_gap: float | None = None


def stage_sums(lane_values: Sequence[float]) -> list[float]:
    """Sum over the lanes of each stage, in the order in which the stage lists them."""
    return [float(sum(lane_values[lane] for lane in lanes)) for lanes in STAGES]


def best_stage(score: Sequence[float], candidates: Sequence[int]) -> int:
    """Largest score, ties to the lowest index."""
    return max(sorted(candidates), key=lambda stage: score[stage])


def order_gaps(winner: float, losers: Sequence[float]) -> list[tuple[float, float]]:
    """(gap, relative gap) of a winner to each loser."""
    gaps = []
    for loser in losers:
        gap, size = abs(winner - loser), max(abs(winner), abs(loser))
        gaps.append((gap, gap / size if size > 0.0 else 0.0))
    return gaps


def decision(
    stage: int,
    score: list[float],
    gaps: Sequence[tuple[float, float]] = (),
    restart: bool = False,
    rounding_gap: float | None = None,
) -> Decision:
    if not gaps:
        return Decision(stage, score, restart=restart, rounding_gap=rounding_gap)
    return Decision(stage, score, min(gap[0] for gap in gaps), min(gap[1] for gap in gaps), restart, rounding_gap)


def pick_best(score: list[float], candidates: Sequence[int]) -> tuple[int, list[tuple[float, float]]]:
    """Best candidate and its gaps to all the others."""
    best = best_stage(score, candidates)
    return best, order_gaps(score[best], [score[stage] for stage in candidates if stage != best])


def others(active: int | None) -> list[int]:
    return [stage for stage in range(STAGE_COUNT) if stage != active]


class Chooser:
    """Decides the stage of the next second from the observed world."""

    def __init__(self, settings: Settings) -> None:
        self.settings = settings

    def decide(self, world: World) -> Decision:
        raise NotImplementedError


class UrgencyChooser(Chooser):
    """Naive and cumulative urgency with the hold window, or the literal rule without it."""

    def __init__(self, settings: Settings, future_veh: Array | None) -> None:
        super().__init__(settings)
        self.future_veh = future_veh  # [second, lane, t]; None for the naive urgency
        self.score_at_activation = 0.0

    def lane_urgencies(self, world: World, red_s: Array, green: BoolArray) -> Array:
        settings = self.settings
        if self.future_veh is None:
            return urgency(
                load(world.queue_veh, CAPACITY_VEH),
                np.where(green, 0.0, red_s),
                settings.t_max_s,
                settings.printed_sign,
            )
        return cumulative_urgencies(
            world.queue_veh,
            red_s,
            green,
            self.future_veh[world.now_s],
            settings.t_max_s,
            settings.constant_t,
            settings.printed_sign,
        )

    def scores(self, world: World) -> list[float]:
        clock = self.settings.literal_clock if self.settings.literal_rule else "lane"
        lanes_green = stage_lanes(world.stage)
        if clock == "lane":
            return stage_sums(self.lane_urgencies(world, world.red_s, lanes_green).tolist())
        result = []
        for stage in range(STAGE_COUNT):
            clock_s = np.full(LANE_COUNT, world.stage_idle_s[stage])
            green = lanes_green if clock == "stage_green_zero" else np.full(LANE_COUNT, stage == world.stage)
            result.append(stage_sums(self.lane_urgencies(world, clock_s, green).tolist())[stage])
        return result

    def decide(self, world: World) -> Decision:
        score = self.scores(world)
        if world.stage is None:
            result = decision(*self._first(score))
        elif self.settings.literal_rule:
            result = self._literal(score, world.stage)
        else:
            result = self._hold_window(score, world.stage, world.elapsed_s)
        if result.stage != world.stage:
            self.score_at_activation = score[result.stage]
        return result

    def _first(self, score: list[float]) -> tuple[int, list[float], list[tuple[float, float]]]:
        best, gaps = pick_best(score, range(STAGE_COUNT))
        return best, score, gaps

    def _literal(self, score: list[float], active: int) -> Decision:
        best, gaps = pick_best(score, range(STAGE_COUNT))
        return decision(active if score[active] == score[best] else best, score, gaps)

    def _hold_window(self, score: list[float], active: int, elapsed_s: int) -> Decision:
        if elapsed_s < self.settings.t_min_s:
            return decision(active, score)
        best, gaps = pick_best(score, others(active))
        if elapsed_s >= self.settings.t_max_s:
            return decision(best, score, gaps)
        own = self.score_at_activation if self.settings.frozen else score[active]
        hold_gap = order_gaps(score[best], [self.settings.hysteresis * own])
        if score[best] > self.settings.hysteresis * own:
            return decision(best, score, gaps + hold_gap)
        return decision(active, score, hold_gap)


class PressureChooser(Chooser):
    """Sum of Q_j q_j over the movements, with hysteresis."""

    def decide(self, world: World) -> Decision:
        score = stage_sums((world.queue_veh * world.rate()).tolist())
        best, gaps = pick_best(score, range(STAGE_COUNT))
        active = world.stage
        if active is None:
            return decision(best, score, gaps)
        if world.elapsed_s < self.settings.t_min_s:
            return decision(active, score)
        if world.elapsed_s >= self.settings.t_max_s:
            return decision(best, score, gaps)
        bar = self.settings.hysteresis * score[active]
        if score[best] > bar:
            return decision(best, score, gaps + order_gaps(score[best], [bar]))
        return decision(active, score, order_gaps(score[best], [bar]))


def clearing_time_s(quantity_veh: float, rate_veh_per_s: float) -> float:
    """Time for a quantity at a constant rate; 0 for nothing, infinite when nothing flows."""
    if quantity_veh <= 0.0:
        return 0.0
    return quantity_veh / rate_veh_per_s if rate_veh_per_s > 0.0 else math.inf


def green_seconds(raw_s: float, low_s: float, high_s: float) -> tuple[int, float | None]:
    """ceil(clamp(raw)) and the distance of the clamped value to a jump of the ceiling (None when clamped)."""
    clamped_s = min(max(raw_s, low_s), high_s)
    gap_s = abs(clamped_s - round(clamped_s)) if low_s < raw_s < high_s else None
    return math.ceil(clamped_s), gap_s


class PhaseChooser(Chooser):
    """Choosers that fix the green time when a phase starts and decide again at its end."""

    def __init__(self, settings: Settings) -> None:
        super().__init__(settings)
        self.green_s = 0

    def start_phase(self, world: World) -> Decision:
        raise NotImplementedError

    def phase_scores(self, world: World) -> list[float]:
        raise NotImplementedError

    def decide(self, world: World) -> Decision:
        if world.stage is not None and world.elapsed_s < self.green_s:
            return decision(world.stage, self.phase_scores(world))
        return self.start_phase(world)


class ItlcChooser(PhaseChooser):
    """Most vehicles in the ready area; green until the last of them has left."""

    def ready_veh(self, world: World) -> Array:
        return np.asarray(np.minimum(world.queue_veh, self.settings.ready_veh), dtype=np.float64)

    def phase_scores(self, world: World) -> list[float]:
        return stage_sums(self.ready_veh(world).tolist())

    def start_phase(self, world: World) -> Decision:
        score = self.phase_scores(world)
        best, gaps = pick_best(score, range(STAGE_COUNT))
        ready_veh, rate = self.ready_veh(world).tolist(), world.rate().tolist()
        raw_s = max(clearing_time_s(ready_veh[lane], rate[lane]) for lane in STAGES[best])
        if best != world.stage:
            raw_s += STARTUP_LOSS_S
        self.green_s, gap_s = green_seconds(raw_s, ITLC_GREEN_MIN_S, ITLC_GREEN_MAX_S)
        return decision(best, score, gaps, restart=True, rounding_gap=gap_s)


class OafChooser(PhaseChooser):
    """The lane with the oldest head picks the stage; green for one platoon."""

    def head_ages_s(self, world: World) -> list[float]:
        """Age of the head of each lane with at least one vehicle; zero in the others."""
        ages = []
        for lane, queue_veh in enumerate(world.queue_veh.tolist()):
            age_s = world.now_s - world.clocks[lane].head_arrival_s(world.now_s)
            ages.append(float(age_s) if queue_veh >= 1.0 else 0.0)
        return ages

    def phase_scores(self, world: World) -> list[float]:
        return stage_sums(self.head_ages_s(world))

    def start_phase(self, world: World) -> Decision:
        score, ages_s = self.phase_scores(world), self.head_ages_s(world)
        queue_veh, rate = world.queue_veh.tolist(), world.rate().tolist()
        threshold_gap = min(abs(quantity - 1.0) for quantity in queue_veh)
        eligible = [lane for lane in range(LANE_COUNT) if queue_veh[lane] >= 1.0]
        if not eligible:
            self.green_s = 1
            return decision(world.stage or 0, score, restart=True, rounding_gap=threshold_gap)
        oldest = max(eligible, key=lambda lane: ages_s[lane])
        best, gaps = pick_best(score, [stage for stage in range(STAGE_COUNT) if oldest in STAGES[stage]])
        raw_s = clearing_time_s(min(self.settings.platoon_veh, queue_veh[oldest]), rate[oldest])
        if best != world.stage:
            raw_s += STARTUP_LOSS_S
        self.green_s, gap_s = green_seconds(raw_s, OAF_GREEN_MIN_S, OAF_GREEN_MAX_S)
        rounding_gap = threshold_gap if gap_s is None else min(threshold_gap, gap_s)
        return decision(best, score, gaps, restart=True, rounding_gap=rounding_gap)


class FixedChooser(Chooser):
    """Stages 0, 1, 2, 3 for 20 s each, then again."""

    def decide(self, world: World) -> Decision:
        return decision(world.now_s // FIXED_GREEN_S % FIXED_STAGE_COUNT, [0.0] * STAGE_COUNT)


def make_chooser(
    chooser: ChooserName, forecast: ForecastName, settings: Settings, inflow: Array, seconds: int
) -> Chooser:
    if chooser == "naive":
        return UrgencyChooser(settings, None)
    if chooser == "cumulative":
        future_veh = future_lane_vehicles(inflow, forecast, seconds, settings.t_max_s, settings.split)
        return UrgencyChooser(settings, future_veh)
    simple: dict[str, type[Chooser]] = {
        "pressure": PressureChooser,
        "itlc": ItlcChooser,
        "oaf": OafChooser,
        "fixed": FixedChooser,
    }
    return simple[chooser](settings)


# --------------------------------------------------------------------------------------------------------------------
# Simulation
# --------------------------------------------------------------------------------------------------------------------


class TickRecord(TypedDict):
    """One simulated second. Queues and red times are those at the end of the tick; scores those of the decision."""

    t_s: int
    stage: int
    queue_veh: list[float]
    outside_veh: list[float]
    red_s: list[float]
    out_veh: list[float]
    arrived: list[float]
    score: list[float]
    margin: float | None
    margin_relative: float | None
    rounding_gap: float | None


class Metrics(TypedDict):
    """vehicles_in counts the initial vehicles and the arrivals: in = out + queued + outside."""

    throughput_veh_per_s: float
    served_share: float
    mean_delay_s: float
    longest_red_s: float
    switches: int
    figure_throughput_veh_per_s: float
    vehicles_in: float
    vehicles_out: float
    vehicles_queued: float
    vehicles_outside: float


@dataclass
class Result:
    records: list[TickRecord]
    metrics: Metrics


@dataclass
class Tally:
    """Running sums of the metrics."""

    vehicles_in: float
    vehicles_out: float = 0.0
    out_squared: float = 0.0
    delay_veh_s: float = 0.0
    longest_red_s: float = 0.0

    def add(self, world: World, arrived_veh: Array, out_veh: Array) -> None:
        out_total = float(out_veh.sum())
        waiting_veh = float(world.queue_veh.sum() + world.outside_veh.sum())
        self.vehicles_in += float(arrived_veh.sum())
        self.vehicles_out += out_total
        self.out_squared += out_total * out_total
        self.delay_veh_s += waiting_veh
        occupied_red_s = world.red_s[world.queue_veh >= 1.0]
        if len(occupied_red_s) > 0:
            self.longest_red_s = max(self.longest_red_s, float(occupied_red_s.max()))
        imbalance_veh = self.vehicles_in - self.vehicles_out - waiting_veh
        assert abs(imbalance_veh) <= CONSERVATION_TOLERANCE_VEH, f"{imbalance_veh} vehicles lost at {world.now_s} s"
        assert float(world.queue_veh.min()) >= 0.0, "negative queue"

    def metrics(self, world: World, seconds: int) -> Metrics:
        return Metrics(
            throughput_veh_per_s=self.vehicles_out / seconds,
            served_share=self.vehicles_out / self.vehicles_in,
            mean_delay_s=self.delay_veh_s / self.vehicles_in,
            longest_red_s=self.longest_red_s,
            switches=world.switches,
            figure_throughput_veh_per_s=self.out_squared / self.vehicles_out if self.vehicles_out > 0.0 else 0.0,
            vehicles_in=self.vehicles_in,
            vehicles_out=self.vehicles_out,
            vehicles_queued=float(world.queue_veh.sum()),
            vehicles_outside=float(world.outside_veh.sum()),
        )


def _record(world: World, arrived_veh: Array, out_veh: Array, choice: Decision) -> TickRecord:
    return TickRecord(
        t_s=world.now_s,
        stage=choice.stage,
        queue_veh=world.queue_veh.tolist(),
        outside_veh=world.outside_veh.tolist(),
        red_s=world.red_s.tolist(),
        out_veh=out_veh.tolist(),
        arrived=arrived_veh.tolist(),
        score=choice.score,
        margin=choice.margin,
        margin_relative=choice.margin_relative,
        rounding_gap=choice.rounding_gap,
    )


def simulate(
    profile: str = "paper",
    chooser: ChooserName = "naive",
    forecast: ForecastName = "none",
    vehicles: float = 800.0,
    seed: int = 1,
    trial: int = 0,
    seconds: int = SIMULATED_POINT_COUNT,
    settings: Settings | None = None,
) -> Result:
    """One trial. `settings` replaces those of the profile and chooser altogether."""
    if not 0 < seconds <= SIMULATED_POINT_COUNT:
        raise ValueError(f"seconds must be 1 .. {SIMULATED_POINT_COUNT}")
    if settings is None:
        settings = settings_for(profile, chooser)
    if settings.mapping == "raw":
        raise ValueError("mapping raw gives signed states, not an inflow")
    points = draw_trajectory(seed, trial, settings.integrator)
    inflow = scale_inflow(points, vehicles, settings.mapping, settings.scope)
    policy = make_chooser(chooser, forecast, settings, inflow, seconds)
    lane_inflow = lanes_from_approaches(inflow[FIRST_SIMULATED_POINT : FIRST_SIMULATED_POINT + seconds], settings.split)
    world = World(settings)
    tally = Tally(vehicles_in=float(world.queue_veh.sum()))
    records = []
    for arrived_veh in lane_inflow:
        world.arrive(arrived_veh)
        choice = policy.decide(world)
        world.show(choice.stage, choice.restart)
        out_veh = world.discharge()
        world.update_clocks()
        tally.add(world, arrived_veh, out_veh)
        records.append(_record(world, arrived_veh, out_veh, choice))
        world.next_tick()
    return Result(records, tally.metrics(world, seconds))


# --------------------------------------------------------------------------------------------------------------------
# Golden values
# --------------------------------------------------------------------------------------------------------------------

# The worked example of the paper (G_alpha): its eight edges, row by row, left / middle / right each, and one edge
# without any lane.
PAPER_QUANTITY = [[0, 2, 3], [0, 6, 4], [0, 0, 3], [2, 0, 1], [2, 1, 3], [4, 5, 4], [7, 7, 7], [3, 2, 0], [0, 0, 0]]
PAPER_CAPACITY = [[0, 4, 4], [3, 9, 6], [0, 0, 7], [3, 2, 4], [3, 5, 3], [7, 8, 9], [9, 8, 7], [4, 5, 5], [0, 0, 0]]
PAPER_LOAD: list[list[float]] = [
    [0, 1 / 2, 3 / 4],
    [0, 2 / 3, 2 / 3],
    [0, 0, 3 / 7],
    [2 / 3, 0, 1 / 4],
    [2 / 3, 1 / 5, 1],
    [4 / 7, 5 / 8, 4 / 9],
    [7 / 9, 7 / 8, 1],
    [3 / 4, 2 / 5, 0],
    [0, 0, 0],
]

EULER_GOLDEN: dict[int, State] = {
    1: (0.397, 0.4975, 0.6925, 0.5),
    2: (0.299025, 0.495274225, 0.883599925, 0.4999975),
    3: (0.20583797625, 0.492963667426, 1.073282932, 0.499992776725),
}
RK4_GOLDEN: dict[int, State] = {
    1: (0.399474343969, 0.497673865425, 0.691798337064, 0.499998813459),
    3: (0.212568219908, 0.493018381771, 1.07114087054, 0.499989663749),
}


def _assert_close(actual: npt.ArrayLike, expected: npt.ArrayLike, tolerance: float, what: str) -> None:
    error = float(np.max(np.abs(np.asarray(actual, dtype=np.float64) - np.asarray(expected, dtype=np.float64))))
    assert error <= tolerance, f"{what}: off by {error:.3g}"


def _test_integrators() -> None:
    for integrator, golden in (("rk4", RK4_GOLDEN), ("euler", EULER_GOLDEN)):
        state: State = (0.5, 0.5, 0.5, 0.5)
        for step in range(1, 4):
            state = STEPPERS[integrator](state)
            if step in golden:
                _assert_close(state, golden[step], 6e-12, f"{integrator} step {step}")


def _test_discharge() -> None:
    queues_veh = [200.0 / 3.0, 250.0, CAPACITY_VEH]
    _assert_close(greenshields(queues_veh), [1.6, 1.875, 0.0], 1e-12, "greenshields")
    _assert_close(greenshields(queues_veh, nolock=True), [1.6, 2.5, 2.5], 1e-12, "greenshields nolock")


def _test_urgency() -> None:
    golden = [0.0735758882, 0.2, 0.5436563657, 0.3032653299]
    _assert_close(urgency([0.2, 0.2, 0.2, 0.5], [0, 60, 120, 30], 60), golden, 6e-11, "naive urgency")
    _assert_close(kernel(4), [0.5, 0.375, 0.25, 0.125, 0.0], 1e-15, "kernel")
    for t_max_s in (4, 20, 60, 120):
        _assert_close(kernel(t_max_s).sum(), 1.0 + 1.0 / t_max_s, 1e-13, "sum of the kernel")
    queue_veh = 0.2 * CAPACITY_VEH
    _assert_close(cumulative_urgency(queue_veh, 10), 0.12630332, 6e-9, "growing T")
    _assert_close(cumulative_urgency(queue_veh, 10, constant_t=True), 0.08836830, 6e-9, "constant T")
    printed = cumulative_urgency(queue_veh, 10, constant_t=True, printed_sign=True)
    _assert_close(printed, 0.46786510, 6e-9, "printed sign")


def _test_load() -> None:
    _assert_close(load(PAPER_QUANTITY, PAPER_CAPACITY), PAPER_LOAD, 1e-15, "the paper's load tensor")


def self_test() -> None:
    """Every golden value of the specification; raises AssertionError."""
    _test_integrators()
    _test_discharge()
    _test_urgency()
    _test_load()


# --------------------------------------------------------------------------------------------------------------------
# Command line
# --------------------------------------------------------------------------------------------------------------------


def parse_chooser(text: str) -> tuple[ChooserName, ForecastName]:
    """NAME or NAME:FORECAST; only the cumulative chooser takes a forecast."""
    name, _, forecast = text.partition(":")
    if name not in CHOOSERS:
        raise argparse.ArgumentTypeError(f"unknown chooser {name!r}, known: {', '.join(CHOOSERS)}")
    if forecast and name != "cumulative":
        raise argparse.ArgumentTypeError(f"chooser {name!r} takes no forecast")
    if forecast and forecast not in FORECASTS:
        raise argparse.ArgumentTypeError(f"unknown forecast {forecast!r}, known: {', '.join(FORECASTS)}")
    chooser = next(known for known in CHOOSERS if known == name)
    return chooser, next((known for known in FORECASTS if known == forecast), "none")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description="Reference of the ELMOPP experiment.")
    parser.add_argument("--profile", choices=list(PROFILES), default="paper")
    parser.add_argument("--chooser", type=parse_chooser, default="naive", metavar="NAME[:FORECAST]")
    parser.add_argument("--vehicles", type=float, default=800.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--trial", type=int, default=0)
    parser.add_argument("--seconds", type=int, default=SIMULATED_POINT_COUNT)
    parser.add_argument("--out", type=Path, help="write one JSON line a simulated second")
    parser.add_argument("--integrator", choices=["rk4", "euler"])
    parser.add_argument("--mapping", choices=["abs", "shift"])
    parser.add_argument("--scope", choices=["per_inroad", "total"])
    parser.add_argument("--discharge", choices=["greenshields", "nolock", "saturation"])
    parser.add_argument("--t-min", type=int, dest="t_min_s")
    parser.add_argument("--t-max", type=int, dest="t_max_s")
    parser.add_argument("--hysteresis", type=float)
    parser.add_argument("--frozen", action="store_true", default=None)
    parser.add_argument("--constant-t", action="store_true", default=None)
    parser.add_argument("--printed-sign", action="store_true", default=None)
    parser.add_argument("--literal-clock", choices=["stage", "stage_green_zero", "lane"])
    parser.add_argument("--ready", type=float, dest="ready_veh")
    parser.add_argument("--platoon", type=float, dest="platoon_veh")
    parser.add_argument("--lyapunov", choices=["rk4", "euler"], help="print the Lyapunov exponents and stop")
    parser.add_argument("--self-test", action="store_true", help="check the golden values and stop")
    return parser


OPTION_NAMES = (
    "integrator",
    "mapping",
    "scope",
    "discharge",
    "t_min_s",
    "t_max_s",
    "hysteresis",
    "frozen",
    "constant_t",
    "printed_sign",
    "literal_clock",
    "ready_veh",
    "platoon_veh",
)


def main(arguments: Sequence[str] | None = None) -> int:
    options = _parser().parse_args(arguments)
    if options.self_test:
        self_test()
        print("self-test passed")
        return 0
    if options.lyapunov:
        print(json.dumps({"integrator": options.lyapunov, "exponents": lyapunov_exponents(options.lyapunov)}))
        return 0
    chooser, forecast = options.chooser
    given = {name: getattr(options, name) for name in OPTION_NAMES if getattr(options, name) is not None}
    settings = replace(settings_for(options.profile, chooser), **given)
    result = simulate(
        options.profile,
        chooser,
        forecast,
        options.vehicles,
        options.seed,
        options.trial,
        options.seconds,
        settings,
    )
    if options.out is not None:
        with options.out.open("w", encoding="utf-8") as stream:
            for record in result.records:
                stream.write(json.dumps(record) + "\n")
    print(json.dumps(result.metrics, indent=2))
    return 0


if __name__ == "__main__":
    sys.exit(main())
