# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Builds SUMO networks of signals from a plan of places and roads, with netconvert.

A road's lanes say where they lead, from the kerb inwards, in letters: r right, s straight, l left. The signal's stages
follow from a kind of phasing; a link that crosses a stronger one in its stage gives way (straight before right before
left).
"""

import math
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import sumolib

from elmopp_tools.sumo_own import phases_of
from elmopp_tools.sumo_signal import Phase, Programme, Times, read_signal

STRAIGHT_DEG = 45.0
STRENGTH = "lrs"  # the later, the stronger
GREEN_S = 30.0
TURN_GREEN_S = 12.0
NET_TIMES = Times(yellow_s=3, all_red_s=0, min_green_s=1, max_green_s=1, red_bound_s=0)  # a network's own: amber alone
SIDES = "ENWS"  # by the quadrant of the angle from which an arm comes


Place = tuple[float, float]  # metres to the east and to the north


class NetError(Exception):
    """netconvert refused; the text is its own first line."""


@dataclass(frozen=True)
class Road:
    """Two-way; `forth` are the lanes that come from `start`, `back` those from `end`. At an end no lane has letters."""

    start: str
    end: str
    forth: tuple[str, ...]
    back: tuple[str, ...]
    speed_m_per_s: float = 13.9

    @property
    def forth_name(self) -> str:
        """SUMO's name of the way from `start`."""
        return f"{self.start}{self.end}"

    @property
    def back_name(self) -> str:
        """SUMO's name of the way from `end`."""
        return f"{self.end}{self.start}"


@dataclass(frozen=True, eq=False)
class Plan:
    """Signals and ends with their places in metres, the roads between them, and how the signals are phased."""

    signals: dict[str, Place]
    ends: dict[str, Place]
    roads: tuple[Road, ...]
    phasing: str


@dataclass(frozen=True)
class Link:
    """One lane's way across a signal: from which side, which turn, between which lanes."""

    side: str
    turn: str
    start: str
    end: str
    start_lane: int
    end_lane: int


@dataclass(frozen=True)
class Edge:
    """One direction of a road."""

    name: str
    start: str
    end: str
    lanes: tuple[str, ...]
    speed_m_per_s: float
    heading_deg: float


Stage = Callable[[Link], bool]


def stages_of(phasing: str) -> list[Stage]:
    """What each stage lets go."""
    both = ("NS", "EW")
    match phasing:
        case "two":
            return [_let(sides, "rsl") for sides in both]
        case "permissive":
            return [_let(sides, turns) for sides in both for turns in ("rsl", "l")]
        case "protected":
            return [_let(sides, turns) for sides in both for turns in ("rs", "l")]
        case "eight":
            pairs = [_let(sides, turns) for sides in both for turns in ("rs", "l")]
            return [*pairs, *(_let(side, "rsl") for side in "NSEW")]
        case "split":
            return [_let(side, "rsl") for side in "NESW"]
        case "tee":
            east = _either(_let("E", "sl"), _let("S", "r"))
            return [_let("EW", "rsl"), east, _either(_let("S", "rl"), _let("W", "r"))]
        case _:
            raise ValueError(phasing)


def _let(sides: str, turns: str) -> Stage:
    return lambda link: link.side in sides and link.turn in turns


def _either(first: Stage, second: Stage) -> Stage:
    return lambda link: first(link) or second(link)


def arms_of(plan: Plan, signal: str) -> dict[str, tuple[str, ...]]:
    """The lanes that come to a signal, by where they come from."""
    return {edge.start: edge.lanes for edge in edges_of(plan) if edge.end == signal}


def stages_at(plan: Plan, signal: str) -> list[list[int]]:
    """The links that are green in each stage.

    Where lanes are missing one stage may be a part of another; it is left out, unless those that it lets go give way
    in the other.
    """
    links = _links(signal, list(edges_of(plan)))
    stages = [[index for index, link in enumerate(links) if lets(link)] for lets in stages_of(plan.phasing)]
    if plan.phasing == "permissive":
        return [stage for stage in stages if stage]
    return [stage for stage in stages if stage and not any(set(stage) < set(other) for other in stages)]


def net_of(plan: Plan) -> bytes:
    """The network as netconvert makes it. Two passes: the paths across a signal say which links cross."""
    edges = list(edges_of(plan))
    links = {signal: _links(signal, edges) for signal in plan.signals}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        net = folder / "n.net.xml"
        _write_plain(folder, plan, edges, links)
        _netconvert(folder, with_phases=False)
        crossing = sumolib.net.readNet(str(net))
        programmes = {signal: _programme(signal, plan, ways, _foes(crossing, ways)) for signal, ways in links.items()}
        (folder / "n.tll.xml").write_bytes(_logics(programmes, links))
        _netconvert(folder, with_phases=True)
        # The date and the folder in netconvert's comment would make every file another one.
        return re.sub(rb"<!--.*?-->\n*", b"", net.read_bytes(), flags=re.DOTALL)


def edges_of(plan: Plan) -> Iterator[Edge]:
    """Both directions of all roads."""
    places = plan.signals | plan.ends
    for road in plan.roads:
        ways = (
            (road.forth_name, road.start, road.end, road.forth),
            (road.back_name, road.end, road.start, road.back),
        )
        for name, start, end, lanes in ways:
            (x, y), (to_x, to_y) = places[start], places[end]
            heading = math.degrees(math.atan2(to_y - y, to_x - x))
            yield Edge(name, start, end, lanes, road.speed_m_per_s, heading)


def turns_at(signal: str, edges: Iterable[Edge]) -> dict[str, dict[str, Edge]]:
    """By the name of each edge that comes to a signal: where which turn leads, without turning round."""
    there = list(edges)
    return {
        edge.name: {_turn(edge, out): out for out in there if out.start == signal and out.end != edge.start}
        for edge in there
        if edge.end == signal
    }


