# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""What the generators of checked-in files share: all files or none, comparing instead of writing, one-line errors."""

import argparse
import os
import sys
from pathlib import Path
from typing import NoReturn

EXIT_DONE = 0
EXIT_DIFFERENT = 1
EXIT_REFUSED = 2

Outputs = dict[Path, bytes]


class OneLineParser(argparse.ArgumentParser):
    """An argument parser whose errors are one line, like all others of our tools. `prog` is tools/NAME."""

    def error(self, message: str) -> NoReturn:
        name = Path(self.prog).name
        self.exit(EXIT_REFUSED, f"{name}: {message} ; see {self.prog} --help\n")


def say(tool: str, message: str) -> None:
    """One line on stderr, whatever the message holds."""
    print(" ".join(f"{tool}: {message}".split()), file=sys.stderr)


def why(error: Exception) -> str:
    """What went wrong, without the number of an OSError and the file that the message names already."""
    return (error.strerror if isinstance(error, OSError) else None) or str(error)


def why_not_writable(path: Path) -> tuple[str, str] | None:
    """What is wrong with an output and what would be right. A rename would replace a device or a folder by a file."""
    if path.exists() and not path.is_file():
        return "the output is no regular file", "a file name"
    if not path.parent.is_dir():
        return "the folder of the output does not exist", "a folder that exists"
    return None


def write(outputs: Outputs) -> None:
    """Writes all files beside their places, then renames: a reader sees the old or the new, never a part."""
    drafts: dict[Path, Path] = {}
    try:
        for path, content in outputs.items():
            drafts[path] = path.with_name(f".{path.name}.{os.getpid()}.tmp")
            drafts[path].write_bytes(content)
        for path, draft in drafts.items():
            draft.replace(path)
    finally:
        for draft in drafts.values():
            draft.unlink(missing_ok=True)


def compare(tool: str, source: Path, outputs: Outputs) -> int:
    """Holds freshly made bytes against the files that are there; says the first that differs."""
    for path, content in outputs.items():
        if not path.exists():
            say(tool, f"{path}: is missing ; make it with tools/{tool} {source}")
            return EXIT_DIFFERENT
        if path.read_bytes() != content:
            say(tool, f"{path}: differs from what {source} makes ; make it again with tools/{tool} {source}")
            return EXIT_DIFFERENT
    return EXIT_DONE
