# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The command behind tools/campaign: many SUMO runs as a job file, run anywhere, merged and compared.

A campaign is a folder: `jobs.txt`, one shell command a line, each for one scenario, one controller and one seed;
`campaign.json`, what the lines were made of; `results/`, a table a line; then `runs.csv`, all of them in the order of
the job file whatever order they were run in, and what sumo_compare.py makes of it. Who runs the lines, and where, is
nobody's business here: tools/campaign run does it with GNU parallel, tools/campaign-slurm on a cluster.
"""

import argparse
import csv
import json
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from elmopp_tools import sumo_compare
from elmopp_tools.library import LibraryError
from elmopp_tools.outputs import EXIT_DONE, EXIT_REFUSED, OneLineParser, say, write
from elmopp_tools.seeds import seeds_of
from elmopp_tools.sumo_choosers import check_chooser
from elmopp_tools.sumo_report import COLUMNS, scenario_name, table
from elmopp_tools.sumo_signal import Times

EXIT_FAILED = 1
# Those of tools/sumo-run: whether a chooser can be made does not hang on them.
USUAL_TIMES = Times(yellow_s=3, all_red_s=2, min_green_s=5, max_green_s=60, red_bound_s=0, junction_wait_s=0)
ROOT = Path(__file__).resolve().parents[2]

DESCRIPTION = """\
Runs many SUMO scenarios under many controllers for many seeds, here or on a cluster.

  check    asks whether choosers, seeds and scenarios are such as make can use, and writes nothing
  make     asks the same, then writes CAMPAIGN/jobs.txt, one command a line
  run      runs its lines with GNU parallel; lines that have their result are left out, so that it goes on where it was
           broken off
  merge    writes CAMPAIGN/runs.csv, one table of all results in the order of the job file
  compare  writes CAMPAIGN/best_rivals.csv, then comparison.csv and standings.csv beside it, and prints them"""

EPILOG = """\
Exit codes: 0 done; 1 a line failed or a result is missing; 2 the request cannot be run, with one line that says why.

Examples:
  tools/campaign make out/campaign --scenarios out/sumo --choosers pressure,max-pressure,static --seeds 1-10
  tools/campaign run out/campaign && tools/campaign merge out/campaign && tools/campaign compare out/campaign
  tools/campaign-slurm out/campaign --wait         # the same job file on a cluster"""


class CampaignError(Exception):
    """The request cannot be run; the text says what is wrong and what would be right."""


class IncompleteError(Exception):
    """It ran, and something failed or is missing."""


