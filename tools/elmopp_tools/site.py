# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The command behind tools/site: reads a site file, checks it, writes it as C or as an image, or compares."""

import argparse
import hashlib
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from elmopp_tools.outputs import (
    EXIT_DONE,
    EXIT_REFUSED,
    OneLineParser,
    Outputs,
    compare,
    say,
    why_not_writable,
    write,
)
from elmopp_tools.site_build import build_junction
from elmopp_tools.site_c import c_text
from elmopp_tools.site_image import image_bytes
from elmopp_tools.site_model import Junction, SiteError, seconds
from elmopp_tools.site_rules import check_junction
from elmopp_tools.site_toml import read_document

DESCRIPTION = """\
Reads the description of one junction (a site file in TOML, see sites/), works out its stages, checks it, and
turns it into what the controller loads.

A stage is a maximal set of signal groups that may be green together; all of them follow from the conflict table.
So does the shortest bound on red (red_bound_s) that the junction can keep, and a fixed-time programme if the file
names none. Without --c and --image nothing is written: the site is checked and a summary is printed."""

EPILOG = """\
Exit codes: 0 done; 1 --check found a difference; 2 the site file or the request is wrong, with one line that says
what and what would be right. Then no file is touched.

Examples:
  tools/site sites/four_way.toml                                  check, print the stages
  tools/site sites/four_way.toml --c sites/four_way.c             make the C file
  tools/site sites/four_way.toml --c sites/four_way.c --check     is the C file up to date?"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    options = _parser().parse_args(arguments)
    try:
        return _run(options)
    except SiteError as error:
        _say(options.site, str(error))
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return EXIT_DONE
    except OSError as error:
        _say(error.filename or options.site, f"{error.strerror} ; a file that can be read or written")
    return EXIT_REFUSED


def load_site(path: Path) -> tuple[Junction, bytes]:
    """The checked junction of a site file, and the bytes it was read from."""
    source = path.read_bytes()
    junction = build_junction(read_document(source))
    check_junction(junction)
    return junction, source


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(
        prog="tools/site",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("site", metavar="SITE.toml", type=Path, help="the site file")
    parser.add_argument("--c", metavar="FILE.c", type=Path, help="write a C file with one constant elmopp_junction_t")
    parser.add_argument(
        "--image", metavar="FILE.bin", type=Path, help="write the same as an image with version and CRC-32"
    )
    parser.add_argument(
        "--check", action="store_true", help="write nothing; compare with the files named by --c and --image"
    )
    return parser


def _run(options: argparse.Namespace) -> int:
    junction, source = load_site(options.site)
    sha256 = hashlib.sha256(source).hexdigest()
    outputs: Outputs = {}
    if options.c is not None:
        outputs[options.c] = c_text(junction, options.site.name, sha256).encode("ascii")
    if options.image is not None:
        _check_distinct(options.image, outputs)
        outputs[options.image] = image_bytes(junction)
    if options.check:
        if not outputs:
            raise SiteError("--check has nothing to compare", "no --c, no --image", "name the file to compare")
        return compare("site", options.site, outputs)
    if not outputs:
        print(summary(junction), flush=True)
    for path in outputs:
        _check_distinct(path, [options.site])
        _check_replaceable(path)
    write(outputs)
    return EXIT_DONE


def summary(junction: Junction) -> str:
    """What the site is, for a person: counts, the stages by number, and what it promises."""
    counts = {
        "approaches": len(junction.approaches),
        "movements": len(junction.movements),
        "groups": len(junction.groups),
        "conflicting pairs": junction.conflict_count(),
        "stages": len(junction.stages),
    }
    name = f"{junction.name} (simulation only)" if junction.simulation_only else junction.name
    head = f"{name}: " + ", ".join(f"{what} {count}" for what, count in counts.items())
    stages = [f"stage {index}: {' '.join(junction.group_names(mask))}" for index, mask in enumerate(junction.stages)]
    return "\n".join([head, *stages, *_right_of_way(junction), *_promises(junction)])


def _right_of_way(junction: Junction) -> list[str]:
    """Who gives way to whom, and how many of a lane."""
    return [
        f"{movement.name} gives way to {' '.join(junction.movement_names(movement.gives_way))}: "
        f"{movement.gives_way_percent} % of its vehicles"
        for movement in junction.movements
        if movement.gives_way
    ]


def _promises(junction: Junction) -> list[str]:
    """The bound on red and how it is kept, and what each programme shows."""
    lines = []
    if junction.red_bound_ds:
        bounds = f"{seconds(junction.red_bound_ds)}, the shortest possible {seconds(junction.red_bound_min_ds())}"
        lines.append(
            f"bound on red: {bounds}, kept with stages {' '.join(map(str, sorted(set(junction.rescue_stages))))}"
        )
    for program in junction.programs:
        steps = ", ".join(f"stage {step.stage} {seconds(step.green_ds)}" for step in program.steps)
        lines.append(f"programme {program.name}: {steps}")
    return lines


def _say(path: Path | str, message: str) -> None:
    say("site", f"{path}: {message}")


def _check_distinct(path: Path, others: Outputs | list[Path]) -> None:
    if any(path.resolve() == other.resolve() for other in others):
        raise SiteError("two of the named files are the same", str(path), "a name for each")


def _check_replaceable(path: Path) -> None:
    reason = why_not_writable(path)
    if reason is not None:
        raise SiteError(reason[0], str(path), reason[1])


if __name__ == "__main__":
    raise SystemExit(main())
