# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The command behind tools/bench-forecast: installs, builds, measures in rounds and says what came out."""

import argparse
import json
import os
import platform
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path

from elmopp_tools.bench_report import (
    PRESETS,
    V3,
    Ours,
    Round,
    json_text,
    lines_of_table,
    lines_of_verdict,
    verdict,
)
from elmopp_tools.outputs import EXIT_REFUSED, OneLineParser, say, why_not_writable, write
from elmopp_tools.venv import enter

TOOL = "bench-forecast"
ROOT = Path(__file__).resolve().parents[2]
WEIGHTS = ROOT / "weights" / "forecast.safetensors"
LOG = ROOT / "build" / f"{TOOL}.log"
ROUNDS = 7
HOST_SIM_SECONDS_MOST = 120

# What x86-64-v3 asks of a processor besides x86-64-v2, as Linux calls it.
V3_FLAGS = {"abm", "avx", "avx2", "bmi1", "bmi2", "f16c", "fma", "movbe"}

DESCRIPTION = """\
Compares the speed of the forecast's LSTM (4 inputs, 16 units) with onnxruntime's LSTM of the same weights, on one
core and batch 1. It installs onnxruntime (tools/setup bench, into build/venv/bench), builds host_sim with the presets
release and release-v3, checks that onnxruntime computes the same network, and measures in rounds, each of which runs
`host_sim bench --forecast-only` of both builds and onnxruntime one after the other. Leave the machine alone meanwhile.

  step      ours: one call. onnxruntime: (time of a run over 61 seconds - time of a run over 1) / 60, so without what
            a run costs by itself
  rollout   60 steps, each of which sees what the one before said. onnxruntime: the faster of 60 runs of one step and
            one run of a graph that holds 60 steps
  ratio     ours to onnxruntime's, of the same round: median (least to most)"""

EPILOG = """\
Exit codes: 0 the LSTM step built for x86-64-v3 takes at most 0.5 of onnxruntime's and both builds give the same bits;
1 not so; 2 it cannot be measured, with one line that says why. On a processor without AVX2 the portable build is
shown and the exit code is 2.

Example:
  tools/bench-forecast --json out/bench_forecast.json"""


