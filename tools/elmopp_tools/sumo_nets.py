# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Builds SUMO networks of signals from a plan of places and roads, with netconvert.

A road's lanes say at each end where they lead, from the kerb inwards, in letters: r right, s straight, l left. The
signal's stages follow from a kind of phasing; a link that crosses a stronger one in its stage gives way (straight
before right before left).
"""

import math
import re
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import sumolib

from elmopp_tools.sumo_signal import Phase, Programme, Signal, read_signal, transition

STRAIGHT_DEG = 45.0
STRENGTH = "lrs"  # the later, the stronger
GREEN_S = 30.0
TURN_GREEN_S = 12.0
YELLOW_S = 3
SIDES = "ENWS"  # by the quadrant of the angle from which an arm comes


class NetError(Exception):
    """netconvert refused; the text is its own first line."""


@dataclass(frozen=True)
class Road:
    """Two-way; `forth` are the lanes from `start` at the signal `end`, `back` the other way. Metres a second."""

    start: str
    end: str
    forth: tuple[str, ...]
    back: tuple[str, ...]
    speed_m_per_s: float = 13.9


@dataclass(frozen=True)
class Plan:
    """Signals and ends with their places in metres, the roads between them, and how the signals are phased."""

    signals: dict[str, tuple[float, float]]
    ends: dict[str, tuple[float, float]]
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


def build(plan: Plan, folder: Path, name: str) -> None:
    """Writes NAME.net.xml into a folder. Two passes: the paths across a signal say which links cross."""
    edges = list(_edges(plan))
    links = {signal: _links(signal, edges) for signal in plan.signals}
    sources = folder / "plain"
    sources.mkdir(parents=True, exist_ok=True)
    _write_plain(sources, plan, edges, links)
    net = folder / f"{name}.net.xml"
    _netconvert(sources, net, with_phases=False)
    crossing = sumolib.net.readNet(str(net))
    programmes = {signal: _programme(signal, plan, links[signal], _foes(crossing, links[signal])) for signal in links}
    (sources / "n.tll.xml").write_bytes(_logics(programmes, links))
    _netconvert(sources, net, with_phases=True)
    # The date and the folder in netconvert's comment would make every file another one.
    net.write_text(re.sub(r"<!--.*?-->\n*", "", net.read_text(encoding="utf-8"), flags=re.DOTALL), encoding="utf-8")
    for file in sources.iterdir():
        file.unlink()
    sources.rmdir()


def _edges(plan: Plan) -> Iterator[Edge]:
    places = plan.signals | plan.ends
    for road in plan.roads:
        for start, end, lanes in ((road.start, road.end, road.forth), (road.end, road.start, road.back)):
            (x, y), (to_x, to_y) = places[start], places[end]
            heading = math.degrees(math.atan2(to_y - y, to_x - x))
            yield Edge(f"{start}{end}", start, end, lanes, road.speed_m_per_s, heading)


def _links(signal: str, edges: Sequence[Edge]) -> list[Link]:
    """All ways across a signal, approach by approach, lane by lane from the kerb."""
    found: list[Link] = []
    ways_out = [edge for edge in edges if edge.start == signal]
    for edge in (edge for edge in edges if edge.end == signal):
        side = SIDES[round((edge.heading_deg + 180.0) / 90.0) % 4]
        exits = {_turn(edge, out): out for out in ways_out if out.end != edge.start}
        for turn in "rsl":
            lanes = [index for index, letters in enumerate(edge.lanes) if turn in letters]
            if turn in exits:
                found.extend(_across(side, turn, edge, exits[turn], lanes))
    return sorted(found, key=lambda link: (link.start, link.start_lane, "rsl".index(link.turn)))


def _across(side: str, turn: str, start: Edge, end: Edge, lanes: Sequence[int]) -> Iterator[Link]:
    last = len(end.lanes) - 1
    for rank, lane in enumerate(lanes):
        to_lane = max(0, last - (len(lanes) - 1 - rank)) if turn == "l" else min(rank, last)
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
    for lets in stages_of(plan.phasing):
        green = [index for index, link in enumerate(links) if lets(link)]
        if green:
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
        for state, seconds in _phases(signal):
            ElementTree.SubElement(logic, "phase", duration=str(seconds), state=state)
    for name, ways in links.items():
        for index, link in enumerate(ways):
            ElementTree.SubElement(root, "connection", _connection(link), tl=name, linkIndex=str(index))
    text: bytes = ElementTree.tostring(root)
    return text


def _phases(signal: Signal) -> Iterator[tuple[str, int]]:
    for stage, state in enumerate(signal.states):
        yield state, round(signal.durations_s[stage])
        following = (stage + 1) % len(signal.states)
        if following != stage:
            amber, _ = transition(signal, stage, following)
            if "y" in amber:
                yield amber, YELLOW_S


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


def _netconvert(sources: Path, net: Path, *, with_phases: bool) -> None:
    words = ["--node-files", "n.nod.xml", "--edge-files", "n.edg.xml", "--connection-files", "n.con.xml"]
    words += ["--output-file", str(net.resolve()), "--no-turnarounds", "--no-warnings"]
    words += ["--tllogic-files", "n.tll.xml"] if with_phases else []
    netconvert = Path(sys.prefix) / "bin" / "netconvert"
    done = subprocess.run([netconvert, *words], cwd=sources, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        errors = [line for line in done.stderr.splitlines() if line.startswith("Error")] or [done.stderr.strip()]
        raise NetError(f"netconvert says: {errors[0]}")
