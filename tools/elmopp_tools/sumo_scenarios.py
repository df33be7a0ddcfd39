# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The command behind tools/sumo-scenarios: the example scenarios, written for SUMO and never stored.

Demand is Poisson (SUMO's period="exp(RATE)"), a flow of its own from one end to another, drawn by SUMO from its --seed.
A seed means the same vehicles whatever the signals do: their names, intended departures, types and speed factors, which
SUMO draws apart from what it draws while they drive, and their routes, because the flows name them. A flow with from
and to alone would be routed on entering, by the state of the roads just then. Tried with all scenarios for half an hour
under fixed and actuated control: all the same. A test does it for one signal and for a network.
"""

import argparse
import math
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from xml.etree import ElementTree

from elmopp_tools.outputs import EXIT_DONE, EXIT_REFUSED, OneLineParser, say
from elmopp_tools.sumo_examples import Scenario, scenarios
from elmopp_tools.sumo_nets import NetError, Plan, arms_of, net_of, stages_at
from elmopp_tools.sumo_paths import shortest

EXIT_FAILED = 1

HOURS = 0.5
HOURS_MAX = 24.0
SECONDS_PER_HOUR = 3600

DESCRIPTION = """\
Writes the example scenarios: for each NAME a folder DIR/NAME with NAME.sumocfg, its network NAME.net.xml and its
vehicles NAME.rou.xml. Without a name all are written. Nobody is given time to leave at the end: a run measures all who
entered."""

EPILOG = """\
Exit codes: 0 done; 1 netconvert failed; 2 the request cannot be run, with one line that says what and what would be
right.

Examples:
  tools/sumo-scenarios --list
  tools/sumo-scenarios --out out/sumo protected-high eight"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    options = _parser().parse_args(arguments)
    known = {scenario.name: scenario for scenario in scenarios(round(options.hours * SECONDS_PER_HOUR))}
    unknown = next((name for name in options.names if name not in known), None)
    if unknown is not None:
        return _refuse(f"unknown scenario {unknown} ; one of {', '.join(known)}")
    chosen = [known[name] for name in options.names or known]
    if options.list:
        sys.stdout.writelines(_table(chosen))
        return EXIT_DONE
    if options.out is None:
        return _refuse("--out is missing ; --out DIR, or --list")
    return _write_all(chosen, options.out)


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(
        prog="tools/sumo-scenarios",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("names", metavar="NAME", nargs="*", help="see --list")
    parser.add_argument("--out", metavar="DIR", type=Path, help="where to; made if it is not there")
    parser.add_argument("--list", action="store_true", help="say what there is and write nothing")
    parser.add_argument("--hours", metavar="H", type=_hours, default=HOURS, help="how long (default: %(default)s)")
    return parser


def _hours(text: str) -> float:
    try:
        hours = float(text)
    except ValueError:
        hours = math.nan
    if not 1.0 <= hours * SECONDS_PER_HOUR <= HOURS_MAX * SECONDS_PER_HOUR:
        raise argparse.ArgumentTypeError(f"{text} is no length ; at least a second, at most {HOURS_MAX:g} hours")
    return hours


def _refuse(message: str) -> int:
    say("sumo-scenarios", message)
    return EXIT_REFUSED


def _table(chosen: Sequence[Scenario]) -> Iterator[str]:
    yield f"{'name':<15} {'signals':>7} {'arms':>4} {'lanes':>5} {'stages':>6} {'veh/h':>6}  what for\n"
    for scenario in chosen:
        signals = scenario.plan.signals
        arms = [lanes for name in signals for lanes in arms_of(scenario.plan, name).values()]
        counts = {len(arms_of(scenario.plan, name)) for name in signals}
        stages = {len(stages_at(scenario.plan, name)) for name in signals}
        yield (
            f"{scenario.name:<15} {len(signals):>7} {_span(counts):>4} {_span(set(map(len, arms))):>5} "
            f"{_span(stages):>6} {scenario.veh_per_h:>6.0f}  {scenario.what}\n"
        )


def _span(values: set[int]) -> str:
    return str(min(values)) if len(values) == 1 else f"{min(values)}-{max(values)}"


def _write_all(chosen: Sequence[Scenario], out: Path) -> int:
    nets: dict[Plan, bytes] = {}  # several scenarios share one
    try:
        for scenario in chosen:
            if scenario.plan not in nets:
                nets[scenario.plan] = net_of(scenario.plan)
            _write(scenario, nets[scenario.plan], out / scenario.name)
    except NetError as error:
        say("sumo-scenarios", str(error))
        return EXIT_FAILED
    except OSError as error:
        return _refuse(f"{error.filename or out}: {error.strerror} ; a folder that can be written")
    return EXIT_DONE


def _write(scenario: Scenario, net: bytes, folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    files = {"net.xml": net, "rou.xml": _routes(scenario), "sumocfg": _configuration(scenario)}
    for suffix, content in files.items():
        (folder / f"{scenario.name}.{suffix}").write_bytes(content)


def _routes(scenario: Scenario) -> bytes:
    """SUMO wants flows in the order in which they begin."""
    root = ElementTree.Element("routes")
    ends = scenario.plan.ends
    first = {road.start: road.forth_name for road in scenario.plan.roads if road.start in ends}
    last = {road.start: road.back_name for road in scenario.plan.roads if road.start in ends}
    for index, flow in enumerate(sorted(scenario.flows, key=lambda flow: flow.begin_s)):
        way = shortest(scenario.plan, first[flow.start], last[flow.end])
        attributes = {
            "id": f"{index}.{flow.start}-{flow.end}",
            "begin": str(flow.begin_s),
            "end": str(flow.end_s),
            "period": f"exp({flow.veh_per_h / SECONDS_PER_HOUR:.6f})",
            "departLane": "best",
            "departSpeed": "max",
        }
        element = ElementTree.SubElement(root, "flow", attributes)
        ElementTree.SubElement(element, "route", edges=" ".join(way))
    return _text(root)


def _configuration(scenario: Scenario) -> bytes:
    root = ElementTree.Element("configuration")
    inputs = ElementTree.SubElement(root, "input")
    ElementTree.SubElement(inputs, "net-file", value=f"{scenario.name}.net.xml")
    ElementTree.SubElement(inputs, "route-files", value=f"{scenario.name}.rou.xml")
    time = ElementTree.SubElement(root, "time")
    ElementTree.SubElement(time, "begin", value="0")
    ElementTree.SubElement(time, "end", value=str(scenario.end_s))
    return _text(root)


def _text(root: ElementTree.Element) -> bytes:
    ElementTree.indent(root)
    text: bytes = ElementTree.tostring(root)
    return text + b"\n"
