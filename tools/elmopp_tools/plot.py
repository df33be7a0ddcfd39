# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The command behind tools/plot: reads the rows of an experiment and writes its figures."""

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from elmopp_tools.outputs import EXIT_DONE, EXIT_REFUSED, OneLineParser, Outputs, say, write
from elmopp_tools.plot_data import PlotError, read_results
from elmopp_tools.plot_figures import KINDS, make_figure

DESCRIPTION = """\
Draws the results of `host_sim experiment`, which calls this by itself; call it to draw them again. It reads

  DIR/trials.csv   one row a trial: profile, chooser, forecast, vehicles, trial, seed and ten measured values
  DIR/beside.csv   more rows with the same columns, if the file is there

and writes three figures, each as .png (150 dpi) and as .svg:

  throughput       vehicles served a second; a panel each for the profiles paper, saturation and figure,
                   beside the curves that are printed in the paper (dashed)
  delay            mean delay of a vehicle; a panel each for the profiles paper and saturation
  longest_red      longest red that a waiting vehicle saw; the same panels

Lines are means over the trials, shaded with the 95 % interval of the mean. With more than 12 different numbers of
vehicles each trial is a point instead. Left out are other profiles, choosers with options (itlc@ready=60) and those
forecasts of the cumulative chooser that the figure names: they nearly coincide with the others. A figure without rows
is not drawn, and a line on stdout says so."""

EPILOG = """\
Exit codes: 0 done; 2 a file or the request is wrong, with one line that says what and what would be right. Then no
figure is touched. The same rows give the same bytes.

Examples:
  tools/plot --results out/experiment                  figures beside the rows
  tools/plot --results out/experiment --out figures    figures in another folder, made if it is not there"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    options = _parser().parse_args(arguments)
    try:
        _run(options.results, options.out or options.results)
    except PlotError as error:
        return _refuse(str(error))
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except OSError as error:
        return _refuse(f"{error.filename or options.out}: {error.strerror}; right would be a file that can be written")
    return EXIT_DONE


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(
        prog="tools/plot",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("--results", metavar="DIR", type=Path, required=True, help="folder with trials.csv")
    parser.add_argument("--out", metavar="DIR", type=Path, help="folder for the figures (default: that of --results)")
    return parser


def _run(results: Path, out: Path) -> None:
    rows = read_results(results)
    if out.exists() and not out.is_dir():
        raise PlotError(f"--out {out}: is no folder; right would be a folder, there or to be made")
    # Only now: matplotlib takes its time, and may talk on stderr where it is new to a machine.
    from elmopp_tools.plot_draw import draw_figure

    files: dict[Path, bytes] = {}
    missing: list[str] = []
    for kind in KINDS:
        figure = make_figure(kind, rows)
        if figure.panels:
            files |= {out / f"{kind.name}.{suffix}": data for suffix, data in draw_figure(figure).items()}
        else:
            missing.append(f"plot: {kind.name} is not drawn: no rows of the profiles {', '.join(kind.profiles)}")
    if files:
        out.mkdir(parents=True, exist_ok=True)
        _write(files)
    if missing:
        print("\n".join(missing), flush=True)


def _write(files: Outputs) -> None:
    for path in files:
        if path.exists() and not path.is_file():
            raise PlotError(f"{path}: is no regular file; right would be a file, or none")
    write(files)


def _refuse(message: str) -> int:
    say("plot", message)
    return EXIT_REFUSED


if __name__ == "__main__":
    raise SystemExit(main())
