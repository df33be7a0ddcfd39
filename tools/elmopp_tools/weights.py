# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The command behind tools/weights: reads trained weights, checks them, writes them as C or as images, or compares."""

import argparse
import hashlib
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
from elmopp_tools.weights_c import c_text, h_text
from elmopp_tools.weights_image import image_bytes
from elmopp_tools.weights_model import NETWORKS, WeightsError, network, read_tensors

DESCRIPTION = """\
Reads trained weights (weights/forecast.safetensors, made by tools/train), checks names, shapes and values, and turns
them into what the firmware loads. Without --c and --image-* nothing is written: the file is checked."""

EPILOG = """\
Exit codes: 0 done; 1 --check found a difference; 2 the file or the request is wrong, with one line that says what
and what would be right. Then no file is touched.

Examples:
  tools/weights weights/forecast.safetensors                                     check
  tools/weights weights/forecast.safetensors --c weights/elmopp_weights.c        make the C file and its header
  tools/weights weights/forecast.safetensors --c weights/elmopp_weights.c --check
  tools/weights weights/forecast.safetensors --image-lstm lstm.elmw              for host_sim run --weights"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    options = _parser().parse_args(arguments)
    try:
        return _run(options)
    except WeightsError as error:
        say("weights", f"{options.source}: {error}")
    except OSError as error:
        say("weights", f"{error.filename or options.source}: {error.strerror} ; a file that can be read or written")
    return EXIT_REFUSED


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(
        prog="tools/weights",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("source", metavar="FILE.safetensors", type=Path, help="the trained weights")
    parser.add_argument("--c", metavar="FILE.c", type=Path, help="write a C file, and a header of the same name")
    for name, levels in NETWORKS.items():
        what = f"write an ELMW image: the network of {levels} level{'s' if levels > 1 else ''}, and ann and gcn"
        parser.add_argument(f"--image-{name}", metavar="FILE", type=Path, help=what)
    parser.add_argument("--check", action="store_true", help="write nothing; compare with the files named")
    return parser


def _run(options: argparse.Namespace) -> int:
    tensors, source = read_tensors(options.source)
    networks = {name: network(tensors, name) for name in NETWORKS}
    wanted: list[tuple[Path, bytes]] = []
    if options.c is not None:
        header = options.c.with_suffix(".h")
        origin = (options.source.name, hashlib.sha256(source).hexdigest())
        wanted.append((header, h_text(list(networks.values()), *origin).encode("ascii")))
        wanted.append((options.c, c_text(list(networks.values()), header.name, *origin).encode("ascii")))
    for name in NETWORKS:
        path = getattr(options, f"image_{name}")
        if path is not None:
            wanted.append((path, image_bytes(networks[name])))
    _check_paths(options.source, [path for path, _ in wanted])
    outputs: Outputs = dict(wanted)
    if options.check:
        if not outputs:
            raise WeightsError("--check has nothing to compare", "name the file to compare with --c or --image-*")
        return compare("weights", options.source, outputs)
    write(outputs)
    return EXIT_DONE


def _check_paths(source: Path, outputs: list[Path]) -> None:
    places = [path.resolve() for path in [source, *outputs]]
    for path, place in zip(outputs, places[1:], strict=True):
        if places.count(place) > 1:
            raise WeightsError(f"two of the named files are {path}", "a name for each")
        reason = why_not_writable(path)
        if reason is not None:
            raise WeightsError(f"{reason[0]} ({path})", reason[1])
