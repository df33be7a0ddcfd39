# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The command behind tools/sumo-scenarios: the example scenarios, written for SUMO and never stored.

Demand is Poisson and drawn by SUMO from its own seed, so that a seed means the same vehicles whatever the signals do: a
test holds departure times, routes and vehicles of two controllers against each other.
"""

import argparse
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

from elmopp_tools.outputs import EXIT_DONE, EXIT_REFUSED, OneLineParser, say
from elmopp_tools.sumo_nets import NetError, Plan, Road, build

EXIT_FAILED = 1

ARM_M = 400.0
END_S = 1800
SECONDS_PER_HOUR = 3600.0
FAST_M_PER_S = 16.7
PLATOON_S, PLATOON_CYCLE_S = 30, 80
SWAP_S = 300

# Lanes of an approach from the kerb inwards, by what each lets do.
ONE = ("rsl",)
SHARED = ("rs", "sl")
EXCLUSIVE = ("rs", "l")
THREE = ("rs", "s", "l")
PAPER = ("r", "s", "l")

DESCRIPTION = """\
Writes the example scenarios: for each NAME a folder DIR/NAME with NAME.sumocfg, its network and its vehicles. Without a
name all are written."""

EPILOG = """\
Exit codes: 0 done; 1 netconvert failed; 2 the request cannot be run, with one line that says what and what would be
right.

