# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The command behind tools/sumo-run: a SUMO scenario under one controller, seed by seed, as a table."""

import argparse
import multiprocessing
import os
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import libsumo

from elmopp_tools.library import FaultError, LibraryError
from elmopp_tools.outputs import EXIT_DONE, EXIT_REFUSED, OneLineParser, say, why_not_writable, write
from elmopp_tools.seeds import seeds_of
from elmopp_tools.sumo_choosers import check_chooser
from elmopp_tools.sumo_drive import Driver, PathLog, Street
from elmopp_tools.sumo_neighbours import Gateway
from elmopp_tools.sumo_network import Network
from elmopp_tools.sumo_oracle import FORETOLD_COLUMNS, Record, foretold
from elmopp_tools.sumo_own import PROGRAM, TYPES, own_programmes
from elmopp_tools.sumo_report import COLUMNS, read_statistics, read_trips, row, table
from elmopp_tools.sumo_scenario import Scenario, ScenarioError, scenario_of
from elmopp_tools.sumo_signal import Signal, SignalError, Times, read_signal

EXIT_FAILED = 1

ORACLE = ":oracle"

STEP_S = 1.0
SECOND_MAX = 1e7  # four months

# Two of its own kinds, and neither can be sent from one process to another.
SUMO_ERRORS = (libsumo.TraCIException, libsumo.FatalTraCIError)

DESCRIPTION = """\
Runs a SUMO scenario with every signal under one controller, once for each seed, and writes one line a seed.

A controller chooses from the green phases of the network's own programme and, unless --stages programme, from all
other largest sets of lanes that never give way and do not cross. Between them amber and all red, minimum and maximum
green are the same for all: the core's plan sees to that, for SUMO's own controllers a programme that is made by the
same rule. A controller knows what a camera of the given reach counts, nothing else."""

EPILOG = """\
Controllers: every chooser of host_sim list, and SUMO's own: static, sumo-actuated, sumo-delay-based.

Forecasts: those of host_sim list. oracle is who came in a first run of the same seed and chooser without a forecast:
nearly the truth where nobody queues beyond the reach and no other signal lies before it; --foretold says how nearly.

Columns: delay_s is the mean of SUMO's timeLoss + departDelay over every vehicle that entered, arrived or not; read it
with not_inserted. longest_wait_s is the longest standing time of a vehicle, longest_red_s how long somebody who was
counted in every second of it found no green; stops, switches, teleports, co2_kg and fuel_kg are of the whole run.

Exit codes: 0 done; 1 a run failed; 2 the request cannot be run, with one line that says what and what would be right.

Examples:
  tools/sumo-run --sumocfg out/sumo/protected-low/protected-low.sumocfg --chooser pressure --seeds 1-5 --csv out.csv
  tools/sumo-run --net town.net.xml --routes town.rou.xml --end 3600 --chooser sumo-actuated --seeds 1 --csv -"""


class RunError(Exception):
    """A run broke off; the text says why."""


class _StartError(Exception):
    """SUMO did not start: the scenario is not one."""


@dataclass(frozen=True)
class Job:
    """One run."""

    scenario: Scenario
    chooser: str
    seed: int
    times: Times
    reach_m: float
    allow_partial: bool
    paths: Path | None
    neighbours: bool = False
    complete: bool = True

    @property
    def foresees(self) -> bool:
        """Whether it needs a recording."""
        return self.chooser.endswith(ORACLE)


