# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The layers of the core: who may include whom, and what the finished library may ask of its surroundings."""

import argparse
import re
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import NoReturn

EXIT_KEPT = 0
EXIT_BROKEN = 1
EXIT_REFUSED = 2

ROOT = Path(__file__).resolve().parents[2]

LEVEL_0 = frozenset(
    {
        "assert",
        "bounds",
        "chooser",
        "dense",
        "elementary",
        "fault",
        "gaps",
        "image",
        "junction",
        "lamps",
        "lstm_kernel",
        "lstm_q15_kernel",
        "lstm_q15_table",
        "lstm_shape",
        "mode",
        "trainer_kernel",
    }
)

# The arithmetic behind the forecasts that learn, on level 1.
MODELS = frozenset({"ann_f32", "ar8", "gcn_f32", "lstm_f32", "lstm_q15"})

# Room: the rooms that it may know besides itself. A room that is not here may not exist.
ROOMS: dict[str, frozenset[str]] = {
    # level 0: nothing above
    "assert": frozenset(),
    "bounds": frozenset(),
    "dense": frozenset(),
    "elementary": frozenset(),
    "fault": frozenset(),
    "image": frozenset(),
    "mode": frozenset(),
    "junction": frozenset({"assert", "bounds"}),
    "lamps": frozenset({"bounds", "junction"}),
    "chooser": frozenset({"bounds", "junction"}),
    "lstm_shape": frozenset(),
    "lstm_kernel": frozenset({"elementary", "lstm_shape"}),
    "lstm_q15_table": frozenset(),
    "lstm_q15_kernel": frozenset({"lstm_q15_table", "lstm_shape"}),
    "trainer_kernel": frozenset({"elementary", "lstm_kernel", "lstm_shape"}),
    "gaps": frozenset({"elementary"}),
    # level 1: not each other
    "account": LEVEL_0,
    "age": LEVEL_0,
    "ann_f32": LEVEL_0,
    "ar8": LEVEL_0,
    "detector": LEVEL_0,
    "gcn_f32": LEVEL_0,
    "link": LEVEL_0,
    "lstm_f32": LEVEL_0,
    "lstm_q15": LEVEL_0,
    "monitor": LEVEL_0,
    "outflow": LEVEL_0,
    "plan": LEVEL_0,
    "sight": LEVEL_0,
    "site": LEVEL_0,
    "store": LEVEL_0,
    "timetable": LEVEL_0,
    "watch": LEVEL_0,
    # level 2: what is learnt, for all models
    "weights": LEVEL_0 | MODELS,
    "lstm_quantize": LEVEL_0 | {"lstm_f32", "lstm_q15"},
    # what changes it, and whether that was good
    "trainer": LEVEL_0 | {"lstm_f32"},
    "learner": LEVEL_0 | MODELS | {"trainer", "weights"},
    # who comes, and a model of what follows, for a chooser that plans ahead
    "coming": LEVEL_0 | {"account", "sight"},
    "future": LEVEL_0 | {"account", "coming", "sight"},
    "rollout": LEVEL_0 | {"account", "coming", "future", "sight"},
    # level 4, above the learner
    "forecast": LEVEL_0 | MODELS | {"account", "learner", "lstm_quantize", "outflow", "trainer", "weights"},
    # level 3: not each other; a chooser's forecast comes in the view
    "urgency": LEVEL_0 | {"age"},
    "pressure": LEVEL_0,
    "priced": LEVEL_0 | {"age"},
    # level 2: what goes over the bus, in the core's words
    "frames": LEVEL_0 | {"detector", "link", "outflow"},
    "transfer": LEVEL_0 | {"link"},
    # level 3: the bus as the controller hears it
    "bus": LEVEL_0 | {"detector", "frames", "link", "outflow"},
    # the other side of it, a device of its own
    "lamp_node": LEVEL_0 | {"detector", "frames", "link", "outflow"},
    # level 5: the inner seam
    "pilot": LEVEL_0
    | MODELS
    | {
        "account",
        "forecast",
        "learner",
        "lstm_quantize",
        "outflow",
        "plan",
        "pressure",
        "site",
        "trainer",
        "urgency",
        "weights",
    },
    # level 6: the outer seam
    "controller": LEVEL_0
    | MODELS
    | {
        "account",
        "bus",
        "detector",
        "forecast",
        "frames",
        "link",
        "lstm_quantize",
        "monitor",
        "outflow",
        "pilot",
        "plan",
        "site",
        "timetable",
        "watch",
        "weights",
    },
}
# what has come, is on trial and outlives a reset, beside the controller
ROOMS["keeper"] = ROOMS["controller"] | {"controller", "learner", "store", "trainer", "transfer"}
# level 7: a controller with everything that its site names
ROOMS["station"] = ROOMS["controller"] | {
    "coming",
    "controller",
    "future",
    "learner",
    "pressure",
    "priced",
    "rollout",
    "sight",
    "trainer",
    "urgency",
}

