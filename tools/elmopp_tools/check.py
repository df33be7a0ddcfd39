# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""Builds, tests and lints the project and counts the results. Started by tools/check, which installs first."""

from __future__ import annotations

import argparse
import hashlib
import os
import re
import shutil
import subprocess
import sys
import threading
import time
import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

from elmopp_tools.compile_database import FOLDER, CompileDatabaseError, compile_database

ROOT = Path(__file__).resolve().parents[2]
REPORTS = ROOT / "build" / "check"
PRESETS = ("asan", "release", "cortex-m4", "fuzz")
C_FOLDERS = (
    "firmware",
    "host_files",
    "choosers",
    "live_page",
    "host_sim",
    "library",
    "perception",
    "scene",
    "closed_loop",
    "tests",
)
C_SUFFIXES = (".c", ".h", ".cpp", ".hpp")
JOBS = len(os.sched_getaffinity(0))

Command = Sequence[str]


@dataclass
class Tally:
    """What passed, failed and was skipped so far; the last three hold one line for each."""

    passed: int = 0
    failed: list[str] = field(default_factory=list)
    skipped: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class Step:
    """A named piece of work. It returns what to show if it fails, or None if all is well."""

    name: str
    work: Callable[[], str | None]


_lock = threading.Lock()


def tool(name: str) -> str:
    """A program of the Python environment that tools/check runs in."""
    return str(ROOT / "build" / "venv" / "check" / "bin" / name)


def report(status: str, name: str, seconds: float, output: str | None = None, note: str = "") -> None:
    """Prints the one line of a step, and all output of a step that failed."""
    with _lock:
        print(f"{status:<7} {name:<28} {seconds:7.1f} s  {note}".rstrip(), flush=True)
        if output:
            print("\n".join(f"    {line}" for line in output.strip().splitlines()), flush=True)


def log_path(name: str) -> Path:
    return REPORTS / (re.sub(r"[^\w.-]+", "-", name) + ".log")


def execute(name: str, command: Command, environment: dict[str, str] | None = None) -> tuple[int, str]:
    """Runs a command in the project's root; its output also goes to the log of the step."""
    try:
        done = subprocess.run(
            list(command),
            cwd=ROOT,
            env={**os.environ, **(environment or {})},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            check=False,
        )
    except OSError as error:
        return 1, f"cannot run {command[0]}: {error.strerror}"
    with log_path(name).open("a", encoding="utf-8") as log:
        log.write(f"$ {' '.join(command)}\n{done.stdout}\n")
    return done.returncode, done.stdout


def commands(name: str, *sequence: Command) -> Step:
    """A step that runs commands one after the other until one fails."""

    def work() -> str | None:
        for command in sequence:
            status, output = execute(name, command)
            if status != 0:
                return output or f"{command[0]} ended with {status}"
        return None

    return Step(name, work)


def run_step(step: Step, tally: Tally) -> bool:
    started = time.monotonic()
    problem = step.work()
    report("ok" if problem is None else "FAILED", step.name, time.monotonic() - started, problem)
    with _lock:
        if problem is None:
            tally.passed += 1
        else:
            tally.failed.append(step.name)
    return problem is None


# --- building and testing ---------------------------------------------------------------------------------------------


def read_allowed_skips(path: Path) -> dict[tuple[str, str], str]:
    """The written list: (preset or *, test) and the reason why that test may be skipped."""
    allowed = {}
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
        if not line.strip() or line.startswith("#"):
            continue
        words = line.split(maxsplit=2)
        if len(words) < 3:
            raise ValueError(f"{path.relative_to(ROOT)}:{number}: '{line}' must read PRESET TEST REASON")
        allowed[words[0], words[1]] = words[2]
    return allowed


def count_tests(preset: str, junit: Path, allowed: dict[tuple[str, str], str], tally: Tally) -> str:
    """Adds the results in a JUnit file of ctest to the tally, and returns them as a phrase."""
    before = Tally(tally.passed, list(tally.failed), list(tally.skipped))
    # ctest wrote this file a moment ago.
    for case in ET.parse(junit).getroot().iter("testcase"):  # noqa: S314
        test = case.get("name", "?")
        skip = case.find("skipped")
        if case.get("status") == "run":
            tally.passed += 1
        elif skip is None or not skip.get("message", "").startswith("SKIP_"):
            tally.failed.append(f"{preset}: {test}")
        else:
            reason = allowed.get((preset, test)) or allowed.get(("*", test))
            if reason is None:
                tally.failed.append(f"{preset}: {test} was skipped, and tools/allowed-skips.txt does not name it")
            else:
                tally.skipped.append(f"{preset}: {test} ({reason})")
    failed = len(tally.failed) - len(before.failed)
    skipped = len(tally.skipped) - len(before.skipped)
    return f"{tally.passed - before.passed} passed, {failed} failed, {skipped} skipped"


