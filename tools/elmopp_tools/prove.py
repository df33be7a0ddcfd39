# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The command behind tools/prove: hands the harnesses of tests/proof to the model checker CBMC.

tests/proof/proofs.json says of each claim the largest loop bound ("loops" those that differ), the sources that it may
use, and one planted bug (file, text, replacement) that must refute it. "replace" puts functions of the harness in the
place of the core's; "parts" says how many proofs a claim is made of, each with its own PART. With --planted the bug is
put into a copy of the sources; the end of the harness must be reachable, too, or the proof would say nothing.
"""

import argparse
import json
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from elmopp_tools.outputs import EXIT_DIFFERENT, EXIT_DONE, EXIT_REFUSED, OneLineParser, say

ROOT = Path(__file__).resolve().parents[2]
PROOFS = ROOT / "tests" / "proof"
CBMC = ROOT / "build" / "cbmc" / "bin" / "cbmc"
EXIT_SKIPPED = 77
LIMIT_S = 1200  # each step of each part
VERDICTS = {0: "proved", 10: "refuted"}

DESCRIPTION = "Proves the claims of tests/proof, all or those named, and prints one line for each."
EPILOG = """\
Exit codes: 0 all as they should be; 1 one is not, or took too long; 2 the request cannot be run; 77 CBMC is not there
(tools/setup check fetches it).

Examples:
  tools/prove                                       all claims
  tools/prove plan_never_trips_monitor --planted    ... whether its planted bug refutes it and its end is reached"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = OneLineParser(
        prog="tools/prove",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help="claims (all)")
    parser.add_argument("--planted", action="store_true", help="try the planted bugs instead, and the harness's end")
    options = parser.parse_args(arguments)
    proofs: dict[str, dict[str, Any]] = json.loads((PROOFS / "proofs.json").read_text(encoding="utf-8"))
    for name in options.names:
        if name not in proofs:
            say("prove", f'"{name}" is no claim ; right would be one of {", ".join(proofs)}')
            return EXIT_REFUSED
    if not CBMC.exists():
        say("prove", f"{CBMC.relative_to(ROOT)} is missing ; run ./tools/setup check")
        return EXIT_SKIPPED
    good = True
    for name in options.names or list(proofs):
        if options.planted:
            good = planted(name, proofs[name]) and good
        else:
            good = judge(name, proofs[name], ROOT / "firmware" / "src", "proved", []) and good
    return EXIT_DONE if good else EXIT_DIFFERENT


def planted(name: str, proof: dict[str, Any]) -> bool:
    """Both ways in which a proof must fail."""
    found = refutes(name, proof, *proof["planted"])
    return judge(name, proof, ROOT / "firmware" / "src", "refuted", ["-DVACUITY"]) and found


def refutes(name: str, proof: dict[str, Any], file: str, text: str, bug: str) -> bool:
    """Whether the proof finds a bug put into a copy of the sources."""
    with tempfile.TemporaryDirectory() as folder:
        sources = Path(folder) / "src"
        shutil.copytree(ROOT / "firmware" / "src", sources)
        code = (sources / file).read_text(encoding="utf-8")
        if code.count(text) != 1:
            say("prove", f"{name}: the planted bug's text is {code.count(text)} times in {file} ; right would be once")
            return False
        (sources / file).write_text(code.replace(text, bug), encoding="utf-8")
        return judge(name, proof, sources, "refuted", [])


def judge(name: str, proof: dict[str, Any], sources: Path, wanted: str, options: list[str]) -> bool:
    """Runs CBMC, once for each part, and says in a line what came of it."""
    started = time.monotonic()
    verdicts = []
    complaints = []
    with tempfile.TemporaryDirectory() as folder:
        for part in range(proof.get("parts", 1)):
            verdict, complaint = run_part(name, proof, sources, [f"-DPART={part}", *options], Path(folder))
            verdicts.append(verdict)
            complaints += complaint
            if verdict != "proved" and not options:
                break
    seconds = time.monotonic() - started
    # One part is enough to find a bug; the end of every part must be reachable.
    said = max(verdicts, key=verdicts.count) if options else verdicts[-1]
    if options and len(set(verdicts)) > 1:
        said = "mixed"
    kind = "vacuity" if options else ("planted" if wanted == "refuted" else "claim")
    print(f"{said:<8} {name:<36} {kind:<8} {seconds:6.1f} s", flush=True)
    if said != wanted:
        print("\n".join(complaints), file=sys.stderr)
    return said == wanted


def run_part(
    name: str, proof: dict[str, Any], sources: Path, options: list[str], folder: Path
) -> tuple[str, list[str]]:
    """The verdict on one part, and what was said against it."""
    checks = ["--unwind", str(proof["bound"] + 1), "--conversion-check", "--drop-unused-functions", "--verbosity", "4"]
    if "loops" in proof:
        checks += ["--unwindset", ",".join(f"{loop}:{bound + 1}" for loop, bound in proof["loops"].items())]
    texts = [str(PROOFS / f"prove_{name}.c"), *(str(sources / f"{room}.c") for room in proof["sources"])]
    headers = (ROOT / "firmware" / "include", ROOT / "firmware" / "can", sources)
    includes = [word for folder in headers for word in ("-I", str(folder))]
    replaced = [word for pair in proof.get("replace", {}).items() for word in ("--replace-calls", ":".join(pair))]
    program, changed = str(folder / "harness.gb"), str(folder / "replaced.gb")
    steps = [
        [str(CBMC.with_name("goto-cc")), "--function", "harness", *includes, *options, *texts, "-o", program],
        [str(CBMC.with_name("goto-instrument")), *replaced, program, changed],
        [str(CBMC), *checks, changed],
    ]
    try:
        for step in steps:
            done = subprocess.run(step, capture_output=True, text=True, check=False, timeout=LIMIT_S)
            if done.returncode != 0:
                break
    except subprocess.TimeoutExpired:
        return "time-out", []
    said = VERDICTS.get(done.returncode, f"error {done.returncode}")
    failures = [line for line in done.stdout.splitlines() if "FAILURE" in line]
    return said, failures or done.stderr.splitlines()
