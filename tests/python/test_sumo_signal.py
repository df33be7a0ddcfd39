# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""SUMO's signals as junctions: on programmes written by hand, without SUMO."""

import pytest
from elmopp_tools.site_model import Junction
from elmopp_tools.sumo_own import own_programmes
from elmopp_tools.sumo_signal import (
    Phase,
    Programme,
    Signal,
    SignalError,
    Times,
    junction_of,
    letters,
    read_signal,
    transition,
)

TIMES = Times(yellow_s=3, all_red_s=2, min_green_s=5, max_green_s=60, red_bound_s=0)

# Links 0 N straight, 1 N left, 2 S straight, 3 S left, 4 E, 5 W. N has one lane for both, S a lane for each.
FOES = {(0, 3), (1, 2), (0, 4), (0, 5), (1, 4), (1, 5), (2, 4), (2, 5), (3, 4), (3, 5)}
LANES = (
    (("N", "N_0"),),
    (("N", "N_0"),),
    (("S", "S_0"),),
    (("S", "S_1"),),
    (("E", "E_0"),),
    (("W", "W_0"), ("W", "W_1")),
)


def programme(*states: str, lanes: tuple[tuple[tuple[str, str], ...], ...] = LANES) -> Programme:
    phases = tuple(Phase(state, 30.0) for state in states)
    return Programme("J", phases, lanes, frozenset(FOES | {(b, a) for a, b in FOES}))


CROSS = programme("GgGgrr", "yyyyrr", "rGrGrr", "ryryrr", "rrrrGG", "rrrryy")


def names(signal: Signal, mask: int) -> list[int]:
    return [link for group, links in enumerate(signal.group_links) if mask >> group & 1 for link in links]


def test_green_phases_are_the_stages_and_links_that_go_together_a_group() -> None:
    signal = read_signal(CROSS)
    assert signal.states == ("GgGgrr", "rGrGrr", "rrrrGG")
    assert signal.group_links == ((0, 2), (1, 3), (4, 5))
    assert signal.stages == (0b011, 0b010, 0b100)


def test_groups_conflict_that_cross_and_are_never_green_together() -> None:
    signal = read_signal(CROSS)
    assert signal.conflict == (0b100, 0b100, 0b011)


def test_a_lane_with_two_links_goes_when_both_go() -> None:
    signal = read_signal(CROSS)
    assert [(m.lanes, names(signal, m.groups)) for m in signal.movements] == [
        (("N_0",), [0, 2, 1, 3]),
        (("S_0",), [0, 2]),
        (("S_1",), [1, 3]),
        (("E_0",), [4, 5]),
        (("W_0", "W_1"), [4, 5]),
    ]
    assert signal.approaches == ((0,), (1, 2), (3,), (4,))


def test_a_lane_that_never_goes_as_a_whole_goes_when_most_of_it_does() -> None:
    signal = read_signal(programme("Grrrrr", "rGrrrr", "rrGGrr", "rrrrGG"))
    first = signal.movements[0]
    assert first.lanes == ("N_0",)
    assert names(signal, first.groups) == [0]
    junction_of(signal, TIMES, 100.0)


def test_the_site_has_the_times_and_the_stages() -> None:
    site = junction_of(read_signal(CROSS), TIMES, 75.0)
    assert site.stages == (0b011, 0b010, 0b100)
    assert site.intergreen_ds == ((0, 0, 50), (0, 0, 50), (50, 50, 0))
    assert [(g.amber_ds, g.min_green_ds, g.max_green_ds) for g in site.groups] == [(30, 50, 600)] * 3
    assert [m.lanes for m in site.movements] == [1, 1, 1, 1, 2]
    assert [m.saturation_veh_per_s for m in site.movements] == [0.5, 0.5, 0.5, 0.5, 1.0]
    assert [m.capacity_veh for m in site.movements] == [10.0, 10.0, 10.0, 10.0, 20.0]
    assert site.simulation_only


def right_of_way(site: Junction) -> dict[int, tuple[list[int], int]]:
    """Of each movement that gives way: to whom, and how many of a hundred."""
    return {
        index: ([at for at in range(len(site.movements)) if item.gives_way >> at & 1], item.gives_way_percent)
        for index, item in enumerate(site.movements)
        if item.gives_way
    }


def test_who_shows_g_gives_way_to_whom_he_crosses_with_g_in_capitals() -> None:
    """N has one lane for straight on and left, so half of its links give way to S; S's left turn does as a whole."""
    site = junction_of(read_signal(CROSS), TIMES, 75.0)
    assert right_of_way(site) == {0: ([1], 50), 2: ([0], 100)}


def test_a_turn_that_only_goes_by_itself_gives_way_to_nobody() -> None:
    lanes = tuple(((f"{'NNSSEW'[link]}", f"L{link}"),) for link in range(6))
    site = junction_of(read_signal(programme("GrGrrr", "rgrgrr", "rrrrGG", lanes=lanes)), TIMES, 75.0)
    assert right_of_way(site) == {}