def run_tests(preset: str, nightly: bool, allowed: dict[tuple[str, str], str], tally: Tally) -> None:
    name = f"{preset}: test"
    junit = REPORTS / f"{preset}.junit.xml"
    command = ["ctest", "--test-dir", f"build/{preset}", "--parallel", str(JOBS)]
    command += ["--output-on-failure", "--no-tests=error", "--output-junit", str(junit)]
    if not nightly:
        command += ["--label-exclude", "^nightly$"]
    failed_before = len(tally.failed)
    started = time.monotonic()
    status, output = execute(name, command, {"UBSAN_OPTIONS": "print_stacktrace=1"})
    note = count_tests(preset, junit, allowed, tally) if junit.exists() else "no report"
    if status != 0 and len(tally.failed) == failed_before:
        tally.failed.append(name)
    bad = len(tally.failed) > failed_before
    report("FAILED" if bad else "ok", name, time.monotonic() - started, output if bad else None, note)


def configure(preset: str) -> Step:
    return commands(f"{preset}: configure", ["cmake", "--preset", preset, "-DELMOPP_MERGE_SOURCES=ON"])


def build_and_test(nightly: bool, allowed: dict[tuple[str, str], str], tally: Tally) -> None:
    # A configuration keeps one processor busy: all of them first, side by side.
    with ThreadPoolExecutor(JOBS) as pool:
        configured = dict(
            zip(PRESETS, pool.map(lambda preset: run_step(configure(preset), tally), PRESETS), strict=True)
        )
    for preset in PRESETS:
        # Ninja goes on after an error, so that one run shows all of them.
        build = ["cmake", "--build", "--preset", preset, "--", "-k", "0"]
        built = configured[preset] and run_step(commands(f"{preset}: build", build), tally)
        if built:
            run_tests(preset, nightly, allowed, tally)
        if built and preset == "release":
            run_step(install_step(), tally)


def install_step() -> Step:
    """Installs release into an empty folder and starts what was installed."""
    prefix = REPORTS / "install"
    return commands(
        "release: install",
        ["cmake", "--install", "build/release", "--prefix", str(prefix)],
        [f"{prefix}/bin/host_sim", "list", "--json"],
        [f"{prefix}/bin/elmopp-view", "--help"],
        [tool("python"), f"{prefix}/share/elmopp/tools/edit-lanes", "--help"],
        [tool("python"), f"{prefix}/share/elmopp/tools/site", "--help"],
        [
            str(ROOT / "build" / "venv" / "sumo" / "bin" / "python"),
            f"{prefix}/share/elmopp/tools/sumo-run",
            "--help",
        ],
        [
            tool("python"),
            f"{prefix}/share/elmopp/tools/weights",
            f"{prefix}/share/elmopp/weights/forecast.safetensors",
        ],
    )


# --- lint -------------------------------------------------------------------------------------------------------------


def c_files() -> list[Path]:
    return sorted(f for folder in C_FOLDERS for f in (ROOT / folder).rglob("*") if f.suffix in C_SUFFIXES)


def python_programs() -> list[str]:
    """The programs of tools/ that are Python but do not say so in their name."""
    candidates = (f for f in sorted((ROOT / "tools").iterdir()) if f.is_file() and not f.suffix)
    first_lines = ((f, f.read_text(encoding="utf-8").partition("\n")[0]) for f in candidates)
    return [str(f.relative_to(ROOT)) for f, line in first_lines if line.startswith("#!") and "python" in line]


def check_format() -> str | None:
    files = [str(f.relative_to(ROOT)) for f in c_files()]
    if not files:
        return "no C or C++ file found"
    status, output = execute("clang-format", [tool("clang-format"), "--dry-run", "-Werror", *files])
    if status == 0:
        return None
    names = sorted(set(re.findall(r"^(\S+?):\d+:\d+: error:", output, flags=re.MULTILINE)))
    if not names:
        return output
    return "not formatted; to format: build/venv/check/bin/clang-format -i " + " ".join(names)


def check_tidy(nightly: bool) -> str | None:
    """Judges each source file of the firmware and the simulation that the preset host compiles.

    Clang's analyzer follows paths through whole functions and takes nearly all of the time: it always judges the core,
    and what is C++ only at night.
    """
    try:
        compiled = compile_database()
    except CompileDatabaseError as error:
        return str(error)
    core = ROOT / "firmware" / "src"
    folders = [core, ROOT / "firmware" / "port"]
    folders += [ROOT / folder for folder in C_FOLDERS[1:-1]]
    files = sorted(f for f in compiled if any(f.is_relative_to(folder) for folder in folders))
    if not files:
        return "the preset host compiles no file of firmware/src or host_sim"
    # The warnings of gcc are judged by the build; clang's own opinion on the same flags is not asked for.
    command = [tool("clang-tidy"), "--quiet", "-p", str(FOLDER), "--extra-arg=-Wno-error"]

    def judge(file: Path) -> tuple[int, str]:
        quick = [] if nightly or file.is_relative_to(core) else ["--checks=-clang-analyzer-*"]
        return execute("clang-tidy", [*command, *quick, str(file.relative_to(ROOT))])

    with ThreadPoolExecutor(JOBS) as pool:
        results = list(pool.map(judge, files))
    return "\n".join(output for status, output in results if status != 0) or None


