# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""What a street sees when something fails: tools/closed-loop once without and once with each trouble, as a table.

The street of a seed is the same in every row, so that what a trouble costs is a paired difference. The delay of a
junction that flashes says nothing: vehicles do not drive at flashing lamps here.
"""

import argparse
import hashlib
import json
import statistics
import subprocess
import sys
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Any

from elmopp_tools.loop_table import Result, read
from elmopp_tools.outputs import OneLineParser
from elmopp_tools.paired import paired

# Beside a run's files: of which program they are.
PROGRAM_FILE = "program.sha256"
ROOT = Path(__file__).resolve().parents[2]
EXIT_DONE, EXIT_FAILED, EXIT_REFUSED = 0, 1, 2
LEAST_S = 180  # the last trouble ends at 120 s, and what comes after it belongs to it
TROUBLES = (
    "",
    "black:N@60-120",
    "freeze:N@60-120",
    "turn:N@60-120",
    "gone:N@60-120",
    "black:all@60-120",
    "lose:10@60-120",
    "reset@60-63",
)


@dataclass(frozen=True)
class Row:
    """One trouble at one seed."""

    trouble: str
    seed: int
    folder: Path
    exit_code: int
    said: str
    reused: bool = False


@dataclass(frozen=True)
class Seen:
    """What its files say."""

    result: Result
    street: list[dict[str, Any]]


def is_there(folder: Path, wanted: dict[str, object], program: str | None = None) -> bool:
    """True if a run of before has answered this, with this very program if one is named."""
    try:
        result = read(folder)
        if program is not None and (folder / PROGRAM_FILE).read_text(encoding="utf-8").strip() != program:
            return False
    except (OSError, ValueError):
        return False
    return all(result.get(key) == value for key, value in wanted.items())


def findings(result: Result) -> list[int]:
    """The witness's, of each kind."""
    return [result[key] for key in ("conflicts", "early_greens", "short_ambers")]


def run(arguments: argparse.Namespace, trouble: str, seed: int) -> Row:
    """The whole chain once, unless it was run before."""
    folder = arguments.out / f"{trouble.replace(':', '-').replace('@', '-') or 'none'}-{seed}"
    wanted = {"seconds": arguments.seconds, "vehicles": arguments.vehicles, "seed": seed, "faults": trouble}
    if is_there(folder, wanted, arguments.sha256):
        failed = any(findings(read(folder)))
        return Row(trouble, seed, folder, EXIT_FAILED if failed else EXIT_DONE, "run before", reused=True)
    (folder / PROGRAM_FILE).unlink(missing_ok=True)
    command = [str(arguments.program), "--seconds", str(arguments.seconds), "--vehicles", str(arguments.vehicles)]
    command += ["--seed", str(seed), "--out", str(folder), "--faults", trouble]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode in (EXIT_DONE, EXIT_FAILED) and folder.is_dir():
        (folder / PROGRAM_FILE).write_text(arguments.sha256 + "\n", encoding="utf-8")
    return Row(trouble, seed, folder, done.returncode, done.stderr.strip())


def seen(row: Row) -> Seen:
    """The two files of a run."""
    lines = (row.folder / "street.jsonl").read_text(encoding="utf-8").splitlines()
    return Seen(read(row.folder), [json.loads(line) for line in lines])


def in_order(words: Sequence[str]) -> str:
    """One after the other, each with its seconds."""
    return ", ".join(f"{word.replace('_', ' ')} {len(list(same))}" for word, same in groupby(words))


def reasons(street: Sequence[dict[str, Any]]) -> str:
    """What cameras and controller said was wrong."""
    cameras = {reason for second in street for reason in second["cameras"].values()} - {"ok"}
    faults = {second["fault"] for second in street} - {"none"}
    return ", ".join(sorted(cameras) + [f"fault {fault}" for fault in sorted(faults)]) or "-"


def table_row(trouble: str, those: Sequence[Seen], without: Sequence[Seen]) -> str:
    """Over all seeds; modes and reasons are those of the first."""
    delay, usual = ([each.result["delay_camera_s"] for each in some] for some in (those, without))
    cost = paired(delay, usual)  # of one seed there is no interval
    told = f"{delay[0] - usual[0]:+.1f}" if cost is None else f"{cost.mean:+.1f} [{cost.low:+.1f}, {cost.high:+.1f}]"
    name = f"`{trouble}`" if trouble else "none"
    red = max(each.result["longest_red_camera_s"] for each in those)
    found = "/".join(str(sum(kind)) for kind in zip(*(findings(each.result) for each in those), strict=True))
    street = those[0].street
    return (
        f"| {name} | {statistics.fmean(delay):.1f} | {told if trouble else '-'} | {red:.0f} "
        f"| {in_order([second['mode'] for second in street])} | {reasons(street)} | {found} |"
    )


def table(rows: Sequence[Row]) -> list[str]:
    """In the order of the troubles."""
    by_trouble = {trouble: [seen(row) for row in rows if row.trouble == trouble] for trouble in TROUBLES}
    head = (
        "| trouble | delay, s | what it costs, s [95 %] | longest red, s | modes and their seconds, first seed "
        "| said, first seed | conflicts/early greens/short ambers |"
    )
    return [
        head,
        "| --- | ---: | ---: | ---: | --- | --- | ---: |",
        *(table_row(trouble, those, by_trouble[""]) for trouble, those in by_trouble.items()),
    ]


def refusal(arguments: argparse.Namespace) -> str | None:
    """Why this cannot be run."""
    if arguments.seconds < LEAST_S:
        return f"--seconds {arguments.seconds}: right would be {LEAST_S} or more"
    if not arguments.program.is_file():
        return f"--program {arguments.program} is missing; right would be what tools/closed-loop builds"
    return None


def main(words: Sequence[str] | None = None) -> int:
    parser = OneLineParser(
        prog="tools/closed-loop-troubles",
        description="Runs the closed loop without and with each of seven troubles and prints what the street saw. "
        "Goes on where it was broken off, as long as the program is the same.",
    )
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="one folder a run goes into it")
    parser.add_argument("--seconds", type=int, default=240, metavar="S")
    parser.add_argument("--vehicles", type=int, default=400, metavar="N", help="of an approach in 2000 s")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3], metavar="S")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="runs at a time")
    parser.add_argument("--program", type=Path, default=ROOT / "build" / "release" / "bin" / "elmopp-closed-loop")
    arguments = parser.parse_args(words)
    arguments.out = arguments.out.absolute()
    if (reason := refusal(arguments)) is not None:
        print(f"closed-loop-troubles: {reason}", file=sys.stderr)
        return EXIT_REFUSED
    arguments.sha256 = hashlib.sha256(arguments.program.read_bytes()).hexdigest()
    with ThreadPoolExecutor(arguments.jobs) as pool:
        runs = [pool.submit(run, arguments, trouble, seed) for seed in arguments.seeds for trouble in TROUBLES]
        rows = [each.result() for each in runs]
    reused = sum(row.reused for row in rows)
    if reused:
        print(f"closed-loop-troubles: {reused} of {len(rows)} runs were there before, of this program", file=sys.stderr)
    for row in rows:
        if row.exit_code != EXIT_DONE:
            print(f"closed-loop-troubles: {row.trouble or 'none'}, seed {row.seed}: {row.said}", file=sys.stderr)
    if any(row.exit_code not in (EXIT_DONE, EXIT_FAILED) or not is_there(row.folder, {}) for row in rows):
        return EXIT_FAILED
    print("\n".join(table(rows)))
    return max(row.exit_code for row in rows)
