# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Ways through a plan, so that a scenario says for each flow how it drives.

SUMO would look for a way when a vehicle enters, by the times that roads take just then: where there are two ways the
vehicles of a seed would no longer be the same under other signals.
"""

import heapq
import math

from elmopp_tools.sumo_nets import Edge, Plan, edges_of, turns_at


def shortest(plan: Plan, first: str, last: str) -> tuple[str, ...]:
    """The edges of the shortest way; of several the one with fewest turns, then the first by name."""
    edges = {edge.name: edge for edge in edges_of(plan)}
    turns = {signal: turns_at(signal, edges.values()) for signal in plan.signals}
    open_ways: list[tuple[float, int, tuple[str, ...]]] = [(0.0, 0, (first,))]
    reached: set[str] = set()
    while open_ways:
        length_m, bends, way = heapq.heappop(open_ways)
        at = edges[way[-1]]
        if at.name == last:
            return way
        if at.name in reached or at.end not in turns:
            continue
        reached.add(at.name)
        for turn, out in turns[at.end][at.name].items():
            if any(turn in letters for letters in at.lanes):
                longer = (length_m + _length_m(plan, out), bends + (turn != "s"), (*way, out.name))
                heapq.heappush(open_ways, longer)
    raise ValueError(f"no way from {first} to {last}")


def _length_m(plan: Plan, edge: Edge) -> float:
    places = plan.signals | plan.ends
    return math.dist(places[edge.start], places[edge.end])
