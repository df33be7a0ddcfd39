# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""The scores themselves, on truths small enough to be worked out by hand."""

from typing import Any

import pytest
from elmopp_tools.count_scores import Event, pooled, presence_error, score_crossings


def truth(**changes: Any) -> dict[str, Any]:
    lanes = [
        {"name": "A", "line": [[0, 10], [10, 10]], "direction": "down"},
        {"name": "B", "line": [[10, 10], [20, 10]], "direction": "down"},
    ]
    crossings = [{"frame": 10, "lane": "A"}, {"frame": 50, "lane": "A"}, {"frame": 52, "lane": "B"}]
    whole = {"lanes": lanes, "crossings": crossings, "count_from": 0, "count_to": 99, "uncertain": []}
    return whole | {"frame_tolerance": 5, "total": 3, "totals": {"A": 2, "B": 1}} | changes


def test_all_found_is_perfect() -> None:
    score = score_crossings(truth(), [Event(12, "A"), Event(47, "A"), Event(52, "B")])
    assert (score.count_error, score.lane_error, score.f1, score.wrong_events) == (0, 0, 1, 0)


def test_the_right_total_in_the_wrong_lanes_is_wrong() -> None:
    score = score_crossings(truth(), [Event(10, "A"), Event(50, "B"), Event(52, "B")])
    assert score.count_error == 0
    assert score.lane_error == pytest.approx(2 / 3)
    assert (score.missed, score.false) == (1, 1)


def test_an_event_too_late_is_missed_and_false() -> None:
    score = score_crossings(truth(), [Event(16, "A"), Event(50, "A"), Event(52, "B")])
    assert (score.missed, score.false) == (1, 1)


def test_one_report_is_one_crossing() -> None:
    near = truth(crossings=[{"frame": 10, "lane": "A"}, {"frame": 13, "lane": "A"}], total=2, totals={"A": 2, "B": 0})
    assert score_crossings(near, [Event(12, "A")]).missed == 1
    assert score_crossings(near, [Event(9, "A"), Event(8, "A")]).matched == 2


def test_the_pairs_are_the_most_that_are_possible() -> None:
    near = truth(crossings=[{"frame": 10, "lane": "A"}, {"frame": 14, "lane": "A"}], total=2, totals={"A": 2, "B": 0})
    # 12 could take either, 17 only the second.
    assert score_crossings(near, [Event(12, "A"), Event(17, "A")]).wrong_events == 0


def test_an_arguable_crossing_may_be_reported_or_not_also_next_to_its_lane() -> None:
    arguable = truth(uncertain=[{"frame": 52, "lane": "B"}])
    for extra in ([], [Event(52, "B")], [Event(52, "A")]):
        score = score_crossings(arguable, [Event(10, "A"), Event(50, "A"), *extra])
        assert score.wrong_events == 0
    assert score_crossings(arguable, [Event(10, "A"), Event(50, "A"), Event(52, "B"), Event(53, "B")]).false == 1


def test_what_is_outside_of_the_counted_frames_does_not_count() -> None:
    assert score_crossings(truth(count_from=20), [Event(10, "A"), Event(50, "A"), Event(52, "B")]).counted == 2


def test_presence_is_the_mean_difference_less_its_uncertainty() -> None:
    listed = truth(present=[{"frame": 0, "A": 3}, {"frame": 50, "A": 3}], present_uncertainty=0.5)
    assert presence_error(listed, [(0, {"A": 1, "B": 9}), (49, {"A": 3, "B": None})]) == pytest.approx(0.5)
    together = truth(present=[{"frame": 0, "all_lanes": 5}])
    assert presence_error(together, [(0, {"A": 3, "B": 2})]) == 0
    assert presence_error(truth(), [(0, {"A": 1})]) is None


def test_clips_are_pooled_by_their_vehicles() -> None:
    good = score_crossings(truth(), [Event(10, "A"), Event(50, "A"), Event(52, "B")])
    none = score_crossings(truth(), [])
    assert pooled([good, none]) == {"count_error": 0.5, "lane_error": 0.5, "f1": pytest.approx(6 / 9)}
    assert score_crossings(truth(total=0, crossings=[], totals={}), []).f1 is None
