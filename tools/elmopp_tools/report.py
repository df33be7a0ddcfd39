# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The command behind tools/report: reads what runs have written and makes one page of it."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from elmopp_tools.outputs import EXIT_DONE, EXIT_REFUSED, OneLineParser, say, why_not_writable, write
from elmopp_tools.plot_data import PlotError, read_results
from elmopp_tools.report_data import ReportError, read_comparison, read_log, read_paths

DESCRIPTION = """\
Makes one self-contained HTML page (no script, no file beside it, nothing from a network) from

  --experiment DIR  trials.csv, and waits.csv and beside.csv if they are there, of `host_sim experiment`: mean delay by
                    number of vehicles as curves and as tables with 95 % intervals, longest red, the longest wait of a
                    vehicle where single ones drive, switches, and what each forecast of a chooser is worth, paired by
                    trial, and in words whether lstm beats none, ewma and ar8
  --sumo DIR        what tools/sumo-compare has written: standings, the best rival of each scenario, ours against
                    him paired by seed, longest red and longest wait, and what each forecast is worth, as there
  --run FILE        a decision log (`host_sim run --log FILE`): queues, lamps, and forecast beside what came
  --paths FILE      where vehicles were before their stop line, as tools/sumo-run --paths writes it: CSV with
                    the columns t_s, approach, vehicle, distance_m

At least one of them; a section whose files are not given is left out."""

EPILOG = """\
Exit codes: 0 done; 2 a file or the request is wrong, with one line that says what and what would be right. Then the
page that was there is untouched. The same files give the same bytes.

Example:
  tools/report --experiment out/experiment --sumo out/compare --out out/report.html"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = _parser()
    options = parser.parse_args(arguments)
    if not any((options.experiment, options.sumo, options.run, options.paths)):
        parser.error("nothing to report on; right would be --experiment, --sumo, --run or --paths")
    try:
        _run(options)
    except (PlotError, ReportError) as error:
        say("report", str(error))
        return EXIT_REFUSED
    return EXIT_DONE


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(
        prog="tools/report",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("--experiment", metavar="DIR", type=Path, help="folder with trials.csv")
    parser.add_argument("--sumo", metavar="DIR", type=Path, help="folder with runs.csv and comparison.csv")
    parser.add_argument("--run", metavar="FILE", type=Path, help="a decision log")
    parser.add_argument("--paths", metavar="FILE", type=Path, help="where vehicles were")
    parser.add_argument("--title", default="ELMOPP: results", help="default: %(default)s")
    parser.add_argument("--out", metavar="FILE", type=Path, required=True, help="the page")
    return parser


def _run(options: argparse.Namespace) -> None:
    wrong = why_not_writable(options.out)
    if wrong is not None:
        raise ReportError(f"--out {options.out}: {wrong[0]}; right would be {wrong[1]}")
    rows = read_results(options.experiment) if options.experiment else []
    comparison = read_comparison(options.sumo) if options.sumo else None
    log = read_log(options.run) if options.run else None
    paths = read_paths(options.paths) if options.paths else []
    # Only now: matplotlib takes its time.
    from elmopp_tools.report_page import make_page

    write({options.out: make_page(options.title, rows, comparison, log, paths).encode()})


if __name__ == "__main__":
    raise SystemExit(main())
