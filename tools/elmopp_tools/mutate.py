# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The command behind tools/mutate: breaks the safety rooms one token at a time and sees whether a test fails.

A mutant is one changed operator, number, word or dropped statement in one room. It is compiled; if its object code is
that of the original it is no mutant. The tests that judge a room, the fastest first, are linked with it and run until
one fails. What all of them pass is a survivor; tests/mutation/survivors.json must say why. An entry there that is no
longer needed is an error, too.
"""

import argparse
import hashlib
import json
import re
import shlex
import subprocess
import tempfile
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from elmopp_tools.compile_database import CompileDatabaseError, compile_database
from elmopp_tools.mutants import Mutant, mutants_of
from elmopp_tools.outputs import EXIT_DIFFERENT, EXIT_DONE, EXIT_REFUSED, OneLineParser, say

ROOT = Path(__file__).resolve().parents[2]
SURVIVORS = ROOT / "tests" / "mutation" / "survivors.json"
JOBS = 2
LIMIT_S = 60
JUDGES = {
    "monitor": ("test_monitor", "test_controller", "test_safety"),
    "plan": ("test_plan", "test_plan_waiting", "test_plan_exhaustive", "test_plan_property", "test_safety"),
    "link": ("test_link", "test_controller", "test_controller_faults"),
    "bus": ("test_bus", "test_controller", "test_controller_faults"),
    "watch": ("test_watch",),
}
# A judge looks for the first failure: fewer random decisions than in its own run, but the same kinds.
FEWER = {
    "test_safety": ["-DDECISIONS=3000U", "-DRANDOM_JUNCTIONS=12U"],
    "test_controller_faults": ["-DSTEPS=200U", "-DRUBBISH_TICKS=1500U"],
}

DESCRIPTION = "Breaks monitor, plan, link, bus and watch one token at a time and says which breaks no test finds."
EPILOG = """\
Exit codes: 0 every survivor is explained in tests/mutation/survivors.json; 1 one is not, or an explained one was found;
2 the request cannot be run.

