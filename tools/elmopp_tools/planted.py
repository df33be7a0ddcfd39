# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The command behind tools/planted: one bug for each safety rule, and every kind of evidence that finds it.

tests/mutation/planted.json says of each bug the rule that it breaks, a file, a text, its replacement, and the proof
that is refuted by it, if there is one. Two kinds must find it: a single mistake in a test must not hide it. A proof
that is named counts here; that it is refuted is shown with --proofs, which takes minutes.
"""

import argparse
import json
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from elmopp_tools import prove
from elmopp_tools.mutants import Mutant
from elmopp_tools.mutate import JOBS, ROOT, MutateError, Workshop
from elmopp_tools.outputs import EXIT_DIFFERENT, EXIT_DONE, EXIT_REFUSED, OneLineParser, say

PLANTED = ROOT / "tests" / "mutation" / "planted.json"
KINDS_WANTED = 2
# What a judge is evidence of.
KINDS = {
    "test_monitor": "unit",
    "test_plan": "unit",
    "test_plan_waiting": "unit",
    "test_link": "unit",
    "test_detector": "unit",
    "test_mode": "unit",
    "test_site": "unit",
    "test_controller": "whole controller",
    "test_plan_exhaustive": "exhaustive",
    "test_plan_property": "property",
    "test_safety": "hostile",
    "test_controller_faults": "faults",
    "test_site_image": "exhaustive",
}


DESCRIPTION = "Puts one bug for each safety rule into the core, and prints which evidence finds it."
EPILOG = """\
Exit codes: 0 each is found by two kinds at least; 1 one is not; 2 the request cannot be run.

Examples:
  tools/planted             the tests alone
  tools/planted --proofs    ... and the proofs that are named"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = OneLineParser(
        prog="tools/planted",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--proofs", action="store_true", help="let the proofs that are named try, too")
    options = parser.parse_args(arguments)
    try:
        return judge_planted(options.proofs)
    except MutateError as error:
        say("planted", str(error))
        return EXIT_REFUSED


def judge_planted(proofs: bool) -> int:
    """Prints a row of a table for each bug; returns an exit code."""
    bugs: list[dict[str, str]] = json.loads(PLANTED.read_text(encoding="utf-8"))
    claims: dict[str, dict[str, Any]] = json.loads(prove.PROOFS.joinpath("proofs.json").read_text(encoding="utf-8"))
    bad = False
    with tempfile.TemporaryDirectory() as folder:
        workshop = Workshop(Path(folder))
        workshop.prepare({Path(bug["file"]).stem: tuple(KINDS) for bug in bugs})
        with ThreadPoolExecutor(JOBS) as pool:
            found = list(pool.map(lambda bug: finders(workshop, bug), bugs))
    print("| rule | file | bug | found by | proof |\n|---|---|---|---|---|")
    for bug, names in zip(bugs, found, strict=True):
        proof = bug.get("proof")
        kinds = {KINDS[name] for name in names} | ({"proof"} if proof else set())
        said = ", ".join(f"`{name}`" for name in names)
        print(f"| {bug['rule']} | `{bug['file']}` | `{bug['bug']}` | {said} | {f'`{proof}`' if proof else '-'} |")
        if len(kinds) < KINDS_WANTED:
            say("planted", f'"{bug["rule"]}" is found by {sorted(kinds)} ; right would be two kinds of evidence')
            bad = True
        if (
            proofs
            and proof is not None
            and not prove.refutes(proof, claims[proof], bug["file"], bug["text"], bug["bug"])
        ):
            bad = True
    return EXIT_DIFFERENT if bad else EXIT_DONE


def finders(workshop: Workshop, bug: dict[str, str]) -> Sequence[str]:
    """The judges that fail."""
    text = (ROOT / "firmware" / "src" / bug["file"]).read_text(encoding="utf-8")
    if text.count(bug["text"]) != 1:
        raise MutateError(f"{bug['text']} is {text.count(bug['text'])} times in {bug['file']} ; right would be once")
    mutant = Mutant(Path(bug["file"]).stem, bug["rule"], 0, text.replace(bug["text"], bug["bug"]))
    return workshop.failing(mutant, tuple(KINDS))
