# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""What neighbouring signals of a SUMO network send to each other: the gateway that NeighbourOutflow is made for.

A road joins two signals if everybody who comes to its end has passed the other's stop line, or another signal's. A
counter where the road begins sees who has left the neighbour; it knows no route, only how long the road takes on the
way to the edge of the counted reach.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import libsumo

from elmopp_tools.library import Announced


@dataclass(frozen=True)
class Road:
    """From a neighbour to an approach: the edge on which vehicles come, and the seconds to the edge of the reach."""

    approach: int
    begins: str
    travel_s: int


class Gateway:
    """Counts who has left the neighbours of one signal, and says when they will come."""

    def __init__(self, roads: Sequence[Road], approaches: int) -> None:
        self._roads = roads
        self._approaches = approaches
        self._known: list[set[str]] = [set() for _ in roads]
        self._left_s: list[deque[int]] = [deque() for _ in roads]
        self._now_s = 0

    def listen(self) -> list[Announced]:
        """Looks once, after a step of the simulation: for each approach what a frame would say now."""
        self._now_s += 1
        words = [Announced() for _ in range(self._approaches)]
        for index, road in enumerate(self._roads):
            now = set(libsumo.edge.getLastStepVehicleIDs(road.begins))
            left_s = self._left_s[index]
            left_s.extend([self._now_s] * len(now - self._known[index]))
            self._known[index] = now
            while left_s and left_s[0] + road.travel_s <= self._now_s:
                left_s.popleft()
            due_s = [second + road.travel_s - self._now_s for second in left_s]
            words[road.approach] = Announced(
                *(float(sum(1 for second in due_s if second <= ahead_s)) for ahead_s in (10, 30, 60)),
                float(road.travel_s),
            )
        return words