Examples:
  tools/mutate                   all mutants of all five rooms
  tools/mutate plan --list       the mutants of one, not run"""


class MutateError(Exception):
    """The tools or the tests do not work; one line."""


@dataclass(frozen=True)
class Result:
    """What became of a mutant: `equal`, `invalid`, the name of the test that found it, or `survived`."""

    mutant: Mutant
    verdict: str


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = OneLineParser(
        prog="tools/mutate",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("rooms", nargs="*", metavar="ROOM", help=f"{', '.join(JUDGES)} (all)")
    parser.add_argument("--list", action="store_true", help="print the mutants instead")
    options = parser.parse_args(arguments)
    for room in options.rooms:
        if room not in JUDGES:
            say("mutate", f'"{room}" is no room that is mutated ; right would be one of {", ".join(JUDGES)}')
            return EXIT_REFUSED
    mutants = [mutant for room in options.rooms or JUDGES for mutant in mutants_of(ROOT, room)]
    if options.list:
        print("\n".join(f"{mutant.line:4} {mutant.key}" for mutant in mutants))
        return EXIT_DONE
    try:
        return judge(mutants)
    except MutateError as error:
        say("mutate", str(error))
        return EXIT_REFUSED


def judge(mutants: Sequence[Mutant]) -> int:
    """Tries them all and holds the survivors against the list."""
    started = time.monotonic()
    rooms = {mutant.room for mutant in mutants}
    explained: dict[str, str] = json.loads(SURVIVORS.read_text(encoding="utf-8"))
    with tempfile.TemporaryDirectory() as folder:
        workshop = Workshop(Path(folder))
        workshop.prepare({room: JUDGES[room] for room in rooms})
        with ThreadPoolExecutor(JOBS) as pool:
            results = list(pool.map(workshop.trial, mutants))
    report(results, time.monotonic() - started)
    survived = {result.mutant.key: result.mutant for result in results if result.verdict == "survived"}
    bad = False
    for key, mutant in survived.items():
        if key not in explained:
            place = f"{mutant.room}.c:{mutant.line}"
            say("mutate", f"{place} survived: {key} ; right would be a test that fails, or a reason in survivors.json")
            bad = True
    for key in explained:
        if key.split(":")[0] in rooms and key not in survived:
            say("mutate", f"{key} is explained in survivors.json but did not survive ; right would be to drop it")
            bad = True
    return EXIT_DIFFERENT if bad else EXIT_DONE


def report(results: Sequence[Result], seconds: float) -> None:
    """One line a room: how many mutants, who found them."""
    for room, judges in JUDGES.items():
        own = [result for result in results if result.mutant.room == room]
        real = [result for result in own if result.verdict not in ("equal", "invalid")]
        if not own:
            continue
        killed = [result for result in real if result.verdict != "survived"]
        finders = ", ".join(f"{name} {sum(result.verdict == name for result in killed)}" for name in judges)
        print(f"{room}: {len(killed)} of {len(real)} mutants found ({finders}); {len(own) - len(real)} are none")
    print(f"{len(results)} changes tried in {seconds:.0f} s")


class Workshop:
    """Compiled tests without the room that is mutated, and a place for mutants."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.commands = compile_commands()
        self.originals: dict[str, str] = {}

    def prepare(self, judges: dict[str, tuple[str, ...]]) -> None:
        """Compiles the core, its test support and the judges, and runs each judge once with the true room."""
        sources = [file for file in self.commands if _is_shared(file)]
        sources += [
            ROOT / "tests" / f"{name}.c" for name in sorted({name for names in judges.values() for name in names})
        ]
        with ThreadPoolExecutor(JOBS) as pool:
            list(pool.map(self._compile_shared, sources))
        for room, names in judges.items():
            true = self.folder / "core" / f"{room}.o"
            self.originals[room] = _digest(true)
            for name in names:
                if not self._passes(name, room, true):
                    raise MutateError(f"{name} fails on the unchanged {room}.c ; right would be a test that passes")

    def _place(self, source: Path) -> Path:
        if source.is_relative_to(ROOT / "firmware"):
            return self.folder / "core" / f"{source.stem}.o"
        return self.folder / ("judges" if source.parent.name == "tests" else "support") / f"{source.stem}.o"

    def _compile_shared(self, source: Path) -> None:
        place = self._place(source)
        place.parent.mkdir(parents=True, exist_ok=True)
        if self.compile(source, source, place, FEWER.get(source.stem, [])) != 0:
            raise MutateError(f"{source.relative_to(ROOT)} does not compile ; right would be a tree that builds")

    def compile(self, like: Path, source: Path, place: Path, options: Sequence[str] = ()) -> int:
        """Compiles `source` as the preset host compiles `like`, but optimised and without debug information."""
        command = [
            *self.commands[like],
            "-O2",
            "-g0",
            "-Wno-error",
            "-w",
            *options,
            "-o",
            str(place),
            "-c",
            str(source),
        ]
        return subprocess.run(command, capture_output=True, check=False).returncode

    def trial(self, mutant: Mutant) -> Result:
        """Compiles a mutant and lets its judges look at it until one fails."""
        made = self._compile_mutant(mutant)
        if made is None:
            return Result(mutant, "invalid")
        if _digest(made) == self.originals[mutant.room]:
            return Result(mutant, "equal")
        for name in JUDGES[mutant.room]:
            if not self._passes(name, mutant.room, made):
                return Result(mutant, name)
        return Result(mutant, "survived")

    def failing(self, mutant: Mutant, names: Sequence[str]) -> list[str]:
        """All of these tests that fail with the mutant."""
        made = self._compile_mutant(mutant)
        if made is None:
            raise MutateError(f"{mutant.key}: the bug does not compile")
        return [name for name in names if not self._passes(name, mutant.room, made)]

    def _compile_mutant(self, mutant: Mutant) -> Path | None:
        folder = Path(tempfile.mkdtemp(dir=self.folder))
        text = folder / f"{mutant.room}.c"
        text.write_text(mutant.text, encoding="utf-8")
        made = folder / "mutant.o"
        compiled = self.compile(ROOT / "firmware" / "src" / text.name, text, made) == 0
        return made if compiled else None

    def _passes(self, name: str, room: str, made: Path) -> bool:
        program = made.with_name(f"{name}_{room}")
        others = [o for o in (self.folder / "core").glob("*.o") if o.stem != room]
        objects = [made, *others, *(self.folder / "support").glob("*.o"), self.folder / "judges" / f"{name}.o"]
        linked = subprocess.run(["cc", "-o", str(program), *map(str, objects), "-lm"], capture_output=True, check=False)
        if linked.returncode != 0:
            raise MutateError(f"{name} cannot be linked: {linked.stderr.decode().splitlines()[-1]}")
        try:
            done = subprocess.run([str(program)], capture_output=True, check=False, cwd=ROOT, timeout=LIMIT_S)
        except subprocess.TimeoutExpired:
            return False
        finally:
            program.unlink()
        return done.returncode == 0


def _digest(file: Path) -> str:
    """Of code, data and relocations; the name of the source is no part of it."""
    listing = subprocess.run(
        ["objdump", "--reloc", "--full-contents", str(file)], capture_output=True, check=True
    ).stdout
    body = re.sub(rb"^.*file format.*$", b"", listing, flags=re.MULTILINE)
    return hashlib.sha256(body).hexdigest()


def _is_shared(source: Path) -> bool:
    """Core, sites, weights, test support and Unity; no port, no test and no other program."""
    parts = source.relative_to(ROOT).parts
    if parts[:2] == ("firmware", "port"):
        return False
    return parts[0] in ("firmware", "sites", "weights") or source.name == "unity.c" or "support" in parts


def compile_commands() -> dict[Path, list[str]]:
    """How the preset host compiles each file, without optimisation level, input and output."""
    try:
        database = compile_database()
    except CompileDatabaseError as error:
        raise MutateError(f"{error} ; right would be a tree that CMake can configure") from error
    commands = {}
    for source, command in database.items():
        words = shlex.split(command)
        commands[source] = [w for w in words[: words.index("-o")] if w not in ("-g", "-Og", "-Werror")]
    return commands
