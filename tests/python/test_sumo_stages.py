# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The stages that a SUMO programme leaves out: by hand, and against a search through all sets of links."""

from itertools import combinations
from random import Random

import pytest
from elmopp_tools.sumo_signal import Phase, Programme, Signal, Times, junction_of, read_signal
from elmopp_tools.sumo_stages import more_stages, streams_of

TIMES = Times(yellow_s=3, all_red_s=2, min_green_s=5, max_green_s=60, red_bound_s=0)

# Of each arm, N E S W clockwise, a lane for straight on and right (links 0 1, 3 4, 6 7, 9 10) and one to the left.
ARMS = "NESW"
LANES = tuple(((arm, f"{arm}_{lane}"),) for arm in ARMS for lane in (0, 0, 1))
STRAIGHT, RIGHT, LEFT = ([3 * arm + at for arm in range(4)] for at in (0, 1, 2))


def _foes() -> frozenset[tuple[int, int]]:
    """Who crosses whom in right-hand traffic; those into the same arm only where they cross before."""
    pairs = set()
    for arm in range(4):
        opposite, from_left, from_right = (arm + 2) % 4, (arm + 1) % 4, (arm + 3) % 4
        pairs |= {(STRAIGHT[arm], STRAIGHT[side]) for side in (from_left, from_right)}
        pairs |= {(LEFT[arm], STRAIGHT[opposite]), (LEFT[arm], LEFT[from_left]), (LEFT[arm], LEFT[from_right])}
        pairs |= {(LEFT[arm], STRAIGHT[from_left]), (LEFT[arm], STRAIGHT[from_right])}
        pairs |= {(LEFT[arm], RIGHT[opposite]), (RIGHT[arm], STRAIGHT[from_left])}
    return frozenset(pairs | {(b, a) for a, b in pairs})


FOES = _foes()
PHASES = ("GGrrrrGGrrrr", "rrGrrrrrGrrr", "rrrGGrrrrGGr", "rrrrrGrrrrrG")


def signal_of(*states: str, places: tuple[str, ...] = ("J",) * 12, foes: frozenset[tuple[int, int]] = FOES) -> Signal:
    phases = tuple(Phase(state, 30.0) for state in states)
    return read_signal(Programme("J", phases, LANES, foes, places), complete=True)


def test_each_arm_alone_is_a_stage_of_a_protected_cross() -> None:
    signal = signal_of(*PHASES)
    assert signal.states[:4] == PHASES
    assert set(signal.states[4:]) == {"GGGrrrrrrrrr", "rrrGGGrrrrrr", "rrrrrrGGGrrr", "rrrrrrrrrGGG"}
    assert sorted(signal.group_links) == [(0, 1), (2,), (3, 4), (5,), (6, 7), (8,), (9, 10), (11,)]
    site = junction_of(signal, TIMES, 100.0)
    assert site.stages == signal.stages


def test_what_the_programme_has_is_not_added() -> None:
    arms = ("GGGrrrrrrrrr", "rrrGGGrrrrrr", "rrrrrrGGGrrr", "rrrrrrrrrGGG")
    assert signal_of(*PHASES, *arms).states == PHASES + arms


def test_a_part_of_a_phase_is_no_stage() -> None:
    """With both lanes of an arm in every phase there is nothing to add but what lets other arms go together."""
    assert set(signal_of("GGGrrrrrrrrr", "rrrGGGrrrrrr", "rrrrrrGGGrrr", "rrrrrrrrrGGG").states[4:]) == {
        PHASES[0], PHASES[1], PHASES[2], PHASES[3],
    }  # fmt: skip


def test_who_gives_way_in_some_phase_stays_as_he_is() -> None:
    permissive = ("GGgrrrGGgrrr", *PHASES)
    signal = signal_of(*permissive)
    assert signal.states[5:] == ("rrrGGGrrrrrr", "rrrrrrrrrGGG")
    assert [links for links in signal.group_links if 2 in links] == [(2, 8)]


def test_a_lane_is_not_taken_apart() -> None:
    """Where straight on and left share a lane they are one stream, which crosses the one from the other side."""
    shared = tuple(((arm, f"{arm}_0"),) for arm in ARMS for _ in range(3))
    assert streams_of(range(12), shared) == [frozenset(range(at, at + 3)) for at in (0, 3, 6, 9)]
    added = more_stages(["GGGrrrrrrrrr", "rrrrrrGGGrrr"], range(12), shared, FOES, ["J"] * 12)
    assert set(added) == {"rrrGGGrrrrrr", "rrrrrrrrrGGG"}


def test_links_without_a_group_stay_as_they_are() -> None:
    """Link 3 is green in all phases and gives way in one; link 4 is green in none."""
    lanes = [((edge, f"{edge}_0"),) for edge in "ABCDE"]
    added = more_stages(["GrrGr", "rGrgr", "rrGGr"], [0, 1, 2], lanes, frozenset({(0, 1), (1, 0)}), ["J"] * 5)
    assert sorted(added) == ["GrGgr", "rGGgr"]


