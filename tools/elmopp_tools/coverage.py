# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The command behind tools/coverage: which lines, branches and conditions of the core its own tests reach.

Builds the preset cov (clang, source-based coverage with MC/DC), runs every Unity test of the core once, and holds each
room against its limit: what decides about lamps and believes frames or sites 100 % of everything, all else 95 % of its
lines. A room that the report lacks fails, but for one that is data alone; and so does a report without a single
condition.
"""

import argparse
import json
import os
import re
import subprocess
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from elmopp_tools.outputs import EXIT_DIFFERENT, EXIT_DONE, EXIT_REFUSED, OneLineParser, say

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build" / "cov"
ROOMS = ROOT / "firmware" / "src"
SAFETY_ROOMS = ("monitor", "plan", "link", "bus", "watch", "detector", "site")
KINDS = ("lines", "branches", "mcdc")
LIMIT_SAFETY = 100.0
LIMIT_LINES = 95.0

DESCRIPTION = "Measures how much of the core its own tests reach, and fails below the limits."
EPILOG = f"""\
Limits: {", ".join(SAFETY_ROOMS)}: {LIMIT_SAFETY:.0f} % of lines, branches and conditions (MC/DC); all other rooms of
firmware/src: {LIMIT_LINES:.0f} % of lines.

Exit codes: 0 all rooms reach theirs; 1 one does not, or a test failed; 2 the request cannot be run.

Examples:
  tools/coverage                 the table
  tools/coverage --show plan     ... and what is missing in plan.c"""


class CoverageError(Exception):
    """A step that failed; its text is one line."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = OneLineParser(
        prog="tools/coverage",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--show", metavar="ROOM", help="also print the parts of this room that no test reaches")
    parser.add_argument("--markdown", action="store_true", help="the table as docs/measurements.md has it")
    options = parser.parse_args(arguments)
    rooms = sorted(file.stem for file in ROOMS.glob("*.c") if has_functions(file.read_text(encoding="utf-8")))
    if options.show is not None and options.show not in rooms:
        say("coverage", f'"{options.show}" is no room ; right would be one of {", ".join(rooms)}')
        return EXIT_REFUSED
    try:
        programs = build()
        with tempfile.TemporaryDirectory() as folder:
            profile = measure(programs, Path(folder))
            found = export(programs, profile)
            print("\n".join(table(rooms, found, options.markdown)))
            if options.show is not None:
                print(uncovered(programs, profile, options.show))
    except CoverageError as error:
        say("coverage", str(error))
        return EXIT_DIFFERENT
    complaints = judge(rooms, found)
    for line in complaints:
        say("coverage", line)
    return EXIT_DIFFERENT if complaints else EXIT_DONE


def has_functions(source: str) -> bool:
    """Whether a C file has anything to run: a parameter list before an opening brace, outside comments."""
    code = re.sub(r"/\*.*?\*/|//[^\n]*", "", source, flags=re.DOTALL)
    return re.search(r"\)\s*\{", code) is not None


def run(command: Sequence[str], environment: dict[str, str] | None = None) -> str:
    """Runs a command in the project's root and returns what it printed."""
    try:
        done = subprocess.run(
            list(command),
            cwd=ROOT,
            env={**os.environ, **(environment or {})},
            capture_output=True,
            text=True,
            check=False,
        )
    except OSError as error:
        raise CoverageError(f"cannot run {command[0]}: {error.strerror} ; run ./tools/setup check") from error
    if done.returncode != 0:
        last = (done.stderr or done.stdout).strip().splitlines()[-1:] or ["no output"]
        raise CoverageError(f"{Path(command[0]).name} ended with {done.returncode}: {last[0]}")
    return done.stdout


def build() -> list[str]:
    """Builds the preset cov and returns its test programs."""
    run(["cmake", "--preset", "cov"])
    run(["cmake", "--build", "--preset", "cov"])
    listing = json.loads(run(["ctest", "--test-dir", str(BUILD), "--show-only=json-v1", "-LE", "^nightly$"]))
    programs = {test["command"][0] for test in listing["tests"]}
    return sorted(program for program in programs if Path(program).parent == BUILD / "bin" / "tests")


def measure(programs: Sequence[str], folder: Path) -> Path:
    """Runs every program once and merges what they counted."""

    def one(program: str) -> None:
        run([program], {"LLVM_PROFILE_FILE": str(folder / f"{Path(program).name}.profraw")})

    with ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        list(pool.map(one, programs))
    profile = folder / "all.profdata"
    run(["llvm-profdata-19", "merge", "-sparse", *map(str, sorted(folder.glob("*.profraw"))), "-o", str(profile)])
    return profile


def _objects(programs: Sequence[str]) -> list[str]:
    return [programs[0], *(f"-object={program}" for program in programs[1:])]


def export(programs: Sequence[str], profile: Path) -> dict[str, dict[str, Any]]:
    """The summary of each room of firmware/src."""
    text = run(["llvm-cov-19", "export", *_objects(programs), f"-instr-profile={profile}", "-summary-only"])
    files = json.loads(text)["data"][0]["files"]
    return {Path(file["filename"]).stem: file["summary"] for file in files if Path(file["filename"]).parent == ROOMS}


def uncovered(programs: Sequence[str], profile: Path, room: str) -> str:
    """The room's text with counts."""
    command = ["llvm-cov-19", "show", *_objects(programs), f"-instr-profile={profile}", "--show-mcdc"]
    return run([*command, "--show-branches=count", str(ROOMS / f"{room}.c")])


def percent(part: dict[str, int]) -> float:
    """Nothing to reach counts as reached."""
    return 100.0 * part["covered"] / part["count"] if part["count"] else 100.0


def table(rooms: Sequence[str], found: dict[str, dict[str, Any]], markdown: bool) -> list[str]:
    """One line a room: reached of all, by kind."""
    bar = "| " if markdown else ""
    lines = [f"{bar}{'room':<12} {bar}{'lines':>12} {bar}{'branches':>12} {bar}{'MC/DC':>12} {bar}".rstrip()]
    if markdown:
        lines.append("|---|---|---|---|")
    for room in rooms:
        if room in found:
            parts = [f"{found[room][kind]['covered']} of {found[room][kind]['count']}" for kind in KINDS]
            lines.append(f"{bar}{room:<12} {bar}{parts[0]:>12} {bar}{parts[1]:>12} {bar}{parts[2]:>12} {bar}".rstrip())
    return lines


def judge(rooms: Sequence[str], found: dict[str, dict[str, Any]]) -> list[str]:
    """What is below its limit, a line each."""
    complaints = []
    if not any(summary["mcdc"]["count"] for summary in found.values()):
        complaints.append("no condition was counted ; right would be a build with -fcoverage-mcdc")
    for room in rooms:
        if room not in found:
            complaints.append(f"{room}.c is not in the report ; right would be a test that links it")
            continue
        kinds, limit = (KINDS, LIMIT_SAFETY) if room in SAFETY_ROOMS else (KINDS[:1], LIMIT_LINES)
        for kind in kinds:
            reached = percent(found[room][kind])
            if reached < limit:
                complaints.append(f"{room}.c: {kind} {reached:.1f} % ; right would be at least {limit:.0f} %")
    return complaints
