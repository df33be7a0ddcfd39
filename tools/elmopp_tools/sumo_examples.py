# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The example scenarios for SUMO: which junctions there are, and who drives through them.

The demands are chosen by experiment, see docs/sumo.md for what SUMO's own actuated control makes of them.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from elmopp_tools.sumo_nets import Place, Plan, Road

ARM_M = 400.0
FAST_ARM_M, SHORT_ARM_M = 500.0, 150.0
GRID_M, PAPER_M, BORDER_M = 200.0, 300.0, 300.0
TOWN_M_PER_S, FAST_M_PER_S = 13.9, 16.7  # 50 and 60 km/h
PLATOON_S, PLATOON_CYCLE_S = 30, 80
SWAP_S = 300

# Lanes of an approach from the kerb inwards, by what each lets do.
ONE = ("rsl",)
SHARED = ("rs", "sl")
EXCLUSIVE = ("rs", "l")
THREE = ("rs", "s", "l")
PAPER = ("r", "s", "l")

CLOCKWISE = "NESW"  # from N the right turn leads to W, the left one to E
TOWARDS: Mapping[str, Place] = {"N": (0.0, 1.0), "E": (1.0, 0.0), "S": (0.0, -1.0), "W": (-1.0, 0.0)}


@dataclass(frozen=True)
class Flow:
    """Vehicles an hour from one end to another, from a second to a second."""

    start: str
    end: str
    veh_per_h: float
    begin_s: int
    end_s: int


@dataclass(frozen=True)
class Scenario:
    """A network, who drives through it in `end_s` seconds, and what it is for."""

    name: str
    what: str
    plan: Plan
    flows: tuple[Flow, ...]
    end_s: int

    @property
    def veh_per_h(self) -> float:
        """The whole demand, its mean over the time."""
        return sum(flow.veh_per_h * (flow.end_s - flow.begin_s) for flow in self.flows) / self.end_s


def scenarios(end_s: int) -> tuple[Scenario, ...]:
    """All of them, so many seconds long."""
    always = [(0, end_s)]
    one, shared = crossroads(ONE, "two"), crossroads(SHARED, "permissive")
    exclusive, three = crossroads(EXCLUSIVE, "protected"), crossroads(THREE, "eight")
    split, major = crossroads(SHARED, "split"), _major()

    def scenario(name: str, what: str, plan: Plan, *flows: Iterable[Flow]) -> Scenario:
        return Scenario(name, what, plan, tuple(flow for some in flows for flow in some), end_s)

    return (
        scenario("tee", "three arms, stages that overlap", _tee(), _tee_flows(end_s)),
        scenario("single", "left turns share the only lane and give way", one, turning((330, 260), 0.15, 0.10, always)),
        scenario("light", "hardly anybody there", one, turning((100, 100), 0.15, 0.12, always)),
        scenario(
            "shared", "left turns share a lane, with and without right of way",
            shared, turning((560, 400), 0.12, 0.12, always),
        ),
        scenario("protected-low", "a lane for left turns, light", exclusive, turning((420, 300), 0.12, 0.15, always)),
        scenario("protected-high", "the same, high demand", exclusive, turning((625, 625), 0.12, 0.18, always)),
        scenario("protected-full", "the same, near capacity", exclusive, turning((690, 690), 0.12, 0.18, always)),
        scenario("unbalanced", "four in five from north and south", exclusive, turning((760, 180), 0.12, 0.15, always)),
        scenario(
            "alternating", "the main direction changes every 300 s", exclusive,
            turning((620, 240), 0.12, 0.15, periods(end_s, 0, SWAP_S, 2 * SWAP_S)),
            turning((240, 620), 0.12, 0.15, periods(end_s, SWAP_S, SWAP_S, 2 * SWAP_S)),
        ),
        scenario("eight", "eight stages in two rings", three, turning((980, 760), 0.12, 0.18, always)),
        scenario("split", "one stage an arm", split, turning((480, 480), 0.15, 0.20, always)),
        scenario("major", "long fast main arms, short side arms", major, turning((140, 700), 0.08, 0.06, always)),
        scenario(
            "platoons", "the main road's vehicles come in 30 of 80 s", major,
            turning((140, 0), 0.20, 0.20, always),
            turning((0, 450 * PLATOON_CYCLE_S / PLATOON_S), 0.08, 0.08, periods(end_s, 0, PLATOON_S, PLATOON_CYCLE_S)),
        ),
        scenario("grid", "four by four signals 200 m apart", _grid(4), _grid_flows(4, end_s)),
        scenario("paper", "the paper's G_alpha, four signals in a ring", _paper(), _paper_flows(end_s)),
    )  # fmt: skip


def crossroads(lanes: Sequence[str], phasing: str) -> Plan:
    """One signal with the same lanes on four arms."""
    return _junction(dict.fromkeys(CLOCKWISE, lanes), phasing)


def periods(end_s: int, first_s: int, length_s: int, cycle_s: int) -> list[tuple[int, int]]:
    """The first `length_s` seconds of every cycle."""
    return [(begin_s, min(end_s, begin_s + length_s)) for begin_s in range(first_s, end_s, cycle_s)]


def turning(
    veh_per_h: tuple[float, float], right: float, left: float, when: Iterable[tuple[int, int]]
) -> Iterator[Flow]:
    """Flows of a four-way junction: vehicles an hour from each of north and south, and of east and west; who turns."""
    for begin_s, end_s in when:
        for at, side in enumerate(CLOCKWISE):
            for steps, share in ((3, right), (2, 1.0 - right - left), (1, left)):
                volume = veh_per_h[at % 2] * share
                if volume > 0.0:
                    yield Flow(side, CLOCKWISE[(at + steps) % 4], volume, begin_s, end_s)


