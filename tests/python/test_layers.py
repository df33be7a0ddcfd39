# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""tools/layers: the project keeps its levels, and every way to break them is found."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from elmopp_tools.layers import LEVEL_0, ROOMS, includes, main

ROOT = Path(__file__).resolve().parents[2]

# The levels of the design, written down a second time.
LEVELS = {
    "assert": 0,
    "bounds": 0,
    "junction": 0,
    "elementary": 0,
    "image": 0,
    "chooser": 0,
    "fault": 0,
    "lamps": 0,
    "mode": 0,
    "lstm_shape": 0,
    "dense": 0,
    "lstm_kernel": 0,
    "lstm_q15_table": 0,
    "lstm_q15_kernel": 0,
    "trainer_kernel": 0,
    "gaps": 0,
    "account": 1,
    "age": 1,
    "ann_f32": 1,
    "ar8": 1,
    "detector": 1,
    "monitor": 1,
    "outflow": 1,
    "timetable": 1,
    "watch": 1,
    "gcn_f32": 1,
    "lstm_f32": 1,
    "lstm_q15": 1,
    "plan": 1,
    "sight": 1,
    "site": 1,
    "store": 1,
    "weights": 2,
    "lstm_quantize": 2,
    "trainer": 2,
    "learner": 3,
    "forecast": 4,
    "urgency": 3,
    "pressure": 3,
    "priced": 3,
    "coming": 2,
    "future": 3,
    "rollout": 4,
    "link": 1,
    "frames": 2,
    "bus": 3,
    "transfer": 2,
    "pilot": 5,
    "controller": 6,
    "lamp_node": 3,
    "station": 7,
    "keeper": 7,
}


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A small project that keeps all layers."""
    write(tmp_path, "firmware/include/elmopp/bounds.h", "#define ELMOPP_GROUP_MAX 16U\n")
    write(tmp_path, "firmware/include/elmopp/junction.h", '#include "elmopp/bounds.h"\n\n#include <stdint.h>\n')
    write(tmp_path, "firmware/include/elmopp/plan.h", '#include "elmopp/junction.h"\n')
    write(tmp_path, "firmware/src/plan.c", '#include "elmopp/plan.h"\n\n#include "elmopp/assert.h"\n')
    write(tmp_path, "choosers/view.hpp", '#include "core.hpp"\n')
    write(tmp_path, "choosers/rounds.hpp", '#include "view.hpp"\n#include <deque>\n')
    write(tmp_path, "choosers/choosers.hpp", '#include "rounds.hpp"\n#include "csv.hpp"\n')
    write(tmp_path, "host_sim/main.cpp", '#include "elmopp/plan.h"\n#include "whatever.hpp"\n')
    return tmp_path


def write(root: Path, name: str, text: str) -> None:
    path = root / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def check(root: Path, *options: str) -> int:
    return main(["--root", str(root), *options])


def expect_broken(root: Path, capsys: pytest.CaptureFixture[str], *parts: str) -> None:
    assert check(root) == 1
    output = capsys.readouterr().err
    assert output.count("\n") == 1, output
    for part in parts:
        assert part in output


def test_the_project_keeps_its_layers() -> None:
    assert check(ROOT) == 0


def test_the_made_up_tree_keeps_its_layers(tree: Path) -> None:
    assert check(tree) == 0


def test_no_room_knows_a_higher_level_or_another_of_its_own() -> None:
    assert set(ROOMS) == set(LEVELS)
    for room, known in ROOMS.items():
        for other in known:
            lower = LEVELS[other] < LEVELS[room]
            assert lower or LEVELS[other] == LEVELS[room] == 0, f"{room} knows {other}"


def test_plan_site_and_the_choosers_know_level_0_only() -> None:
    for room in ("plan", "site", "sight", "account", "ann_f32", "ar8", "gcn_f32", "lstm_f32", "age", "outflow"):
        assert ROOMS[room] == LEVEL_0


@pytest.mark.parametrize("room", sorted(ROOMS))
@pytest.mark.parametrize("other", sorted(ROOMS))
def test_each_pair_of_rooms_is_judged_by_the_table(
    tree: Path, capsys: pytest.CaptureFixture[str], room: str, other: str
) -> None:
    write(tree, f"firmware/src/{room}.c", f'/* one */\n#include "elmopp/{other}.h"\n')
    if room == other or other in ROOMS[room]:
        assert check(tree) == 0
    else:
        expect_broken(tree, capsys, f"firmware/src/{room}.c:2: ", f'"elmopp/{other}.h"', f"{room} may know")


def test_headers_are_judged_too(tree: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write(tree, "firmware/include/elmopp/plan.h", '#include "elmopp/site.h"\n')
    expect_broken(tree, capsys, "firmware/include/elmopp/plan.h:1: ", '"elmopp/site.h"')


@pytest.mark.parametrize("header", ["stdlib.h", "stdio.h", "math.h", "time.h", "elmopp/junction.h"])
def test_the_core_includes_no_other_system_header(tree: Path, capsys: pytest.CaptureFixture[str], header: str) -> None:
    write(tree, "firmware/src/plan.c", f"\n\n#include <{header}>\n")
    expect_broken(tree, capsys, f"firmware/src/plan.c:3: #include <{header}>")


@pytest.mark.parametrize("header", ["stdint.h", "stdbool.h", "stddef.h", "string.h", "assert.h"])
def test_the_core_may_include_a_free_standing_header(tree: Path, header: str) -> None:
    write(tree, "firmware/src/plan.c", f"#include <{header}>\n")
    assert check(tree) == 0


@pytest.mark.parametrize(
    "what", ['"plan.h"', '"../plan.h"', '"elmopp/../x.h"', '"elmopp/elmopp_weights.h"', "HEADER", ""]
)
def test_the_core_includes_nothing_else(tree: Path, capsys: pytest.CaptureFixture[str], what: str) -> None:
    write(tree, "firmware/src/plan.c", f"#include {what}\n")
    expect_broken(tree, capsys, "firmware/src/plan.c:1: #include")


@pytest.mark.parametrize(
    "line",
    [
        '  #  include "elmopp/site.h"',
        '#include"elmopp/site.h"',
        '%:include "elmopp/site.h"',
        '#include_next "elmopp/site.h"',
        '#import "elmopp/site.h"',
        '#include /* why not */ "elmopp/site.h" // here',
        '#include \\\n"elmopp/site.h"',
        'char quote = \'"\'; /*\n*/ #\n#include "elmopp/site.h"',
    ],
)
def test_an_include_is_found_however_it_is_written(tree: Path, capsys: pytest.CaptureFixture[str], line: str) -> None:
    write(tree, "firmware/src/plan.c", f"{line}\n")
    expect_broken(tree, capsys, "firmware/src/plan.c:", '"elmopp/site.h"')


@pytest.mark.parametrize(
    "line", ['// #include "elmopp/site.h"', '/*\n#include "elmopp/site.h"\n*/', "// a\\\n#include <x>"]
)
def test_a_comment_includes_nothing(tree: Path, line: str) -> None:
    write(tree, "firmware/src/plan.c", f"{line}\n")
    assert check(tree) == 0


def test_lines_are_counted_through_comments() -> None:
    found = includes('/* a\n b */ // c "\n#include <x.h>\n"//"\n\n#include "y.h"\n\\\n// \\\n\n#include <z.h>\n')
    assert [(include.line, include.what) for include in found] == [(3, "<x.h>"), (6, '"y.h"'), (10, "<z.h>")]


@pytest.mark.parametrize("name", ["firmware/src/util.c", "firmware/include/elmopp/common.h", "firmware/src/deep/log.c"])
def test_a_room_without_a_level_is_found(tree: Path, capsys: pytest.CaptureFixture[str], name: str) -> None:
    write(tree, name, "\n")
    expect_broken(tree, capsys, name, "has no level")


@pytest.mark.parametrize(
    "what",
    [
        *['"elmopp/plan.h"', '"elmopp/pilot.h"', '"traffic.hpp"', "<elmopp/plan.h>", '"../host_sim/trial.hpp"'],
        *['"scenario.hpp"', '"csv.hpp"', '"choosers.hpp"'],
    ],
)
def test_a_rival_knows_the_choosers_view_only(tree: Path, capsys: pytest.CaptureFixture[str], what: str) -> None:
    write(tree, "choosers/rounds.cpp", f'#include "rounds.hpp"\n#include <vector>\n#include {what}\n')
    expect_broken(tree, capsys, f"choosers/rounds.cpp:3: #include {what}")


@pytest.mark.parametrize("what", ['"scenario.hpp"', '"whole_file.hpp"', '"elmopp/pilot.h"'])
def test_who_names_the_choosers_knows_no_simulator(tree: Path, capsys: pytest.CaptureFixture[str], what: str) -> None:
    write(tree, "choosers/making.cpp", f'#include "choosers.hpp"\n#include "error.hpp"\n#include {what}\n')
    expect_broken(tree, capsys, f"choosers/making.cpp:3: #include {what}")


def test_every_break_has_a_line(tree: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write(tree, "firmware/src/plan.c", '#include "elmopp/site.h"\n#include <stdio.h>\n')
    write(tree, "firmware/src/site.c", '#include "elmopp/plan.h"\n')
    assert check(tree) == 1
    assert capsys.readouterr().err.count("\n") == 3


def test_a_folder_without_a_core_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert check(tmp_path) == 2
    assert "firmware/src" in capsys.readouterr().err


def test_an_unknown_option_is_refused() -> None:
    with pytest.raises(SystemExit) as caught:
        main(["--nonsense"])
    assert caught.value.code == 2


# --- symbols ---


def archive(folder: Path, **sources: str) -> Path:
    """Compiles each source and packs the objects."""
    objects = []
    for name, source in sources.items():
        write(folder, f"{name}.c", source)
        objects.append(f"{name}.o")
        subprocess.run(["cc", "-std=c11", "-O0", "-fno-builtin", "-c", f"{name}.c"], cwd=folder, check=True)
    subprocess.run(["ar", "rcs", "libmade_up.a", *objects], cwd=folder, check=True)
    return folder / "libmade_up.a"


ALLOWED = """\
#include <string.h>
_Noreturn void elmopp_assert_failed(const char *file, int line);
int other(int);
int one(char *a, const char *b) {
    memcpy(a, b, 1); memset(a, 0, 1); memmove(a, b, 1);
    if (memcmp(a, b, 1)) elmopp_assert_failed("", 1);
    return other(1);
}
"""


def test_symbols_of_its_own_and_the_five_from_outside_are_fine(tree: Path) -> None:
    library = archive(tree, one=ALLOWED, two="int other(int x) { return x; }\n")
    assert check(tree, "--library", str(library)) == 0


def test_an_undefined_symbol_names_its_member(tree: Path, capsys: pytest.CaptureFixture[str]) -> None:
    library = archive(tree, one=ALLOWED)
    assert check(tree, "--library", str(library)) == 1
    assert "one.o" in (output := capsys.readouterr().err)
    assert "needs other" in output


@pytest.mark.parametrize(
    ("source", "symbol"),
    [
        ("#include <stdlib.h>\nvoid *f(void) { return malloc(1); }\n", "malloc"),
        ('#include <stdio.h>\nvoid f(void) { printf("x"); }\n', "printf"),
        ("#include <math.h>\nfloat f(float x) { return expf(x); }\n", "expf"),
        ("__attribute__((weak)) int hook(void);\nint f(void) { return hook ? hook() : 0; }\n", "hook"),
        ("extern int errno_copy;\nint f(void) { return errno_copy; }\n", "errno_copy"),
    ],
)
def test_heap_output_libm_and_hooks_are_found(
    tree: Path, capsys: pytest.CaptureFixture[str], source: str, symbol: str
) -> None:
    library = archive(tree, one=source)
    assert check(tree, "--library", str(library)) == 1
    assert f"needs {symbol};" in capsys.readouterr().err


def test_a_static_function_of_another_member_does_not_resolve(tree: Path, capsys: pytest.CaptureFixture[str]) -> None:
    hidden = "static int other(int x) { return x; }\nint use(void) { return other(1); }\n"
    library = archive(tree, one=ALLOWED, two=hidden)
    assert check(tree, "--library", str(library)) == 1
    assert "needs other" in capsys.readouterr().err


def test_a_library_that_is_not_there_is_refused(tree: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert check(tree, "--library", str(tree / "none.a")) == 2
    assert "none.a" in capsys.readouterr().err


def test_an_nm_that_is_not_there_is_refused(tree: Path, capsys: pytest.CaptureFixture[str]) -> None:
    library = archive(tree, one=ALLOWED)
    assert check(tree, "--library", str(library), "--nm", "no-such-nm") == 2
    assert "no-such-nm" in capsys.readouterr().err


def symbols_of(source: Path, tmp_path: Path) -> set[str]:
    """External names that an object defines or needs."""
    target = tmp_path / f"{source.stem}.o"
    include = ROOT / "firmware" / "include"
    subprocess.run(["cc", "-std=c11", "-O1", "-I", str(include), "-c", str(source), "-o", str(target)], check=True)
    listed = subprocess.run(["nm", "-g", "-P", str(target)], capture_output=True, text=True, check=True)
    return {line.split()[0] for line in listed.stdout.splitlines()}


def test_plan_and_monitor_share_no_code(tmp_path: Path) -> None:
    plan, monitor = (symbols_of(ROOT / "firmware" / "src" / f"{room}.c", tmp_path) for room in ("plan", "monitor"))
    assert "elmopp_plan_step" in plan
    assert "elmopp_monitor_check" in monitor
    assert plan & monitor <= {"memcpy", "memset", "elmopp_assert_failed"}
