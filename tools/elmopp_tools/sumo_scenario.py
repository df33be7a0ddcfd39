# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Which files make a SUMO scenario: those that a configuration names, or a network and its routes."""

from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import sumolib

from elmopp_tools.sumo_report import scenario_name


class ScenarioError(Exception):
    """Why a scenario cannot be run, with the value, and what would be right."""


@dataclass(frozen=True)
class Scenario:
    """A scenario to run. `configuration` is null where network and routes were named."""

    name: str
    configuration: Path | None
    net: Path
    routes: tuple[Path, ...]
    additional: tuple[Path, ...]
    begin_s: float | None
    end_s: float | None

    def arguments(self, *more_additional: Path) -> list[str]:
        """SUMO's arguments, with further additional files."""
        made = (
            ["--configuration-file", str(self.configuration)] if self.configuration else ["--net-file", str(self.net)]
        )
        if not self.configuration:
            made += ["--route-files", ",".join(map(str, self.routes))]
        additional = (*self.additional, *more_additional)
        if additional:
            made += ["--additional-files", ",".join(map(str, additional))]
        if self.begin_s is not None:
            made += ["--begin", str(self.begin_s)]
        if self.end_s is not None:
            made += ["--end", str(self.end_s)]
        return made


def scenario_of(
    configuration: Path | None, net: Path | None, routes: str | None, begin_s: float | None, end_s: float | None
) -> Scenario:
    """The scenario of a command line. ScenarioError names the file that is missing, or the option."""
    if (configuration is None) == (net is None) or (net is None) != (routes is None):
        given = "both" if configuration and (net or routes) else "not enough"
        raise ScenarioError(
            f"{given} of --sumocfg, --net and --routes ; either --sumocfg FILE or --net FILE --routes FILE"
        )
    if configuration is not None:
        scenario = _of_configuration(configuration, begin_s, end_s)
    else:
        assert net is not None and routes is not None  # noqa: S101  the first check says so
        scenario = Scenario(scenario_name(net), None, net, tuple(map(Path, routes.split(","))), (), begin_s, end_s)
    for file in (scenario.net, *scenario.routes, *scenario.additional):
        if not file.is_file():
            raise ScenarioError(f"{file} is missing ; a file that {configuration or 'the command line'} may name")
    _check_net(scenario.net)
    if scenario.end_s is not None and scenario.end_s <= (scenario.begin_s or 0.0):
        raise ScenarioError(
            f"--end {scenario.end_s:g} is not after --begin {scenario.begin_s or 0.0:g} ; a later second"
        )
    return scenario


def _check_net(file: Path) -> None:
    """A network begins with <net>. One that is compressed is left to SUMO."""
    if file.suffix == ".gz":
        return
    try:
        tag = next(ElementTree.iterparse(file, events=("start",)))[1].tag  # noqa: S314  the user's own
    except (ElementTree.ParseError, StopIteration):
        tag = "no XML"
    if tag != "net":
        raise ScenarioError(f"{file} is no network ({tag}) ; a file that netconvert has made")


def _of_configuration(file: Path, begin_s: float | None, end_s: float | None) -> Scenario:
    if not file.is_file():
        raise ScenarioError(f"--sumocfg {file} is missing; right would be a SUMO configuration")
    try:
        root = ElementTree.parse(file).getroot()  # noqa: S314  a scenario of the user's own
    except ElementTree.ParseError as error:
        raise ScenarioError(f"--sumocfg {file} is no XML: {error} ; a SUMO configuration") from None
    values = {element.tag: element.get("value", element.get("v", "")) for element in root.iter()}
    if not values.get("net-file", values.get("n", "")):
        raise ScenarioError(f"--sumocfg {file} names no net-file ; a SUMO configuration with a network")

    def files(*names: str) -> tuple[Path, ...]:
        named = next((values[name] for name in names if values.get(name)), "")
        return tuple(file.parent / piece.strip() for piece in named.split(",") if piece.strip())

    def second(given: float | None, name: str) -> float | None:
        if given is not None or not values.get(name):
            return given
        try:
            return float(sumolib.miscutils.parseTime(values[name]))
        except ValueError:
            wrong = f"--sumocfg {file} has {name} {values[name]}"
            raise ScenarioError(f"{wrong} ; seconds, or hours:minutes:seconds") from None

    end = second(end_s, "end")
    return Scenario(
        name=scenario_name(file),
        configuration=file,
        net=files("net-file", "n")[0],
        routes=files("route-files", "r"),
        additional=files("additional-files", "a"),
        begin_s=second(begin_s, "begin"),
        end_s=None if end is not None and end < 0.0 else end,
    )
