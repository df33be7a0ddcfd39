# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""The long-memory experiment without its networks: its demand, its peers and its verdict."""

from __future__ import annotations

import json
import math
from collections.abc import Callable

import numpy as np
import pytest
from elmopp_tools.long_memory_data import (
    DAY,
    HORIZONS,
    MINUTES,
    PEERS,
    REBOUND_SHARE,
    SEEDS,
    TRAIN_MINUTES,
    WEEK,
    Errors,
    Series,
    fit_ar8,
    fit_scale,
    forecast_ar8,
    forecast_last_week,
    forecast_mean,
    forecast_persistence,
    make_demand,
    make_result,
    origins,
    paired_difference,
    peer_errors,
    rmse,
    verdict,
    weekly_cycle,
    with_incident,
)

MONDAY, SATURDAY = 0, 5
Forecaster = Callable[[Series, int], Series]


@pytest.fixture(scope="module")
def demand() -> Series:
    return make_demand(1)


def mean_day(demand: Series, day: int) -> Series:
    """Vehicles per minute by the hour [24], over all weeks."""
    hours = demand.reshape(-1, 7, 24, 60).mean(axis=(0, 3))
    return np.asarray(hours[day])


def test_eight_weeks_of_whole_vehicles(demand: Series) -> None:
    assert demand.shape == (80_640,) == (MINUTES,)
    assert TRAIN_MINUTES == 60_480
    assert demand.min() >= 0.0
    np.testing.assert_array_equal(demand, np.round(demand))


def test_a_seed_is_one_demand(demand: Series) -> None:
    np.testing.assert_array_equal(demand, make_demand(1))
    assert not np.array_equal(demand, make_demand(2))


def test_a_weekday_has_two_peaks(demand: Series) -> None:
    monday = mean_day(demand, MONDAY)
    peaks = [h for h in range(1, 23) if monday[h] > max(monday[h - 1], monday[h + 1]) and monday[h] > monday.mean()]
    assert len(peaks) == 2
    assert peaks[0] in (7, 8)
    assert peaks[1] in (16, 17)


def test_the_weekend_has_no_rush_in_the_morning(demand: Series) -> None:
    assert mean_day(demand, SATURDAY)[8] < 0.5 * mean_day(demand, MONDAY)[8]