def misra_step() -> Step:
    command = ["cppcheck", "--quiet", "--error-exitcode=1", "--std=c11", "--language=c", "--addon=misra"]
    command += ["--enable=warning,style,performance,portability", "--suppressions-list=tools/misra-suppressions.txt"]
    command += ["--template={file}:{line}:{column}: {severity}: {message} [{id}]", "--template-location="]
    return commands("cppcheck and MISRA", [*command, "-I", "firmware/include", "-I", "firmware/can", "firmware/src"])


def check_deviations() -> str | None:
    """Every suppression names a deviation that docs/safety.md explains."""
    safety = ROOT / "docs" / "safety.md"
    explained = set(re.findall(r"\bD\d+\b", safety.read_text(encoding="utf-8"))) if safety.exists() else set()
    problems = []
    path = ROOT / "tools" / "misra-suppressions.txt"
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
        if not line.strip() or line.startswith("#"):
            continue
        deviation = re.search(r"#\s*(D\d+)\b", line)
        if deviation is None:
            problems.append(f"{path.relative_to(ROOT)}:{number}: '{line}' does not end with # D<number>")
        elif deviation[1] not in explained:
            problems.append(f"{path.relative_to(ROOT)}:{number}: docs/safety.md does not explain {deviation[1]}")
    return "\n".join(problems) or None


def _requirement_sources() -> dict[str, list[str]]:
    """The .in files of each pinned list."""
    return {"base": ["base.in"]} | {name: ["base.in", f"{name}.in"] for name in ("bench", "check", "sumo", "train")}


def check_requirements() -> str | None:
    """Each pinned list was made from the present .in files; their SHA-256 is in its first line."""
    folder = ROOT / "tools" / "requirements"
    stale = []
    for name, sources in _requirement_sources().items():
        digest = hashlib.sha256(b"".join((folder / source).read_bytes() for source in sources)).hexdigest()
        if digest not in (folder / f"{name}.txt").read_text(encoding="utf-8").partition("\n")[0]:
            stale.append(f"tools/requirements/{name}.txt")
    return f"{' and '.join(stale)} out of date: run tools/requirements/lock" if stale else None


def mypy_step() -> Step:
    """Programs are checked one by one, because each of them is the module __main__."""
    mypy = [tool("mypy"), "--no-error-summary"]
    tests = sorted(str(f.relative_to(ROOT)) for f in (ROOT / "tests").rglob("*.py"))
    return commands(
        "mypy", [*mypy, "tools/elmopp_tools", "cmake/seal_image.py", *tests], *([*mypy, f] for f in python_programs())
    )


def lint_steps(nightly: bool) -> list[Step]:
    ruff = tool("ruff")
    python = ["cmake", "tools", "tests", *python_programs()]
    return [
        commands("coverage", [tool("python"), "tools/coverage"]),
        misra_step(),
        Step("clang-tidy", lambda: check_tidy(nightly)),
        mypy_step(),
        Step("clang-format", check_format),
        commands("ruff check", [ruff, "check", "--quiet", "--no-cache", *python]),
        commands("ruff format", [ruff, "format", "--check", "--no-cache", *python]),
        Step("MISRA deviations", check_deviations),
        Step("requirements", check_requirements),
    ]


def lint(nightly: bool, tally: Tally) -> None:
    """Coverage is among these: while it links and reads what was counted, it leaves a processor to the others."""
    with ThreadPoolExecutor(JOBS) as pool:
        for _ in pool.map(lambda step: run_step(step, tally), lint_steps(nightly)):
            pass


# --- summary ----------------------------------------------------------------------------------------------------------


def summarise(tally: Tally, seconds: float) -> None:
    print()
    list_lines("failed ", tally.failed)
    list_lines("skipped", tally.skipped)
    counts = f"{tally.passed} passed, {len(tally.failed)} failed, {len(tally.skipped)} skipped"
    minutes, rest = divmod(round(seconds), 60)
    print(f"check: {counts} in {minutes} min {rest} s; logs and JUnit reports are in {REPORTS.relative_to(ROOT)}")


def list_lines(word: str, lines: Iterable[str]) -> None:
    for line in lines:
        print(f"{word}  {line}")


def main() -> int:
    parser = argparse.ArgumentParser(prog="check", description=__doc__)
    parser.add_argument("--all", action="store_true", help="also run the tests labelled nightly")
    parser.add_argument("--since", type=float, default=time.time(), help="when the installation began, in Unix time")
    arguments = parser.parse_args()
    try:
        allowed = read_allowed_skips(ROOT / "tools" / "allowed-skips.txt")
    except ValueError as error:
        print(f"check: {error}", file=sys.stderr)
        return 2
    shutil.rmtree(REPORTS, ignore_errors=True)
    REPORTS.mkdir(parents=True)
    tally = Tally()
    build_and_test(arguments.all, allowed, tally)
    lint(arguments.all, tally)
    summarise(tally, time.time() - arguments.since)
    return 1 if tally.failed else 0


if __name__ == "__main__":
    sys.exit(main())