@pytest.mark.parametrize("places", [(), ("J",) * 11, ("",) * 12, ("J",) * 11 + ("",), ("J",) * 6 + ("K",) * 6])
def test_signals_of_several_or_unknown_junctions_stay_as_they_are(places: tuple[str, ...]) -> None:
    assert signal_of(*PHASES, places=places).states == PHASES


def test_people_on_crossings_stay_as_they_are() -> None:
    lanes = (*LANES, ((":J_w0", ":J_w0_0"),))
    phases = (*(Phase(state + "r", 30.0) for state in PHASES), Phase("r" * 12 + "G", 30.0))
    signal = read_signal(Programme("J", phases, lanes, FOES, ("J",) * 13), complete=True)
    assert len(signal.states) == 9
    assert all(state[12] == "r" for state in signal.states[5:])


def test_too_many_stages_or_groups_are_none() -> None:
    """Five pairs of lanes, of each pair one at a time: 2^5 stages beside the programme's two."""
    lanes = [((f"A{at}", f"A{at}_0"),) for at in range(10)]
    foes = frozenset((a, b) for a in range(10) for b in range(10) if a != b and a // 2 == b // 2)
    states = ["Gr" * 5, "rG" * 5]
    assert len(more_stages(states, range(10), lanes, foes, ["J"] * 10)) == 30
    assert len(read_signal(Programme("J", tuple(Phase(s, 9.0) for s in states), tuple(lanes), foes, ("J",) * 10),
                           complete=True).states) == 32  # fmt: skip
    more = [*states, "rrrrrrrrGG"[:8] + "Gr"]
    signal = read_signal(
        Programme("J", tuple(Phase(s, 9.0) for s in more), tuple(lanes), foes, ("J",) * 10), complete=True
    )
    assert signal.states == tuple(more)


def test_groups_are_cut_where_stages_part_them() -> None:
    """Links 1 and 2 cross; 0 and 1 together is the stage that is added."""
    lanes = tuple(((edge, f"{edge}_0"),) for edge in "ABC")
    phases = (Phase("GrG", 30.0), Phase("rGr", 30.0))
    programme = Programme("J", phases, lanes, frozenset({(1, 2), (2, 1)}), ("J",) * 3)
    assert read_signal(programme).group_links == ((0, 2), (1,))
    signal = read_signal(programme, complete=True)
    assert signal.states == ("GrG", "rGr", "GGr")
    assert signal.group_links == ((0,), (1,), (2,))


def any_signal(random: Random) -> tuple[list[str], list[tuple[tuple[str, str]]], frozenset[tuple[int, int]]]:
    """Phases, lanes and who crosses whom, with links that give way and lanes that share; no phase lets foes have G."""
    count = random.randint(2, 9)
    lanes = [(("E", f"E_{random.randint(0, count)}"),) for _ in range(count)]
    pairs = {pair for pair in combinations(range(count), 2) if random.random() < 0.4}
    states = []
    for _ in range(random.randint(2, 5)):
        state = ["r"] * count
        for link in random.sample(range(count), count):
            free = all(tuple(sorted((link, other))) not in pairs or state[other] == "r" for other in range(count))
            if random.random() < 0.6:
                state[link] = "G" if free else random.choice("rrrg")
        states.append("".join(state))
    return states, lanes, frozenset(pairs | {(b, a) for a, b in pairs})


def test_what_is_added_is_safe_whole_new_and_all_there_is() -> None:
    """Against every set of links, 300 signals."""
    random = Random(71)
    found = 0
    for _ in range(300):
        states, lanes, foes = any_signal(random)
        count = len(lanes)
        added = more_stages(states, range(count), lanes, foes, ["J"] * count)
        sharing = {(a, b) for a in range(count) for b in range(count) if set(lanes[a]) & set(lanes[b])}
        yields = {link for link in range(count) if any(state[link] == "g" for state in states)}

        def is_whole(links: frozenset[int], sharing: set[tuple[int, int]] = sharing, count: int = count) -> bool:
            return not any((a, b) in sharing for a in links for b in range(count) if b not in links)

        sets = [frozenset(links) for size in range(1, count + 1) for links in combinations(range(count), size)]
        able = [
            links
            for links in sets
            if is_whole(links) and not links & yields and not any((a, b) in foes for a in links for b in links)
        ]
        largest = [links for links in able if not any(links < other for other in able)]
        new = [links for links in largest if not any(all(state[link] == "G" for link in links) for state in states)]
        assert {frozenset(link for link in range(count) if state[link] == "G") for state in added} == set(new)
        assert len(added) == len(new)
        assert all(set(state) <= {"G", "r"} for state in added)
        found += len(added)
    assert found > 200
