# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The long-memory experiment without its networks: eight weeks of demand, the peers, the errors and the verdict.

Time is in minutes since Monday 0:00 of the first week, demand in vehicles per minute. A forecast for h minutes ahead of
minute t uses the demand of minute t and before. The first six weeks are for training, the last two for the test: every
forecaster is measured on each minute of the test weeks, for each of HORIZONS, so all RMSEs are of the same minutes.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elmopp_tools.paired import half_width

Series = NDArray[np.float64]

DAY = 1440
WEEK = 7 * DAY
WEEKS = 8
TRAIN_WEEKS = 6
MINUTES = WEEKS * WEEK
TRAIN_MINUTES = TRAIN_WEEKS * WEEK
HORIZONS = (1, 15, 60)
SEEDS = (1, 2, 3)

# The daily cycle: what flows at night, and humps of (minute of the day, width in minutes, height in vehicles/minute).
NIGHT = 3.0
WEEKDAY = ((480.0, 60.0, 20.0), (780.0, 150.0, 8.0), (1050.0, 80.0, 24.0))
WEEKEND = ((690.0, 120.0, 11.0), (1110.0, 150.0, 13.0))
DAY_FACTORS = (0.97, 1.0, 1.02, 1.03, 1.1, 1.0, 0.85)  # Monday to Sunday
FIRST_WEEKEND_DAY = 5

# Slow noise, as of the weather: a factor whose logarithm is an AR(1).
WEATHER_MINUTES = 720.0  # until its correlation is 1/e
WEATHER_SD = 0.12

# Incidents: as many a day on average, each a time of less flow; a share of the vehicles held back comes afterwards,
# fading out linearly over a multiple of the incident's duration.
INCIDENTS_PER_DAY = 0.75
INCIDENT_MINUTES = (15, 120)
INCIDENT_PASSED = (0.1, 0.6)  # share of the flow that gets through
REBOUND_SHARE = 0.5
REBOUND_STRETCH = 2

LAGS = 8
JUDGED_HORIZON = 60
DIGITS = 4  # of what is written down


def daily_cycle(humps: Sequence[tuple[float, float, float]]) -> Series:
    """Vehicles per minute [DAY]."""
    minute = np.arange(DAY, dtype=np.float64)
    flow = np.full(DAY, NIGHT)
    for at, width, height in humps:
        away = np.abs(minute - at)
        flow += height * np.exp(-0.5 * (np.minimum(away, DAY - away) / width) ** 2)
    return flow


def weekly_cycle() -> Series:
    """Vehicles per minute [WEEK], Monday first."""
    weekday, weekend = daily_cycle(WEEKDAY), daily_cycle(WEEKEND)
    days = [weekday] * FIRST_WEEKEND_DAY + [weekend] * (len(DAY_FACTORS) - FIRST_WEEKEND_DAY)
    return np.concatenate([factor * day for factor, day in zip(DAY_FACTORS, days, strict=True)])


def make_weather(rng: np.random.Generator, minutes: int) -> Series:
    """A slow factor [minutes] with mean 1."""
    keep = float(np.exp(-1.0 / WEATHER_MINUTES))
    kicks = WEATHER_SD * np.sqrt(1.0 - keep**2) * rng.standard_normal(minutes)
    level = WEATHER_SD * float(rng.standard_normal())
    logarithm = np.empty(minutes)
    for at, kick in enumerate(kicks):
        level = keep * level + float(kick)
        logarithm[at] = level
    return np.asarray(np.exp(logarithm - 0.5 * WEATHER_SD**2))


def with_incident(flow: Series, start: int, duration: int, passed: float) -> Series:
    """Flow [minutes] with one incident of so many minutes and its rebound; either may be cut off by the end."""
    changed = flow.copy()
    changed[start : start + duration] *= passed
    held_back = float(np.sum(flow - changed))
    fading = np.arange(REBOUND_STRETCH * duration, 0, -1, dtype=np.float64)
    rebound = REBOUND_SHARE * held_back * fading / fading.sum()
    after = changed[start + duration : start + duration + rebound.size]
    after += rebound[: after.size]
    return changed


def with_incidents(rng: np.random.Generator, flow: Series) -> Series:
    for _ in range(int(rng.poisson(INCIDENTS_PER_DAY * flow.size / DAY))):
        start = int(rng.integers(flow.size))
        duration = int(rng.integers(INCIDENT_MINUTES[0], INCIDENT_MINUTES[1], endpoint=True))
        flow = with_incident(flow, start, duration, float(rng.uniform(*INCIDENT_PASSED)))
    return flow


def make_flow(rng: np.random.Generator) -> Series:
    """Expected vehicles per minute [MINUTES]: all but the counting noise."""
    return with_incidents(rng, np.tile(weekly_cycle(), WEEKS) * make_weather(rng, MINUTES))


def make_demand(seed: int) -> Series:
    """Counted vehicles per minute [MINUTES]: Poisson around the flow."""
    rng = np.random.default_rng(seed)
    return rng.poisson(make_flow(rng)).astype(np.float64)


