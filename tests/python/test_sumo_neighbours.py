# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""What neighbouring signals say to each other, with a SUMO and a network that are pretended.

test_sumo_run.py has the real ones.
"""

import sys
from importlib import import_module
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest
from elmopp_tools.sumo_signal import Phase, Programme, Signal, read_signal

for absent in ("libsumo", "sumolib"):
    sys.modules.setdefault(absent, ModuleType(absent))
neighbours: Any = import_module("elmopp_tools.sumo_neighbours")
sumo_network: Any = import_module("elmopp_tools.sumo_network")

CROSS = Programme(
    "J",
    tuple(Phase(state, 30.0) for state in ("Gr", "yr", "rG", "ry")),
    ((("N", "N_0"),), (("E", "E_0"),)),
    frozenset({(0, 1), (1, 0)}),
)
LIMIT_M_PER_S = 12.5 / 0.864  # 12.5 m/s on an empty road


class Edge:
    """An edge of a network that is pretended."""

    def __init__(self, name: str, length_m: float, before: "dict[Edge, list[str]] | None" = None) -> None:
        self.name, self.length_m, self.before = name, length_m, before or {}

    def getID(self) -> str:  # noqa: N802
        return self.name

    def getLength(self) -> float:  # noqa: N802
        return self.length_m

    def getSpeed(self) -> float:  # noqa: N802
        return LIMIT_M_PER_S

    def getFunction(self) -> str:  # noqa: N802
        return "internal" if self.name.startswith(":") else ""

    def getIncoming(self) -> "list[Edge]":  # noqa: N802
        return list(self.before)

    def getConnections(self, to: "Edge") -> list[Any]:  # noqa: N802
        lanes = to.before[self]
        return [SimpleNamespace(getFromLane=lambda name=name: SimpleNamespace(getID=lambda: name)) for name in lanes]


def roads(north: Edge, reach_m: float, signals: set[str]) -> list[tuple[int, str, int]]:
    edges = {"N": north, "E": Edge("E", 300.0)}
    network = sumo_network.Network(SimpleNamespace(getEdge=edges.__getitem__))
    found = network.roads(signal(), reach_m, frozenset(signals))
    return [(road.approach, road.begins, road.travel_s) for road in found]


def signal() -> Signal:
    return read_signal(CROSS)


def test_a_road_between_signals_takes_what_it_is_long_before_the_reach() -> None:
    other = Edge("A", 50.0)
    assert roads(Edge("N", 350.0, {other: ["A_0"]}), 100.0, {"A_0"}) == [(0, "N", 20)]


def test_a_road_in_pieces_is_one_and_begins_at_the_other_signal() -> None:
    far = Edge("far", 125.0, {Edge("A", 50.0): ["A_0", "A_1"], Edge(":J_1", 9.0): [":J_1_0"]})
    assert roads(Edge("N", 60.0, {far: ["far_0"]}), 85.0, {"A_0", "A_1"}) == [(0, "far", 8)]


@pytest.mark.parametrize(
    ("before", "signals"),
    [
        ({Edge("A", 50.0): ["A_0"], Edge("B", 50.0): ["B_0"]}, {"A_0"}),  # B is no signal
        ({Edge("A", 50.0): ["A_0", "A_1"]}, {"A_0"}),  # one lane goes by the signal
        ({}, {"A_0"}),  # begins at the edge of the network
    ],
)
def test_who_may_have_others_on_his_road_announces_nothing(before: dict[Edge, list[str]], signals: set[str]) -> None:
    assert roads(Edge("N", 350.0, before), 100.0, signals) == []


def test_a_ring_without_a_signal_ends() -> None:
    ring = Edge("N", 350.0)
    ring.before = {ring: ["N_0"]}
    assert roads(ring, 100.0, set()) == []


def test_a_reach_up_to_the_neighbour_leaves_nothing_to_announce() -> None:
    assert roads(Edge("N", 100.0, {Edge("A", 50.0): ["A_0"]}), 95.0, {"A_0"}) == []


def test_who_has_left_is_announced_until_he_comes(monkeypatch: pytest.MonkeyPatch) -> None:
    there: dict[str, tuple[str, ...]] = {}
    pretended = SimpleNamespace(edge=SimpleNamespace(getLastStepVehicleIDs=lambda edge: there.get(edge, ())))
    monkeypatch.setattr(neighbours, "libsumo", pretended)
    gateway = neighbours.Gateway([neighbours.Road(1, "far", 12)], 2)

    def words() -> list[tuple[float, ...]]:
        return [(w.next10_veh, w.next30_veh, w.next60_veh, w.ahead_s) for w in gateway.listen()]

    nobody = (0.0, 0.0, 0.0, 0.0)
    assert words() == [nobody, (0.0, 0.0, 0.0, 12.0)]
    there["far"] = ("a", "b")
    assert words() == [nobody, (0.0, 2.0, 2.0, 12.0)]
    there["far"] = ("b", "c")
    assert words() == [nobody, (0.0, 3.0, 3.0, 12.0)]
    there["far"] = ()
    assert words() == [nobody, (2.0, 3.0, 3.0, 12.0)]
    for _ in range(9):
        assert words()[1][1] == 3.0
    assert words() == [nobody, (1.0, 1.0, 1.0, 12.0)]
    assert words() == [nobody, (0.0, 0.0, 0.0, 12.0)]
