# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""tools/budget: frames and calls from a disassembly, the deepest way through them, and what is beyond a limit."""

from __future__ import annotations

from pathlib import Path

import pytest
from elmopp_tools.bench_cortex_m4 import Count
from elmopp_tools.budget import BudgetError, Image, Measured, beyond, image_of, main, new_limits, with_table
from elmopp_tools.stack_use import (
    Calls,
    Depth,
    Function,
    Graph,
    StackError,
    StackUse,
    raise_frames,
    read_frames,
    read_functions,
)

NO_POINTERS = Calls({}, ["vectors"], [])

DISASSEMBLY = """\
00000100 <outer>:
     100:\tpush\t{r4, r5, lr}
     102:\tvpush\t{d8-d9}
     106:\tsub\tsp, #20
     108:\tcbz\tr0, 10e <outer+0xe>
     10a:\tbl\t200 <inner>
     10e:\tb.w\t300 <last>

00000200 <inner>:
     200:\tstmdb\tsp!, {r4, r5, r6, r7, r8, r9, sl, fp, lr}
     204:\tvpush\t{s16-s31}
     208:\tbeq.n\t200 <inner+0x8>
     20a:\tldr.w\tpc, [r2, r3, lsl #2]
     20e:\tldr.w\tpc, [sp], #4

00000300 <last>:
     300:\tstr.w\tlr, [sp, #-4]!
     304:\tbx\tlr
"""


def functions_of(text: str) -> dict[int, Function]:
    return read_functions(text.splitlines())


def depth_of(text: str, root: int, calls: Calls = NO_POINTERS) -> Depth:
    return Graph(functions_of(text), calls).deepest([root])


def test_a_frame_is_all_that_is_taken_off_the_stack_pointer() -> None:
    frames = {function.name: function.frame for function in functions_of(DISASSEMBLY).values()}
    assert frames == {"outer": 12 + 16 + 20, "inner": 36 + 64, "last": 4}


def test_the_deepest_way_goes_through_calls_and_tail_calls() -> None:
    assert depth_of(DISASSEMBLY.replace("208:\tbeq.n\t200 <inner+0x8>", "208:\tnop"), 0x100) == Depth(
        148, ("outer", "inner")
    )
    assert functions_of(DISASSEMBLY)[0x100].calls == {0x200, 0x300}


def test_a_loop_inside_a_function_is_no_recursion_but_a_call_of_itself_is() -> None:
    inside = DISASSEMBLY.replace("200 <inner+0x8>", "208 <inner+0x8>")
    assert depth_of(inside, 0x200).bytes == 100
    with pytest.raises(StackError, match="inner calls inner: recursion has no bound"):
        depth_of(DISASSEMBLY, 0x200)


def test_recursion_over_two_functions_is_named() -> None:
    text = "00000100 <a>:\n     100:\tbl\t200 <b>\n00000200 <b>:\n     200:\tbl\t100 <a>\n"
    with pytest.raises(StackError, match="a calls b calls a: recursion has no bound"):
        depth_of(text, 0x100)


POINTER = "00000100 <asks>:\n     100:\tblx\tr3\n00000200 <answers>:\n     200:\tpush\t{r4, lr}\n"


def test_a_call_through_a_pointer_goes_where_the_list_says() -> None:
    assert depth_of(POINTER, 0x100, Calls({"asks": ["answers", "absent"]}, [], [])) == Depth(8, ("asks", "answers"))


def test_a_call_through_a_pointer_that_is_not_listed_is_an_error() -> None:
    with pytest.raises(StackError, match=r"asks\(\) calls through a pointer"):
        depth_of(POINTER, 0x100)


@pytest.mark.parametrize("jump", ["bx\tr3", "mov\tpc, r3"])
def test_a_jump_through_a_register_is_a_call_through_a_pointer(jump: str) -> None:
    with pytest.raises(StackError, match="pointer"):
        depth_of(POINTER.replace("blx\tr3", jump), 0x100)


def test_an_amount_that_is_not_known_is_refused() -> None:
    with pytest.raises(StackError, match="not known"):
        functions_of("00000100 <grows>:\n     100:\tsub.w\tsp, sp, r3\n")


def test_gccs_frame_counts_where_it_is_larger_by_source_for_local_functions(tmp_path: Path) -> None:
    (tmp_path / "one.c.su").write_text("/x/one.c:1:2:same\t40\tstatic\n", encoding="utf-8")
    (tmp_path / "two.c.su").write_text("/x/two.c:1:2:same\t8\tstatic\n", encoding="utf-8")
    functions = {0x100: Function("same", 0x100, 4), 0x200: Function("same.isra.0", 0x200, 4)}
    symbols = (
        "  1: 00000000 0 FILE LOCAL DEFAULT ABS one.c",
        "  2: 00000101 4 FUNC LOCAL DEFAULT 1 same",
        "  3: 00000000 0 FILE LOCAL DEFAULT ABS two.c",
        "  4: 00000201 4 FUNC LOCAL DEFAULT 1 same.isra.0",
    )
    raise_frames(functions, symbols, read_frames(tmp_path))
    assert (functions[0x100].frame, functions[0x200].frame) == (40, 8)


