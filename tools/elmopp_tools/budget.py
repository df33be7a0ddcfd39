# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The command behind tools/budget: what an image takes, against what it may take."""

import argparse
import json
import math
import re
import subprocess
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from elmopp_tools.bench_cortex_m4 import Count, CountError, WrongCountError, count
from elmopp_tools.bench_cortex_m4 import table as table_of_counts
from elmopp_tools.outputs import EXIT_DIFFERENT, EXIT_DONE, EXIT_REFUSED, OneLineParser, say, write
from elmopp_tools.stack_use import StackError, StackUse, read_calls, stack_use

TOOL = "budget"
ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "tools" / "cortex_m4"
LIMITS = FOLDER / "budgets.json"
CALLS = FOLDER / "calls.json"
DOCUMENT = ROOT / "docs" / "measurements.md"
MARKED = re.compile(r"(<!-- budgets -->\n).*?(<!-- end of budgets -->)", re.DOTALL)
ROOM_ABOVE = 1.05
COUNTED = frozenset({"instructions", "model_cycles"})  # limits that are not an image's
CONSTANT = ("lstm_", "nlstm3_", "quantize", "train_", "rollout60_")  # whatever the numbers are
TICK_CYCLES = 3_360_000  # 2 % of a second at 168 MHz

# Whoever has one of these can have memory that no budget knows.
HEAP = frozenset({"malloc", "calloc", "realloc", "free", "sbrk", "_sbrk", "_malloc_r", "_free_r", "_sbrk_r"})

DESCRIPTION = """\
Holds what the images for a Cortex-M4 take against what they may take: flash, RAM, the deepest stack (gcc's frames
along the call graph, interrupts and faults on top; calls through pointers as tools/cortex_m4/calls.json lists them), no
heap, and the instructions of the firmware's work as tools/bench-cortex-m4 counts them. Limits are in
tools/cortex_m4/budgets.json: what was measured and 5 %. They go up only in a commit that says why. A tick with a
decision may also take 2 % of a second at 168 MHz, 3,360,000 model cycles; the few that may take more are named there,
under model_cycles, with what they may take. A network's step, its training and its quantising take the same
instructions for all numbers."""

EPILOG = """\
Exit codes: 0 everything is within its limit, and docs/measurements.md shows what was measured; 1 not so, with a line
for each; 2 it cannot be measured, with one line that says why.

Examples:
  tools/budget --build build/cortex-m4            after cmake --build --preset cortex-m4
  tools/budget --build build/cortex-m4 --write    ... and writes the table in docs/measurements.md
  tools/budget --build build/cortex-m4 --limits   ... and the limits: what was measured and 5 %"""


class BudgetError(Exception):
    """It cannot be measured; the text is the one line that the user sees."""


@dataclass(frozen=True)
class Image:
    """What an image takes."""

    flash_bytes: int
    ram_bytes: int
    aside_bytes: int  # of a second block of RAM
    stack_bytes: int
    stack_reserved_bytes: int
    heap_functions: int


@dataclass(frozen=True)
class Measured:
    images: dict[str, Image]
    stacks: dict[str, StackUse]
    counts: dict[str, Count]


