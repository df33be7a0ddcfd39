# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""tools/mutate and tools/coverage: what they change and what they refuse."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from elmopp_tools import coverage
from elmopp_tools.mutants import mutants_of
from elmopp_tools.mutate import main as mutate

CODE = """\
#include "x<y.h"
/* a < b */
uint32_t f(const uint8_t *p, uint32_t n) {
    uint32_t sum = 0U;
    if (!is_new(&p[n]) && (n < 3U)) {
        sum = (uint32_t)*p;
    }
    return sum - 1U;
}
"""


def changes_of(tmp_path: Path, code: str) -> dict[str, str]:
    source = tmp_path / "firmware" / "src" / "room.c"
    source.parent.mkdir(parents=True)
    source.write_text(code, encoding="utf-8")
    return {mutant.key.removeprefix("room: "): mutant.text for mutant in mutants_of(tmp_path, "room")}


def test_every_token_and_statement_is_changed_once_and_comments_are_not(tmp_path: Path) -> None:
    changes = changes_of(tmp_path, CODE)
    assert set(changes) == {
        "uint32_t sum = 0U; : 0U -> 1U",
        "if (!is_new(&p[n]) && (n < 3U)) { : ! -> nothing",
        "if (!is_new(&p[n]) && (n < 3U)) { : && -> ||",
        "if (!is_new(&p[n]) && (n < 3U)) { : < -> <=",
        "if (!is_new(&p[n]) && (n < 3U)) { : < -> >=",
        "if (!is_new(&p[n]) && (n < 3U)) { : 3U -> 4U",
        "if (!is_new(&p[n]) && (n < 3U)) { : 3U -> 2U",
        "sum = (uint32_t)*p; : dropped",
        "return sum - 1U; : - -> +",
        "return sum - 1U; : 1U -> 2U",
        "return sum - 1U; : 1U -> 0U",
    }


def test_a_change_changes_nothing_else(tmp_path: Path) -> None:
    changes = changes_of(tmp_path, CODE)
    assert changes["return sum - 1U; : - -> +"] == CODE.replace("sum - 1U", "sum + 1U")
    assert changes["sum = (uint32_t)*p; : dropped"] == CODE.replace("sum = (uint32_t)*p;", ";")


def test_equal_changes_have_different_keys(tmp_path: Path) -> None:
    assert set(changes_of(tmp_path, "a = 1U;\na = 1U;\n")) >= {"a = 1U; : 1U -> 2U", "a = 1U; : 1U -> 2U (2)"}


def test_an_unknown_room_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert mutate(["pilot"]) == 2
    assert '"pilot" is no room that is mutated ; right would be one of monitor, plan, link' in capsys.readouterr().err


def summary(lines: int, branches: int, conditions: int) -> dict[str, dict[str, int]]:
    counts = zip(coverage.KINDS, (lines, branches, conditions), strict=True)
    return {kind: {"count": 100, "covered": covered} for kind, covered in counts}


def test_a_safety_room_needs_all_of_everything_and_any_other_most_of_its_lines() -> None:
    found = {"plan": summary(100, 100, 99), "pilot": summary(95, 0, 0), "weights": summary(94, 100, 100)}
    assert coverage.judge(["pilot", "plan", "weights"], found) == [
        "plan.c: mcdc 99.0 % ; right would be at least 100 %",
        "weights.c: lines 94.0 % ; right would be at least 95 %",
    ]


def test_a_room_that_the_report_lacks_and_a_report_without_conditions_are_refused() -> None:
    nothing = {"plan": {kind: {"count": 0, "covered": 0} for kind in coverage.KINDS}}
    assert coverage.judge(["plan", "site"], nothing) == [
        "no condition was counted ; right would be a build with -fcoverage-mcdc",
        "site.c is not in the report ; right would be a test that links it",
    ]


def test_a_room_of_data_alone_has_nothing_to_cover() -> None:
    assert not coverage.has_functions("/* f(x) { */\nconst int t[2] = {\n    1, 2};\n// g() {\n")
    assert coverage.has_functions("static int f(void) {\n    return 1;\n}\n")
    bare = {file.stem for file in coverage.ROOMS.glob("*.c") if not coverage.has_functions(file.read_text())}
    assert bare == {"lstm_q15_table"}


def test_docs_safety_names_every_proof_that_there_is_and_no_other() -> None:
    root = Path(__file__).resolve().parents[2]
    proofs = json.loads((root / "tests" / "proof" / "proofs.json").read_text(encoding="utf-8"))
    section = (root / "docs" / "safety.md").read_text(encoding="utf-8").split("\n## Proofs\n")[1].split("\n## ")[0]
    named = {name: bool(star) for name, star in re.findall(r"^\| `(\w+)`( \*)?[,:]? ?", section, flags=re.MULTILINE)}
    assert named == {name: proof.get("nightly", False) for name, proof in proofs.items()}
