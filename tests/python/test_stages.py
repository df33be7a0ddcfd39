# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""Stages and conflicts of the sites in the repository, against derivations of their own."""

from __future__ import annotations

import random
from itertools import combinations
from pathlib import Path

import pytest
from elmopp_tools.site import load_site
from elmopp_tools.site_model import Junction
from elmopp_tools.stages import addable_group, conflict_pair, enumerate_stages, smallest_cover

SITES = Path(__file__).resolve().parents[2] / "sites"

PAPER_STAGES = [
    ["N.L", "S.L"],
    ["N.M", "N.R", "S.M", "S.R"],
    ["E.L", "W.L"],
    ["E.M", "E.R", "W.M", "W.R"],
    ["N.L", "N.M", "N.R"],
    ["E.L", "E.M", "E.R"],
    ["S.L", "S.M", "S.R"],
    ["W.L", "W.M", "W.R"],
]

# Masks in the order of the generated files; a change here changes what every recorded run means.
PINNED_STAGES = {
    "paper": [0x041, 0x186, 0x208, 0xC30, 0x007, 0x038, 0x1C0, 0xE00],
    "four_way": [
        *[0x027, 0x126, 0x12C, 0x138, 0x186, 0x30C, 0x825, 0x861, 0x924],
        *[0x930, 0x960, 0x984, 0x9C0, 0xB04, 0xC24, 0xC30, 0xE04],
    ],
    "three_way": [0x0B, 0x2A, 0x2C, 0x32],
    "five_way": [0x007, 0x018, 0x020, 0x041, 0x110, 0x186, 0x1C0, 0x20C, 0x304, 0x410, 0x604],
    "one_way": [0x1, 0x2],
    "left_lanes": [0x06, 0x09, 0x12, 0x24, 0x30],
    "shared_lanes": [0x5, 0xA],
}

# Arms clockwise, and for each group of the site its ways from arm to arm. Traffic keeps to the right.
ARMS = {
    "four_way": "N E S W",
    "three_way": "E S W",
    "five_way": "N E SE S W",
    "one_way": "N E S W",
    "left_lanes": "N E S W",
    "shared_lanes": "N E S W",
}
# Groups whose left turns give way to each other's traffic: their paths cross and they are green together.
PERMISSIVE = {"left_lanes": [{"N", "S"}], "shared_lanes": [{"N", "S"}, {"E", "W"}]}
WAYS = {
    "four_way": """N.L: N>E  N.M: N>S  N.R: N>W  E.L: E>S  E.M: E>W  E.R: E>N
                   S.L: S>W  S.M: S>N  S.R: S>E  W.L: W>N  W.M: W>E  W.R: W>S""",
    "three_way": "E.L: E>S  E.M: E>W  S.L: S>W  S.R: S>E  W.M: W>E  W.R: W>S",
    "five_way": """N.L: N>E N>SE  N.M: N>S  N.R: N>W  E.L: E>SE E>S  E.T: E>W E>N  SE: SE>S SE>W SE>N SE>E
                   S.L: S>W  S.M: S>N  S.R: S>E S>SE  W.L: W>N  W.T: W>E W>SE W>S""",
    "one_way": "N: N>S N>E  W: W>E W>S",
    "left_lanes": """N: N>E N>S N>W  E.L: E>S  E.T: E>W E>N  S: S>W S>N S>E  W.L: W>N  W.T: W>E W>S""",
    "shared_lanes": "N: N>E N>S N>W  E: E>S E>W E>N  S: S>W S>N S>E  W: W>N W>E W>S",
}


def site(name: str) -> Junction:
    return load_site(SITES / f"{name}.toml")[0]


def brute_force(conflict: list[int]) -> list[int]:
    """All maximal compatible sets, by trying every subset."""
    size = len(conflict)

    def compatible(subset: int) -> bool:
        return all(not (subset >> group & 1 and subset & conflict[group]) for group in range(size))

    good = {subset for subset in range(1, 1 << size) if compatible(subset)}
    return sorted(s for s in good if not any(s | 1 << g in good for g in range(size) if not s >> g & 1))


def random_conflicts(generator: random.Random, size: int, share: float) -> list[int]:
    conflict = [0] * size
    for first, second in combinations(range(size), 2):
        if generator.random() < share:
            conflict[first] |= 1 << second
            conflict[second] |= 1 << first
    return conflict