# The standard headers that need no library.
SYSTEM_HEADERS = frozenset({"assert.h", "stdbool.h", "stddef.h", "stdint.h", "string.h"})

# What a rival may include with quotes, beside the headers of its own folder but for those of the naming.
RIVALS_HEADERS = frozenset({"learning.hpp", "core.hpp", "elmopp/bounds.h", "elmopp/chooser.h", "elmopp/junction.h"})
# Who knows all rivals by name, and the headers of host_files that he may include for it.
NAMING = frozenset({"choosers", "making"})
NAMING_HEADERS = RIVALS_HEADERS | {"csv.hpp", "error.hpp"}

# What the library may leave to the port and the compiler: no heap, no output, no libm, no double-precision helper.
OUTSIDE_SYMBOLS = frozenset({"elmopp_assert_failed", "memcmp", "memcpy", "memmove", "memset"})

SOURCE_SUFFIXES = (".c", ".cpp", ".h", ".hpp")

# Stands for a line end behind a backslash while a source is read.
CONTINUED = "\v"

_COMMENT_OR_LITERAL = re.compile(r"//[^\n]*|/\*.*?\*/|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])*'", re.DOTALL)
_INCLUDE = re.compile(r"^[ \t\v]*(?:#|%:)[ \t\v]*(?:include|include_next|import)\b[ \t\v]*(.*?)[ \t\v]*$", re.MULTILINE)
# The codec that tools/can generates lies beside its definition, and only those who speak to the bus include it.
CODEC_HEADER = '"elmopp_can.h"'
CODEC_ROOMS = frozenset({"bus", "frames", "keeper", "lamp_node", "transfer"})

_CORE_HEADER = re.compile(r'"elmopp/(\w+)\.h"')
_SYMBOL = re.compile(r"(?P<member>.*): (?P<name>\S+) (?P<kind>\w)(?: |$)")

DESCRIPTION = """\
Checks that each room of the firmware includes only what its level lets it know, and, with --library, that the
finished core needs nothing from outside but memcpy, memset, memmove, memcmp and elmopp_assert_failed."""

EPILOG = """\
Exit codes: 0 all layers are kept; 1 some are broken, with one line for each; 2 the request cannot be run.

Examples:
  tools/layers                                                     the includes of this project
  tools/layers --library build/release/lib/libelmopp_core.a        ... and the symbols of a library"""


class RequestError(Exception):
    """The check cannot be run; the text says what is wrong and what would be right."""


@dataclass(frozen=True)
class Include:
    """One #include line: its number, and what is included, with its quotes or angle brackets."""

    line: int
    what: str


class _Parser(argparse.ArgumentParser):
    """An argument parser whose errors are one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(EXIT_REFUSED, f"layers: {message} ; see tools/layers --help\n")


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    options = _parser().parse_args(arguments)
    try:
        broken = list(broken_includes(options.root))
        if options.library is not None:
            broken += broken_symbols(options.library, options.nm)
    except (RequestError, OSError, UnicodeDecodeError) as error:
        print(f"layers: {error}", file=sys.stderr)
        return EXIT_REFUSED
    for line in broken:
        print(line, file=sys.stderr)
    return EXIT_BROKEN if broken else EXIT_KEPT


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="tools/layers",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--root", type=Path, default=ROOT, help="folder with firmware/ and host_sim/ (this project)")
    parser.add_argument("--library", type=Path, metavar="FILE", help="also check the symbols of this archive")
    parser.add_argument("--nm", default="nm", help="program that lists symbols, of the library's tool chain (nm)")
    return parser


def broken_includes(root: Path) -> Iterator[str]:
    """One line for each file or include under root that the levels forbid."""
    headers = _sources(root / "firmware" / "include" / "elmopp")
    sources = _sources(root / "firmware" / "src")
    if not headers or not sources:
        raise RequestError(f"{root} has no firmware/include/elmopp and firmware/src; name the project's folder")
    for path in headers + sources:
        name = str(path.relative_to(root))
        if path.stem in ROOMS:
            yield from _broken_in_file(path, name, partial(_why_not_in_room, path.stem))
        else:
            yield f"{name}: room {path.stem} has no level; right would be a row in ROOMS of elmopp_tools/layers.py"
    yield from _broken_in_choosers(root)


def _broken_in_choosers(root: Path) -> Iterator[str]:
    """A rival knows the chooser's view, not the simulator that calls it."""
    folder = root / "choosers"
    own = frozenset(path.name for path in _sources(folder) if path.suffix == ".hpp")
    names = frozenset(f"{stem}.hpp" for stem in NAMING)
    for path in _sources(folder):
        allowed = own | NAMING_HEADERS if path.stem in NAMING else (own - names) | RIVALS_HEADERS
        yield from _broken_in_file(path, str(path.relative_to(root)), partial(_why_not_in_rival, allowed))