def _links(signal: str, edges: Sequence[Edge]) -> list[Link]:
    """All ways across a signal, approach by approach, lane by lane from the kerb."""
    found: list[Link] = []
    exits = turns_at(signal, edges)
    for edge in (edge for edge in edges if edge.end == signal):
        side = SIDES[round((edge.heading_deg + 180.0) / 90.0) % 4]
        for turn, out in exits[edge.name].items():
            lanes = [index for index, letters in enumerate(edge.lanes) if turn in letters]
            found.extend(_across(side, turn, edge, out, lanes))
    return sorted(found, key=lambda link: (link.start, link.start_lane, "rsl".index(link.turn)))


def _across(side: str, turn: str, start: Edge, end: Edge, lanes: Sequence[int]) -> Iterator[Link]:
    """Straight on one keeps the lane, counted from the kerb; a turn leads to the side to which it turns."""
    last = len(end.lanes) - 1
    for rank, lane in enumerate(lanes):
        to_lane = max(0, last - (len(lanes) - 1 - rank)) if turn == "l" else min(lane, last)
        yield Link(side, turn, start.name, end.name, lane, to_lane)


def _turn(edge: Edge, out: Edge) -> str:
    difference = (out.heading_deg - edge.heading_deg + 180.0) % 360.0 - 180.0
    if abs(difference) <= STRAIGHT_DEG:
        return "s"
    return "l" if difference > 0.0 else "r"


def _foes(net: sumolib.net.Net, links: Sequence[Link]) -> frozenset[tuple[int, int]]:
    places = []
    for link in links:
        lane = net.getLane(f"{link.start}_{link.start_lane}")
        way = next(c for c in lane.getOutgoing() if c.getToLane().getID() == f"{link.end}_{link.end_lane}")
        places.append((way.getJunction(), way.getJunctionIndex()))
    return frozenset(
        (i, j) for i, (node, a) in enumerate(places) for j, (_, b) in enumerate(places) if i != j and node.areFoes(a, b)
    )


def _programme(name: str, plan: Plan, links: Sequence[Link], foes: frozenset[tuple[int, int]]) -> Programme:
    """The green phases, without what lies between them."""
    phases: list[Phase] = []
    for green in stages_at(plan, name):
        state = "".join(_letter(index, green, links, foes) for index in range(len(links)))
        turns = {links[index].turn for index in green}
        phases.append(Phase(state, TURN_GREEN_S if turns == {"l"} else GREEN_S))
    lanes = tuple(((link.start, f"{link.start}_{link.start_lane}"),) for link in links)
    return Programme(name, tuple(phases), lanes, foes)


def _letter(index: int, green: Sequence[int], links: Sequence[Link], foes: frozenset[tuple[int, int]]) -> str:
    if index not in green:
        return "r"
    strength = STRENGTH.index(links[index].turn)
    gives_way = any(
        (index, other) in foes and STRENGTH.index(links[other].turn) >= strength for other in green if other != index
    )
    return "g" if gives_way else "G"


def _logics(programmes: dict[str, Programme], links: dict[str, list[Link]]) -> bytes:
    root = ElementTree.Element("tlLogics")
    for name, programme in programmes.items():
        signal = read_signal(programme)
        logic = ElementTree.SubElement(root, "tlLogic", id=name, type="static", programID="0", offset="0")
        for attributes in phases_of(signal, NET_TIMES, "static"):
            ElementTree.SubElement(logic, "phase", attributes)
    for name, ways in links.items():
        for index, link in enumerate(ways):
            ElementTree.SubElement(root, "connection", _connection(link), tl=name, linkIndex=str(index))
    text: bytes = ElementTree.tostring(root)
    return text


def _connection(link: Link) -> dict[str, str]:
    return {
        "from": link.start,
        "to": link.end,
        "fromLane": str(link.start_lane),
        "toLane": str(link.end_lane),
    }


def _write_plain(folder: Path, plan: Plan, edges: Sequence[Edge], links: dict[str, list[Link]]) -> None:
    nodes = ElementTree.Element("nodes")
    for kind, places in (("traffic_light", plan.signals), ("priority", plan.ends)):
        for name, (x, y) in places.items():
            ElementTree.SubElement(nodes, "node", id=name, x=f"{x:g}", y=f"{y:g}", type=kind)
    roads = ElementTree.Element("edges")
    for edge in edges:
        attributes = {"id": edge.name, "from": edge.start, "to": edge.end, "numLanes": str(len(edge.lanes))}
        ElementTree.SubElement(roads, "edge", attributes, speed=f"{edge.speed_m_per_s:g}")
    ways = ElementTree.Element("connections")
    for members in links.values():
        for link in members:
            ElementTree.SubElement(ways, "connection", _connection(link))
    for name, root in (("n.nod.xml", nodes), ("n.edg.xml", roads), ("n.con.xml", ways)):
        (folder / name).write_bytes(ElementTree.tostring(root))


def _netconvert(folder: Path, *, with_phases: bool) -> None:
    words = ["--node-files", "n.nod.xml", "--edge-files", "n.edg.xml", "--connection-files", "n.con.xml"]
    words += ["--output-file", "n.net.xml", "--no-turnarounds", "--no-warnings"]
    words += ["--tllogic-files", "n.tll.xml"] if with_phases else []
    netconvert = Path(sys.prefix) / "bin" / "netconvert"
    done = subprocess.run([netconvert, *words], cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        errors = [line for line in done.stderr.splitlines() if line.startswith("Error")] or [done.stderr.strip()]
        raise NetError(f"netconvert says: {errors[0]}")