Limits = dict[str, dict[str, int]]


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    options = _parser().parse_args(arguments)
    try:
        limits: Limits = json.loads(LIMITS.read_text(encoding="utf-8"))
        measured = measure(options.build, [name for name in limits if name not in COUNTED])
    except (BudgetError, StackError, CountError, WrongCountError) as error:
        say(TOOL, str(error))
        return EXIT_REFUSED
    if options.limits:
        limits = new_limits(measured)
        write({LIMITS: (json.dumps(limits, indent=2) + "\n").encode()})
    lines = lines_of(measured, limits)
    text = with_table(DOCUMENT.read_text(encoding="utf-8"), lines)
    if options.write or options.limits:
        write({DOCUMENT: text.encode()})
    print("\n".join(lines))
    problems = beyond(measured, limits)
    if text != DOCUMENT.read_text(encoding="utf-8"):
        problems.append(f"{DOCUMENT.relative_to(ROOT)}: shows other figures ; write it with tools/budget --write")
    for problem in problems:
        say(TOOL, problem)
    return EXIT_DIFFERENT if problems else EXIT_DONE


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(
        prog=f"tools/{TOOL}",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("--build", metavar="DIR", type=Path, required=True, help="a build by the preset cortex-m4")
    parser.add_argument("--write", action="store_true", help="write the table in docs/measurements.md")
    parser.add_argument("--limits", action="store_true", help="write the limits, and the table")
    return parser


# --- measuring --------------------------------------------------------------------------------------------------------


def measure(build: Path, names: Sequence[str]) -> Measured:
    images: dict[str, Image] = {}
    stacks: dict[str, StackUse] = {}
    calls = read_calls(CALLS)
    for name in names:
        path = build / "bin" / name
        if not path.is_file():
            raise BudgetError(f"{path}: there is no such image ; build it with cmake --build --preset cortex-m4")
        stacks[name] = stack_use(path, build / "firmware", calls)
        images[name] = image_of(_readelf("-SW", path), _readelf("-sW", path), stacks[name].bytes)
    program = build / "bin" / "tests" / "count_work"
    if not program.is_file():
        raise BudgetError(f"{program}: there is no such program ; build it with cmake --build --preset cortex-m4")
    return Measured(images, stacks, count(program))


def _readelf(option: str, image: Path) -> list[str]:
    command = ["arm-none-eabi-readelf", option, str(image)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError as error:
        raise BudgetError(f"{command[0]}: {error.strerror} ; run ./tools/setup check") from error
    if done.returncode != 0:
        raise BudgetError(f"{' '.join(command)} failed: {done.stderr.strip()}")
    return done.stdout.splitlines()


def image_of(sections: Sequence[str], symbols: Sequence[str], stack_bytes: int) -> Image:
    """From what readelf says. What is kept for the stack is not RAM that variables take."""
    flash = 0
    ram = 0
    aside = 0
    reserved = 0
    for line in sections:
        found = re.match(r"^ +\[ *\d+\] (\S+) +(\S+) +[0-9a-f]+ [0-9a-f]+ ([0-9a-f]+) [0-9a-f]+ +(\w*)", line)
        if found is None or "A" not in found[4]:
            continue
        name, kind, size = found[1], found[2], int(found[3], 16)
        if name == ".stack":
            reserved += size
        elif name == ".aside":
            aside += size
        elif kind == "NOBITS":
            ram += size
        else:
            flash += size
            ram += size if name == ".data" else 0
    heap = {line.split()[-1] for line in symbols if line.strip()} & HEAP
    return Image(flash, ram, aside, stack_bytes, reserved, len(heap))


# --- limits -----------------------------------------------------------------------------------------------------------


def new_limits(measured: Measured) -> Limits:
    limits: Limits = {}
    for name, image in measured.images.items():
        values = asdict(image)
        values.pop("stack_reserved_bytes")
        limits[name] = {key: math.ceil(value * ROOM_ABOVE) for key, value in values.items()}
    counts = measured.counts.items()
    limits["instructions"] = {key: math.ceil(value.insn * ROOM_ABOVE) for key, value in counts}
    limits["model_cycles"] = {
        key: math.ceil(value.model_cycles * ROOM_ABOVE)
        for key, value in counts
        if key.startswith("tick") and value.model_cycles > TICK_CYCLES
    }
    return limits


def beyond(measured: Measured, limits: Limits) -> list[str]:
    """One line for each that is not within its limit, or has none."""
    problems = []
    for name, image in measured.images.items():
        values = asdict(image)
        reserved = values.pop("stack_reserved_bytes")
        problems += _beyond(name, values, limits[name])
        if 0 < reserved < image.stack_bytes:
            problems.append(f"{name}: stack_bytes {image.stack_bytes} ; {reserved} are kept for it")
    counts = {key: value.insn for key, value in measured.counts.items()}
    problems += _beyond("instructions", counts, limits["instructions"])
    return problems + _too_long(measured, limits) + _uneven(measured)


def _uneven(measured: Measured) -> list[str]:
    return [
        f"spread: {key} {value.spread} ; 0 would be right"
        for key, value in measured.counts.items()
        if key.startswith(CONSTANT) and value.spread != 0
    ]


def _too_long(measured: Measured, limits: Limits) -> list[str]:
    named = limits["model_cycles"]
    ticks = {key: value.model_cycles for key, value in measured.counts.items() if key.startswith("tick")}
    problems = [
        f"model cycles: {key} {cycles} ; at most {named.get(key, TICK_CYCLES)} would be right"
        for key, cycles in ticks.items()
        if cycles > named.get(key, TICK_CYCLES)
    ]
    idle = [key for key in named if ticks.get(key, 0) <= TICK_CYCLES]
    return problems + [f"model cycles: {key} needs no limit of its own ; leave it out" for key in idle]


def _beyond(name: str, values: dict[str, int], limits: dict[str, int]) -> list[str]:
    problems = []
    for key, value in values.items():
        if key not in limits:
            problems.append(f"{name}: {key} {value} has no limit ; write one in {LIMITS.relative_to(ROOT)}")
        elif value > limits[key]:
            problems.append(f"{name}: {key} {value} ; at most {limits[key]} would be right")
    problems += [f"{name}: {key} was not measured, but has a limit" for key in limits if key not in values]
    return problems


# --- the table --------------------------------------------------------------------------------------------------------


def lines_of(measured: Measured, limits: Limits) -> list[str]:
    lines = [
        "| image | flash, bytes | RAM, bytes | core-coupled RAM, bytes | deepest stack, bytes | heap |",
        "| --- | ---: | ---: | ---: | ---: | ---: |",
    ]
    for name, image in measured.images.items():
        may = limits[name]
        lines.append(
            f"| `{name}` | {image.flash_bytes:,} of {may['flash_bytes']:,} | {image.ram_bytes:,} of "
            f"{may['ram_bytes']:,} | {image.aside_bytes:,} of {may['aside_bytes']:,} | {image.stack_bytes:,} of "
            f"{may['stack_bytes']:,} | {image.heap_functions} |"
        )
    for name, stack in measured.stacks.items():
        ways = (
            f"main {stack.main.bytes:,} (`{'` `'.join(stack.main.way[-4:])}` at the end)",
            f"interrupt {stack.interrupt.bytes:,}",
            f"fault {stack.fault.bytes:,}",
        )
        lines += ["", f"Stack of `{name}`: {', '.join(ways)}."]
    head, rule, *rows = table_of_counts(measured.counts)
    lines += ["", head + " limit |", rule + " ---: |"]
    limits_of_counts = limits["instructions"]
    lines += [f"{row} {limits_of_counts.get(key, 0):,} |" for key, row in zip(measured.counts, rows, strict=True)]
    return lines


def with_table(text: str, lines: Sequence[str]) -> str:
    if MARKED.search(text) is None:
        raise BudgetError(f"{DOCUMENT.relative_to(ROOT)} has no <!-- budgets --> and <!-- end of budgets -->")
    return MARKED.sub(lambda found: found[1] + "\n" + "\n".join(lines) + "\n\n" + found[2], text)
