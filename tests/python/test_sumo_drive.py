# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""One second of a signal, with a SUMO that is pretended: who is counted, what is shown, what is written down.

test_sumo_run.py has the real one, where a wrong count or a lamp that is a second late is hard to see in a table.
"""

import sys
from collections.abc import Sequence
from importlib import import_module
from itertools import groupby
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest
from elmopp_tools.library import LibraryError
from elmopp_tools.sumo_signal import Phase, Programme, Signal, Times, read_signal

for absent in ("libsumo", "sumolib"):
    sys.modules.setdefault(absent, ModuleType(absent))
sumo_drive: Any = import_module("elmopp_tools.sumo_drive")
sumo_network: Any = import_module("elmopp_tools.sumo_network")

TIMES = Times(yellow_s=4, all_red_s=3, min_green_s=7, max_green_s=20, red_bound_s=0)
REACH_M = 100.0

# Links 0 and 1 of N, 2 of E: three groups, because 1 goes in a stage of its own; 1 gives way where 0 goes, too.
CROSS = Programme(
    "J",
    tuple(Phase(state, 30.0) for state in ("Ggr", "yyr", "rGr", "ryr", "rrG", "rry")),
    ((("N", "N_0"),), (("N", "N_1"),), (("E", "E_0"),)),
    frozenset({(0, 2), (2, 0), (1, 2), (2, 1)}),
)
N, LEFT, E = 0, 1, 2

LENGTH_M = 5.0


class Sumo:
    """What a street looks like, and what was shown there."""

    def __init__(self) -> None:
        self.lanes: dict[str, dict[str, float]] = {}
        self.people: dict[str, dict[str, str]] = {}
        self.speed_m_per_s: dict[str, float] = {}
        self.state = "rrr"
        self.shown: list[str] = []

    def show(self, name: str, state: str) -> None:
        assert name == "J"
        assert state != self.state or not self.shown, "what is shown already need not be said"
        self.state = state
        self.shown.append(state)

    def module(self) -> Any:
        made: Any = ModuleType("libsumo")
        places = lambda vehicle: next(lane[vehicle] for lane in self.lanes.values() if vehicle in lane)  # noqa: E731
        goals = lambda person: next(edge[person] for edge in self.people.values() if person in edge)  # noqa: E731
        made.lane = SimpleNamespace(getLastStepVehicleIDs=lambda lane: tuple(self.lanes.get(lane, ())))
        made.vehicle = SimpleNamespace(
            getLanePosition=places, getSpeed=lambda v: self.speed_m_per_s[v], getLength=lambda _: LENGTH_M
        )
        made.edge = SimpleNamespace(getLastStepPersonIDs=lambda edge: tuple(self.people.get(edge, ())))
        made.person = SimpleNamespace(getNextEdge=goals)
        made.trafficlight = SimpleNamespace(
            setRedYellowGreenState=self.show, getRedYellowGreenState=lambda _: self.state
        )
        return made


@pytest.fixture
def sumo() -> Sumo:
    return Sumo()


@pytest.fixture
def drive(sumo: Sumo, monkeypatch: pytest.MonkeyPatch) -> Any:
    """The module under test, on the pretended SUMO."""
    monkeypatch.setattr(sumo_drive, "libsumo", sumo.module())
    return sumo_drive


@pytest.fixture
def signal() -> Signal:
    found = read_signal(CROSS)
    assert [movement.lanes for movement in found.movements] == [("N_0",), ("N_1",), ("E_0",)]
    assert found.states == ("Ggr", "rGr", "rrG")
    return found


def sight(
    *views: tuple[str, float, tuple[tuple[int, float], ...]],
    downstream: Sequence[Sequence[str]] = (),
    inside: tuple[str, ...] = (),
) -> Any:
    ways_on = tuple(tuple(lanes) for lanes in downstream or [[] for _ in range(3)])
    pieces = tuple(sumo_network.View(lane, from_m, 0.0, parts) for lane, from_m, parts in views)
    return sumo_network.Sight(pieces, (), ways_on, inside)


# --- cameras ---


def test_who_is_in_the_reach_is_counted_once_as_he_comes(drive: Any, sumo: Sumo, signal: Signal) -> None:
    camera = drive.Camera(
        signal, sight(("up", 40.0, ((N, 1.0),)), ("N_0", 0.0, ((N, 1.0),)), ("E_0", 0.0, ((E, 1.0),)))
    )
    steps = [
        ({"up": {"a": 39.9}}, [0, 0, 0], [0, 0, 0]),
        ({"up": {"a": 40.0}, "E_0": {"b": 3.0}}, [1, 0, 1], [1, 0, 1]),
        ({"up": {"c": 50.0}, "N_0": {"a": 0.0}, "E_0": {"b": 3.0}}, [2, 0, 1], [1, 0, 0]),
        ({"N_0": {"c": 1.0}}, [1, 0, 0], [0, 0, 0]),
        ({}, [0, 0, 0], [0, 0, 0]),
        ({"N_0": {"c": 1.0}}, [1, 0, 0], [1, 0, 0]),
    ]
    for lanes, present_veh, arrived_veh in steps:
        sumo.lanes = lanes
        camera.count()
        assert (camera.present_veh, camera.arrived_veh) == (present_veh, arrived_veh), lanes


def test_who_may_go_either_way_counts_in_parts(drive: Any, sumo: Sumo, signal: Signal) -> None:
    camera = drive.Camera(signal, sight(("up", 0.0, ((N, 0.5), (LEFT, 0.5))), ("N_1", 0.0, ((LEFT, 1.0),))))
    sumo.lanes = {"up": {"a": 1.0}, "N_1": {"b": 1.0}}
    camera.count()
    assert camera.present_veh == camera.arrived_veh == [0.5, 1.5, 0.0]


def test_people_count_who_wait_for_this_crossing(drive: Any, sumo: Sumo, signal: Signal) -> None:
    crossing = sumo_network.Crossing(":w", ":c", E)
    camera = drive.Camera(signal, sumo_network.Sight((), (crossing,), ((), (), ()), ()))
    sumo.people = {":w": {"p": ":c", "q": ":other"}}
    for arrived_veh in (1.0, 0.0):
        camera.count()
        assert (camera.present_veh, camera.arrived_veh) == ([0.0, 0.0, 1.0], [0.0, 0.0, arrived_veh])


@pytest.mark.parametrize(
    ("lanes", "speed_m_per_s", "occupied"),
    [
        ({}, 0.0, False),
        ({":J_0": {"a": 3.0}}, 0.9, True),
        ({":J_0": {"a": 3.0}}, 1.1, False),  # drives on
        ({":J_1": {"a": 3.0}}, 0.0, True),
        ({"N_0": {"a": 99.0}}, 0.0, False),  # before the stop line
        ({"X_0": {"a": LENGTH_M - 0.1}}, 0.0, True),  # its tail is still inside
        ({"X_0": {"a": LENGTH_M + 0.1}}, 0.0, False),
    ],
)
def test_who_stands_across_the_junction_is_seen(
    drive: Any, sumo: Sumo, lanes: dict[str, dict[str, float]], speed_m_per_s: float, occupied: bool
) -> None:
    seen = sight(("N_0", 0.0, ((N, 1.0),)), downstream=[["X_0"], [], []], inside=(":J_0", ":J_1"))
    sumo.lanes, sumo.speed_m_per_s = lanes, {"a": speed_m_per_s}
    assert drive.JunctionCamera(seen).is_occupied() is occupied


# --- a signal that is controlled ---


def runs(states: Sequence[str]) -> list[tuple[str, int]]:
    return [(state, len(list(same))) for state, same in groupby(states)]


def seconds(
    driver: Any, sumo: Sumo, waiting: Sequence[float], count: int, downstream: Sequence[float] | None = None
) -> list[str]:
    seen = []
    for _ in range(count):
        driver.drive(waiting, [0.0, 0.0, 0.0], downstream)
        seen.append(sumo.state)
    return seen


def test_lamps_follow_who_waits_second_by_second(drive: Any, sumo: Sumo, signal: Signal) -> None:
    driver = drive.Driver(signal, TIMES, REACH_M, "max-pressure@interval=1", 1)
    assert sumo.shown == ["rrr"], "all red before the first second"
    seen = seconds(driver, sumo, [5.0, 0.0, 0.0], 40) + seconds(driver, sumo, [0.0, 0.0, 5.0], 40)
    driver.close()
    (red, red_s), (green, green_s), *rest = runs(seen)
    assert (red, green) == ("rrr", "Ggr")
    assert red_s + green_s == 40, "a green ends when somebody waits who is not in it, and no sooner"
    assert rest == [("yyr", 4), ("rrr", 3), ("rrG", 33)], "amber and all red are what was asked for"


def test_what_is_green_before_and_after_stays_green(drive: Any, sumo: Sumo, signal: Signal) -> None:
    driver = drive.Driver(signal, TIMES, REACH_M, "max-pressure@interval=1", 1)
    seconds(driver, sumo, [5.0, 0.0, 0.0], 30)
    assert sumo.state == "Ggr"
    seen = seconds(driver, sumo, [0.0, 9.0, 0.0], 20, downstream=[9.0, 0.0, 0.0])
    driver.close()
    assert runs(seen) == [("ygr", 4), ("rGr", 16)], "it gives way while the other still has amber"


def test_minimum_green_is_kept_against_who_waits(drive: Any, sumo: Sumo, signal: Signal) -> None:
    driver = drive.Driver(signal, TIMES, REACH_M, "random@interval=1", 3)
    seen = runs(seconds(driver, sumo, [5.0, 5.0, 5.0], 400))
    driver.close()
    assert len(seen) > 40
    for link in range(3):
        times = [(letter, length) for letter, length in runs([s[link].lower() for s, n in seen for _ in range(n)])][
            1:-1
        ]
        assert min(length for letter, length in times if letter == "g") == TIMES.min_green_s
        assert {length for letter, length in times if letter == "y"} == {TIMES.yellow_s}


def test_maximum_green_is_kept_for_who_waits(drive: Any, sumo: Sumo, signal: Signal) -> None:
    driver = drive.Driver(signal, TIMES, REACH_M, "naive", 1)
    seen = runs(seconds(driver, sumo, [500.0, 0.0, 1.0], 200))
    driver.close()
    assert max(length for state, length in seen if state[N] in "Gg") <= TIMES.max_green_s + 1
    assert "rrG" in dict(seen)


def test_the_library_is_told_of_the_seed_and_takes_the_way_to_the_stop_line_from_the_site(
    drive: Any, signal: Signal, monkeypatch: pytest.MonkeyPatch
) -> None:
    told: dict[str, object] = {}
    right = drive.CoreJunction

    def noting(site: bytes, chooser: str, **words: object) -> object:
        told.update(words, chooser=chooser)
        return right(site, chooser, **words)

    monkeypatch.setattr(drive, "CoreJunction", noting)
    drive.Driver(signal, TIMES, REACH_M, "random", 77).close()
    assert told == {"chooser": "random", "seed": 77}


def test_vehicles_beyond_the_junction_reach_the_chooser(drive: Any, sumo: Sumo, signal: Signal) -> None:
    driver = drive.Driver(signal, TIMES, REACH_M, "max-pressure", 1)
    seconds(driver, sumo, [9.0, 0.0, 8.0], 30, downstream=[7.0, 0.0, 0.0])
    driver.close()
    assert sumo.state == "rrG"


# --- who watches ---


def test_a_red_is_as_long_as_somebody_was_there_in_every_second(drive: Any, sumo: Sumo, signal: Signal) -> None:
    watch = drive.Watch(signal)
    for state, waits, count in (("rrG", 1.0, 5), ("rrG", 0.5, 1), ("rrG", 1.0, 7), ("Ggr", 1.0, 9), ("yyr", 1.0, 3)):
        sumo.state = state
        for _ in range(count):
            watch.look([waits, 0.0, 0.0])
    assert watch.longest_red_s == 7


def test_a_lane_waits_until_all_its_links_go(drive: Any, sumo: Sumo) -> None:
    lanes = ((("N", "N_0"),), (("N", "N_0"),), (("E", "E_0"),))
    watch = drive.Watch(read_signal(Programme("J", CROSS.phases, lanes, CROSS.foes)))
    for state, count in (("rGr", 4), ("Ggr", 2), ("rrG", 3)):
        sumo.state = state
        for _ in range(count):
            watch.look([1.0, 0.0])
    assert watch.longest_red_s == 4


def test_a_switch_is_another_stage_than_the_last(drive: Any, sumo: Sumo, signal: Signal) -> None:
    watch = drive.Watch(signal)
    for state in ("rrr", "Ggr", "Ggr", "yyr", "rrr", "Ggr", "yyr", "rrr", "rrG", "rrr", "rGr"):
        sumo.state = state
        watch.look([0.0, 0.0, 0.0])
    assert watch.switches == 2


# --- all signals ---


class Noted:
    """A driver who notes what he is told."""

    def __init__(self, *, waits: bool = False) -> None:
        self.waits = waits
        self.told: list[tuple[list[float], list[float], list[float]]] = []
        self.occupied: list[bool] = []
        self.announced: list[object] = []
        self.foreseen: list[Sequence[Sequence[float]]] = []

    def drive(
        self,
        present_veh: list[float],
        arrived_veh: list[float],
        downstream_veh: list[float],
        *,
        occupied: bool,
        announced: object,
        foreseen_veh: Sequence[Sequence[float]],
    ) -> None:
        self.announced.append(announced)
        self.foreseen.append(foreseen_veh)
        self.told.append((list(present_veh), list(arrived_veh), list(downstream_veh)))
        self.occupied.append(occupied)


def test_only_who_waits_for_it_is_told_of_an_occupied_junction(drive: Any, sumo: Sumo, signal: Signal) -> None:
    drivers = [Noted(), Noted(waits=True)]
    street = drive.Street([signal, signal], [sight(inside=(":J_0",)), sight(inside=(":J_0",))], drivers)
    sumo.lanes, sumo.speed_m_per_s = {":J_0": {"a": 1.0}}, {"a": 0.0}
    street.second()
    sumo.lanes = {}
    street.second()
    assert [driver.occupied for driver in drivers] == [[False, False], [True, False]]


def test_everybody_hears_what_his_own_neighbours_say(drive: Any, signal: Signal) -> None:
    drivers = [Noted(), Noted()]
    gateways = [SimpleNamespace(listen=lambda: ["to the first"]), SimpleNamespace(listen=lambda: ["to the second"])]
    drive.Street([signal, signal], [sight(), sight()], drivers, gateways).second()
    assert [driver.announced for driver in drivers] == [[["to the first"]], [["to the second"]]]
    drive.Street([signal, signal], [sight(), sight()], drivers).second()
    assert [driver.announced[-1] for driver in drivers] == [(), ()]


def test_what_one_street_has_seen_the_next_one_foresees(drive: Any, sumo: Sumo, signal: Signal) -> None:
    """N is the first approach, E the second."""
    seen = sight(("N_0", 0.0, ((N, 1.0),)), ("E_0", 0.0, ((E, 1.0),)))
    steps: list[dict[str, dict[str, float]]] = [{"N_0": {"a": 1.0}}, {"N_0": {"a": 9.0, "b": 0.0}}, {"E_0": {"c": 0.0}}]

    def drive_by(street: Any) -> Any:
        for sumo.lanes in steps:
            street.second()
        return street.record

    blind, told = Noted(), Noted()
    record = drive_by(drive.Street([signal], [seen], [blind]))
    assert record.first_s == [{"a": 1, "b": 2, "c": 3}]
    drive_by(drive.Street([signal], [seen], [told], foresight=record))
    assert blind.foreseen == [(), (), ()]
    assert told.foreseen == [record.rows(0, second) for second in (1, 2, 3)]
    assert [[row[:3] for row in rows] for rows in told.foreseen[:2]] == [[[1, 0, 0], [0, 1, 0]], [[0, 0, 0], [1, 0, 0]]]


def test_an_oracle_without_a_record_is_refused(drive: Any, signal: Signal) -> None:
    with pytest.raises(LibraryError, match="0 foreseen rows ; a row of seconds an approach"):
        drive.Driver(signal, TIMES, REACH_M, "rollout:oracle", 1)
    drive.Driver(signal, TIMES, REACH_M, "rollout:oracle", 1, [[0.0, 1.0]] * 2).close()


def test_everybody_decides_with_the_counts_of_this_second(drive: Any, sumo: Sumo, signal: Signal) -> None:
    near = sight(("N_0", 0.0, ((N, 1.0),)), downstream=[["X_0", "X_1"], ["nowhere"], []])
    far = sight(("X_0", 0.0, ((E, 1.0),)), ("X_1", 0.0, ((N, 0.5), (E, 0.5))))
    drivers = [Noted(), Noted()]
    street = drive.Street([signal, signal], [near, far], drivers)
    sumo.state = "rrG"
    sumo.lanes = {"N_0": {"a": 1.0}, "X_0": {"b": 1.0, "c": 2.0}, "X_1": {"d": 1.0}}
    street.second()
    # On X_0 wait 2.5 for E; on X_1, by the same counts, half of 2.5 and half of 0.5: 4.0 on two ways.
    assert drivers[0].told == [([1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0])]
    assert drivers[1].told == [([0.5, 0.0, 2.5], [0.5, 0.0, 2.5], [0.0, 0.0, 0.0])]
    street.second()
    assert drivers[0].told[1] == ([1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [2.0, 0.0, 0.0])
    assert street.longest_red_s == 2
    assert street.switches == 0
