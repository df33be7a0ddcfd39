# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The arithmetic of latency.py, on logs made up for it. Needs no bus."""

import pytest
from latency import ages_ms, changes_s, gaps_ms, quantiles


def test_gaps_are_between_neighbours() -> None:
    assert gaps_ms([]) == gaps_ms([7.0]) == []
    assert gaps_ms([1.0, 1.1, 1.35]) == pytest.approx([100.0, 250.0])


def test_a_change_is_a_command_that_differs_from_the_one_before() -> None:
    red, green = [1, 1], [1, 3]
    log = [(0.0, green), (0.1, green), (0.2, red), (0.3, red), (0.4, green), (0.5, [3, 3])]
    assert changes_s(log) == [0.2, 0.4, 0.5]
    assert changes_s([]) == changes_s([(0.0, red)]) == []


def test_an_age_is_from_a_cause_to_the_first_effect_after_it() -> None:
    assert ages_ms([1.0, 5.0], [0.5, 1.25, 1.5, 5.75, 9.0]) == pytest.approx([250.0, 750.0])


def test_a_cause_that_is_overtaken_or_without_effect_has_no_age() -> None:
    assert ages_ms([1.0, 2.0, 3.0], [2.5]) == pytest.approx([500.0])
    assert ages_ms([1.0], [0.9, 1.0]) == []
    assert ages_ms([], [1.0]) == ages_ms([1.0], []) == []


def test_quantiles_of_many_and_of_none() -> None:
    assert quantiles([float(n) for n in range(100, -1, -1)]) == {
        "n": 101,
        "min": 0.0,
        "p50": 50.0,
        "p99": 99.0,
        "max": 100.0,
    }
    assert quantiles([3.14]) == {"n": 1, "min": 3.1, "p50": 3.1, "p99": 3.1, "max": 3.1}
    assert quantiles([]) == {"n": 0}