def test_a_frame_without_a_bound_is_refused(tmp_path: Path) -> None:
    with pytest.raises(StackError, match=r"has no \.su files"):
        read_frames(tmp_path)
    (tmp_path / "one.c.su").write_text("/x/one.c:1:2:grows\t40\tdynamic\n", encoding="utf-8")
    with pytest.raises(StackError, match=r"grows\(\) takes stack without a bound"):
        read_frames(tmp_path)


SECTIONS = """\
  [ 1] .text             PROGBITS        00000000 001000 000100 00  AX  0   0 64
  [ 2] .data             PROGBITS        20000000 016474 000010 00  WA  0   0  1
  [ 4] .bss              NOBITS          20000000 017000 000020 00  WA  0   0  4
  [ 5] .stack            NOBITS          20017b90 017000 002000 00  WA  0   0  1
  [ 6] .aside            NOBITS          10000000 017000 000040 00  WA  0   0  4
  [ 7] .comment          PROGBITS        00000000 016474 000026 01  MS  0   0  1
"""


def test_initial_values_take_flash_and_ram_and_the_stack_takes_neither() -> None:
    symbols = ["  7: 00000101 4 FUNC GLOBAL DEFAULT 1 malloc", ""]
    assert image_of(SECTIONS.splitlines(), symbols, 99) == Image(0x110, 0x30, 0x40, 99, 0x2000, 1)


def measured_with(image: Image, insn: int) -> Measured:
    stack = StackUse(Depth(image.stack_bytes, ()), Depth(0, ()), Depth(0, ()))
    return Measured({"one": image}, {"one": stack}, {"step": Count(insn, insn, 0)})


def test_limits_are_what_was_measured_and_five_per_cent() -> None:
    measured = measured_with(Image(1000, 200, 40, 100, 8192, 0), 1001)
    assert new_limits(measured) == {
        "one": {"flash_bytes": 1050, "ram_bytes": 210, "aside_bytes": 42, "stack_bytes": 105, "heap_functions": 0},
        "instructions": {"step": 1052},
        "model_cycles": {},
    }
    assert beyond(measured, new_limits(measured)) == []


def test_each_value_beyond_its_limit_is_a_line() -> None:
    limits = new_limits(measured_with(Image(1000, 200, 40, 100, 8192, 0), 1000))
    problems = beyond(measured_with(Image(1051, 211, 43, 106, 50, 1), 1051), limits)
    assert [problem.split(" ; ")[0] for problem in problems] == [
        "one: flash_bytes 1051",
        "one: ram_bytes 211",
        "one: aside_bytes 43",
        "one: stack_bytes 106",
        "one: heap_functions 1",
        "one: stack_bytes 106",
        "instructions: step 1051",
    ]
    assert "50 are kept for it" in problems[5]


def test_what_has_no_limit_and_what_was_not_measured_are_lines() -> None:
    measured = measured_with(Image(1000, 200, 40, 100, 8192, 0), 1000)
    limits = new_limits(measured)
    limits["instructions"] = {"other": 5}
    assert [problem.split(" ; ")[0] for problem in beyond(measured, limits)] == [
        "instructions: step 1000 has no limit",
        "instructions: other was not measured, but has a limit",
    ]


def with_tick(cycles: int) -> Measured:
    return Measured({}, {}, {"tick.one": Count(1000, cycles, 0), "step": Count(1000, 9_999_999, 0)})


def test_a_tick_takes_two_per_cent_of_a_second_or_what_is_written_for_it() -> None:
    limits = new_limits(with_tick(3_360_000))
    assert beyond(with_tick(3_360_000), limits) == []
    assert beyond(with_tick(3_360_001), limits) == ["model cycles: tick.one 3360001 ; at most 3360000 would be right"]
    limits = new_limits(with_tick(4_000_000))
    assert limits["model_cycles"] == {"tick.one": 4_200_000}
    assert beyond(with_tick(4_200_000), limits) == []
    assert beyond(with_tick(4_200_001), limits) == ["model cycles: tick.one 4200001 ; at most 4200000 would be right"]


def test_a_tick_that_needs_no_limit_of_its_own_has_none() -> None:
    limits = new_limits(with_tick(4_000_000))
    assert beyond(with_tick(3_360_000), limits) == ["model cycles: tick.one needs no limit of its own ; leave it out"]


def test_what_depends_on_the_numbers_is_a_line_where_nothing_may() -> None:
    limits = new_limits(Measured({}, {}, {"train_w30": Count(1000, 1000, 0)}))
    assert beyond(Measured({}, {}, {"train_w30": Count(1000, 1000, 2)}), limits) == [
        "spread: train_w30 2 ; 0 would be right"
    ]


def test_the_table_is_written_between_its_marks() -> None:
    text = "a\n<!-- budgets -->\nold\n<!-- end of budgets -->\nb\n"
    assert with_table(text, ["new"]) == "a\n<!-- budgets -->\n\nnew\n\n<!-- end of budgets -->\nb\n"
    with pytest.raises(BudgetError, match="has no <!-- budgets -->"):
        with_table("a\n", ["new"])


def test_a_build_without_the_image_is_one_line_and_status_2(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--build", str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "there is no such image" in error
