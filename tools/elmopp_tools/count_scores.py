# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""How well crossings and vehicles present agree with a truth file `lane-count-truth/1`.

Count error, lane error, event F1 and presence error, as shares and not percent.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Event:
    """A vehicle crosses the line of a lane in this frame."""

    frame: int
    lane: str


@dataclass(frozen=True)
class Counted:
    """What a clip's crossings are worth; the sums are kept so that clips can be pooled."""

    truth: int
    counted: int
    lane_difference: int
    matched: int
    missed: int
    false: int

    @property
    def count_error(self) -> float | None:
        return abs(self.counted - self.truth) / self.truth if self.truth else None

    @property
    def lane_error(self) -> float | None:
        return self.lane_difference / self.truth if self.truth else None

    @property
    def f1(self) -> float | None:
        events = 2 * self.matched + self.missed + self.false
        return 2 * self.matched / events if events else None

    @property
    def wrong_events(self) -> int:
        return self.missed + self.false


def _pairs(reported: Sequence[Event], alike: Mapping[int, Sequence[int]]) -> dict[int, int]:
    """The most pairs of a reported and a true event that are alike, each in one pair only: reported to true."""
    taken_by: dict[int, int] = {}

    def place(i: int, seen: set[int]) -> bool:
        for k in alike[i]:
            if k not in seen:
                seen.add(k)
                if k not in taken_by or place(taken_by[k], seen):
                    taken_by[k] = i
                    return True
        return False

    for i in range(len(reported)):
        place(i, set())
    return {i: k for k, i in taken_by.items()}


def _alike(
    reported: Sequence[Event], true: Sequence[Event], tolerance: int, near: Mapping[str, set[str]]
) -> dict[int, list[int]]:
    """For each reported event the true ones that it may be, the nearest in time first."""
    alike = {}
    for i, r in enumerate(reported):
        may_be = [
            (abs(t.frame - r.frame), k)
            for k, t in enumerate(true)
            if abs(t.frame - r.frame) <= tolerance and r.lane in near[t.lane]
        ]
        alike[i] = [k for _, k in sorted(may_be)]
    return alike


def _neighbours(lanes: Sequence[Mapping[str, Any]]) -> dict[str, set[str]]:
    """For each lane itself and the lanes whose lines begin or end where its own does."""

    def touch(a: Mapping[str, Any], b: Mapping[str, Any]) -> bool:
        length = max(abs(a["line"][1][0] - a["line"][0][0]), abs(a["line"][1][1] - a["line"][0][1]), 1)
        return any(abs(p[0] - q[0]) + abs(p[1] - q[1]) <= 0.12 * length for p in a["line"] for q in b["line"])

    return {a["name"]: {b["name"] for b in lanes if b["name"] == a["name"] or touch(a, b)} for a in lanes}


@dataclass(frozen=True)
class _Matched:
    reported: list[Event]
    missed: list[Event]
    false: list[Event]
    pairs: int


def _match(truth: Mapping[str, Any], crossings: Sequence[Event]) -> _Matched:
    within = range(truth["count_from"], truth["count_to"] + 1)
    reported = sorted((c for c in crossings if c.frame in within), key=lambda c: (c.frame, c.lane))
    listed = [Event(c["frame"], c["lane"]) for c in truth["crossings"]]
    arguable = [Event(u["frame"], u["lane"]) for u in truth.get("uncertain", [])]
    certain = [e for e in listed if e not in arguable]
    tolerance = truth["frame_tolerance"]
    alone = {lane["name"]: {lane["name"]} for lane in truth["lanes"]}
    sure = _pairs(reported, _alike(reported, certain, tolerance, alone))
    rest = [r for i, r in enumerate(reported) if i not in sure]
    maybe = _pairs(rest, _alike(rest, arguable, tolerance, _neighbours(truth["lanes"])))
    return _Matched(
        reported=reported,
        missed=[c for k, c in enumerate(certain) if k not in sure.values()],
        false=[r for i, r in enumerate(rest) if i not in maybe],
        pairs=len(sure) + sum(arguable[k] in listed for k in maybe.values()),
    )


def score_crossings(truth: Mapping[str, Any], crossings: Sequence[Event]) -> Counted:
    """The crossings of a clip beside its truth."""
    found = _match(truth, crossings)
    totals = truth["totals"]
    lanes = [lane["name"] for lane in truth["lanes"]]
    return Counted(
        truth=truth["total"],
        counted=len(found.reported),
        lane_difference=sum(abs(sum(r.lane == lane for r in found.reported) - totals.get(lane, 0)) for lane in lanes),
        matched=found.pairs,
        missed=len(found.missed),
        false=len(found.false),
    )


def wrong_events(truth: Mapping[str, Any], crossings: Sequence[Event]) -> tuple[list[Event], list[Event]]:
    """The missed and the false ones, for whoever wants to look at them."""
    found = _match(truth, crossings)
    return found.missed, found.false


def presence_error(truth: Mapping[str, Any], present: Sequence[tuple[int, Mapping[str, int | None]]]) -> float | None:
    """Mean difference of vehicles present over the listed frames, less the truth's own uncertainty.

    `present`: frame and vehicles per lane; the record nearest to a listed frame is taken.
    """
    listed = truth.get("present", [])
    if not listed or not present:
        return None
    total = 0.0
    for row in listed:
        _, lanes = min(present, key=lambda record: abs(record[0] - row["frame"]))
        if "all_lanes" in row:
            wanted = {"all_lanes": row["all_lanes"]}
            found = {"all_lanes": sum(v or 0 for v in lanes.values())}
        else:
            wanted = {k: v for k, v in row.items() if k != "frame"}
            found = {k: lanes.get(k) or 0 for k in wanted}
        total += sum(abs(found[k] - wanted[k]) for k in wanted)
    return max(0.0, total / len(listed) - float(truth.get("present_uncertainty", 0)))


def pooled(scores: Sequence[Counted]) -> dict[str, float | None]:
    """All clips as one: sums of differences over sums of vehicles."""
    truth = sum(s.truth for s in scores)
    matched = sum(s.matched for s in scores)
    events = 2 * matched + sum(s.missed + s.false for s in scores)
    counted = [s for s in scores if s.truth]
    return {
        "count_error": sum(abs(s.counted - s.truth) for s in scores) / truth if truth else None,
        "lane_error": sum(s.lane_difference for s in counted) / truth if truth else None,
        "f1": 2 * matched / events if events else None,
    }
