# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""Takes a program of tools/ into the Python environment it needs.

A program calls enter("base") before it imports numpy and its like. It never installs anything: tools/setup does.
"""

from __future__ import annotations

import importlib
import importlib.util
import os
import sys
from pathlib import Path

_TOOLS = Path(__file__).resolve().parents[1]

# The modules that each environment is there for; an interpreter that has them all will do in its place.
_MODULES = {
    "base": ("jsonschema", "matplotlib", "numpy", "safetensors", "scipy"),
    "check": ("cantools", "jsonschema", "matplotlib", "mypy", "numpy", "pytest", "safetensors", "scipy"),
    "train": ("jax", "numpy", "optax", "safetensors", "scipy"),
    "bench": ("numpy", "onnx", "onnxruntime", "safetensors"),
    "sumo": ("libsumo", "sumolib"),
}


def enter(name: str) -> None:
    """Returns inside an interpreter that can import the modules of build/venv/<name>.

    Where that environment exists, this runs the program again with its Python. Without it, as in an installed copy,
    the present interpreter goes on if it has the modules; otherwise the program ends with 2 and one line that says
    what to do.
    """
    folder = _TOOLS.parent / "build" / "venv" / name
    python = folder / "bin" / "python"
    # Only a finished environment has this file, see tools/setup.
    if (folder / "made-from").exists() and python.exists():
        if not os.path.samefile(sys.prefix, folder):
            sys.stdout.flush()
            os.execv(python, [str(python), *sys.orig_argv[1:]])
        return
    missing = [module for module in _MODULES[name] if importlib.util.find_spec(module) is None]
    if missing:
        print(f"{Path(sys.argv[0]).name}: this Python has no {', '.join(missing)}; {_remedy(name)}", file=sys.stderr)
        sys.exit(2)


def must_load(name: str) -> None:
    """Ends the program with 2 and one line where a module of an environment is there but cannot be loaded."""
    try:
        for module in _MODULES[name]:
            importlib.import_module(module)
    except ImportError as error:
        print(f"{Path(sys.argv[0]).name}: cannot load {error.name}: {error}; {_remedy(name)}", file=sys.stderr)
        sys.exit(2)


def _remedy(name: str) -> str:
    if (_TOOLS / "setup").exists():
        return f"run ./tools/setup {name}"
    return f"run python3 -m pip install --require-hashes -r {_TOOLS / 'requirements' / name}.txt"