def test_nobody_gives_way_to_people_on_a_crossing() -> None:
    lanes = ((("N", "N_0"),), ((":J_w0", ":J_w0_0"),), (("E", "E_0"),))
    phases = (Phase("gGr", 30.0), Phase("rrG", 30.0))
    foes = frozenset({(0, 1), (1, 0), (0, 2), (2, 0), (1, 2), (2, 1)})
    assert right_of_way(junction_of(read_signal(Programme("J", phases, lanes, foes)), TIMES, 75.0)) == {}


def test_two_greens_that_cross_are_refused() -> None:
    with pytest.raises(SignalError, match=r"signal J has conflicting greens in phase GGGgrr: links 1 and 2 cross"):
        read_signal(programme("GGGgrr", "rrrrGG"))


@pytest.mark.parametrize("states", [("rrrrrr",), ("yyyyyy", "rrrrrr"), ("GGyyrr",), ("OOOOOO",)])
def test_a_signal_without_a_green_phase_is_refused(states: tuple[str, ...]) -> None:
    with pytest.raises(SignalError, match=f"signal J has no green phase .{states[0]}"):
        read_signal(programme(*states))


def test_a_signal_with_too_many_groups_is_refused() -> None:
    count = 17
    states = ["r" * link + "G" + "r" * (count - link - 1) for link in range(count)]
    lanes = tuple(((f"E{link}", f"E{link}_0"),) for link in range(count))
    with pytest.raises(
        SignalError, match=r"signal J has 17 groups of links that go together; right would be at most 16"
    ):
        read_signal(programme(*states, lanes=lanes))


def test_the_same_green_twice_is_one_stage() -> None:
    signal = read_signal(programme("GgGgrr", "rrrrGG", "GgGgrr", "rrrrgg"))
    assert signal.states == ("GgGgrr", "rrrrGG")


def test_links_that_are_always_green_belong_to_no_group() -> None:
    signal = read_signal(programme("GgGrrg", "rrrgGg"))
    assert 5 not in [link for links in signal.group_links for link in links]
    assert [m.lanes for m in signal.movements] == [("N_0",), ("S_0",), ("S_1",), ("E_0",)]
    assert letters(signal, 0, 1, "4411")[5] == "g"


def test_a_signal_with_one_stage_is_always_green() -> None:
    signal = read_signal(programme("GrGrrr", "yryrrr"))
    assert signal.stages == (1,)
    assert letters(signal, 0, 0, "3") == "GrGrrr"
    junction_of(signal, TIMES, 100.0)


def test_letters_of_a_stage_are_sumos() -> None:
    signal = read_signal(CROSS)
    assert letters(signal, 0, 0, "331") == "GgGgrr"
    assert letters(signal, 1, 1, "131") == "rGrGrr"
    assert letters(signal, 2, 2, "113") == "rrrrGG"


def test_on_the_way_the_weaker_letter_holds() -> None:
    signal = read_signal(CROSS)
    assert letters(signal, 0, 1, "431") == "ygygrr", "a left turn still gives way to those who clear"
    assert letters(signal, 1, 0, "331") == "ggggrr", "who begins gives way until the stage is shown"
    assert letters(signal, 0, 2, "331") == "GgGgrr", "nobody has ended yet"
    assert letters(signal, 0, 2, "441") == "yyyyrr"
    assert letters(signal, 0, 2, "111") == "rrrrrr"


def test_transitions_follow_the_plans_rule() -> None:
    signal = read_signal(CROSS)
    assert transition(signal, 0, 2) == ("yyyyrr", "rrrrrr")
    assert transition(signal, 0, 1) == ("ygygrr", "rgrgrr")
    assert transition(signal, 1, 0) == ("ggggrr", "ggggrr")


def test_edges_share_approaches_where_there_are_too_many() -> None:
    count = 10
    lanes = tuple(((f"E{link}", f"E{link}_0"),) for link in range(count))
    phases = (Phase("G" * 5 + "r" * 5, 30.0), Phase("r" * 5 + "G" * 5, 30.0))
    signal = read_signal(Programme("J", phases, lanes, frozenset({(0, 5), (5, 0)})))
    assert [len(members) for members in signal.approaches] == [3, 3, 3, 1]
    junction_of(signal, TIMES, 100.0)


def test_sumos_own_programmes_have_the_same_times() -> None:
    text = own_programmes([read_signal(CROSS)], TIMES, "sumo-actuated").decode()
    assert 'type="actuated"' in text
    assert '<phase duration="30" state="GgGgrr" minDur="5" maxDur="60" />' in text
    assert '<phase duration="3" state="ygygrr" /><phase duration="30" state="rGrGrr"' in text, "nothing starts"
    assert '<phase duration="3" state="ryryrr" /><phase duration="2" state="rrrrrr" /><phase duration="30"' in text
    static = own_programmes([read_signal(CROSS)], TIMES, "static").decode()
    assert "minDur" not in static