def _sources(folder: Path) -> list[Path]:
    return sorted(path for path in folder.rglob("*") if path.suffix in SOURCE_SUFFIXES)


def _broken_in_file(path: Path, name: str, why_not: Callable[[str], str | None]) -> Iterator[str]:
    for include in includes(path.read_text(encoding="utf-8")):
        reason = why_not(include.what)
        if reason is not None:
            yield f"{name}:{include.line}: #include {include.what}: {reason}"


def includes(text: str) -> list[Include]:
    """The #include lines of a source; those in comments do not count."""
    code = _COMMENT_OR_LITERAL.sub(_without_comment, text.replace("\\\n", CONTINUED))
    return [Include(_lines(code[: found.start(1)]) + 1, found[1]) for found in _INCLUDE.finditer(code)]


def _without_comment(found: re.Match[str]) -> str:
    """A comment becomes a space and its line ends. A literal stays, so that a // inside of it is none."""
    if not found[0].startswith("/"):
        return found[0]
    return " " + "".join(character for character in found[0] if character in ("\n", CONTINUED))


def _lines(code: str) -> int:
    return code.count("\n") + code.count(CONTINUED)


def _why_not_in_room(room: str, what: str) -> str | None:
    """Why a room must not include this; None if it may."""
    if what.startswith("<") and what.endswith(">"):
        if what[1:-1] in SYSTEM_HEADERS:
            return None
        return f"the core includes only {', '.join(sorted(SYSTEM_HEADERS))} of the system"
    if what == CODEC_HEADER:
        return None if room in CODEC_ROOMS else f"only {', '.join(sorted(CODEC_ROOMS))} speak to the bus"
    header = _CORE_HEADER.fullmatch(what)
    if header is None:
        return 'the core includes only <system> headers and "elmopp/room.h"'
    if header[1] == room or header[1] in ROOMS[room]:
        return None
    return f"{room} may know {', '.join(sorted(ROOMS[room])) or 'no other room'}"


def _why_not_in_rival(allowed: frozenset[str], what: str) -> str | None:
    """Why a rival must not include this; None if it may. The C++ library is free."""
    if what.startswith("<") and what.endswith(">") and "elmopp" not in what:
        return None
    if what.startswith('"') and what.strip('"') in allowed:
        return None
    return f"a rival may know {', '.join(sorted(allowed))}"


def broken_symbols(library: Path, nm: str) -> Iterator[str]:
    """One line for each symbol that a member of the library needs from outside and must not."""
    symbols = _symbols(library, nm)
    own = {name for _, kind, name in symbols if not _is_undefined(kind)}
    for member, kind, name in symbols:
        if _is_undefined(kind) and name not in own and name not in OUTSIDE_SYMBOLS:
            yield f"{member}: needs {name}; right would be at most {', '.join(sorted(OUTSIDE_SYMBOLS))}"


def _is_undefined(kind: str) -> bool:
    """Undefined, or weak and undefined."""
    return kind in ("U", "w", "v")


def _symbols(library: Path, nm: str) -> list[tuple[str, str, str]]:
    """Member, kind and name of each external symbol."""
    command = [nm, "-A", "-P", "-g", str(library)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RequestError(f"{' '.join(command)} failed: {done.stderr.strip()}")
    matches = [_SYMBOL.match(line) for line in done.stdout.splitlines()]
    found = [(match["member"], match["kind"], match["name"]) for match in matches if match is not None]
    if not found or len(found) != len(matches):
        raise RequestError(f"{' '.join(command)} printed no list of symbols; name an archive that is not stripped")
    return found