def test_a_week_ago_is_more_alike_than_half_a_week_ago(demand: Series) -> None:
    def alike(lag: int) -> float:
        return float(np.corrcoef(demand[lag:], demand[:-lag])[0, 1])

    assert alike(WEEK) > alike(DAY) > alike(DAY // 2)
    assert alike(WEEK) > 0.7


def test_the_cycle_goes_on_over_midnight() -> None:
    week = weekly_cycle()
    assert week.shape == (WEEK,)
    assert np.abs(np.diff(np.append(week, week[0]))).max() < 1.0


def test_an_incident_drops_and_rebounds() -> None:
    changed = with_incident(np.full(1000, 10.0), 100, 50, 0.2)
    np.testing.assert_array_equal(changed[:100], 10.0)
    np.testing.assert_allclose(changed[100:150], 2.0)
    assert np.all(changed[150:250] > 10.0)
    assert np.all(np.diff(changed[150:250]) < 0.0)
    np.testing.assert_array_equal(changed[250:], 10.0)
    assert float(np.sum(changed[150:] - 10.0)) == pytest.approx(REBOUND_SHARE * 400.0)


@pytest.mark.parametrize("start", [960, 999])
def test_an_incident_may_be_cut_off(start: int) -> None:
    changed = with_incident(np.full(1000, 10.0), start, 20, 0.5)
    assert changed.shape == (1000,)
    assert np.all(changed[start : start + 20] == 5.0)


def test_the_scale_knows_only_the_training_weeks(demand: Series) -> None:
    other = demand.copy()
    other[TRAIN_MINUTES:] = 1000.0
    assert fit_scale(other) == fit_scale(demand)


def test_the_scale_goes_back(demand: Series) -> None:
    scale = fit_scale(demand)
    scaled = scale.apply(demand)
    assert scaled[:TRAIN_MINUTES].mean() == pytest.approx(0.0, abs=1e-9)
    assert scaled[:TRAIN_MINUTES].std() == pytest.approx(1.0)
    np.testing.assert_allclose(scale.undo(scaled), demand, atol=1e-9)


@pytest.mark.parametrize("forecast", PEERS.values(), ids=PEERS.keys())
@pytest.mark.parametrize("horizon", HORIZONS)
def test_no_peer_sees_what_comes_after(demand: Series, forecast: Forecaster, horizon: int) -> None:
    """What changes from one minute on changes no forecast made before it."""
    changed_at = TRAIN_MINUTES + 5000
    other = demand.copy()
    other[changed_at:] += 100.0
    made_before = origins(horizon) < changed_at
    before, after = forecast(demand, horizon), forecast(other, horizon)
    assert before.shape == (MINUTES - TRAIN_MINUTES,)
    np.testing.assert_array_equal(before[made_before], after[made_before])


def test_last_week_is_right_where_weeks_repeat() -> None:
    demand = np.tile(weekly_cycle(), 8)
    assert rmse(demand, forecast_last_week(demand, 60)) == 0.0


@pytest.mark.parametrize("horizon", HORIZONS)
def test_persistence_lags_by_the_horizon(horizon: int) -> None:
    ramp = np.arange(MINUTES, dtype=np.float64)
    assert rmse(ramp, forecast_persistence(ramp, horizon)) == pytest.approx(horizon)


def test_the_mean_is_that_of_the_training_weeks() -> None:
    demand = np.where(np.arange(MINUTES) < TRAIN_MINUTES, 7.0, 9.0)
    assert rmse(demand, forecast_mean(demand, 15)) == pytest.approx(2.0)


def test_ar8_finds_the_coefficients_of_an_autoregression() -> None:
    kicks = np.random.default_rng(5).standard_normal(MINUTES)
    demand = np.zeros(MINUTES)
    for at in range(2, MINUTES):
        demand[at] = 2.0 + 1.2 * demand[at - 1] - 0.4 * demand[at - 2] + kicks[at]
    np.testing.assert_allclose(fit_ar8(demand), [2.0, 1.2, -0.4, 0, 0, 0, 0, 0, 0], atol=0.15)
    assert rmse(demand, forecast_ar8(demand, 1)) == pytest.approx(1.0, abs=0.02)
    stationary_sd = float(demand.std())
    assert rmse(demand, forecast_ar8(demand, 60)) == pytest.approx(stationary_sd, rel=0.02)


@pytest.mark.parametrize("horizon", HORIZONS)
def test_ar8_goes_on_with_a_sine(horizon: int) -> None:
    demand = 10.0 + 5.0 * np.sin(np.arange(MINUTES) * (math.tau / 90.0))
    assert rmse(demand, forecast_ar8(demand, horizon)) < 1e-6


def test_every_peer_is_measured_for_every_horizon_and_seed(demand: Series) -> None:
    errors = peer_errors([demand, demand])
    assert set(errors) == {"last_week", "ar8", "persistence", "mean"}
    for by_horizon in errors.values():
        assert set(by_horizon) == {"1", "15", "60"}
        assert all(len(each) == 2 for each in by_horizon.values())
    assert errors["mean"]["1"] == errors["mean"]["60"]
    assert errors["ar8"]["1"][0] < errors["persistence"]["1"][0]


def test_the_interval_is_student_s() -> None:
    """Differences -1, -2, -3: mean -2, sd 1, and 4.3027 is the quantile with two degrees of freedom."""
    found = paired_difference([4.0, 3.0, 2.0], [5.0, 5.0, 5.0])
    assert found.mean == pytest.approx(-2.0)
    assert found.ci_low == pytest.approx(-2.0 - 4.3027 / math.sqrt(3.0), abs=1e-4)
    assert found.ci_high == pytest.approx(-2.0 + 4.3027 / math.sqrt(3.0), abs=1e-4)


@pytest.mark.parametrize(
    ("three", "expected"),
    [
        ([4.0, 4.1, 3.9], "reproduced"),
        ([4.0, 3.0, 4.9], "not_reproduced"),  # lower in each seed, but it may be chance
        ([4.0, 4.1, 5.1], "not_reproduced"),  # higher in one seed
        ([6.0, 6.1, 5.9], "not_reproduced"),
        ([5.0, 5.0, 5.0], "not_reproduced"),
    ],
)
def test_the_verdict(three: list[float], expected: str) -> None:
    assert verdict(three, [5.0, 5.0, 5.0]) == expected


def made_up(at_60: list[float]) -> Errors:
    return {"1": [3.0, 3.1, 3.2], "15": [4.0, 4.1, 4.2], "60": at_60}


def test_the_result_is_judged_at_sixty_minutes_and_can_be_written() -> None:
    errors = {"lstm1": made_up([5.0, 5.0, 5.0]), "lstm2": made_up([5.0, 5.1, 5.2]), "lstm3": made_up([4.0, 4.1, 3.9])}
    result = make_result({"lstm1": 10, "lstm2": 10, "lstm3": 10}, errors | {"last_week": made_up([1.0, 2.0, 3.000049])})
    assert json.loads(json.dumps(result)) == result
    assert result["minutes"] == [1, 15, 60]
    assert result["seeds"] == list(SEEDS)
    assert result["rmse"]["last_week"]["60"] == [1.0, 2.0, 3.0]
    assert result["summary"]["last_week"]["60"] == {"mean": 2.0, "sd": 1.0}
    assert result["difference_3_1"]["1"] == {"mean": 0.0, "ci_low": 0.0, "ci_high": 0.0}
    assert result["difference_3_1"]["60"]["mean"] == -1.0
    assert result["verdict"] == "reproduced"
