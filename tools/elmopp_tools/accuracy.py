# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The tables of weights/README.md: errors that host_sim measures of every forecast, beside those of tools/train.

A document holds `<!-- table: NAME -->` and `<!-- end of table -->`; what stands between is replaced. With --check the
document must hold already what would be written.
"""

import argparse
import json
import os
import statistics
import subprocess
import tempfile
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from elmopp_tools.outputs import EXIT_DIFFERENT, EXIT_DONE, EXIT_REFUSED, OneLineParser, say
from elmopp_tools.tables import TableError, table, update

ROOT = Path(__file__).resolve().parents[2]
HOST_SIM = Path(os.environ.get("ELMOPP_HOST_SIM", str(ROOT / "build" / "release" / "bin" / "host_sim")))

HORIZONS_S = ("1", "10", "30", "60")
MINUTES = ("1", "15", "60")

FORECASTS = {
    "oracle": "`oracle`: what comes",
    "nlstm": "`nlstm`: three levels, stateful, shipped",
    "nlstm-q15": "`nlstm-q15`: the same in whole numbers",
    "lstm": "`lstm`: one level, stateful, shipped",
    "lstm-q15": "`lstm-q15`: the same in whole numbers",
    "lstm-learn": "`lstm-learn`: the same, which learns on while it runs",
    "ann": "`ann`: a plain network over windows of 16 s, shipped",
    "gcn": "`gcn`: a convolution over the graph of approaches, windows of 32 s, shipped",
    "paper": "the paper's variant: one level, windows of 8 s, trained on each trial",
    "ar8": "`ar8`: fitted to each trial",
    "persistence": "`persistence`",
    "ewma": "`ewma`",
    "mean": "`mean`",
    "lstm-literal": "`lstm-literal`: `lstm`, trained on as the paper has it",
}
LONG_FORECASTS = {
    "lstm1": "one level",
    "lstm2": "two levels",
    "lstm3": "three levels",
    "ar8": "AR(8)",
    "last_week": "same time last week",
    "persistence": "persistence",
    "mean": "mean",
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    options = _parser().parse_args(arguments)
    try:
        errors = measured(options.host_sim) if options.measured is None else read_json(options.measured)
        tables = make_tables(errors, options.weights)
        good = [update(document, tables, options.check) for document in options.documents]
    except KeyError as error:
        say("accuracy", f"{options.weights}: a file lacks {error}; right would be files of tools/train")
        return EXIT_REFUSED
    except TableError as error:
        say("accuracy", str(error))
        return EXIT_REFUSED
    return EXIT_DONE if all(good) else EXIT_DIFFERENT


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(
        prog="tools/accuracy",
        description=__doc__,
        epilog="Exit codes: 0 done; 1 --check found a document that differs; 2 the request cannot be met.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument(
        "--host-sim", type=Path, default=HOST_SIM, metavar="FILE", help="the simulator (preset release)"
    )
    parser.add_argument(
        "--measured", type=Path, metavar="FILE", help="what `host_sim accuracy --json` wrote, instead of asking it"
    )
    parser.add_argument(
        "--weights", type=Path, default=ROOT / "weights", metavar="DIR", help="folder of tools/train (weights)"
    )
    parser.add_argument("--check", action="store_true", help="write nothing, compare")
    parser.add_argument("documents", nargs="*", type=Path, default=[ROOT / "weights" / "README.md"], metavar="FILE.md")
    return parser


def measured(host_sim: Path) -> dict[str, Any]:
    """What `host_sim accuracy` says of the core's forecasts."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "accuracy.json"
        try:
            done = subprocess.run(
                [str(host_sim), "accuracy", "--json", str(file)], capture_output=True, text=True, check=False
            )
        except OSError as error:
            raise TableError(f"{host_sim}: {error.strerror}; right would be host_sim of preset release") from error
        if done.returncode != 0 or not file.exists():
            said = (done.stderr.strip() or "no message").splitlines()[-1]
            raise TableError(f"{host_sim} accuracy: {said}; right would be host_sim of preset release")
        return read_json(file)


def read_json(file: Path) -> dict[str, Any]:
    try:
        found = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise TableError(f"{file}: {error}; right would be a file of tools/train or of host_sim accuracy") from error
    if not isinstance(found, dict):
        raise TableError(f"{file} holds no object; right would be a file of tools/train")
    return found


def make_tables(errors: dict[str, Any], weights: Path) -> Mapping[str, Callable[[], str]]:
    paper = read_json(weights / "paper_variant.json")
    long_memory = read_json(weights / "long_memory.json")
    errors["rmse"]["paper"] = paper["rmse"]
    errors["rmse"]["oracle"] = dict.fromkeys(HORIZONS_S, 0.0)
    return {
        "accuracy": partial(accuracy_table, errors),
        "long-memory": partial(long_memory_table, long_memory),
        "long-memory-difference": partial(difference_table, long_memory),
    }


def accuracy_table(errors: dict[str, Any]) -> str:
    lines = [
        [what, *(f"{errors['rmse'][name][seconds]:.3f}" for seconds in HORIZONS_S)] for name, what in FORECASTS.items()
    ]
    return table(["forecast", *(f"{seconds} s" for seconds in HORIZONS_S)], lines)


def long_memory_table(found: dict[str, Any]) -> str:
    def cell(values: list[float]) -> str:
        return f"{statistics.fmean(values):.3f} ± {statistics.stdev(values):.3f}"

    lines = []
    for name, what in LONG_FORECASTS.items():
        count = found["parameters"].get(name)
        errors = (cell(found["rmse"][name][minutes]) for minutes in MINUTES)
        lines.append([what, f"{count:,}" if count else "", *errors])
    return table(["forecast", "parameters", *(f"{minutes} min" for minutes in MINUTES)], lines)


def difference_table(found: dict[str, Any]) -> str:
    lines = []
    for minutes in MINUTES:
        each = found["difference_3_1"][minutes]
        lines.append([f"{minutes} min", f"{each['mean']:+.3f}", f"{each['ci_low']:+.3f} to {each['ci_high']:+.3f}"])
    return table(["ahead", "three levels less one", "95 % interval"], lines)