@dataclass(frozen=True)
class Line:
    """One line of the job file."""

    scenario: str
    chooser: str
    seed: int
    result: str
    command: str


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    options = _parser().parse_args(arguments)
    steps = {"check": _check, "make": _make, "run": _run, "merge": _merge, "compare": _compare}
    try:
        steps[options.step](options)
    except (CampaignError, LibraryError, sumo_compare.CompareError) as error:
        say("campaign", str(error))
        return EXIT_REFUSED
    except IncompleteError as error:
        say("campaign", str(error))
        return EXIT_FAILED
    return EXIT_DONE


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(
        prog="tools/campaign",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    steps = parser.add_subparsers(dest="step", required=True, metavar="STEP")
    for name in ("check", "make", "run", "merge", "compare"):
        step = steps.add_parser(name, prog=f"tools/campaign {name}", allow_abbrev=False)
        if name != "check":
            step.add_argument("campaign", metavar="CAMPAIGN", type=Path, help="its folder")
        if name in {"check", "make"}:
            _add_choice(step, scenarios_needed=name == "make")
        if name == "make":
            step.add_argument(
                "--options", metavar="TEXT", default="", help="further options of tools/sumo-run, in one word"
            )
        if name == "run":
            step.add_argument(
                "--jobs", metavar="N", type=int, default=0, help="lines at a time (default: one a processor)"
            )
        if name == "merge":
            step.add_argument("--partial", action="store_true", help="merge what is there")
        if name == "compare":
            step.add_argument("--ours", metavar="A,B", default=",".join(sumo_compare.OURS), help="who is no rival")
    return parser


def _add_choice(step: argparse.ArgumentParser, *, scenarios_needed: bool) -> None:
    step.add_argument(
        "--scenarios", metavar="FOLDER|FILE,...", required=scenarios_needed, help="sumocfg files, or a folder of them"
    )
    step.add_argument(
        "--choosers", metavar="A,B@OPTION:FORECAST,...", required=True, help="each as tools/sumo-run --chooser takes it"
    )
    step.add_argument("--seeds", metavar="A-B|A,B", type=seeds_of, default=tuple(range(1, 11)), help="(default: 1-10)")


def _configurations(text: str) -> list[Path]:
    files: list[Path] = []
    for piece in text.split(","):
        path = Path(piece)
        files.extend(sorted(path.glob("**/*.sumocfg")) if path.is_dir() else [path])
    missing = [file for file in files if not file.is_file()]
    if missing or not files:
        raise CampaignError(
            f"--scenarios {missing[0] if missing else text} is missing ; sumocfg files, or a folder with some"
        )
    return files


def _check(options: argparse.Namespace) -> None:
    """A name that is wrong would else fail once a scenario and seed, after the others have run."""
    for chooser in options.choosers.split(","):
        check_chooser("--choosers", chooser, USUAL_TIMES)
    if options.scenarios is not None:
        _configurations(options.scenarios)


def _make(options: argparse.Namespace) -> None:
    _check(options)
    lines = list(_lines(options))
    if len({line.result for line in lines}) != len(lines):
        raise CampaignError("two lines have the same result ; every scenario's file name and every chooser once")
    options.campaign.mkdir(parents=True, exist_ok=True)
    (options.campaign / "results").mkdir(exist_ok=True)
    write(
        {
            options.campaign / "jobs.txt": "".join(f"{line.command}\n" for line in lines).encode(),
            options.campaign / "campaign.json": json.dumps([asdict(line) for line in lines], indent=1).encode(),
        }
    )
    print(f"{options.campaign / 'jobs.txt'}: {len(lines)} lines")


def _lines(options: argparse.Namespace) -> Iterator[Line]:
    for configuration in _configurations(options.scenarios):
        scenario = scenario_name(configuration)
        for chooser in options.choosers.split(","):
            for seed in options.seeds:
                label = chooser.replace(":", "+").replace("=", "-")
                result = f"results/{scenario}.{label}.{seed}.csv"
                words = [
                    "tools/sumo-run", "--sumocfg", _from_root(configuration), "--chooser", chooser,
                    "--seeds", str(seed), "--jobs", "1", *shlex.split(options.options),
                    "--csv", _from_root(options.campaign / result),
                ]  # fmt: skip
                yield Line(scenario, chooser, seed, result, shlex.join(words))


def _from_root(path: Path) -> str:
    """Lines are run from the project's root."""
    absolute = path.resolve()
    return str(absolute.relative_to(ROOT)) if absolute.is_relative_to(ROOT) else str(absolute)


def _read(campaign: Path) -> list[Line]:
    file = campaign / "campaign.json"
    if not file.is_file():
        raise CampaignError(f"{file} is missing ; a folder that tools/campaign make has written")
    return [Line(**item) for item in json.loads(file.read_text(encoding="utf-8"))]


def _run(options: argparse.Namespace) -> None:
    lines = _read(options.campaign)
    if shutil.which("parallel") is None:
        raise CampaignError("GNU parallel is not installed ; run ./tools/setup sumo")
    waiting = [line for line in lines if not (options.campaign / line.result).exists()]
    command = ["parallel", "--will-cite", "--joblog", str(options.campaign.resolve() / "jobs.log"), "--jobs"]
    command += [str(options.jobs) if options.jobs > 0 else "100%"]
    command += ["--bar"] if sys.stderr.isatty() else []
    # The results say what is done, also of lines that ran elsewhere; the log is a record of this run.
    done = subprocess.run(command, cwd=ROOT, input="".join(f"{w.command}\n" for w in waiting), text=True, check=False)
    missing = [line for line in lines if not (options.campaign / line.result).exists()]
    if done.returncode != 0 or missing:
        raise IncompleteError(
            f"{len(missing)} of {len(lines)} lines have no result, first: {missing[0].command if missing else '?'}"
        )
    print(f"{len(waiting)} lines run, {len(lines) - len(waiting)} were there")


def _merge(options: argparse.Namespace) -> None:
    lines = _read(options.campaign)
    rows: list[dict[str, str]] = []
    missing = [line for line in lines if not (options.campaign / line.result).exists()]
    if missing and not options.partial:
        raise IncompleteError(f"{len(missing)} of {len(lines)} results are missing, first: {missing[0].result}")
    for line in lines:
        if line not in missing:
            with (options.campaign / line.result).open(encoding="utf-8", newline="") as file:
                found = list(csv.DictReader(file))
            if len(found) != 1 or found[0]["scenario"] != line.scenario or found[0]["seed"] != str(line.seed):
                raise IncompleteError(f"{line.result} is not the result of its line ; remove it and run again")
            rows.extend(found)
    write({options.campaign / "runs.csv": table(rows, COLUMNS)})
    print(f"{options.campaign / 'runs.csv'}: {len(rows)} runs")


def _compare(options: argparse.Namespace) -> None:
    runs = options.campaign / "runs.csv"
    if not runs.is_file():
        raise CampaignError(f"{runs} is missing ; run tools/campaign merge before")
    sumo_compare.compare(runs, options.campaign, tuple(options.ours.split(",")))
