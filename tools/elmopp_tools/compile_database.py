# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""How the preset host compiles each source file by itself: configured in build/lint for tools, never built."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "build" / "lint"


class CompileDatabaseError(Exception):
    """CMake refused; the text is what it said."""


def compile_database() -> dict[Path, str]:
    """The command for each source file. Beside it FOLDER holds compile_commands.json itself."""
    command = ["cmake", "--preset", "host", "-B", str(FOLDER), "-DELMOPP_MERGE_SOURCES=OFF"]
    try:
        done = subprocess.run(
            command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False
        )
    except OSError as error:
        raise CompileDatabaseError(f"cannot run cmake: {error.strerror}") from error
    if done.returncode != 0:
        raise CompileDatabaseError(f"{' '.join(command)} failed: {done.stdout}")
    entries = json.loads((FOLDER / "compile_commands.json").read_text(encoding="utf-8"))
    return {Path(entry["file"]): entry["command"] for entry in entries}