def _junction(
    lanes: Mapping[str, Sequence[str]],
    phasing: str,
    *,
    length_m: Mapping[str, float] | None = None,
    speed_m_per_s: Mapping[str, float] | None = None,
) -> Plan:
    """One signal C with an arm to each of the named sides."""
    lengths, speeds = length_m or {}, speed_m_per_s or {}
    ends = {side: _away((0.0, 0.0), side, lengths.get(side, ARM_M)) for side in lanes}
    arms = (_arm(side, "C", letters, speeds.get(side, TOWN_M_PER_S)) for side, letters in lanes.items())
    return Plan({"C": (0.0, 0.0)}, ends, tuple(arms), phasing)


def _away(place: Place, side: str, distance_m: float) -> Place:
    x, y = TOWARDS[side]
    return place[0] + x * distance_m, place[1] + y * distance_m


def _arm(end: str, signal: str, lanes: Sequence[str], speed_m_per_s: float = TOWN_M_PER_S) -> Road:
    """As many lanes lead out as in."""
    return Road(end, signal, tuple(lanes), ("",) * len(lanes), speed_m_per_s)


def _tee() -> Plan:
    return _junction({"E": ("s", "sl"), "S": ("r", "l"), "W": ("rs", "s")}, "tee")


def _tee_flows(end_s: int) -> Iterator[Flow]:
    pairs = (("E", "W", 550, 550), ("E", "S", 130, 150), ("W", "S", 120, 130))
    for first, second, there_veh_per_h, back_veh_per_h in pairs:
        yield Flow(first, second, there_veh_per_h, 0, end_s)
        yield Flow(second, first, back_veh_per_h, 0, end_s)


def _major() -> Plan:
    return _junction(
        {"N": ONE, "E": SHARED, "S": ONE, "W": SHARED},
        "two",
        length_m={"N": SHORT_ARM_M, "E": FAST_ARM_M, "S": SHORT_ARM_M, "W": FAST_ARM_M},
        speed_m_per_s={"E": FAST_M_PER_S, "W": FAST_M_PER_S},
    )


def _grid(count: int) -> Plan:
    """Signals a0, a1, ... northwards, then b0, ... in the next column; ends W0, ... on all sides."""
    columns, rows = "abcdefgh"[:count], range(count)
    signals = {f"{column}{row}": (x * GRID_M, row * GRID_M) for x, column in enumerate(columns) for row in rows}
    ends: dict[str, Place] = {}
    roads = []
    for step in rows:
        borders = {"W": f"{columns[0]}{step}", "E": f"{columns[-1]}{step}"}
        borders |= {"S": f"{columns[step]}0", "N": f"{columns[step]}{count - 1}"}
        for side, signal in borders.items():
            ends[f"{side}{step}"] = _away(signals[signal], side, BORDER_M)
            roads.append(_arm(f"{side}{step}", signal, SHARED))
    for x, column in enumerate(columns):
        for row in rows:
            if x + 1 < count:
                roads.append(Road(f"{column}{row}", f"{columns[x + 1]}{row}", SHARED, SHARED))
            if row + 1 < count:
                roads.append(Road(f"{column}{row}", f"{column}{row + 1}", SHARED, SHARED))
    return Plan(signals, ends, tuple(roads), "permissive")


def _grid_flows(count: int, end_s: int) -> Iterator[Flow]:
    """Straight across along every row and column, and from every end to the two sides beside it; both ways."""
    straight_veh_per_h, turning_veh_per_h = 260.0, 30.0
    for step in range(count):
        for first, second in ((f"W{step}", f"E{step}"), (f"S{step}", f"N{step}")):
            for start, end in ((first, second), (second, first)):
                yield Flow(start, end, straight_veh_per_h, 0, end_s)
        for first in (f"W{step}", f"E{step}"):
            for second in (f"N{(step + 1) % count}", f"S{(step + count - 1) % count}"):
                for start, end in ((first, second), (second, first)):
                    yield Flow(start, end, turning_veh_per_h, 0, end_s)


def _paper() -> Plan:
    """The ring a b c d with two roads more at each, drawn dashed there.

    Which lanes there are is the paper's adjacency tensor: from a to b is no lane for left turns, from b to a only the
    one for right turns, elsewhere a lane a turn.
    """
    signals = {"a": (0.0, PAPER_M), "b": (PAPER_M, PAPER_M), "c": (PAPER_M, 0.0), "d": (0.0, 0.0)}
    sides = {"a": "NW", "b": "NE", "c": "ES", "d": "SW"}
    ends = {f"{name}{side}": _away(place, side, BORDER_M) for name, place in signals.items() for side in sides[name]}
    ring = (
        Road("a", "b", ("r", "s"), ("r",)),
        Road("b", "c", PAPER, PAPER),
        Road("c", "d", PAPER, PAPER),
        Road("d", "a", PAPER, PAPER),
    )
    return Plan(signals, ends, (*ring, *(_arm(end, end[0], PAPER) for end in ends)), "eight")


def _paper_flows(end_s: int) -> Iterator[Flow]:
    """Nobody can drive straight from b over a to the west, so those from the east turn north there."""
    straight = ("aN dS", "dS aN", "bN cS", "cS bN", "dW cE", "cE dW", "aW bE", "bE aN")
    turns = ("aN bE", "aW dS", "bN cE", "bE cS", "cE bN", "cS dW", "dS cE", "dW aN", "aN aW", "bE bN", "cS cE", "dW dS")
    for pairs, veh_per_h in ((straight, 240.0), (turns, 60.0)):
        for pair in pairs:
            start, end = pair.split()
            yield Flow(start, end, veh_per_h, 0, end_s)