@dataclass(frozen=True)
class Done:
    """What a run leaves: its line of the table, and of an oracle's how well it was told."""

    row: dict[str, str]
    told: dict[str, str] | None = None


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    options = _parser().parse_args(arguments)
    try:
        jobs = _jobs(options)
        _check_output("--csv", None if options.csv == "-" else Path(options.csv))
        _check_output("--paths", options.paths)
        _check_output("--foretold", options.foretold)
        done = _run_all(jobs, options.jobs)
    except (ScenarioError, SignalError, LibraryError) as error:
        say("sumo-run", str(error))
        return EXIT_REFUSED
    except (RunError, FaultError) as error:
        say("sumo-run", str(error))
        return EXIT_FAILED
    _write(options.csv, [one.row for one in done])
    if options.foretold:
        write({options.foretold: table([one.told for one in done if one.told], FORETOLD_COLUMNS)})
    return EXIT_DONE


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(
        prog="tools/sumo-run",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("--sumocfg", metavar="FILE", type=Path, help="a scenario; or instead of it:")
    parser.add_argument("--net", metavar="FILE", type=Path, help="a network, with --routes")
    parser.add_argument("--routes", metavar="FILE[,FILE]", help="its vehicles")
    parser.add_argument("--begin", metavar="S", type=_second, help="first second (default: the scenario's, or 0)")
    parser.add_argument(
        "--end", metavar="S", type=_second, help="last second (default: the scenario's, or when all have arrived)"
    )
    parser.add_argument(
        "--chooser", metavar="CHOOSER", required=True,
        help="who chooses the stages: NAME[@OPTION[=VALUE]...][:FORECAST], as rollout@caution=0.3:lstm",
    )  # fmt: skip
    parser.add_argument("--seeds", metavar="A-B|A,B", type=seeds_of, default=(1,), help="SUMO's seeds (default: 1)")
    parser.add_argument("--yellow", metavar="S", type=_whole(0, 600), default=3, help="amber (default: 3)")
    parser.add_argument(
        "--all-red", metavar="S", type=_whole(0, 600), default=2, help="clearance after it (default: 2)"
    )
    parser.add_argument("--min-green", metavar="S", type=_whole(1, 150), default=5, help="(default: 5)")
    parser.add_argument(
        "--max-green", metavar="S", type=_whole(1, 150), default=60,
        help="counted from the first conflicting demand (default: 60)",
    )  # fmt: skip
    parser.add_argument(
        "--red-bound", metavar="S", type=_whole(0, 600), default=0,
        help="nobody who is counted waits longer for green, whatever is chosen (default: 0, no bound)",
    )  # fmt: skip
    parser.add_argument(
        "--junction-wait", metavar="S", type=_whole(0, 10), default=0,
        help="a change of stage waits so long at most while a vehicle stands inside the junction (default: 0, it does "
        "not); SUMO's own controllers never do",
    )  # fmt: skip
    parser.add_argument(
        "--stages", choices=("all", "programme"),
        help="what may be chosen from: the programme's green phases, or all that is safe as well (default: all; SUMO's "
        "own controllers have their programme)",
    )  # fmt: skip
    parser.add_argument("--reach", metavar="M", type=_reach, default=100.0, help="how far cameras see (default: 100)")
    parser.add_argument(
        "--neighbours", action="store_true",
        help="signals announce to the next ones who has left them; the column forecast then ends in +neighbours",
    )  # fmt: skip
    parser.add_argument("--csv", metavar="FILE", default="-", help="the table (default: -, the terminal)")
    parser.add_argument(
        "--paths", metavar="FILE", type=Path,
        help="where each vehicle in reach was in each second, of one seed: for tools/report --paths",
    )  # fmt: skip
    parser.add_argument(
        "--foretold", metavar="FILE", type=Path,
        help="how well an oracle was told, a line a seed: who came in how many seconds of the recorded one",
    )  # fmt: skip
    parser.add_argument("--jobs", metavar="N", type=_whole(1, 1024), default=os.cpu_count() or 1, help="runs at a time")
    parser.add_argument(
        "--allow-partial", action="store_true",
        help="leave signals that cannot be controlled to their own programmes; the column signals says how many are",
    )  # fmt: skip
    return parser


def _whole(least: int, most: int) -> Callable[[str], int]:
    def whole(text: str) -> int:
        if not text.isdecimal() or not least <= int(text) <= most:
            raise argparse.ArgumentTypeError(f"'{text}'; right would be a whole number from {least} to {most}")
        return int(text)

    return whole


def _second(text: str) -> float:
    try:
        second = float(text)
    except ValueError:
        second = -1.0
    if not 0.0 <= second <= SECOND_MAX:
        raise argparse.ArgumentTypeError(f"'{text}'; right would be a second from 0 to {SECOND_MAX:g}")
    return second


def _reach(text: str) -> float:
    try:
        reach_m = float(text)
    except ValueError:
        reach_m = 0.0
    if not 1.0 <= reach_m <= 1000.0:
        raise argparse.ArgumentTypeError(f"'{text}'; right would be 1 to 1000 metres")
    return reach_m


def _jobs(options: argparse.Namespace) -> list[Job]:
    if options.max_green < options.min_green:
        wrong = f"--max-green {options.max_green} is below --min-green {options.min_green}"
        raise ScenarioError(f"{wrong} ; at least as long")
    scenario = scenario_of(options.sumocfg, options.net, options.routes, options.begin, options.end)
    times = Times(
        yellow_s=options.yellow,
        all_red_s=options.all_red,
        min_green_s=options.min_green,
        max_green_s=options.max_green,
        red_bound_s=options.red_bound,
        junction_wait_s=options.junction_wait,
    )
    check_chooser("--chooser", options.chooser, times)
    if options.neighbours and options.chooser in TYPES:
        raise ScenarioError(f"--neighbours with --chooser {options.chooser} ; a chooser of ours, as SUMO's hear nobody")
    if options.stages == "all" and options.chooser in TYPES:
        raise ScenarioError(f"--stages all with --chooser {options.chooser} ; programme, as SUMO's run through theirs")
    if options.foretold and not options.chooser.endswith(ORACLE):
        raise ScenarioError(
            f"--foretold with --chooser {options.chooser} ; one with forecast oracle, as rollout{ORACLE}"
        )
    if options.paths == Path("-"):
        raise ScenarioError("--paths - ; a file, as the terminal may have the table")
    if options.paths and len(options.seeds) > 1:
        raise ScenarioError(f"--paths {options.paths} with {len(options.seeds)} seeds ; one, as the file is of one run")
    return [
        Job(
            scenario,
            options.chooser,
            seed,
            times,
            options.reach,
            options.allow_partial,
            options.paths,
            options.neighbours,
            complete=options.stages != "programme" and options.chooser not in TYPES,
        )
        for seed in options.seeds
    ]


def _check_output(option: str, file: Path | None) -> None:
    reason = why_not_writable(file) if file else None
    if reason is not None:
        raise ScenarioError(f"{option} {file}: {reason[0]} ; {reason[1]}")


def _run_all(jobs: Sequence[Job], at_once: int) -> list[Done]:
    """Each in a process of its own, as SUMO lives once in a process; one alone in this one."""
    if len(jobs) == 1:
        return [run(jobs[0])]
    with multiprocessing.get_context("spawn").Pool(min(at_once, len(jobs)), maxtasksperchild=1) as pool:
        return pool.map(run, jobs, chunksize=1)


def _write(name: str, rows: Sequence[dict[str, str]]) -> None:
    content = table(rows, COLUMNS)
    if name == "-":
        sys.stdout.write(content.decode())
    else:
        write({Path(name): content})


def run(job: Job) -> Done:
    """One run from beginning to end, in this process; an oracle's after the one that is recorded for it."""
    with tempfile.TemporaryDirectory(prefix="elmopp-sumo-") as place:
        folder = Path(place)
        try:
            with _own_words(folder / "words"):
                return _run_with_oracle(job, folder) if job.foresees else Done(_run_in(job, folder)[0])
        except _StartError as error:
            raise ScenarioError(f"{job.scenario.name}: SUMO says: {_said(folder, error)}") from None
        except SUMO_ERRORS as error:
            raise RunError(f"{job.scenario.name}, seed {job.seed}: SUMO says: {_said(folder, error)}") from None


def _said(folder: Path, error: Exception) -> str:
    """The first error of SUMO's own words."""
    words = (folder / "words").read_text(errors="replace").splitlines()
    return next((line for line in words if line.startswith("Error")), f"Error: {error}")


@contextmanager
def _own_words(file: Path) -> Iterator[None]:
    """What SUMO writes to stderr by itself goes to a file meanwhile."""
    kept = os.dup(2)
    with file.open("wb") as words:
        os.dup2(words.fileno(), 2)
        try:
            yield
        finally:
            os.dup2(kept, 2)
            os.close(kept)


def _run_with_oracle(job: Job, folder: Path) -> Done:
    """First the same run without a forecast, which records who comes, and then the one that is told of it."""
    _, recorded = _run_in(replace(job, chooser=job.chooser.removesuffix(ORACLE), paths=None), folder)
    cells, seen = _run_in(job, folder, recorded)
    told = {name: cells[name] for name in ("scenario", "chooser", "seed")} | foretold(recorded, seen).cells()
    return Done(cells, told)


def _run_in(job: Job, folder: Path, foresight: Record | None = None) -> tuple[dict[str, str], Record]:
    """The row of a run, and who came in it."""
    own = job.chooser in TYPES
    trips, statistics = folder / "trips.xml", folder / "statistics.xml"
    outputs = (
        "--tripinfo-output", str(trips), "--tripinfo-output.write-unfinished", "true",
        "--statistic-output", str(statistics), "--device.emissions.probability", "1",
        "--seed", str(job.seed), "--step-length", str(STEP_S), "--no-step-log", "true", "--no-warnings", "true",
        "--duration-log.disable", "true",
    )  # fmt: skip
    network = Network.read(job.scenario.net)
    signals: list[Signal] = []
    drivers: list[Driver] = []
    try:
        _start([*job.scenario.arguments(), *outputs])
        signals = _signals(job, network)
        if own:
            _restart_with_own(job, signals, folder, outputs)
        at_signals = frozenset(lane for name in libsumo.trafficlight.getIDList() for lane in _lanes_of(name))
        sights = [network.sight(signal, job.reach_m, at_signals) for signal in signals]
        if not own:
            drivers = _drivers(job, signals, foresight)
        gateways = _gateways(job, network, signals, at_signals) if job.neighbours else []
        street = Street(signals, sights, drivers, gateways, foresight)
        log = PathLog(signals, sights) if job.paths else None
        _simulate(street, job.scenario.end_s, log)
    finally:
        for driver in drivers:
            driver.close()
        libsumo.close()
    if job.paths and log:
        write({job.paths: table(log.rows, PathLog.columns)})
    name, _, forecast = job.chooser.partition(":")
    told = "+neighbours" if job.neighbours else ""
    names = (job.scenario.name, name, (forecast or "none") + told, job.seed)
    seen = (read_trips(trips), read_statistics(statistics), street.longest_red_s, street.switches)
    return row(names, len(signals), *seen), street.record


def _drivers(job: Job, signals: Sequence[Signal], foresight: Record | None) -> list[Driver]:
    return [
        Driver(signal, job.times, job.reach_m, job.chooser, job.seed, foresight.rows(index, 0) if foresight else ())
        for index, signal in enumerate(signals)
    ]


def _gateways(job: Job, network: Network, signals: Sequence[Signal], at_signals: frozenset[str]) -> list[Gateway]:
    """One a signal; a request in which nobody has a neighbour is a mistake."""
    roads = [network.roads(signal, job.reach_m, at_signals) for signal in signals]
    if not any(roads):
        raise ScenarioError(
            f"--neighbours with {job.scenario.name}: no road leads from one signal to the reach of another ; a network "
            f"that has one, or a shorter --reach than {job.reach_m:g}"
        )
    return [Gateway(own, len(signal.approaches)) for own, signal in zip(roads, signals, strict=True)]


def _start(arguments: Sequence[str]) -> None:
    try:
        libsumo.start(["sumo", *arguments])
    except SUMO_ERRORS as error:
        raise _StartError(str(error)) from None


def _simulate(street: Street, end_s: float | None, log: PathLog | None) -> None:
    """To the end of the scenario, or until everybody has arrived."""
    while libsumo.simulation.getMinExpectedNumber() > 0 if end_s is None else libsumo.simulation.getTime() < end_s:
        libsumo.simulationStep()
        street.second()
        if log:
            log.look()


def _lanes_of(name: str) -> tuple[str, ...]:
    lanes: tuple[str, ...] = libsumo.trafficlight.getControlledLanes(name)
    return lanes


def _signals(job: Job, network: Network) -> list[Signal]:
    """Every signal of the network; SignalError for one that cannot be controlled, unless some may be left out."""
    names = libsumo.trafficlight.getIDList()
    if not names:
        raise SignalError(f"{job.scenario.net} has no signal ; a network with at least one tlLogic")
    signals: list[Signal] = []
    refused: SignalError | None = None
    for name in names:
        try:
            signals.append(read_signal(network.programme(name), complete=job.complete))
        except SignalError as error:
            if not job.allow_partial:
                raise
            refused = error
    if not signals and refused is not None:
        raise refused
    return signals


def _restart_with_own(job: Job, signals: Sequence[Signal], folder: Path, outputs: Sequence[str]) -> None:
    """SUMO's own controllers read their programmes at the start."""
    libsumo.close()
    programmes = folder / "own.add.xml"
    programmes.write_bytes(own_programmes(signals, job.times, job.chooser))
    _start([*job.scenario.arguments(programmes), *outputs])
    for signal in signals:
        libsumo.trafficlight.setProgram(signal.name, PROGRAM)