@dataclass(frozen=True)
class Scale:
    """Demand to a network's units and back."""

    mean: float
    sd: float

    def apply(self, demand: Series) -> Series:
        return (demand - self.mean) / self.sd

    def undo(self, scaled: Series) -> Series:
        return scaled * self.sd + self.mean


def fit_scale(demand: Series) -> Scale:
    """From the training weeks alone."""
    train = demand[:TRAIN_MINUTES]
    return Scale(float(train.mean()), float(train.std()))


def origins(horizon: int) -> NDArray[np.int64]:
    """Minutes at which the forecasts for the test weeks are made [MINUTES - TRAIN_MINUTES]."""
    return np.arange(TRAIN_MINUTES, MINUTES) - horizon


def rmse(demand: Series, forecast: Series) -> float:
    """In vehicles per minute; the forecast is of the test weeks [MINUTES - TRAIN_MINUTES]."""
    return float(np.sqrt(np.mean((demand[TRAIN_MINUTES:] - forecast) ** 2)))


def forecast_last_week(demand: Series, horizon: int) -> Series:
    """What was counted one week before the minute forecast."""
    return demand[origins(horizon) + horizon - WEEK]


def forecast_persistence(demand: Series, horizon: int) -> Series:
    """What was counted last."""
    return demand[origins(horizon)]


def forecast_mean(demand: Series, horizon: int) -> Series:
    """The mean of the training weeks."""
    return np.full(origins(horizon).size, demand[:TRAIN_MINUTES].mean())


def latest(demand: Series, at: NDArray[np.int64]) -> Series:
    """The last LAGS values up to and with each of these minutes, newest first [at.size, LAGS]."""
    return np.asarray(demand[at[:, None] - np.arange(LAGS)])


def fit_ar8(demand: Series) -> Series:
    """Intercept, then the lags from the newest [1 + LAGS]: least squares, one minute ahead, over the training weeks."""
    at = np.arange(LAGS - 1, TRAIN_MINUTES - 1)
    rows = np.column_stack([np.ones(at.size), latest(demand, at)])
    return np.asarray(np.linalg.lstsq(rows, demand[at + 1], rcond=None)[0], dtype=np.float64)


def forecast_ar8(demand: Series, horizon: int) -> Series:
    """AR(8) iterated on its own output."""
    intercept, *lags = fit_ar8(demand)
    window = latest(demand, origins(horizon))
    for _ in range(horizon):
        ahead = intercept + window @ np.asarray(lags)
        window = np.column_stack([ahead, window[:, :-1]])
    return window[:, 0]


PEERS = {
    "last_week": forecast_last_week,
    "ar8": forecast_ar8,
    "persistence": forecast_persistence,
    "mean": forecast_mean,
}

# A forecaster's RMSE: by horizon in minutes, one number for each seed.
Errors = dict[str, list[float]]


def peer_errors(demands: Sequence[Series]) -> dict[str, Errors]:
    return {
        name: {str(h): [rmse(demand, forecast(demand, h)) for demand in demands] for h in HORIZONS}
        for name, forecast in PEERS.items()
    }


@dataclass(frozen=True)
class Difference:
    """The mean of paired differences with its t interval."""

    mean: float
    ci_low: float
    ci_high: float


def paired_difference(ours: Sequence[float], theirs: Sequence[float]) -> Difference:
    """Ours minus theirs, seed by seed; below 0 is for us."""
    each = np.subtract(ours, theirs).tolist()
    mean, half = float(np.mean(each)), half_width(each)
    return Difference(mean, mean - half, mean + half)


def verdict(three: Sequence[float], one: Sequence[float]) -> str:
    """Whether three levels remember longer: RMSEs at JUDGED_HORIZON, one a seed, lower in each and beyond chance."""
    everywhere = all(ours < theirs for ours, theirs in zip(three, one, strict=True))
    return "reproduced" if everywhere and paired_difference(three, one).ci_high < 0.0 else "not_reproduced"


def _rounded(number: float) -> float:
    return round(number, DIGITS)


def _summary(errors: Errors) -> dict[str, dict[str, float]]:
    return {
        h: {"mean": _rounded(float(np.mean(each))), "sd": _rounded(float(np.std(each, ddof=1)))}
        for h, each in errors.items()
    }


def _difference(three: Errors, one: Errors) -> dict[str, dict[str, float]]:
    found = {h: paired_difference(three[h], one[h]) for h in one}
    return {
        h: {"mean": _rounded(d.mean), "ci_low": _rounded(d.ci_low), "ci_high": _rounded(d.ci_high)}
        for h, d in found.items()
    }


def make_result(parameters: dict[str, int], errors: dict[str, Errors]) -> dict[str, Any]:
    """What is written down, with nothing in it that differs between two runs that found the same."""
    one, three = errors["lstm1"], errors["lstm3"]
    return {
        "minutes": list(HORIZONS),
        "seeds": list(SEEDS),
        "parameters": parameters,
        "rmse": {name: {h: [_rounded(x) for x in each] for h, each in by.items()} for name, by in errors.items()},
        "summary": {name: _summary(by) for name, by in errors.items()},
        "difference_3_1": _difference(three, one),
        "verdict": verdict(three[str(JUDGED_HORIZON)], one[str(JUDGED_HORIZON)]),
    }
