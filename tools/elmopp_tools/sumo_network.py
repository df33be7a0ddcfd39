# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""What the bridge reads of a SUMO network: every signal's programme, and the roads that its cameras see.

A camera at the stop line sees `reach_m` up the road, also across the edges into which a network cuts an approach, as
far back as the next signal. Where a lane upstream leads to several lanes at the stop line nobody can tell who will take
which: a vehicle there counts for each of them in equal parts.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import libsumo
import sumolib

from elmopp_tools.sumo_neighbours import Road
from elmopp_tools.sumo_signal import LaneGroup, Phase, Programme, Signal, SignalError

FREE_FLOW_SHARE = 0.864  # of the limit: what drivers reach, as the core's sight.h has it

# SUMO's links of a signal: for each the lanes from and to, and the one across the junction.
Links = Sequence[Sequence[tuple[str, str, str]]]


@dataclass(frozen=True)
class View:
    """A piece of a lane that a camera sees: vehicles from `from_m` on count for these movements in these parts.

    The stop line is at `line_m` of the lane, behind its end for a lane further up the road.
    """

    lane: str
    from_m: float
    line_m: float
    parts: tuple[tuple[int, float], ...]


@dataclass(frozen=True)
class Crossing:
    """People who wait on a walking area to take a crossing count for a movement."""

    waiting_edge: str
    crossing_edge: str
    movement: int


@dataclass(frozen=True)
class Sight:
    """All that is counted at one signal. `downstream[movement]`: the lanes behind the junction that it leads to.

    `inside`: the lanes across the junction, on which vehicles are that have passed the stop line and not left yet.
    """

    views: tuple[View, ...]
    crossings: tuple[Crossing, ...]
    downstream: tuple[tuple[str, ...], ...]
    inside: tuple[str, ...]