class BenchError(Exception):
    """It cannot be measured; the text is the one line that the user sees."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    options = _parser().parse_args(arguments)
    try:
        return _run(options)
    except BenchError as error:
        say(TOOL, str(error))
        return EXIT_REFUSED


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(
        prog=f"tools/{TOOL}",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("--rounds", metavar="N", type=_positive, default=ROUNDS, help="default: %(default)s")
    parser.add_argument("--json", metavar="FILE", type=Path, help="write everything that was measured to this file too")
    return parser


def _positive(text: str) -> int:
    if not text.isascii() or not text.isdigit() or int(text) == 0:
        raise argparse.ArgumentTypeError(f"'{text}' is no number of rounds; right would be 1 or more")
    return int(text)


def _run(options: argparse.Namespace) -> int:
    reason = options.json and why_not_writable(options.json)
    if reason:
        raise BenchError(f"--json {options.json}: {reason[0]} ; {reason[1]}")
    _install()
    enter("bench")
    lacking = missing_flags(Path("/proc/cpuinfo").read_text(encoding="utf-8"))
    programs = {flags: _build(preset) for flags, preset in PRESETS.items() if flags != V3 or not lacking}
    rounds, about = _measure(programs, options.rounds)
    _say_all(_title(about, rounds), rounds)
    if options.json:
        write({options.json: json_text(rounds, about).encode()})
    if lacking:
        raise BenchError(f"this processor has no {', '.join(lacking)}, so only the portable build was measured")
    return verdict(rounds).exit_code


# --- before -----------------------------------------------------------------------------------------------------------


def _install() -> None:
    """Nothing, if this is the environment already: enter() starts the program a second time."""
    folder = ROOT / "build" / "venv" / "bench"
    if folder.exists() and os.path.samefile(sys.prefix, folder):
        return
    if subprocess.run([ROOT / "tools" / "setup", "bench"], check=False).returncode != 0:
        raise BenchError("tools/setup bench failed, see above")


def missing_flags(cpuinfo: str) -> list[str]:
    """What the first processor of this /proc/cpuinfo lacks for x86-64-v3."""
    if platform.machine() != "x86_64":
        return ["x86-64"]
    line = next((line for line in cpuinfo.splitlines() if line.startswith("flags")), "")
    return sorted(V3_FLAGS - set(line.partition(":")[2].split()))


def processor(cpuinfo: str) -> str:
    line = next((line for line in cpuinfo.splitlines() if line.startswith("model name")), "")
    return line.partition(":")[2].strip() or platform.machine()


def _build(preset: str) -> Path:
    """host_sim of that preset. The tests stay out: they would need Unity, and ./tools/check builds them."""
    print(f"{TOOL}: building build/{preset}/bin/host_sim", flush=True)
    configure = ["cmake", "--preset", preset, "-DBUILD_TESTING=OFF"]
    build = ["cmake", "--build", "--preset", preset, "--target", "host_sim"]
    for command in (configure, build):
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, errors="replace", check=False)
        if done.returncode != 0:
            LOG.write_text(done.stdout + done.stderr, encoding="utf-8")
            raise BenchError(f"'{' '.join(command)}' failed ; see {LOG.relative_to(ROOT)}")
    return ROOT / "build" / preset / "bin" / "host_sim"


# --- measuring --------------------------------------------------------------------------------------------------------


def _measure(programs: dict[str, Path], count: int) -> tuple[list[Round], dict[str, str]]:
    """All rounds, and what was compared."""
    import numpy
    import onnx
    import onnxruntime

    from elmopp_tools.onnx_lstm import Clocked, NotTheSameError, check
    from elmopp_tools.weights_model import WeightsError, network, read_tensors

    try:
        weights = network(read_tensors(WEIGHTS)[0], "lstm")
        check(weights)
    except WeightsError as error:
        raise BenchError(f"{WEIGHTS.relative_to(ROOT)}: {error}") from error
    except OSError as error:
        raise BenchError(f"{WEIGHTS.relative_to(ROOT)}: {error.strerror} ; make it with tools/train") from error
    except NotTheSameError as error:
        raise BenchError(f"{error}, so nothing was compared") from error
    clocked = Clocked(weights)
    print(f"{TOOL}: measuring", end="", flush=True)
    rounds = []
    for number in range(count):
        # Every other round the other way round, so that no one is always first.
        order = list(programs) if number % 2 == 0 else list(programs)[::-1]
        ours = {flags: host_sim_says(programs[flags]) for flags in order}
        rounds.append(Round({flags: ours[flags] for flags in programs}, clocked.measure()))
        print(f" {number + 1}", end="", flush=True)
    print()
    versions = {module.__name__: module.__version__ for module in (onnxruntime, onnx, numpy)}
    return rounds, {"processor": processor(Path("/proc/cpuinfo").read_text(encoding="utf-8")), **versions}


def _title(about: dict[str, str], rounds: Sequence[Round]) -> str:
    what = f"{len(rounds)} round{'s' if len(rounds) > 1 else ''}, medians"
    return f"onnxruntime {about['onnxruntime']} with one thread, batch 1; {about['processor']}; {what}"


def _say_all(title: str, rounds: Sequence[Round]) -> None:
    lines = ["", title, "", *lines_of_table(rounds), "", *lines_of_verdict(rounds)]
    print("\n".join(lines), flush=True)


def host_sim_says(program: Path) -> Ours:
    """Runs the measurement of one build."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "bench.json"
        command = [str(program), "bench", "--forecast-only", "--json", str(file)]
        try:
            done = subprocess.run(
                command, capture_output=True, text=True, errors="replace", timeout=HOST_SIM_SECONDS_MOST, check=False
            )
        except OSError as error:
            raise BenchError(f"{program}: {error.strerror} ; a program that can be run") from error
        except subprocess.TimeoutExpired as error:
            raise BenchError(f"{program} bench took more than {HOST_SIM_SECONDS_MOST} s") from error
        if done.returncode != 0:
            last = (done.stderr.strip() or "no message").splitlines()[-1]
            raise BenchError(f"{program} bench --forecast-only ended with {done.returncode}: {last}")
        try:
            return read_ours(file.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise BenchError(f"{program} bench --forecast-only --json wrote no measurement: {error}") from error


def read_ours(text: str) -> Ours:
    """ValueError, with what is wrong, if it is not what host_sim should write."""
    values = json.loads(text)
    if not isinstance(values, dict):
        raise ValueError("no object")
    for field in fields(Ours):
        value = values.get(field.name)
        right = isinstance(value, str) if field.type is str else isinstance(value, float | int) and value > 0
        if not right:
            raise ValueError(f"{field.name} is {json.dumps(value)}")
    return Ours(**{field.name: values[field.name] for field in fields(Ours)})