def ways_of(name: str) -> dict[str, list[tuple[str, str]]]:
    """For each group its ways as (from, to)."""
    ways: dict[str, list[tuple[str, str]]] = {}
    for word in WAYS[name].split():
        if word.endswith(":"):
            current = ways.setdefault(word[:-1], [])
        else:
            entry, _, exit_ = word.partition(">")
            current.append((entry, exit_))
    return ways


def paths_meet(arms: list[str], first: tuple[str, str], second: tuple[str, str]) -> bool:
    """Whether two ways cross or merge. Clockwise round the junction every arm has its entry, then its exit."""
    if first[0] == second[0]:
        return False
    if first[1] == second[1]:
        return True
    low, high = sorted((2 * arms.index(first[0]), 2 * arms.index(first[1]) + 1))
    entry, exit_ = 2 * arms.index(second[0]), 2 * arms.index(second[1]) + 1
    return (low < entry < high) != (low < exit_ < high)


def geometric_conflicts(name: str) -> dict[str, set[str]]:
    arms, ways = ARMS[name].split(), ways_of(name)
    return {
        group: {
            other
            for other in ways
            if any(paths_meet(arms, a, b) for a in ways[group] for b in ways[other])
            and {group, other} not in PERMISSIVE.get(name, [])
        }
        for group in ways
    }


@pytest.mark.parametrize("name", PINNED_STAGES)
def test_stages_of_the_sites_are_pinned(name: str) -> None:
    assert list(site(name).stages) == PINNED_STAGES[name]


@pytest.mark.parametrize("name", PINNED_STAGES)
def test_stages_of_the_sites_are_all_that_a_brute_force_finds(name: str) -> None:
    junction = site(name)
    assert sorted(junction.stages) == brute_force(list(junction.conflict))


def test_every_site_in_the_repository_is_pinned() -> None:
    assert {path.stem for path in SITES.glob("*.toml")} == set(PINNED_STAGES)


def test_enumeration_is_the_brute_force_on_random_conflicts() -> None:
    generator = random.Random(20260131)
    for trial in range(400):
        size = 1 + trial % 12
        conflict = random_conflicts(generator, size, generator.choice([0.1, 0.3, 0.5, 0.7, 0.9]))
        assert enumerate_stages(conflict) == brute_force(conflict)


def test_enumeration_has_one_stage_without_conflicts_and_one_per_group_with_all() -> None:
    assert enumerate_stages([]) == []
    assert enumerate_stages([0] * 5) == [0b11111]
    assert enumerate_stages([0b1111 ^ 1 << group for group in range(4)]) == [1, 2, 4, 8]


