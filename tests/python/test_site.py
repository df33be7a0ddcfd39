# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""tools/site: what it writes, what it refuses, and that it leaves nothing behind."""

from __future__ import annotations

import errno
import hashlib
import json
import os
import re
import shutil
import struct
import subprocess
import zlib
from pathlib import Path

import pytest
from elmopp_tools import site_model
from elmopp_tools.site import load_site, main
from elmopp_tools.site_c import float_literal
from elmopp_tools.site_image import image_bytes
from elmopp_tools.site_toml import SCHEMA_PATH

ROOT = Path(__file__).resolve().parents[2]
INCLUDE = ROOT / "firmware" / "include"
SITES = sorted((ROOT / "sites").glob("*.toml"))
STRUCT_SIZE = 1740
WARNINGS = ["-std=c11", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wsign-conversion", "-Werror"]

# A small street that uses most keys: a and b conflict, c is compatible with both.
GOOD = """\
name = "cross"
hold_s = [10, 60]
reach_m = 75
saturation_veh_per_s = 0.5
startup_s = 2
chooser = "naive"
forecast = "none"
stages = [["b", "c"], ["a", "c"]]
approaches = [{ name = "A" }, { name = "B" }]

[conflicts]
a = ["b"]
b = ["a"]

[intergreen_ds]
a = { b = 50 }
b = { a = 60 }

[[movements]]
name = "A.M"
approach = "A"
groups = ["a"]

[[movements]]
name = "A.R"
approach = "A"
groups = ["a", "c"]
lanes = 2

[[movements]]
name = "B.M"
approach = "B"
groups = ["b"]
capacity_veh = 4.5
saturation_veh_per_s = 0.4
startup_s = 1.5

[[groups]]
name = "a"
amber_s = 3
red_amber_s = 1
min_green_s = 5
max_green_s = 60

[[groups]]
name = "b"
amber_s = 3.5
red_amber_s = 1
min_green_s = 6

[[groups]]
name = "c"
amber_s = 3
min_green_s = 5
"""

# What is replaced in GOOD (once), by what, and what the message must say.
REFUSED: dict[str, tuple[str, str, list[str]]] = {
    "not TOML": ("reach_m = 75", "reach_m = ", ["is not TOML", "line 3", "reach_m ="]),
    "duplicate key": ("reach_m = 75", "reach_m = 75\nreach_m = 80", ["is not TOML", "line 4", "reach_m = 80"]),
    "duplicate group in conflicts": ('b = ["a"]', 'a = ["b"]', ["is not TOML", "line 13"]),
    "nan": ("reach_m = 75", "reach_m = nan", ["reach_m is not finite", "nan"]),
    "nan inside": ("capacity_veh = 4.5", "capacity_veh = nan", ["movements[2].capacity_veh", "nan"]),
    "infinity": ("startup_s = 2\n", "startup_s = -inf\n", ["startup_s is not finite", "-inf"]),
    "huge integer": ("reach_m = 75", "reach_m = 0x" + "f" * 9000, ["reach_m is too large", "36000 bits"]),
    "long integer": ("reach_m = 75", "reach_m = " + "9" * 5000, ["is not TOML"]),
    "deep nesting": ("reach_m = 75", "reach_m = " + "[" * 5000, ["nested"]),
    "unknown key": ("hold_s =", "holds =", ["unknown key", '"holds"', "hold_s, reach_m"]),
    "unknown key in a movement": ("lanes = 2", "lane = 2", ["unknown key", "movements[1].lane", "lanes, capacity_veh"]),
    "unknown key in a group": ("max_green_s", "maximum_s", ["unknown key", "groups[0].maximum_s", "max_green_s"]),
    "unknown key in an approach": ('{ name = "B" }', '{ name = "B", x = 1 }', ["approaches[1].x", "name"]),
    "missing key": ("reach_m = 75\n", "", ["lacks a key", '"reach_m"']),
    "missing key in a group": ("min_green_s = 6", "", ["groups[1] lacks a key", '"min_green_s"']),
    "wrong type": ("reach_m = 75", 'reach_m = "far"', ["reach_m has the wrong type", '"far"', "a number"]),
    "date": ("reach_m = 75", "reach_m = 2026-01-01", ["reach_m has the wrong type", "2026-01-01"]),
    "boolean as number": ("lanes = 2", "lanes = true", ["movements[1].lanes", "true", "an integer"]),
    "wrong type of intergreen": ("a = { b = 50 }", "a = 50", ["intergreen_ds.a", "50", "a table"]),
    "fraction of intergreen": ("a = { b = 50 }", "a = { b = 50.5 }", ["intergreen_ds.a.b", "50.5", "an integer"]),
    "text as groups": ('groups = ["b"]', 'groups = "b"', ["movements[2].groups", '"b"', "an array"]),
    "no groups": ('groups = ["b"]', "groups = []", ["movements[2].groups", "at least 1"]),
    "group twice": ('groups = ["b"]', 'groups = ["b", "b"]', ["movements[2].groups", "twice"]),
    "one hold": ("[10, 60]", "[10]", ["hold_s has 1 entries", "[10]", "at least 2"]),
    "three holds": ("[10, 60]", "[10, 60, 70]", ["hold_s has 3 entries", "at most 2"]),
    "hold backwards": ("[10, 60]", "[60, 10]", ["hold_s", "[60, 10]", "min <= max"]),
    "hold 0": ("[10, 60]", "[0, 60]", ["hold_s", "[0, 60]"]),
    "hold 151": ("[10, 60]", "[10, 151]", ["hold_s", "[10, 151]", "150"]),
    "unknown chooser": ('"naive"', '"clever"', ["chooser", '"clever"', "naive, cumulative, pressure"]),
    "unknown forecast": ('"none"', '"lstn"', ["forecast", '"lstn"', "ar8", "nlstm"]),
    "street by Greenshields": (
        "reach_m = 75",
        'reach_m = 75\ndischarge = "greenshields"\nfree_flow_m_per_s = 10',
        ["discharge", "greenshields", "saturation"],
    ),
    "unknown discharge": ("reach_m = 75", 'reach_m = 75\ndischarge = "x"', ["discharge", '"x"', "greenshields"]),
    "q15": ("reach_m = 75", 'reach_m = 75\narithmetic = "q15"', ["arithmetic", '"q15"', 'only "float" is built']),
    "no free flow": ("reach_m = 75", 'reach_m = 75\ndischarge = "nolock"', ["free_flow_m_per_s", "0.0"]),
    "idle free flow": ("reach_m = 75", "reach_m = 75\nfree_flow_m_per_s = 10", ["free_flow_m_per_s", "10.0"]),
    "no reach": ("reach_m = 75", "reach_m = 0", ["reach_m is too small", "(0)", "at least 1"]),
    "no flow": ("saturation_veh_per_s = 0.4", "saturation_veh_per_s = 0", ["B.M", "(0.0)", "more than 0"]),
    "negative flow": ("saturation_veh_per_s = 0.5", "saturation_veh_per_s = -0.5", ["A.M", "(-0.5)", "more than 0"]),
    "flow below single precision": ("saturation_veh_per_s = 0.4", "saturation_veh_per_s = 1e-60", ["B.M", "(0.0)"]),
    "negative capacity": ("capacity_veh = 4.5", "capacity_veh = -1", ["capacity_veh", "(-1)", "at least 0"]),
    "no lane": ("lanes = 2", "lanes = 0", ["movements[1].lanes", "(0)", "at least 1"]),
    "start-up too fine": ("startup_s = 1.5", "startup_s = 1.55", ["startup_s of movement B.M", "1.55", "tenth"]),
    "amber too fine": ("amber_s = 3.5", "amber_s = 3.51", ["amber_s of group b", "3.51"]),
    "amber short": ("amber_s = 3.5", "amber_s = 2.9", ["amber_s of group b", "(2.9)", "3.0 s to 6.0 s"]),
    "amber long": ("amber_s = 3.5", "amber_s = 6.1", ["amber_s of group b", "(6.1)"]),
    "min green short": ("min_green_s = 6", "min_green_s = 4.9", ["min_green_s of group b", "(4.9)", "5.0 s"]),
    "max green below min": ("max_green_s = 60", "max_green_s = 4.9", ["max_green_s of group a", "(4.9)", "5.0 s"]),
    "name long": ('name = "A.M"', 'name = "A.M123456789"', ["12 bytes", "A.M123456789", "at most 11"]),
    "site name long": ('"cross"', '"' + "x" * 24 + '"', ["24 bytes", "at most 23"]),
    "name empty": ('name = "A.M"', 'name = ""', ["movements[0].name", "not a name"]),
    "name not ASCII": ('name = "A.M"', 'name = "Ä.M"', ["movements[0].name", "Ä.M", "ASCII"]),
    "name with end of line": ('name = "A.M"', 'name = "A.M\\n"', ["movements[0].name", "A.M\\n"]),
    "name with quote": ('"cross"', "'cr\"oss'", ["name is not a name", 'cr\\"oss']),
    "movement twice": ('name = "A.R"', 'name = "A.M"', ["movements[1].name is taken", '"A.M"']),
    "approach twice": ('{ name = "B" }', '{ name = "A" }', ["approaches[1].name is taken", '"A"']),
    "unknown approach": ('approach = "B"', 'approach = "C"', ["approach of movement B.M", '"C"', "A, B"]),
    "unknown group": ('groups = ["b"]', 'groups = ["d"]', ["group of movement B.M", '"d"', "a, b, c"]),
    "unknown group in conflicts": ('b = ["a"]', 'b = ["a"]\nd = ["a"]', ["conflicts", '"d"', "a, b, c"]),
    "unknown conflicting group": ('b = ["a"]', 'b = ["a", "d"]', ["conflicts.b", '"d"', "a, b, c"]),
    "own conflict": ('b = ["a"]', 'b = ["a", "b"]', ["conflicts.b names itself"]),
    "asymmetric conflicts": ('b = ["a"]', "b = []", ["asymmetric", "a names b", '"a, b"']),
    "asymmetric, row missing": ('b = ["a"]', 'b = ["a", "c"]', ["asymmetric", "b names c", '"b, c"']),
    "intergreen missing": ("b = { a = 60 }", "", ["intergreen_ds lacks", "b to a"]),
    "intergreen of a compatible pair": ("{ a = 60 }", "{ a = 60, c = 0 }", ["intergreen_ds from b to c", "(0)"]),
    "intergreen to itself": ("{ a = 60 }", "{ a = 60, b = 60 }", ["intergreen_ds from b to b", "do not conflict"]),
    "intergreen of nobody": ("{ a = 60 }", "{ a = 60, d = 60 }", ["intergreen_ds.b", '"d"']),
    "intergreen short": ("{ a = 60 }", "{ a = 44 }", ["intergreen_ds from b to a", "(44)", "at least 45"]),
    "intergreen negative": ("{ a = 60 }", "{ a = -1 }", ["intergreen_ds.b.a is too small", "(-1)"]),
    "movement in conflict": ('groups = ["a", "c"]', 'groups = ["a", "b"]', ["movement A.R", "a and b, which conflict"]),
    "empty approach": ('[{ name = "A" }', '[{ name = "0" }, { name = "A" }', ["approach 0 has no movement"]),
    "idle group": ('groups = ["a", "c"]', 'groups = ["a"]', ["group c is used by no movement"]),
    "conflicting stage": ('["a", "c"]]', '["a", "b", "c"]]', ["stages[1]", "a and b, which conflict"]),
    "stage not maximal": ('["a", "c"]]', '["a"]]', ["stages[1] is not maximal", '["a"]', "c conflicts with none"]),
    "stage twice": ('["a", "c"]]', '["c", "b"]]', ["stages[1] is stage 0 again", '["c", "b"]']),
    "stage missing": (', ["a", "c"]]', "]", ["stages lacks a stage", '["a", "c"]', "all 2"]),
    "stage of nobody": ('["a", "c"]]', '["a", "d"]]', ["stages[1]", '"d"', "a, b, c"]),
    "stage empty": ('["a", "c"]]', "[]]", ["stages[1] is not maximal", "[]"]),
    "table twice": ("[intergreen_ds]", "[conflicts]", ["is not TOML", "conflicts"]),
}


def write_site(folder: Path, text: str = GOOD, name: str = "cross.toml") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def changed(old: str, new: str) -> str:
    assert GOOD.count(old) == 1, f"{old!r} must occur once"
    return GOOD.replace(old, new)


def cocktail(pairs: int, extra: str = "") -> str:
    """A site of conflicting pairs of groups that are otherwise compatible: 2 ** pairs stages."""
    names = [f"{side}{pair}" for pair in range(pairs) for side in "xy"]
    other = {"x": "y", "y": "x"}
    conflicts = "\n".join(f'{name} = ["{other[name[0]]}{name[1:]}"]' for name in names)
    movements = "\n".join(f'[[movements]]\nname = "{name}"\napproach = "A"\ngroups = ["{name}"]' for name in names)
    groups = "\n".join(f'[[groups]]\nname = "{name}"\namber_s = 3\nmin_green_s = 5' for name in names)
    head = GOOD[: GOOD.index("stages")] + 'approaches = [{ name = "A" }]\nintergreen_ds = 50\n'
    return f"{head}{extra}[conflicts]\n{conflicts}\n{movements}\n{groups}\n"


def refusal(capsys: pytest.CaptureFixture[str], site: Path, *arguments: str) -> str:
    """The one line on stderr of a refused request."""
    assert main([str(site), *arguments]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.endswith("\n")
    assert captured.err.count("\n") == 1
    assert captured.err.startswith("site: ")
    assert " ; " in captured.err
    return captured.err


def compile_and_dump(c_file: Path, symbol: str, folder: Path) -> bytes:
    """The bytes of the constant in a compiled C file."""
    dump = folder / "dump.c"
    dump.write_text(
        '#include "elmopp/junction.h"\n#include <stdio.h>\n'
        f"extern const elmopp_junction_t {symbol};\n"
        f"int main(void) {{ return fwrite(&{symbol}, sizeof {symbol}, 1, stdout) == 1 ? 0 : 1; }}\n"
    )
    compiler = os.environ.get("CC") or shutil.which("gcc") or "cc"
    program = folder / "dump"
    subprocess.run([compiler, *WARNINGS, f"-I{INCLUDE}", str(c_file), str(dump), "-o", str(program)], check=True)
    return subprocess.run([str(program)], check=True, capture_output=True).stdout


def test_good_site_is_accepted_and_summarised(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([str(write_site(tmp_path))]) == 0
    captured = capsys.readouterr()
    assert captured.err == ""
    assert captured.out.splitlines() == [
        "cross: approaches 2, movements 3, groups 3, conflicting pairs 1, stages 2",
        "stage 0: b c",
        "stage 1: a c",
    ]
    assert [path.name for path in tmp_path.iterdir()] == ["cross.toml"]


@pytest.mark.parametrize("case", REFUSED)
def test_bad_site_is_refused_in_one_line_and_leaves_no_file(
    case: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    old, new, expected = REFUSED[case]
    path = write_site(tmp_path, changed(old, new))
    line = refusal(capsys, path, "--c", str(tmp_path / "a.c"), "--image", str(tmp_path / "a.bin"))
    assert line.startswith(f"site: {path}: ")
    for part in expected:
        assert part in line
    assert [path.name for path in tmp_path.iterdir()] == ["cross.toml"]


def test_refused_site_leaves_the_old_files_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "a.c").write_text("old")
    refusal(capsys, write_site(tmp_path, changed("[10, 60]", "[0, 60]")), "--c", str(tmp_path / "a.c"))
    assert (tmp_path / "a.c").read_text() == "old"


def test_limits_are_accepted_on_their_good_side(tmp_path: Path) -> None:
    for old, new in [
        ("[10, 60]", "[1, 150]"),
        ("amber_s = 3.5", "amber_s = 3.0"),
        ("amber_s = 3.5", "amber_s = 5"),
        ("min_green_s = 6", "min_green_s = 5.0"),
        ("max_green_s = 60", "max_green_s = 5"),
        ("max_green_s = 60", "max_green_s = 0"),
        ("{ a = 60 }", "{ a = 45 }"),
        ("capacity_veh = 4.5", "capacity_veh = 0"),
        ('name = "A.M"', 'name = "A.M12345678"'),
        ('"cross"', '"' + "x" * 23 + '"'),
        ("reach_m = 75", "reach_m = 75\nfree_flow_m_per_s = 0"),
        ("reach_m = 75", 'reach_m = 75\nsimulation_only = true\ndischarge = "nolock"\nfree_flow_m_per_s = 10'),
        ("reach_m = 75", 'reach_m = 75\narithmetic = "float"'),
        ('stages = [["b", "c"], ["a", "c"]]', ""),
    ]:
        assert main([str(write_site(tmp_path, changed(old, new)))]) == 0, new


def test_simulation_only_site_may_have_zero_times(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = re.sub(r"(amber_s|a|b) = (3\.5|[13]|\{ [ab] = [56]0 \})\n", zero_time, GOOD)
    text = re.sub(r"min_green_s = .", "min_green_s = 1", text)
    simulated = text.replace('"cross"\n', '"cross"\nsimulation_only = true\n')
    assert main([str(write_site(tmp_path, simulated))]) == 0
    assert "cross (simulation only): " in capsys.readouterr().out
    assert "amber_s of group a" in refusal(capsys, write_site(tmp_path, text))
    short = simulated.replace("min_green_s = 1", "min_green_s = 0.9", 1)
    assert "min_green_s of group a" in refusal(capsys, write_site(tmp_path, short))


def zero_time(match: re.Match[str]) -> str:
    other = {"a": "b", "b": "a"}
    return f"{match[1]} = {{ {other[match[1]]} = 0 }}\n" if match[1] in other else f"{match[1]} = 0\n"


def test_defaults_are_per_lane_and_overrides_win(tmp_path: Path) -> None:
    one, two, own = load_site(write_site(tmp_path))[0].movements
    assert (one.capacity_veh, one.saturation_veh_per_s, one.startup_ds, one.lanes) == (10.0, 0.5, 20, 1)
    assert (two.capacity_veh, two.saturation_veh_per_s, two.startup_ds, two.lanes) == (20.0, 1.0, 20, 2)
    assert (own.capacity_veh, own.startup_ds, own.lanes) == (4.5, 15, 1)
    assert own.saturation_veh_per_s == pytest.approx(0.4, rel=1e-7)


def test_own_saturation_is_per_lane_too(tmp_path: Path) -> None:
    text = changed("lanes = 2", "lanes = 2\nsaturation_veh_per_s = 0.25\ncapacity_veh = 8")
    movement = load_site(write_site(tmp_path, text))[0].movements[1]
    assert (movement.saturation_veh_per_s, movement.capacity_veh) == (0.5, 8.0)


def test_one_intergreen_for_all_fills_the_conflicting_pairs_only(tmp_path: Path) -> None:
    table = GOOD[GOOD.index("[intergreen_ds]") : GOOD.index("[[movements]]")]
    text = changed(table, "").replace("reach_m = 75", "reach_m = 75\nintergreen_ds = 55")
    assert load_site(write_site(tmp_path, text))[0].intergreen_ds == ((0, 55, 0), (55, 0, 0), (0, 0, 0))


def test_intergreen_table_is_ending_then_starting(tmp_path: Path) -> None:
    assert load_site(write_site(tmp_path))[0].intergreen_ds == ((0, 50, 0), (60, 0, 0), (0, 0, 0))


def test_stage_bound_is_tried_on_both_sides(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([str(write_site(tmp_path, cocktail(5)))]) == 0
    assert "stages 32\n" in capsys.readouterr().out
    assert "has 64 stages, ELMOPP_STAGE_MAX is 32" in refusal(capsys, write_site(tmp_path, cocktail(6)))


def test_too_many_groups_movements_and_approaches_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    many = cocktail(9)
    assert "too many groups (18) ; ELMOPP_GROUP_MAX is 16" in refusal(capsys, write_site(tmp_path, many))
    movement = '[[movements]]\nname = "m{}"\napproach = "A"\ngroups = ["a"]\n\n'
    more = GOOD + "".join(movement.format(index) for index in range(22))
    assert "too many movements (25) ; ELMOPP_MOVEMENT_MAX is 24" in refusal(capsys, write_site(tmp_path, more))
    approaches = "[" + ", ".join(f'{{ name = "{index}" }}' for index in range(9)) + "]"
    wide = changed('[{ name = "A" }, { name = "B" }]', approaches)
    assert "too many approaches (9) ; ELMOPP_APPROACH_MAX is 8" in refusal(capsys, write_site(tmp_path, wide))


def test_bounds_and_codes_are_those_of_the_headers() -> None:
    bounds = (INCLUDE / "elmopp" / "bounds.h").read_text()
    for name in ["APPROACH_MAX", "MOVEMENT_MAX", "GROUP_MAX", "STAGE_MAX", "SITE_NAME_SIZE", "NAME_SIZE"]:
        found = re.search(rf"#define ELMOPP_{name} (\d+)U", bounds)
        assert found is not None
        assert int(found[1]) == getattr(site_model, name)
    junction = (INCLUDE / "elmopp" / "junction.h").read_text()
    properties = json.loads(SCHEMA_PATH.read_text())["properties"]
    for key in ["discharge", "chooser", "forecast"]:
        codes = re.findall(rf"ELMOPP_{key.upper()}_(\w+) = (\d+)", junction)
        names = [name.lower() for name, code in sorted(codes, key=lambda item: int(item[1])) if name != "COUNT"]
        assert names == properties[key]["enum"] == list(getattr(site_model, f"{key.upper()}S"))


@pytest.mark.parametrize("path", SITES, ids=lambda path: path.stem)
def test_generated_files_of_the_repository_are_up_to_date(path: Path) -> None:
    assert main([str(path), "--c", str(path.with_suffix(".c")), "--check"]) == 0


@pytest.mark.parametrize("path", SITES, ids=lambda path: path.stem)
def test_compiled_constant_is_the_image_body(path: Path, tmp_path: Path) -> None:
    c_file, image_file = tmp_path / "site.c", tmp_path / "site.bin"
    assert main([str(path), "--c", str(c_file), "--image", str(image_file)]) == 0
    image = image_file.read_bytes()
    assert len(image) == 16 + STRUCT_SIZE
    assert compile_and_dump(c_file, f"elmopp_site_{path.stem}", tmp_path) == image[16:]


def test_compiled_constant_is_the_image_body_with_odd_values(tmp_path: Path) -> None:
    laws = 'simulation_only = true\ndischarge = "nolock"\nfree_flow_m_per_s = 1e-30'
    text = changed("reach_m = 75", f"reach_m = 1e3\n{laws}")
    text = text.replace("capacity_veh = 4.5", "capacity_veh = 0.1").replace('"naive"', '"pressure"')
    path = write_site(tmp_path, text.replace('"none"', '"ar8"'), "5-odd*name.v2.toml")
    c_file, image_file = tmp_path / "site.c", tmp_path / "site.bin"
    assert main([str(path), "--c", str(c_file), "--image", str(image_file)]) == 0
    assert compile_and_dump(c_file, "elmopp_site_5_odd_name_v2", tmp_path) == image_file.read_bytes()[16:]


def test_image_has_magic_version_length_and_crc(tmp_path: Path) -> None:
    image = image_bytes(load_site(write_site(tmp_path))[0])
    magic, version, length, crc = struct.unpack("<4sIII", image[:16])
    assert (magic, version, length) == (b"ELMS", 1, STRUCT_SIZE)
    assert len(image) == 16 + length
    assert crc == zlib.crc32(image[16:])
    assert image[16:40] == b"cross".ljust(24, b"\0")


def test_c_file_names_generator_and_hash_in_its_first_line(tmp_path: Path) -> None:
    path = write_site(tmp_path)
    assert main([str(path), "--c", str(tmp_path / "any.c")]) == 0
    lines = (tmp_path / "any.c").read_text().splitlines()
    sha256 = hashlib.sha256(path.read_bytes()).hexdigest()
    assert lines[0].startswith(f"/* Generated by tools/site from cross.toml, SHA-256 {sha256}.")
    assert "SPDX-License-Identifier: Apache-2.0" in lines[1]
    assert "extern const elmopp_junction_t elmopp_site_cross;" in lines
    assert str(tmp_path) not in "\n".join(lines)


def test_float_literals_read_back_as_the_same_single() -> None:
    for bits in [0x3DCCCCCD, 0x43A6AAAB, 0x00000001, 0x7F7FFFFF, 0x3F800000, 0x501502F9]:
        (number,) = struct.unpack("<f", struct.pack("<I", bits))
        literal = float_literal(number)
        assert re.fullmatch(r"\d+\.\d+(e[+-]\d+)?F", literal)
        assert struct.pack("<f", float(literal[:-1])) == struct.pack("<I", bits)


@pytest.mark.parametrize("option", ["--c", "--image"])
def test_check_finds_one_changed_byte(option: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    site, made = write_site(tmp_path), tmp_path / "made"
    assert main([str(site), option, str(made)]) == 0
    assert main([str(site), option, str(made), "--check"]) == 0
    content = bytearray(made.read_bytes())
    content[len(content) // 2] ^= 1
    made.write_bytes(content)
    assert main([str(site), option, str(made), "--check"]) == 1
    captured = capsys.readouterr()
    assert captured.err.count("\n") == 1
    assert str(made) in captured.err
    assert made.read_bytes() == content, "--check writes nothing"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["cross.toml", "made"]


def test_check_looks_at_both_files(tmp_path: Path) -> None:
    site, c_file, image = write_site(tmp_path), tmp_path / "a.c", tmp_path / "a.bin"
    both = [str(site), "--c", str(c_file), "--image", str(image)]
    assert main(both) == 0
    assert main([*both, "--check"]) == 0
    image.write_bytes(image.read_bytes()[:-1])
    assert main([*both, "--check"]) == 1


def test_check_of_a_missing_file_differs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([str(write_site(tmp_path)), "--c", str(tmp_path / "none.c"), "--check"]) == 1
    assert "is missing" in capsys.readouterr().err
    assert not (tmp_path / "none.c").exists()


def test_check_notices_a_changed_comment_of_the_source(tmp_path: Path) -> None:
    site, c_file = write_site(tmp_path), tmp_path / "a.c"
    assert main([str(site), "--c", str(c_file)]) == 0
    write_site(tmp_path, GOOD + "# more\n")
    assert main([str(site), "--c", str(c_file), "--check"]) == 1


def test_requests_that_cannot_be_run_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    site, folder = write_site(tmp_path), tmp_path / "folder"
    folder.mkdir()
    same = str(tmp_path / "same")
    assert "none.toml" in refusal(capsys, tmp_path / "none.toml")
    assert str(folder) in refusal(capsys, folder)
    assert "--check" in refusal(capsys, site, "--check")
    assert "same" in refusal(capsys, site, "--c", same, "--image", same)
    assert "same" in refusal(capsys, site, "--c", str(site))
    assert "regular file" in refusal(capsys, site, "--c", str(folder))
    assert "regular file" in refusal(capsys, site, "--c", os.devnull)
    assert "folder" in refusal(capsys, site, "--c", str(tmp_path / "no" / "a.c"))
    assert site.read_text() == GOOD
    assert sorted(path.name for path in tmp_path.iterdir()) == ["cross.toml", "folder"]


def test_failed_write_leaves_no_draft_and_the_old_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(_draft: Path, target: Path) -> Path:
        raise OSError(errno.ENOSPC, "No space left on device", str(target))

    site, c_file = write_site(tmp_path), tmp_path / "a.c"
    c_file.write_text("old")
    monkeypatch.setattr(Path, "replace", fail)
    assert "No space left" in refusal(capsys, site, "--c", str(c_file), "--image", str(tmp_path / "a.bin"))
    assert c_file.read_text() == "old"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.c", "cross.toml"]


def test_source_that_is_not_utf8_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    site = tmp_path / "latin.toml"
    site.write_bytes(b'name = "\xe4"\n')
    assert "UTF-8" in refusal(capsys, site)


@pytest.mark.parametrize("arguments", [[], ["a.toml", "--out", "x"], ["a.toml", "--ima", "x"], ["a.toml", "b.toml"]])
def test_wrong_arguments_are_one_line(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        main(arguments)
    assert stop.value.code == 2
    captured = capsys.readouterr()
    assert captured.err.startswith("site: ")
    assert captured.err.count("\n") == 1


def test_program_runs_from_any_folder(tmp_path: Path) -> None:
    program = str(ROOT / "tools" / "site")
    site = write_site(tmp_path)
    good = subprocess.run([program, site.name], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (good.returncode, good.stderr) == (0, "")
    assert good.stdout.startswith("cross: ")
    bad = subprocess.run([program, "none.toml"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (bad.returncode, bad.stdout) == (2, "")
    assert bad.stderr.startswith("site: none.toml: ")
    manual = subprocess.run([program, "--help"], capture_output=True, text=True, check=True).stdout
    assert "signal groups that may be green together" in manual