Examples:
  tools/sumo-scenarios --list
  tools/sumo-scenarios --out out/sumo protected-high eight"""


@dataclass(frozen=True)
class Flow:
    """Vehicles an hour from one end to another, from a second to a second."""

    start: str
    end: str
    veh_per_h: float
    begin_s: float = 0.0
    end_s: float = float(END_S)


@dataclass(frozen=True)
class Scenario:
    """A network and who drives through it."""

    name: str
    what: str
    plan: Plan
    flows: tuple[Flow, ...]

    @property
    def veh_per_h(self) -> float:
        """The whole demand, its mean over the time."""
        return sum(flow.veh_per_h * (flow.end_s - flow.begin_s) for flow in self.flows) / END_S


def junction(lanes: dict[str, Sequence[str]], phasing: str, *, length_m: dict[str, float] | None = None,
             speed_m_per_s: dict[str, float] | None = None) -> Plan:  # fmt: skip
    """One signal C with an arm to each of the named sides."""
    unit = {"N": (0.0, 1.0), "E": (1.0, 0.0), "S": (0.0, -1.0), "W": (-1.0, 0.0)}
    lengths, speeds = length_m or {}, speed_m_per_s or {}
    ends = {
        side: (unit[side][0] * lengths.get(side, ARM_M), unit[side][1] * lengths.get(side, ARM_M)) for side in lanes
    }
    roads = tuple(
        Road(side, "C", tuple(letters), tuple("s" * len(letters)), speeds.get(side, 13.9))
        for side, letters in lanes.items()
    )
    return Plan({"C": (0.0, 0.0)}, ends, roads, phasing)


def turning(volumes: dict[str, float], right: float, left: float, **times: float) -> tuple[Flow, ...]:
    """Flows of a four-way junction: vehicles an hour by arm, shares that turn."""
    order = "NESW"  # clockwise: from N the right turn leads to W, the left one to E
    flows = []
    for side, volume in volumes.items():
        at = order.index(side)
        for steps, share in ((3, right), (2, 1.0 - right - left), (1, left)):
            flows.append(Flow(side, order[(at + steps) % 4], volume * share, **times))
    return tuple(flows)


def four(letters: Sequence[str]) -> dict[str, Sequence[str]]:
    """The same lanes on all arms."""
    return dict.fromkeys("NESW", letters)


def grid(count: int, spacing_m: float, lanes: Sequence[str], phasing: str) -> Plan:
    """Signals in rows and columns, named by column and row, with roads to ends on all sides."""
    signals = {_at(x, y): (x * spacing_m, y * spacing_m) for x in range(count) for y in range(count)}
    ends: dict[str, tuple[float, float]] = {}
    roads = []
    back = tuple(lanes)
    for step in range(count):
        for first, second, place in (
            (f"W{step}", _at(0, step), (-spacing_m, step * spacing_m)),
            (f"E{step}", _at(count - 1, step), (count * spacing_m, step * spacing_m)),
            (f"S{step}", _at(step, 0), (step * spacing_m, -spacing_m)),
            (f"N{step}", _at(step, count - 1), (step * spacing_m, count * spacing_m)),
        ):
            ends[first] = place
            roads.append(Road(first, second, tuple(lanes), tuple("s" * len(lanes))))
    for x in range(count):
        for y in range(count):
            if x + 1 < count:
                roads.append(Road(_at(x, y), _at(x + 1, y), tuple(lanes), back))
            if y + 1 < count:
                roads.append(Road(_at(x, y), _at(x, y + 1), tuple(lanes), back))
    return Plan(signals, ends, tuple(roads), phasing)


def _at(x: int, y: int) -> str:
    return f"{'abcd'[x]}{y}"


def grid_flows(count: int, straight_veh_per_h: float, turning_veh_per_h: float) -> tuple[Flow, ...]:
    """Straight across along every row and column, both ways, and from every end to the two sides beside it."""
    flows = []
    for step in range(count):
        for first, second in ((f"W{step}", f"E{step}"), (f"S{step}", f"N{step}")):
            flows += [Flow(first, second, straight_veh_per_h), Flow(second, first, straight_veh_per_h)]
        for start in (f"W{step}", f"E{step}"):
            for end in (f"N{(step + 1) % count}", f"S{(step + count - 1) % count}"):
                flows += [Flow(start, end, turning_veh_per_h), Flow(end, start, turning_veh_per_h)]
    return tuple(flows)


def axes(north_south: float, east_west: float) -> dict[str, float]:
    """The same volume on opposite arms."""
    return {"N": north_south, "E": east_west, "S": north_south, "W": east_west}


def scenarios() -> tuple[Scenario, ...]:
    """All of them."""
    return (_tee(), *_one_lane(), *_two_lanes(), *_more_lanes(), *_major(), *_networks())


def _tee() -> Scenario:
    plan = junction({"E": ("s", "sl"), "S": ("r", "l"), "W": ("rs", "s")}, "tee")
    volumes = {("E", "W"): 550, ("E", "S"): 130, ("S", "E"): 150, ("S", "W"): 130, ("W", "E"): 550, ("W", "S"): 120}
    flows = tuple(Flow(start, end, float(volume)) for (start, end), volume in volumes.items())
    return Scenario("tee", "three arms, stages that overlap", plan, flows)


def _one_lane() -> Iterator[Scenario]:
    plan = junction(four(ONE), "two")
    yield Scenario("single", "one lane an arm, left turns give way", plan, turning(axes(330.0, 260.0), 0.15, 0.1))
    yield Scenario("light", "the same, hardly anybody there", plan, turning(axes(100.0, 100.0), 0.15, 0.12))


def _two_lanes() -> Iterator[Scenario]:
    shared = junction(four(SHARED), "permissive")
    what = "two lanes, left turns share one; with and without right of way"
    yield Scenario("shared", what, shared, turning(axes(560.0, 400.0), 0.12, 0.12))
    plan = junction(four(EXCLUSIVE), "protected")
    for name, what, volumes, left in (
        ("protected-low", "a lane for left turns, four stages", axes(420.0, 300.0), 0.15),
        ("protected-high", "the same with 2,500 vehicles an hour", axes(625.0, 625.0), 0.18),
        ("protected-full", "the same near capacity", axes(690.0, 690.0), 0.18),
        ("unbalanced", "the same, most of it north and south", axes(760.0, 180.0), 0.15),
    ):
        yield Scenario(name, what, plan, turning(volumes, 0.12, left))
    flows: list[Flow] = []
    for begin in range(0, END_S, SWAP_S):
        volumes = axes(620.0, 240.0) if begin // SWAP_S % 2 == 0 else axes(240.0, 620.0)
        flows += turning(volumes, 0.12, 0.15, begin_s=float(begin), end_s=float(begin + SWAP_S))
    yield Scenario("alternating", "the same, the main direction changes every 300 s", plan, tuple(flows))


def _more_lanes() -> Iterator[Scenario]:
    eight = junction(four(THREE), "eight")
    yield Scenario("eight", "three lanes, eight stages", eight, turning(axes(980.0, 760.0), 0.12, 0.18))
    split = junction(four(SHARED), "split")
    yield Scenario("split", "one stage an arm", split, turning(axes(480.0, 480.0), 0.15, 0.2))


def _major() -> Iterator[Scenario]:
    plan = junction(
        {"N": ONE, "S": ONE, "E": SHARED, "W": SHARED},
        "two",
        length_m={"N": 150.0, "S": 150.0, "E": 500.0, "W": 500.0},
        speed_m_per_s=dict.fromkeys("EW", FAST_M_PER_S),
    )
    what = "500 m of main road at 60 km/h, side roads of 150 m"
    yield Scenario("major", what, plan, turning(axes(140.0, 700.0), 0.08, 0.06))
    flows = list(turning(dict.fromkeys("NS", 140.0), 0.2, 0.2))
    packed = dict.fromkeys("EW", 450.0 * PLATOON_CYCLE_S / PLATOON_S)
    for begin in range(0, END_S, PLATOON_CYCLE_S):
        end_s = float(min(END_S, begin + PLATOON_S))
        flows += turning(packed, 0.08, 0.08, begin_s=float(begin), end_s=end_s)
    yield Scenario("platoons", "the same, the main road's vehicles in 30 of 80 s", plan, tuple(flows))


def _networks() -> Iterator[Scenario]:
    plan = grid(4, 200.0, SHARED, "permissive")
    yield Scenario("grid", "four by four signals 200 m apart", plan, grid_flows(4, 260.0, 30.0))
    what = "the paper's G_alpha: four junctions in a ring, a lane a turn"
    yield Scenario("paper", what, grid(2, 300.0, PAPER, "protected"), grid_flows(2, 330.0, 70.0))


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = OneLineParser(
        prog="tools/sumo-scenarios",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("names", metavar="NAME", nargs="*")
    parser.add_argument("--out", metavar="DIR", type=Path, help="where to")
    parser.add_argument("--list", action="store_true", help="say what there is and write nothing")
    options = parser.parse_args(arguments)
    known = {scenario.name: scenario for scenario in scenarios()}
    unknown = [name for name in options.names if name not in known]
    if unknown or (options.out is None and not options.list):
        wrong = f"unknown scenario {unknown[0]}" if unknown else "--out is missing"
        say("sumo-scenarios", f"{wrong} ; {'one of ' + ', '.join(known) if unknown else 'a folder, or --list'}")
        return EXIT_REFUSED
    chosen = [known[name] for name in options.names or known]
    if options.list:
        sys.stdout.writelines(_line(scenario) for scenario in chosen)
        return EXIT_DONE
    try:
        for scenario in chosen:
            write_scenario(scenario, options.out / scenario.name)
    except (NetError, OSError) as error:
        say("sumo-scenarios", str(error))
        return EXIT_FAILED if isinstance(error, NetError) else EXIT_REFUSED
    return EXIT_DONE


def _line(scenario: Scenario) -> str:
    signals = len(scenario.plan.signals)
    return f"{scenario.name:<15} {signals:>2} signals {scenario.veh_per_h:>6.0f} veh/h  {scenario.what}\n"


def write_scenario(scenario: Scenario, folder: Path) -> None:
    """Network, vehicles and configuration of one scenario."""
    folder.mkdir(parents=True, exist_ok=True)
    build(scenario.plan, folder, scenario.name)
    routes = ElementTree.Element("routes")
    for attributes in _flows(scenario):
        ElementTree.SubElement(routes, "flow", attributes)
    ElementTree.indent(routes)
    (folder / f"{scenario.name}.rou.xml").write_bytes(ElementTree.tostring(routes) + b"\n")
    root = ElementTree.Element("configuration")
    inputs = ElementTree.SubElement(root, "input")
    ElementTree.SubElement(inputs, "net-file", value=f"{scenario.name}.net.xml")
    ElementTree.SubElement(inputs, "route-files", value=f"{scenario.name}.rou.xml")
    ElementTree.SubElement(ElementTree.SubElement(root, "time"), "end", value=str(END_S))
    ElementTree.indent(root)
    (folder / f"{scenario.name}.sumocfg").write_bytes(ElementTree.tostring(root) + b"\n")


def _flows(scenario: Scenario) -> Iterator[dict[str, str]]:
    """SUMO wants flows in the order in which they begin."""
    first = {road.start: f"{road.start}{road.end}" for road in scenario.plan.roads if road.start in scenario.plan.ends}
    last = {road.start: f"{road.end}{road.start}" for road in scenario.plan.roads if road.start in scenario.plan.ends}
    for index, flow in enumerate(sorted(scenario.flows, key=lambda flow: flow.begin_s)):
        yield {
            "id": f"{index}.{flow.start}-{flow.end}",
            "from": first[flow.start],
            "to": last[flow.end],
            "begin": f"{flow.begin_s:g}",
            "end": f"{flow.end_s:g}",
            "period": f"exp({flow.veh_per_h / SECONDS_PER_HOUR:.6f})",
            "departLane": "best",
            "departSpeed": "desired",
        }