def test_enumeration_of_sixteen_groups_in_conflicting_triples() -> None:
    conflict = [(0b111 << group // 3 * 3) & 0xFFFF & ~(1 << group) for group in range(16)]
    stages = enumerate_stages(conflict)
    assert len(stages) == len(set(stages)) == 3**5
    assert all(conflict_pair(conflict, stage) is None and addable_group(conflict, stage) is None for stage in stages)


def test_conflict_pair_and_addable_group_name_the_lowest() -> None:
    conflict = [0b0010, 0b0101, 0b0010, 0b0000]
    assert conflict_pair(conflict, 0b0111) == (0, 1)
    assert conflict_pair(conflict, 0b1101) is None
    assert addable_group(conflict, 0b1001) == 2
    assert addable_group(conflict, 0b1101) is None


def test_paper_site_has_the_eight_configurations_in_order() -> None:
    junction = site("paper")
    assert [junction.group_names(stage) for stage in junction.stages] == PAPER_STAGES
    assert junction.simulation_only


def test_paper_movements_are_compatible_exactly_if_they_share_a_configuration() -> None:
    junction = site("paper")
    names = [group.name for group in junction.groups]
    conflicting = 0
    for first, second in combinations(range(len(names)), 2):
        share = any(names[first] in stage and names[second] in stage for stage in PAPER_STAGES)
        assert share != bool(junction.conflict[first] >> second & 1), (names[first], names[second])
        conflicting += not share
    assert conflicting == junction.conflict_count() == 44


def test_paper_movements_have_the_index_of_the_paper() -> None:
    junction = site("paper")
    names = [f"{approach}.{turn}" for approach in "NESW" for turn in "LMR"]
    assert [movement.name for movement in junction.movements] == names
    assert [movement.approach for movement in junction.movements] == [index // 3 for index in range(12)]
    assert [movement.groups for movement in junction.movements] == [1 << index for index in range(12)]


@pytest.mark.parametrize("name", WAYS)
def test_street_sites_conflict_where_paths_cross_or_merge(name: str) -> None:
    junction = site(name)
    written = {
        group.name: set(junction.group_names(junction.conflict[index])) for index, group in enumerate(junction.groups)
    }
    assert written == geometric_conflicts(name)
    assert not junction.simulation_only


@pytest.mark.parametrize("name", WAYS)
def test_street_sites_have_intergreens_between_amber_and_ten_seconds(name: str) -> None:
    junction = site(name)
    for end, row in enumerate(junction.intergreen_ds):
        for start, time_ds in enumerate(row):
            assert (50 <= time_ds <= 100) if junction.conflict[end] >> start & 1 else time_ds == 0


def brute_force_cover(sets: list[int], needed: int) -> tuple[int, ...]:
    """The first of the smallest covers, by trying all choices in order."""
    for count in range(len(sets) + 1):
        for chosen in combinations(range(len(sets)), count):
            if all(any(sets[index] >> bit & 1 for index in chosen) for bit in range(24) if needed >> bit & 1):
                return chosen
    raise AssertionError("no cover")


def test_smallest_cover_is_that_of_a_brute_force() -> None:
    draw = random.Random(7)
    for _ in range(400):
        bits = draw.randint(1, 12)
        density = draw.choice([0.15, 0.3, 0.5])
        sets = [sum((draw.random() < density) << bit for bit in range(bits)) for _ in range(draw.randint(1, 10))]
        needed = draw.getrandbits(bits)
        union = 0
        for held in sets:
            union |= held
        assert smallest_cover(sets, needed & union) == brute_force_cover(sets, needed & union)


def test_smallest_cover_of_nothing_is_empty() -> None:
    assert smallest_cover([], 0) == ()
    assert smallest_cover([5, 3], 0) == ()


def test_smallest_cover_prefers_the_first_in_order() -> None:
    assert smallest_cover([0b0011, 0b1100, 0b0110, 0b1001], 0b1111) == (0, 1)
    assert smallest_cover([0b0110, 0b0011, 0b1001, 0b1100], 0b1111) == (0, 2)
    assert smallest_cover([0b0001, 0b0111, 0b1000, 0b1110, 0b0001], 0b1111) == (0, 3)


def test_smallest_cover_of_the_most_stages_and_movements_ends() -> None:
    """24 movements with a stage of their own among 32: trying every choice would not."""
    sets = [1 << index % 24 for index in range(32)]
    assert smallest_cover(sets, (1 << 24) - 1) == tuple(range(24))


@pytest.mark.parametrize("name", PINNED_STAGES)
def test_rescue_stages_serve_everybody_with_as_few_as_possible(name: str) -> None:
    junction = site(name)
    needed = [movement.groups for movement in junction.movements]
    for groups, stage in zip(needed, junction.rescue_stages, strict=True):
        assert junction.stages[stage] & groups == groups
    used = sorted(set(junction.rescue_stages))
    served = [sum((stage & groups == groups) << j for j, groups in enumerate(needed)) for stage in junction.stages]
    assert tuple(used) == brute_force_cover(served, (1 << len(needed)) - 1)
    for j, stage in enumerate(junction.rescue_stages):
        assert stage == min(index for index in used if served[index] >> j & 1)


# What each street can promise, by hand: a change takes 5 s of green, the longest intergreen and 0.2 s.
LEAST_BOUNDS_DS = {
    "four_way": (1 + 4) * (50 + 70 + 2),
    "three_way": (1 + 3) * (50 + 70 + 2),
    "five_way": (1 + 5) * (50 + 100 + 2),
    "one_way": (1 + 2) * (50 + 50 + 2),
    "left_lanes": (1 + 3) * (50 + 70 + 2),
    "shared_lanes": (1 + 2) * (50 + 70 + 2),
}


@pytest.mark.parametrize("name", LEAST_BOUNDS_DS)
def test_streets_promise_two_minutes_and_can_keep_it(name: str) -> None:
    assert site(name).red_bound_min_ds() == LEAST_BOUNDS_DS[name]
    assert LEAST_BOUNDS_DS[name] <= site(name).red_bound_ds == 1200
