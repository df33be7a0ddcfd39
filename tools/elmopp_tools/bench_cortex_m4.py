# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The command behind tools/bench-cortex-m4: builds, lets QEMU count, and says what came out."""

import argparse
import json
import os
import subprocess
import tempfile
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from elmopp_tools.outputs import EXIT_DONE, EXIT_REFUSED, OneLineParser, say, why_not_writable, write

TOOL = "bench-cortex-m4"
ROOT = Path(__file__).resolve().parents[2]
PLUGIN = ROOT / "tools" / "cortex_m4" / "count_plugin.c"
RUN_QEMU = ROOT / "tests" / "board" / "run_qemu.sh"
PROGRAM = ROOT / "build" / "cortex-m4" / "bin" / "tests" / "count_work"
PROBE = "lstm_q15_probe"  # beside the program
LOG = ROOT / "build" / f"{TOOL}.log"
SECONDS_MOST = 120
CLOCK_HZ = 168e6

# What the program counts to show that the counting is right: key, instructions and cycles.
PROBES = {"nothing": (0, 0), "thousand": (1000, 1000)}

DESCRIPTION = """\
Counts, exactly, the instructions that the firmware's work takes on a Cortex-M4: QEMU runs tests/board/count_work.c on
an emulated board with a plugin of ours (tools/cortex_m4/count_plugin.c). Beside them stand model cycles, the same
instructions weighted by the timings of the Cortex-M4's manual for memory without wait states: an estimate, never
compared with silicon. What is counted, and over which inputs, is said at the top of count_work.c.

  insn          the most over all inputs
  model_cycles  the most over all inputs
  spread        the most less the fewest instructions
  of a second   model cycles at 168 MHz

And the error of a free run over 60 steps (err60): the largest difference of any output from the same run in double
precision, the median over the models of tests/golden/q15_models.safetensors, of the float and the whole-number LSTM as
the board computes them (tests/lstm_q15_probe.c) and of a NumPy simulation of 16x8 (tools/elmopp_tools/err60.py)."""

EPILOG = """\
Exit codes: 0 counted; 1 the counting itself is wrong (two marks, and a thousand instructions, did not count as 0 and
1000); 2 it cannot be counted, with one line that says why.

Example:
  tools/bench-cortex-m4 --json out/bench_cortex_m4.json"""


class CountError(Exception):
    """It cannot be counted; the text is the one line that the user sees."""


class WrongCountError(Exception):
    """The counting is wrong; the text is the one line that the user sees."""


