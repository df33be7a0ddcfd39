# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""What is fitted to the training data without a training: the clamp and the street's AR(8)."""

from __future__ import annotations

import numpy as np
from elmopp_tools.inflow_data import clamp, fit_ar8


def test_the_clamp_is_the_range_widened_by_a_tenth_and_never_below_zero() -> None:
    series = np.zeros((2, 3, 4), np.float32)
    series[0, :, 0] = [1.0, 2.0, 3.0]
    series[1, :, 0] = [1.5, 2.0, 11.0]
    series[:, :, 1] = 5.0
    series[0, 1, 1] = 15.0
    low, high = clamp(series)
    np.testing.assert_allclose(low, [0.0, 4.0, 0.0, 0.0])
    np.testing.assert_allclose(high, [12.0, 16.0, 0.0, 0.0])
    assert low.dtype == high.dtype == np.float32


def test_ar8_finds_the_coefficients_that_made_the_data() -> None:
    lags = np.array([0.5, -0.3, 0.2, 0.0, 0.1, 0.0, -0.1, 0.05])
    random = np.random.default_rng(3)
    series = np.zeros((3, 4000, 2))
    series[:, :8] = random.normal(size=(3, 8, 2))
    for t in range(8, 4000):
        series[:, t] = 0.7 + np.einsum("k,nki->ni", lags, series[:, t - 8 : t][:, ::-1]) + random.normal(size=(3, 2))
    intercept, found = fit_ar8(series.astype(np.float32))
    np.testing.assert_allclose(found, lags, atol=0.02)
    assert abs(intercept - 0.7) < 0.06


def test_ar8_of_an_exact_recurrence_is_exact() -> None:
    t = np.arange(2000)
    wave = (1.0 + 0.5 * np.sin(0.02 * t)).astype(np.float64)
    series = wave[None, :, None].astype(np.float32)
    intercept, lag = fit_ar8(series)
    window = series[0, 500:508, 0][::-1].astype(np.float64)
    assert abs(intercept + float(lag.astype(np.float64) @ window) - wave[508]) < 1e-5