@dataclass
class Network:
    """The network of a running simulation, for questions that the simulation does not answer."""

    net: Any
    fed_by: dict[str, list[str]] = field(default_factory=dict)
    ways_on: dict[str, int] = field(default_factory=dict)

    @classmethod
    def read(cls, file: Path) -> "Network":
        """Reads a net file with its internal lanes."""
        net = sumolib.net.readNet(str(file), withInternal=True, withPedestrianConnections=True)
        network = cls(net)
        for edge in net.getEdges(withInternal=True):
            for lane in edge.getLanes():
                for connection in lane.getOutgoing():
                    via = connection.getViaLaneID() or connection.getToLane().getID()
                    network.fed_by.setdefault(via, []).append(lane.getID())
                network.ways_on[lane.getID()] = len(lane.getOutgoing())
        return network

    def programme(self, name: str) -> Programme:
        """A signal's programme as the simulation runs it now."""
        current = libsumo.trafficlight.getProgram(name)
        logic = next(item for item in libsumo.trafficlight.getAllProgramLogics(name) if item.programID == current)
        links = libsumo.trafficlight.getControlledLinks(name)
        if not any(links):
            raise SignalError(f"signal {name} controls no link; right would be a signal of a road junction")
        width = max(len(phase.state) for phase in logic.phases)
        lanes = [tuple((_edge_of(lane), lane) for lane, _, _ in link) for link in links]
        return Programme(
            name=name,
            phases=tuple(Phase(phase.state, phase.duration) for phase in logic.phases),
            lanes=tuple(lanes) + ((),) * (width - len(lanes)),
            foes=frozenset(self._foes(links)),
            places=tuple(self._junction_of(link) for link in links),
        )

    def _foes(self, links: Links) -> Iterator[tuple[int, int]]:
        """Pairs of links of one signal whose paths cross or merge, at whatever junction of it."""
        places: dict[str, list[tuple[int, int]]] = {}
        nodes: dict[str, Any] = {}
        for index, link in enumerate(links):
            for start, end, _ in link:
                node, place = self._place(start, end)
                if node is not None:
                    places.setdefault(node.getID(), []).append((index, place))
                    nodes[node.getID()] = node
        for name, members in places.items():
            for first, first_place in members:
                for second, second_place in members:
                    if first != second and nodes[name].areFoes(first_place, second_place):
                        yield first, second

    def _junction_of(self, link: Sequence[tuple[str, str, str]]) -> str:
        """The junction at which all connections of a link are; "" if it has none, or is not of one."""
        nodes = {self._place(start, end)[0] for start, end, _ in link}
        node = nodes.pop() if len(nodes) == 1 else None
        return str(node.getID()) if node is not None else ""

    def _place(self, start: str, end: str) -> tuple[Any, int]:
        """The junction of a connection and its number there."""
        lane = self.net.getLane(start)
        for connection in lane.getOutgoing():
            if connection.getToLane().getID() == end:
                return connection.getJunction(), connection.getJunctionIndex()
        return None, -1

    def sight(self, signal: Signal, reach_m: float, signals: frozenset[str]) -> Sight:
        """What cameras of a reach see of a signal; `signals` are the lanes at whose end there is one."""
        links = libsumo.trafficlight.getControlledLinks(signal.name)
        shares: dict[str, dict[int, float]] = {}
        starts: dict[str, float] = {}
        for index, movement in enumerate(signal.movements):
            for lane in movement.lanes:
                if not self._is_walked(lane):
                    shares.setdefault(lane, {})[index] = 1.0
                    starts[lane] = self._length(lane) - reach_m
        self._look_upstream(shares, starts, signals)
        return Sight(
            views=tuple(
                View(lane, max(starts[lane], 0.0), starts[lane] + reach_m, tuple(parts.items()))
                for lane, parts in shares.items()
            ),
            crossings=tuple(self._crossings(links, signal.movements)),
            downstream=tuple(_downstream(links, movement) for movement in signal.movements),
            inside=self._inside(links),
        )

    def roads(self, signal: Signal, reach_m: float, signals: frozenset[str]) -> list[Road]:
        """The roads from other signals to the reach of this one, of the approaches that are one whole edge."""
        edges = [sorted({signal.movements[index].edge for index in members}) for members in signal.approaches]
        once = [edge for names in edges for edge in names]
        found = []
        for approach, names in enumerate(edges):
            if len(names) == 1 and once.count(names[0]) == 1 and not names[0].startswith(":"):
                found += self._road(approach, names[0], reach_m, signals)
        return found

    def _road(self, approach: int, edge_name: str, reach_m: float, signals: frozenset[str]) -> list[Road]:
        """None if somebody may come from elsewhere, or if the reach goes as far as the neighbour."""
        edge = self.net.getEdge(edge_name)
        seen, travel_s, left_m = set(), 0.0, reach_m
        while edge.getID() not in seen:
            seen.add(edge.getID())
            travel_s += max(edge.getLength() - left_m, 0.0) / (FREE_FLOW_SHARE * edge.getSpeed())
            left_m = max(left_m - edge.getLength(), 0.0)
            before = [one for one in edge.getIncoming() if not one.getFunction()]
            at_signal = [self._is_at_signal(one, edge, signals) for one in before]
            if before and all(at_signal):
                return [Road(approach, edge.getID(), int(travel_s))] if int(travel_s) > 0 else []
            if len(before) != 1:
                break
            edge = before[0]
        return []

    @staticmethod
    def _is_at_signal(before: Any, edge: Any, signals: frozenset[str]) -> bool:
        """Whether every lane that leads from one edge to the other ends at a signal."""
        lanes = {connection.getFromLane().getID() for connection in before.getConnections(edge)}
        return bool(lanes) and lanes <= signals

    def _inside(self, links: Links) -> tuple[str, ...]:
        """The lanes across the junction that vehicles take, piece by piece: a left turn may wait between two."""
        lanes: dict[str, None] = {}
        ring = [via for link in links for start, _, via in link if via and not self._is_walked(start)]
        while ring:
            lane = ring.pop()
            if lane not in lanes and self.net.getLane(lane).getEdge().getFunction() == "internal":
                lanes[lane] = None
                ring += [on.getViaLaneID() or on.getToLane().getID() for on in self.net.getLane(lane).getOutgoing()]
        return tuple(sorted(lanes))

    def _look_upstream(
        self, shares: dict[str, dict[int, float]], starts: dict[str, float], signals: frozenset[str]
    ) -> None:
        """Adds the lanes before those whose beginning is still within reach, one ring after the other."""
        ring = list(shares)
        while ring:
            reached: dict[str, list[str]] = {}
            for lane in ring:
                if starts[lane] < 0.0:
                    for before in self.fed_by.get(lane, []):
                        if before not in shares and before not in signals and not self._is_walked(before):
                            reached.setdefault(before, []).append(lane)
            for before, lanes in reached.items():
                starts[before] = self._length(before) + min(starts[lane] for lane in lanes)
                parts: dict[int, float] = {}
                for lane in lanes:
                    for movement, part in shares[lane].items():
                        parts[movement] = parts.get(movement, 0.0) + part / self.ways_on[before]
                shares[before] = parts
            ring = list(reached)

    def _crossings(self, links: Links, movements: Sequence[LaneGroup]) -> Iterator[Crossing]:
        for index, movement in enumerate(movements):
            for link in movement.links:
                for start, end, _ in links[link]:
                    if start in movement.lanes and self._is_walked(start):
                        yield Crossing(_edge_of(start), _edge_of(end), index)

    def _length(self, lane: str) -> float:
        length: float = self.net.getLane(lane).getLength()
        return length

    def _is_walked(self, lane: str) -> bool:
        function = self.net.getLane(lane).getEdge().getFunction()
        return function in ("walkingarea", "crossing")


def _downstream(links: Links, movement: LaneGroup) -> tuple[str, ...]:
    ends = {end for link in movement.links for start, end, _ in links[link] if start in movement.lanes}
    return tuple(sorted(ends))


def _edge_of(lane: str) -> str:
    return lane.rsplit("_", 1)[0]