@dataclass(frozen=True)
class Count:
    """Of one piece of work, over its inputs."""

    insn: int
    model_cycles: int
    spread: int


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    options = _parser().parse_args(arguments)
    try:
        counts, err60 = _run(options)
    except CountError as error:
        say(TOOL, str(error))
        return EXIT_REFUSED
    except WrongCountError as error:
        say(TOOL, str(error))
        return 1
    print("\n".join([*table(counts), "", *err60_table(err60)]))
    return EXIT_DONE


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(
        prog=f"tools/{TOOL}",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("--json", metavar="FILE", type=Path, help="write all counts and errors to this file")
    parser.add_argument(
        "--program",
        metavar="FILE",
        type=Path,
        help=f"count_work, built by somebody else, {PROBE} beside it; without it the preset cortex-m4 builds both",
    )
    return parser


def _run(options: argparse.Namespace) -> tuple[dict[str, Count], dict[str, float]]:
    reason = options.json and why_not_writable(options.json)
    if reason:
        raise CountError(f"--json {options.json}: {reason[0]} ; {reason[1]}")
    for file in (options.program, options.program.with_name(PROBE)) if options.program else ():
        if not file.is_file():
            raise CountError(f"--program {options.program}: there is no file {file} ; leave it out to build one")
    program = options.program or _build()
    counts = count(program)
    err60 = measure_err60(program.with_name(PROBE))
    if options.json:
        write({options.json: json_text(counts, err60).encode()})
    return counts, err60


def _build() -> Path:
    commands = (
        ["cmake", "--preset", "cortex-m4"],
        ["cmake", "--build", "--preset", "cortex-m4", "--target", "count_work", PROBE],
    )
    LOG.parent.mkdir(exist_ok=True)
    with LOG.open("w", encoding="utf-8") as log:
        for command in commands:
            if subprocess.run(command, cwd=ROOT, stdout=log, stderr=log, check=False).returncode != 0:
                raise CountError(f"{' '.join(command)} failed, see {LOG.relative_to(ROOT)}")
    return PROGRAM


def count(program: Path) -> dict[str, Count]:
    """Runs the program in the emulator and reads what it and the plugin say."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        plugin = folder / "count_plugin.so"
        counted = folder / "counted"
        _say_if_failed(["cc", "-std=c11", "-O2", "-shared", "-fPIC", str(PLUGIN), "-o", str(plugin)], {})
        keys = _say_if_failed([str(RUN_QEMU), str(program)], {"QEMU_PLUGIN": f"{plugin},out={counted}"})
        return read_counts(keys.splitlines(), counted.read_text(encoding="utf-8").splitlines())


def measure_err60(probe: Path) -> dict[str, float]:
    """Runs every fixed model on the emulated board."""
    from elmopp_tools import err60  # needs an environment that tools/budget does without

    each = []
    with tempfile.TemporaryDirectory() as name:
        for model in err60.read_models():
            file = Path(name) / f"{model.name}.bin"
            file.write_bytes(model.record())
            command = [str(RUN_QEMU), str(probe), str(file)]
            done = subprocess.run(command, capture_output=True, timeout=SECONDS_MOST, check=False)
            if done.returncode != 0:
                raise CountError(f"{' '.join(command)} ended with {done.returncode}: {done.stderr.decode().strip()}")
            each.append(err60.errors(model, done.stdout))
    return err60.medians(each)


def _say_if_failed(command: Sequence[str], environment: dict[str, str]) -> str:
    try:
        done = subprocess.run(
            command,
            env={**os.environ, **environment},
            capture_output=True,
            text=True,
            errors="replace",
            timeout=SECONDS_MOST,
            check=False,
        )
    except OSError as error:
        raise CountError(f"{command[0]}: {error.strerror} ; run ./tools/setup check") from error
    except subprocess.TimeoutExpired as error:
        raise CountError(f"{command[0]} took more than {SECONDS_MOST} s") from error
    if done.returncode != 0:
        last = (done.stderr.strip() or done.stdout.strip() or "no message").splitlines()[-1]
        raise CountError(f"{' '.join(command)} ended with {done.returncode}: {last}")
    return done.stdout


def read_counts(keys: Sequence[str], lines: Sequence[str]) -> dict[str, Count]:
    """The n-th key belongs to the n-th line of the plugin, `instructions cycles`."""
    if len(keys) != len(lines):
        raise CountError(f"the program names {len(keys)} pieces of work, and {len(lines)} were counted")
    found: dict[str, list[tuple[int, int]]] = {}
    for key, line in zip(keys, lines, strict=True):
        insn, cycles = line.split()
        found.setdefault(key, []).append((int(insn), int(cycles)))
    for key, right in PROBES.items():
        if found.pop(key, None) != [right]:
            raise WrongCountError(f"'{key}' was not counted as {right[0]} instructions and {right[1]} cycles")
    return {key: _summary(values) for key, values in found.items()}


def _summary(values: Iterable[tuple[int, int]]) -> Count:
    insns, cycles = zip(*values, strict=True)
    return Count(max(insns), max(cycles), max(insns) - min(insns))


def json_text(counts: dict[str, Count], err60: dict[str, float]) -> str:
    return json.dumps({**{key: asdict(value) for key, value in counts.items()}, "err60": err60}, indent=2) + "\n"


def err60_table(err60: dict[str, float]) -> list[str]:
    """A table of Markdown, one row an arithmetic."""
    lines = ["| err60 | median | of 16x8 |", "| --- | ---: | ---: |"]
    lines += [f"| `{name}` | {value:.3g} | {value / err60['ref_16x8']:.3g} |" for name, value in err60.items()]
    return lines


def table(counts: dict[str, Count]) -> list[str]:
    """A table of Markdown, one row a key."""
    lines = ["| work | instructions | model cycles | spread | of a second |", "| --- | ---: | ---: | ---: | ---: |"]
    for key, value in counts.items():
        share = f"{100.0 * value.model_cycles / CLOCK_HZ:.3f} %"
        lines.append(f"| `{key}` | {value.insn:,} | {value.model_cycles:,} | {value.spread:,} | {share} |")
    return lines
