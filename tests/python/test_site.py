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
STRUCT_SIZE = 2312
VERSION = 5
WARNINGS = ["-std=c11", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wsign-conversion", "-Werror"]

# A small street that uses all keys: a and b conflict, c is compatible with both. Stage 0 serves B.M, stage 1 the
# others; a change takes up to 6 + 6 + 1.5 + 0.2 s, so that a bound on red is 3 * 13.7 s at least.
GOOD = """\
name = "cross"
hold_s = [10, 60]
reach_m = 75
saturation_veh_per_s = 0.5
startup_s = 2
speed_km_per_h = 40
chooser = "naive"
forecast = "none"
red_bound_s = 90
stages = [["b", "c"], ["a", "c"]]
approaches = [{ name = "A" }, { name = "B", speed_km_per_h = 30 }]
start_flash_s = 12.5
start_red_s = 4
junction_wait_ds = 15
first_stage = ["c", "a"]
cameras = ["B"]

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
max_green_s = 50
node = 7
flash = "red"

[[groups]]
name = "c"
amber_s = 3
min_green_s = 5
max_green_s = 45
flash = "dark"

[detectors]
no_activity_min = 31
max_presence_min = 62
erratic_per_min = 93

[[programs]]
name = "day"
steps = [{ stage = ["c", "a"], green_s = 20 }, { stage = ["b", "c"], green_s = 6.5 }]

[[programs]]
name = "late"
steps = [{ stage = ["b", "c"], green_s = 6 }, { stage = ["a", "c"], green_s = 8 }, { stage = ["b", "c"], green_s = 9 }]

[[schedule]]
weekdays = ["Mon", "Fri"]
from = "06:30"
program = "late"

[[schedule]]
weekdays = ["Sun", "Fri"]
from = "22:00"
program = "flash"

[[special_days]]
date = "2026-12-25"
as = "Sun"

[[special_days]]
date = "2027-01-01"
as = "Sat"
"""

# What is replaced in GOOD (once), by what, and what the message must say.
REFUSED: dict[str, tuple[str, str, list[str]]] = {
    "not TOML": ("reach_m = 75", "reach_m = ", ["is not TOML", "line 3", "reach_m ="]),
    "duplicate key": ("reach_m = 75", "reach_m = 75\nreach_m = 80", ["is not TOML", "line 4", "reach_m = 80"]),
    "duplicate group in conflicts": ('b = ["a"]', 'a = ["b"]', ["is not TOML", "line 20"]),
    "nan": ("reach_m = 75", "reach_m = nan", ["reach_m is not finite", "nan"]),
    "nan inside": ("capacity_veh = 4.5", "capacity_veh = nan", ["movements[2].capacity_veh", "nan"]),
    "infinity": ("startup_s = 2\n", "startup_s = -inf\n", ["startup_s is not finite", "-inf"]),
    "huge integer": ("reach_m = 75", "reach_m = 0x" + "f" * 9000, ["reach_m is too large", "36000 bits"]),
    "long integer": ("reach_m = 75", "reach_m = " + "9" * 5000, ["is not TOML"]),
    "deep nesting": ("reach_m = 75", "reach_m = " + "[" * 5000, ["nested"]),
    "unknown key": ("hold_s =", "holds =", ["unknown key", '"holds"', "hold_s, red_bound_s"]),
    "unknown key in a movement": ("lanes = 2", "lane = 2", ["unknown key", "movements[1].lane", "lanes, capacity_veh"]),
    "unknown key in a group": (
        "max_green_s = 60",
        "maximum_s = 60",
        ["unknown key", "groups[0].maximum_s", "max_green_s"],
    ),
    "unknown key in an approach": ('{ name = "B",', '{ name = "B", x = 1,', ["approaches[1].x", "name"]),
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
    "q15 without a network": (
        "reach_m = 75",
        'reach_m = 75\narithmetic = "q15"',
        ["forecast none has no arithmetic q15", '"lstm" or "nlstm"'],
    ),
    "q15 of a network that sees windows": (
        '"none"',
        '"ann"\narithmetic = "q15"',
        ["forecast ann has no arithmetic q15", '"lstm" or "nlstm"'],
    ),
    "learning without a network": (
        "reach_m = 75",
        "reach_m = 75\nlearning = true",
        ["forecast none does not learn on", "(true)", '"lstm" or "nlstm"'],
    ),
    "learning in whole numbers": (
        '"none"',
        '"lstm"\narithmetic = "q15"\nlearning = true',
        ["forecast lstm-q15 does not learn on", 'arithmetic = "float"'],
    ),
    "learning that nobody looks at": (
        '"none"',
        '"lstm"\nlearning = true',
        ["chooser naive looks at no forecast", "(true)", '"cumulative" or "rollout"'],
    ),
    "learning as a word": ("reach_m = 75", 'reach_m = 75\nlearning = "yes"', ["learning has the wrong type", '"yes"']),
    "unknown arithmetic": ("reach_m = 75", 'reach_m = 75\narithmetic = "q7"', ["arithmetic", '"q7"', "float, q15"]),
    "arithmetic in the forecast's name": ('"none"', '"lstm-q15"', ["forecast", '"lstm-q15"', "nlstm"]),
    "no free flow": ("reach_m = 75", 'reach_m = 75\ndischarge = "nolock"', ["free_flow_m_per_s", "0.0"]),
    "idle free flow": ("reach_m = 75", "reach_m = 75\nfree_flow_m_per_s = 10", ["free_flow_m_per_s", "10.0"]),
    "no reach": ("reach_m = 75", "reach_m = 0", ["reach_m is too small", "(0)", "at least 1"]),
    "no speed limit": ("speed_km_per_h = 40", "speed_km_per_h = 4", ["speed_km_per_h", "(4)", "5"]),
    "limit of an aeroplane": ("speed_km_per_h = 30", "speed_km_per_h = 201", ["speed_km_per_h", "(201)", "200"]),
    "no flow": ("saturation_veh_per_s = 0.4", "saturation_veh_per_s = 0", ["B.M", "(0.0)", "more than 0"]),
    "negative flow": ("saturation_veh_per_s = 0.5", "saturation_veh_per_s = -0.5", ["A.M", "(-0.5)", "more than 0"]),
    "flow below single precision": ("saturation_veh_per_s = 0.4", "saturation_veh_per_s = 1e-60", ["B.M", "(0.0)"]),
    "negative capacity": ("capacity_veh = 4.5", "capacity_veh = -1", ["capacity_veh", "(-1)", "at least 0"]),
    "gives way to nobody known": (
        "lanes = 2",
        'lanes = 2\ngives_way = ["X"]',
        ["gives_way of movement A.R", '"X"', "A.M"],
    ),
    "gives way to itself": ("lanes = 2", 'lanes = 2\ngives_way = ["A.R"]', ["gives_way of movement A.R names itself"]),
    "gives way to one on red": (
        "lanes = 2",
        'lanes = 2\ngives_way = ["B.M"]',
        ["gives_way of movement A.R names B.M", "never goes with it", "some stage"],
    ),
    "gives way twice": ("lanes = 2", 'lanes = 2\ngives_way = ["A.M", "A.M"]', ["movements[1].gives_way", "twice"]),
    "share of nobody": ("lanes = 2", "lanes = 2\ngives_way_share = 0.5", ["gives_way_share of movement A.R", "(0.5)"]),
    "share of none": (
        "lanes = 2",
        'lanes = 2\ngives_way = ["A.M"]\ngives_way_share = 0',
        ["gives_way_share of movement A.R", "(0.0)", "0.01 to 1.0"],
    ),
    "share too fine": (
        "lanes = 2",
        'lanes = 2\ngives_way = ["A.M"]\ngives_way_share = 0.255',
        ["gives_way_share of movement A.R is finer", "0.255", "hundredth"],
    ),
    "more than all": (
        "lanes = 2",
        'lanes = 2\ngives_way = ["A.M"]\ngives_way_share = 1.1',
        ["movements[1].gives_way_share is too large", "1.1"],
    ),
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
    "approach twice": ('{ name = "B",', '{ name = "A",', ["approaches[1].name is taken", '"A"']),
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
    "stage empty": ('["a", "c"]]', "[]]", ["stages[1] is empty", "[]"]),
    "no bound on red": ("red_bound_s = 90\n", "", ["red_bound_s of a street is missing", "(0.0)", "41.1 s to 600.0 s"]),
    "bound on red 0": ("red_bound_s = 90", "red_bound_s = 0", ["red_bound_s of a street is missing", "13.7 s"]),
    "bound on red short": (
        "red_bound_s = 90",
        "red_bound_s = 41.0",
        ["cannot be kept", "(41.0)", "41.1 s", "2 stages"],
    ),
    "bound on red long": ("red_bound_s = 90", "red_bound_s = 600.1", ["red_bound_s is too large", "at most 600"]),
    "bound on red too fine": ("red_bound_s = 90", "red_bound_s = 90.05", ["red_bound_s is finer", "90.05"]),
    "start flash long": ("start_flash_s = 12.5", "start_flash_s = 601", ["start_flash_s is too large", "(601)"]),
    "start red negative": ("start_red_s = 4", "start_red_s = -1", ["start_red_s is too small", "(-1)"]),
    "wait for the junction long": (
        "junction_wait_ds = 15",
        "junction_wait_ds = 101",
        ["junction_wait_ds is too large", "(101)", "at most 100"],
    ),
    "wait for the junction in parts": (
        "junction_wait_ds = 15",
        "junction_wait_ds = 1.5",
        ["junction_wait_ds", "1.5"],
    ),
    "first stage of nobody": (
        'first_stage = ["c", "a"]',
        'first_stage = ["d"]',
        ["first_stage: group", '"d"', "a, b, c"],
    ),
    "first stage not maximal": (
        'first_stage = ["c", "a"]',
        'first_stage = ["a"]',
        ["no stage", '["a"]', "example a c"],
    ),
    "first stage conflicting": (
        'first_stage = ["c", "a"]',
        'first_stage = ["a", "b", "c"]',
        ["first_stage is no stage", '["a", "b", "c"]', "for example b c"],
    ),
    "first stage empty": ('first_stage = ["c", "a"]', "first_stage = []", ["first_stage is no stage", "[]"]),
    "camera at no approach": ('cameras = ["B"]', 'cameras = ["C"]', ["cameras: approach", '"C"', "A, B"]),
    "camera twice": ('cameras = ["B"]', 'cameras = ["B", "B"]', ["cameras", "twice"]),
    "unknown detector key": ("erratic_per_min", "erratic", ["detectors.erratic", "no_activity_min, max_presence_min"]),
    "no activity long": ("no_activity_min = 31", "no_activity_min = 256", ["detectors.no_activity_min", "at most 255"]),
    "presence of half minutes": ("= 62", "= 62.5", ["detectors.max_presence_min", "62.5", "an integer"]),
    "erratic negative": ("= 93", "= -1", ["detectors.erratic_per_min is too small", "(-1)"]),
    "no max green": ("max_green_s = 50\n", "", ["max_green_s of group b is missing", "(0)", "6.0 s or more"]),
    "max green 0": ("max_green_s = 50", "max_green_s = 0", ["max_green_s of group b is missing", "(0)"]),
    "no such node": ("node = 7", "node = 8", ["groups[1].node is too large", "(8)", "at most 7"]),
    "unknown flash": ('"dark"', '"green"', ["groups[2].flash", '"green"', "amber, red, dark"]),
    "four movements of an approach": (
        'name = "B.M"\n',
        "".join(f'name = "{name}"\napproach = "A"\ngroups = ["c"]\n[[movements]]\n' for name in "xy")
        + 'name = "B.M"\n',
        ["approach A has too many movements", "(4)", "at most 3"],
    ),
    "programme twice": ('name = "late"', 'name = "day"', ["programs[1].name is taken", '"day"', "every name once"]),
    "programme called flash": (
        'name = "late"',
        'name = "flash"',
        ["programs[1].name is taken", '"flash"', "not flash"],
    ),
    "programme without a name": ('name = "late"', 'name = ""', ["programs[1].name is not a name", '""']),
    "programme with end of line": ('name = "late"', 'name = "l\\n"', ["programs[1].name is not a name", "l\\n"]),
    "programme without steps": (
        'steps = [{ stage = ["c", "a"], green_s = 20 }, { stage = ["b", "c"], green_s = 6.5 }]',
        "steps = []",
        ["programs[0].steps has 0 entries", "at least 1"],
    ),
    "unknown key in a programme": (
        'name = "late"',
        'name = "late"\ncycle_s = 60',
        ["programs[1].cycle_s", "name, steps"],
    ),
    "unknown key in a step": ("green_s = 20", "time_s = 20", ["programs[0].steps[0].time_s", "stage, green_s"]),
    "step of nobody": ('["c", "a"], green', '["d"], green', ["step 0 of programme day: group", '"d"', "a, b, c"]),
    "step without a stage": (
        '["c", "a"], green',
        '["a"], green',
        ["step 0 of programme day is no stage", '["a"]', "a c"],
    ),
    "step short": ("= 6.5", "= 5.9", ["green_s of step 1 of programme day", "group b", "(5.9)", "at least 6.0 s"]),
    "step too fine": ("= 6.5", "= 6.55", ["green_s of step 1 of programme day is finer", "6.55"]),
    "step long": ("= 6.5", "= 601", ["programs[0].steps[1].green_s is too large", "(601)"]),
    "movement left out": (
        '["b", "c"], green_s = 6.5',
        '["a", "c"], green_s = 6.5',
        ["programme day never serves movement B.M", "a step whose stage has b"],
    ),
    "unknown programme": (
        'program = "late"',
        'program = "noon"',
        ["schedule[0].program", '"noon"', "day, late, flash"],
    ),
    "unknown weekday": ('"Mon"', '"Mo"', ["schedule[0].weekdays[0]", '"Mo"', "Mon, Tue"]),
    "no weekday": ('["Mon", "Fri"]', "[]", ["schedule[0].weekdays has 0 entries", "at least 1"]),
    "weekday twice": ('["Mon", "Fri"]', '["Fri", "Fri"]', ["schedule[0].weekdays", "twice"]),
    "short hour": ('"06:30"', '"6:30"', ["schedule[0].from is no time of day", '"6:30"', "00:00 to 23:59"]),
    "24 hours": ('"06:30"', '"24:00"', ["schedule[0].from is no time of day", '"24:00"']),
    "60 minutes": ('"06:30"', '"06:60"', ["schedule[0].from is no time of day", '"06:60"']),
    "hour with end of line": ('"06:30"', '"06:30\\n"', ["schedule[0].from is no time of day", "06:30\\n"]),
    "hour without quotes": ('"06:30"', "06:30:00", ["schedule[0].from has the wrong type", "06:30:00", "a string"]),
    "two lines begin together": ('"22:00"', '"06:30"', ["schedule[1] begins with another", "on Fri", '"06:30"']),
    "no such day": ('"2026-12-25"', '"2026-02-30"', ["special_days[0].date is no date", '"2026-02-30"']),
    "day without dashes": ('"2026-12-25"', '"20261225"', ["special_days[0].date is no date", "YYYY-MM-DD"]),
    "day without quotes": ('"2026-12-25"', "2026-12-25", ["special_days[0].date has the wrong type", "a string"]),
    "day before the count": (
        '"2026-12-25"',
        '"1999-12-31"',
        ["out of range", '"1999-12-31"', "2000-01-01 to 2179-06-06"],
    ),
    "day after the count": ('"2026-12-25"', '"2179-06-07"', ["special_days[0].date is out of range", "2179-06-07"]),
    "day twice": ('"2027-01-01"', '"2026-12-25"', ["special_days[1].date is taken", '"2026-12-25"', "every date once"]),
    "day like no weekday": ('as = "Sun"', 'as = "holiday"', ["special_days[0].as", '"holiday"', "Sat, Sun"]),
    "table twice": ("[intergreen_ds]", "[conflicts]", ["is not TOML", "conflicts"]),
}


def write_site(folder: Path, text: str = GOOD, name: str = "cross.toml") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def changed(old: str, new: str) -> str:
    assert GOOD.count(old) == 1, f"{old!r} must occur once"
    return GOOD.replace(old, new)


def without(*headings: str) -> str:
    """GOOD without the tables and arrays of tables of these names."""
    return re.sub(rf"\n\[\[?({'|'.join(headings)})\]\]?\n(?:(?!\[).+\n)*", "", GOOD)


def cocktail(pairs: int, movements: str = "") -> str:
    """A site of conflicting pairs of groups that are otherwise compatible: 2 ** pairs stages.

    Without `movements` there is one for each group.
    """
    names = [f"{side}{pair}" for pair in range(pairs) for side in "xy"]
    other = {"x": "y", "y": "x"}
    conflicts = "\n".join(f'{name} = ["{other[name[0]]}{name[1:]}"]' for name in names)
    movements = movements or "\n".join(movement(i, name, [name]) for i, name in enumerate(names))
    groups = "\n".join(f'[[groups]]\nname = "{name}"\namber_s = 3\nmin_green_s = 5\nmax_green_s = 60' for name in names)
    head = GOOD[: GOOD.index("stages")].replace("= 90", "= 300") + "intergreen_ds = 50\n"
    approaches = "\n".join(f'[[approaches]]\nname = "{i}"' for i in range(movements.count("[[movements]]") // 3 + 1))
    return f"{head}\n{approaches}\n[conflicts]\n{conflicts}\n{movements}\n{groups}\n"


def movement(index: int, name: str, groups: list[str]) -> str:
    """One of the movements of a cocktail, three to an approach."""
    return f'[[movements]]\nname = "{name}"\napproach = "{index // 3}"\ngroups = {json.dumps(groups)}'


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
        "bound on red: 90.0 s, the shortest possible 41.1 s, kept with stages 0 1",
        "programme day: stage 1 20.0 s, stage 0 6.5 s",
        "programme late: stage 0 6.0 s, stage 1 8.0 s, stage 0 9.0 s",
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
        ("red_bound_s = 90", "red_bound_s = 41.1"),
        ("red_bound_s = 90", "red_bound_s = 600"),
        ("start_flash_s = 12.5", "start_flash_s = 600"),
        ("start_red_s = 4", "start_red_s = 0"),
        ('cameras = ["B"]', "cameras = []"),
        ("no_activity_min = 31", "no_activity_min = 255.0"),
        ("max_presence_min = 62", "max_presence_min = 0"),
        ("node = 7", "node = 0.0"),
        ("green_s = 6.5", "green_s = 6"),
        ("green_s = 6.5", "green_s = 600"),
        ('"06:30"', '"00:00"'),
        ('"06:30"', '"23:59"'),
        ('["Sun", "Fri"]\nfrom = "22:00"', '["Sun"]\nfrom = "06:30"'),
        ('"2026-12-25"', '"2000-01-01"'),
        ('"2026-12-25"', '"2179-06-06"'),
        ('"2026-12-25"', '"2028-02-29"'),
        ("{ a = 60 }", "{ a = 45 }"),
        ("capacity_veh = 4.5", "capacity_veh = 0"),
        ('name = "A.M"', 'name = "A.M12345678"'),
        ('"cross"', '"' + "x" * 23 + '"'),
        ("reach_m = 75", "reach_m = 75\nfree_flow_m_per_s = 0"),
        ("reach_m = 75", 'reach_m = 75\nsimulation_only = true\ndischarge = "nolock"\nfree_flow_m_per_s = 10'),
        ("reach_m = 75", 'reach_m = 75\narithmetic = "float"'),
        ("reach_m = 75", "reach_m = 75\nlearning = false"),
        ('stages = [["b", "c"], ["a", "c"]]', ""),
    ]:
        assert main([str(write_site(tmp_path, changed(old, new)))]) == 0, new


@pytest.mark.parametrize(
    ("forecast", "arithmetic", "code"), [("lstm", "float", 5), ("lstm", "q15", 9), ("nlstm", "q15", 10)]
)
def test_arithmetic_names_the_firmware_s_forecast(tmp_path: Path, forecast: str, arithmetic: str, code: int) -> None:
    text = GOOD.replace('"none"', f'"{forecast}"\narithmetic = "{arithmetic}"', 1)
    c_file, image = tmp_path / "site.c", tmp_path / "site.bin"
    assert main([str(write_site(tmp_path, text)), "--c", str(c_file), "--image", str(image)]) == 0
    suffix = "" if arithmetic == "float" else "_Q15"
    assert f".forecast = ELMOPP_FORECAST_{forecast.upper()}{suffix}," in c_file.read_text()
    assert image.read_bytes()[16 + site_model.SITE_NAME_SIZE + 7] == code


@pytest.mark.parametrize("forecast", ["lstm", "nlstm"])
@pytest.mark.parametrize("chooser", ["cumulative", "rollout"])
def test_a_site_that_learns_on_says_so_in_its_last_word(tmp_path: Path, chooser: str, forecast: str) -> None:
    text = GOOD.replace('"none"', f'"{forecast}"\nlearning = true', 1).replace('"naive"', f'"{chooser}"', 1)
    c_file, image = tmp_path / "site.c", tmp_path / "site.bin"
    assert main([str(write_site(tmp_path, text)), "--c", str(c_file), "--image", str(image)]) == 0
    assert ".learning = 1U," in c_file.read_text()
    assert image.read_bytes()[-4:] == bytes([1, 0, 0, 0])
    assert compile_and_dump(c_file, "elmopp_site_cross", tmp_path) == image.read_bytes()[16:]


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


def test_an_approach_has_its_own_limit_or_the_sites_or_none(tmp_path: Path) -> None:
    def limits(text: str) -> list[int]:
        return [movement.limit_km_per_h for movement in load_site(write_site(tmp_path, text))[0].movements]

    silent = GOOD.replace("speed_km_per_h = 40\n", "", 1)
    assert limits(GOOD) == [40, 40, 30]
    assert limits(silent) == [0, 0, 30]
    assert limits(silent.replace(", speed_km_per_h = 30", "", 1)) == [0, 0, 0]


def test_who_gives_way_is_said_by_name_and_share(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = changed("lanes = 2", 'lanes = 2\ngives_way = ["A.M"]\ngives_way_share = 0.29')
    path = write_site(tmp_path, text)
    junction = load_site(path)[0]
    assert [(item.gives_way, item.gives_way_percent) for item in junction.movements] == [(0, 0), (0b1, 29), (0, 0)]
    assert main([str(path)]) == 0
    assert "\nA.R gives way to A.M: 29 % of its vehicles\n" in capsys.readouterr().out
    alone = load_site(write_site(tmp_path, text.replace("\ngives_way_share = 0.29", "")))[0]
    assert alone.movements[1].gives_way_percent == 100
    silent = load_site(write_site(tmp_path))[0]
    assert all(item.gives_way == item.gives_way_percent == 0 for item in silent.movements)
    assert image_bytes(junction)[-100:-4] == struct.pack("<24I", 0, 0b1, *[0] * 22)


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


def test_promises_of_a_street_are_read(tmp_path: Path) -> None:
    site = load_site(write_site(tmp_path))[0]
    assert (site.red_bound_ds, site.start_flash_ds, site.start_red_ds) == (900, 125, 40)
    assert (site.first_stage, site.cameras, site.junction_wait_ds) == (1, 0b10, 15)
    assert (site.no_activity_min, site.max_presence_min, site.erratic_per_min) == (31, 62, 93)
    assert [(group.node, group.flash) for group in site.groups] == [(0, "amber"), (7, "red"), (0, "dark")]
    assert site.rescue_stages == (1, 1, 0)
    assert (site.change_ds(), site.red_bound_min_ds()) == (137, 411)


def test_programmes_and_their_hours_are_read(tmp_path: Path) -> None:
    site = load_site(write_site(tmp_path))[0]
    steps = [(program.name, [(step.stage, step.green_ds) for step in program.steps]) for program in site.programs]
    assert steps == [("day", [(1, 200), (0, 65)]), ("late", [(0, 60), (1, 80), (0, 90)])]
    lines = [(line.from_min, line.weekdays, line.program) for line in site.schedule]
    assert lines == [(390, 0b0010001, 1), (1320, 0b1010000, 255)]
    days_of_26_years = 26 * 365 + 7  # 2000, 2004, ... 2024 are leap years
    assert [(day.day, day.weekday) for day in site.special_days] == [
        (days_of_26_years + 358, 6),
        (days_of_26_years + 365, 5),
    ]


def test_what_a_street_does_not_say_has_a_default(tmp_path: Path) -> None:
    text = re.sub(
        r"(start_flash_s|start_red_s|first_stage|cameras|junction_wait_ds) = .*\n",
        "",
        without("detectors", "schedule", "special_days"),
    )
    site = load_site(write_site(tmp_path, text))[0]
    assert (site.start_flash_ds, site.start_red_ds, site.first_stage, site.cameras) == (100, 60, 0, 0b11)
    assert (site.no_activity_min, site.max_presence_min, site.erratic_per_min) == (0, 0, 0)
    assert (site.junction_wait_ds, site.change_ds()) == (0, 122)
    assert (site.schedule, site.special_days) == ((), ())


def test_a_street_without_programmes_gets_its_rescue_stages_as_one(tmp_path: Path) -> None:
    text = without("programs", "schedule").replace("min_green_s = 6\n", "min_green_s = 21.5\n")
    (program,) = load_site(write_site(tmp_path, text))[0].programs
    assert [(step.stage, step.green_ds) for step in program.steps] == [(0, 215), (1, 150)]
    scheduled = text + '[[schedule]]\nweekdays = ["Sun"]\nfrom = "01:00"\nprogram = "default"\n'
    assert load_site(write_site(tmp_path, scheduled))[0].schedule[0].program == 0


def test_a_simulation_has_no_promises_unless_it_asks(tmp_path: Path) -> None:
    text = without("programs", "schedule", "special_days").replace("red_bound_s = 90", "simulation_only = true")
    text = re.sub(r"(start_flash_s|start_red_s) = .*\n", "", text)
    site = load_site(write_site(tmp_path, text.replace("max_green_s = 50\n", "")))[0]
    assert (site.red_bound_ds, site.start_flash_ds, site.start_red_ds, site.programs) == (0, 0, 0, ())
    assert site.rescue_stages == (1, 1, 0)
    asking = load_site(write_site(tmp_path, changed("red_bound_s = 90", "red_bound_s = 90\nsimulation_only = true")))[0]
    assert (asking.red_bound_ds, asking.start_flash_ds, len(asking.programs)) == (900, 125, 2)


def test_a_simulation_keeps_a_bound_that_it_sets(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = changed("red_bound_s = 90", "red_bound_s = 41.0\nsimulation_only = true")
    assert "red_bound_s cannot be kept" in refusal(capsys, write_site(tmp_path, text))


def test_the_papers_site_promises_nothing() -> None:
    site = load_site(ROOT / "sites" / "paper.toml")[0]
    assert (site.red_bound_ds, site.start_flash_ds, site.start_red_ds) == (0, 0, 0)
    assert (site.programs, site.schedule, site.special_days) == ((), (), ())


def test_tables_of_hours_are_tried_on_both_sides(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    steps = '{{ stage = ["a", "c"], green_s = 5 }}, {{ stage = ["b", "c"], green_s = 6 }}'
    program = f'[[programs]]\nname = "p{{}}"\nsteps = [{steps}]\n'
    line = '[[schedule]]\nweekdays = ["Sat"]\nfrom = "{:02}:00"\nprogram = "flash"\n'
    day = '[[special_days]]\ndate = "2026-01-{:02}"\nas = "Sun"\n'
    for text, room, message in [
        (program, 2, "too many programs (5) ; ELMOPP_PROGRAM_MAX is 4"),
        (line, 14, "too many lines in schedule (17) ; ELMOPP_SCHEDULE_MAX is 16"),
        (day, 14, "too many special_days (17) ; ELMOPP_SPECIAL_DAY_MAX is 16"),
    ]:
        rows = [text.format(index + 1) for index in range(room + 1)]
        assert main([str(write_site(tmp_path, GOOD + "".join(rows[:-1])))]) == 0
        capsys.readouterr()
        assert message in refusal(capsys, write_site(tmp_path, GOOD + "".join(rows)))


def test_steps_of_a_programme_are_tried_on_both_sides(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    step = '{ stage = ["b", "c"], green_s = 6.5 }'
    assert main([str(write_site(tmp_path, changed(step, ", ".join([step] * 15))))]) == 0
    capsys.readouterr()
    line = refusal(capsys, write_site(tmp_path, changed(step, ", ".join([step] * 16))))
    assert "too many steps in programme day (17) ; ELMOPP_STEP_MAX is 16" in line


def test_a_street_that_no_programme_can_serve_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Movements that need one group of each pair have a stage of their own each."""
    sides = [[f"{'xy'[stage >> pair & 1]}{pair}" for pair in range(5)] for stage in range(32)]
    movements = [movement(index, f"m{index}", groups) for index, groups in enumerate(sides[:15] + sides[-2:])]
    assert main([str(write_site(tmp_path, cocktail(5, "\n".join(movements[1:]))))]) == 0
    assert "programme default: stage 1 15.0 s" in capsys.readouterr().out
    line = refusal(capsys, write_site(tmp_path, cocktail(5, "\n".join(movements))))
    assert "too many stages for a programme that serves all movements (17) ; ELMOPP_STEP_MAX is 16" in line


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
    wide = changed('[{ name = "A" }, { name = "B", speed_km_per_h = 30 }]', approaches)
    assert "too many approaches (9) ; ELMOPP_APPROACH_MAX is 8" in refusal(capsys, write_site(tmp_path, wide))


def test_bounds_and_codes_are_those_of_the_headers() -> None:
    bounds = (INCLUDE / "elmopp" / "bounds.h").read_text()
    names = ["APPROACH_MAX", "MOVEMENT_MAX", "GROUP_MAX", "STAGE_MAX", "SITE_NAME_SIZE", "NAME_SIZE"]
    names += ["APPROACH_MOVEMENT_MAX", "NODE_MAX", "PROGRAM_MAX", "STEP_MAX", "SCHEDULE_MAX", "SPECIAL_DAY_MAX"]
    for name in names:
        found = re.search(rf"#define ELMOPP_{name} (\d+)U", bounds)
        assert found is not None
        assert int(found[1]) == getattr(site_model, name)
    junction = (INCLUDE / "elmopp" / "junction.h").read_text()
    properties = json.loads(SCHEMA_PATH.read_text())["properties"]
    assert f"ELMOPP_SCHEDULE_FLASH = {site_model.SCHEDULE_FLASH} " in junction
    group = properties["groups"]["items"]["properties"]
    assert group["node"]["maximum"] == site_model.NODE_MAX - 1
    assert json.loads(SCHEMA_PATH.read_text())["$defs"]["weekday"]["enum"] == list(site_model.WEEKDAYS)
    flashes = re.findall(r" ELMOPP_FLASH_(\w+) = (\d+)", junction)
    assert [name.lower() for name, _ in sorted(flashes, key=lambda item: int(item[1]))] == group["flash"]["enum"]
    assert group["flash"]["enum"] == list(site_model.FLASHES)
    for key in ["discharge", "chooser", "forecast"]:
        codes = re.findall(rf"ELMOPP_{key.upper()}_(\w+) = (\d+)", junction)
        words = [name for name, code in sorted(codes, key=lambda item: int(item[1])) if name != "COUNT"]
        names = [word.lower().replace("_", "-") for word in words]
        assert names == list(getattr(site_model, f"{key.upper()}S"))
        # A forecast in whole numbers is the site's forecast and its arithmetic.
        assert properties[key]["enum"] == [name for name in names if not name.endswith("-q15")]


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
    assert (magic, version, length) == (b"ELMS", VERSION, STRUCT_SIZE)
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
