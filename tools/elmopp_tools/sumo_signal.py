# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""A signal of a SUMO network as a junction of ours: green phases become stages, link columns groups, lanes movements.

Pure: it reads no network and no simulation (sumo_network.py does). Words of SUMO: a *link* is a numbered place in a
signal's state, one letter each; a *phase* is such a state with a duration.

- A *stage* is the set of links that a green phase lets go. A green phase has a green letter and no amber one. On
  request the stages are completed (sumo_stages.py), as those of a site have to be.
- A *group* is the set of links that are green in the same stages. Links that are green in all are left green; links
  that are green in none stay as they are.
- Two groups *conflict* if some link of one crosses a link of the other and they are green together in no phase. A
  permissive turn (letter g, which gives way) is therefore compatible with what it crosses.
- A *movement* is the lanes of one edge that need the same groups. A lane that shares a straight and a turning link goes
  when all its links go; where no stage lets all of them go, when the most do that any stage lets.
- A movement *gives way* to another one that goes with it if one of its links shows g while a link of the other that it
  crosses or merges with shows G. The share of it that does is that of its links. People on crossings are left out:
  they are not a flow with gaps.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from elmopp_tools.site_build import build_junction
from elmopp_tools.site_model import (
    APPROACH_MAX,
    APPROACH_MOVEMENT_MAX,
    GROUP_MAX,
    MOVEMENT_MAX,
    STAGE_MAX,
    Junction,
    SiteError,
)
from elmopp_tools.site_rules import check_junction
from elmopp_tools.stages import bits_of
from elmopp_tools.sumo_stages import cross, more_stages

GREEN = "Gg"
AMBER = "yYu"
RED = "r"
SHOWN_AMBER = "y"

SATURATION_VEH_PER_S = 0.5  # a lane: 1800 vehicles an hour of green
STARTUP_S = 2


class SignalError(Exception):
    """Why a signal cannot be controlled, with the value, and what would be right."""


@dataclass(frozen=True)
class Times:
    """What holds for every controller, in whole seconds: amber, clearance after it, minimum and maximum green.

    The wait for an occupied junction lies in the plan: SUMO's own controllers do without.
    """

    yellow_s: int
    all_red_s: int
    min_green_s: int
    max_green_s: int
    red_bound_s: int
    junction_wait_s: int = 0


@dataclass(frozen=True)
class Phase:
    """One phase of SUMO's own programme."""

    state: str
    duration_s: float


@dataclass(frozen=True)
class Programme:
    """A signal as SUMO has it. `lanes[link]`: the incoming lanes behind that link, each (edge, lane).

    `foes`: pairs of links whose paths cross or merge, both ways round. `places[link]`: its junction, "" if unknown.
    """

    name: str
    phases: tuple[Phase, ...]
    lanes: tuple[tuple[tuple[str, str], ...], ...]
    foes: frozenset[tuple[int, int]]
    places: tuple[str, ...] = ()


@dataclass(frozen=True)
class LaneGroup:
    """One movement: its lanes, the links behind them that have a group, and the groups it needs (mask)."""

    edge: str
    lanes: tuple[str, ...]
    links: tuple[int, ...]
    groups: int


@dataclass(frozen=True)
class Signal:
    """A signal whose stages are known. `states[stage]` are SUMO's letters; `group_links[group]` its links."""

    name: str
    states: tuple[str, ...]
    durations_s: tuple[float, ...]
    stages: tuple[int, ...]
    group_links: tuple[tuple[int, ...], ...]
    conflict: tuple[int, ...]
    foes: frozenset[tuple[int, int]]
    movements: tuple[LaneGroup, ...]
    approaches: tuple[tuple[int, ...], ...]


def read_signal(programme: Programme, *, complete: bool = False) -> Signal:
    """The signal that a programme describes. SignalError for one that cannot be controlled safely or not at all.

    `complete`: with the stages that the programme leaves out, as far as there is room for all of them and their groups.
    """
    phases = _green_phases(programme)
    for phase in phases:
        _check_green(programme, phase)
    if complete:
        phases = _completed(programme, phases)
    group_links = tuple(tuple(links) for links in _columns(phases).values())
    _check_count(programme, "groups of links that go together", len(group_links), GROUP_MAX)
    stages = tuple(
        sum((phase.state[links[0]] in GREEN) << group for group, links in enumerate(group_links)) for phase in phases
    )
    _check_count(programme, "green phases", len(stages), STAGE_MAX)
    movements = _movements(programme, group_links, stages)
    _check_count(programme, "groups of lanes", len(movements), MOVEMENT_MAX)
    return Signal(
        name=programme.name,
        states=tuple(phase.state for phase in phases),
        durations_s=tuple(phase.duration_s for phase in phases),
        stages=stages,
        group_links=group_links,
        conflict=_conflicts(programme, group_links, stages),
        foes=programme.foes,
        movements=movements,
        approaches=_approaches(movements),
    )


def _completed(programme: Programme, phases: list[Phase]) -> list[Phase]:
    """With the stages to add, after the programme's own; unchanged where they or their groups would be too many."""
    links = sorted(link for group in _columns(phases).values() for link in group)
    states = [phase.state for phase in phases]
    added = more_stages(states, links, programme.lanes, programme.foes, programme.places)
    whole = [*phases, *(Phase(state, 0.0) for state in added)]
    return whole if len(whole) <= STAGE_MAX and len(_columns(whole)) <= GROUP_MAX else phases


def junction_of(signal: Signal, times: Times, reach_m: float) -> Junction:
    """The site: names are short and stand for positions, as SUMO's are too long for a site."""
    names = [f"g{group}" for group in range(len(signal.group_links))]
    document = {
        "name": "sumo",
        "simulation_only": True,
        "chooser": "naive",
        "forecast": "none",
        "hold_s": [times.min_green_s, times.max_green_s],
        "red_bound_s": times.red_bound_s,
        "junction_wait_ds": 10 * times.junction_wait_s,
        "reach_m": reach_m,
        "saturation_veh_per_s": SATURATION_VEH_PER_S,
        "startup_s": STARTUP_S,
        "approaches": [{"name": f"a{index}"} for index in range(len(signal.approaches))],
        "groups": [
            {
                "name": name,
                "amber_s": times.yellow_s,
                "min_green_s": times.min_green_s,
                "max_green_s": times.max_green_s,
            }
            for name in names
        ],
        "movements": [
            {
                "name": f"m{index}",
                "approach": f"a{approach}",
                "groups": [names[group] for group in bits_of(signal.movements[index].groups)],
                "lanes": len(signal.movements[index].lanes),
                **_right_of_way(signal, index),
            }
            for approach, members in enumerate(signal.approaches)
            for index in members
        ],
        "conflicts": {
            names[group]: [names[other] for other in bits_of(mask)]
            for group, mask in enumerate(signal.conflict)
            if mask
        },
        "intergreen_ds": 10 * (times.yellow_s + times.all_red_s),
        "stages": [[names[group] for group in bits_of(stage)] for stage in signal.stages],
    }
    try:
        junction = build_junction(document)
        check_junction(junction)
    except SiteError as error:
        raise SignalError(f"signal {signal.name} cannot be made a junction: {error}") from None
    return junction


def _right_of_way(signal: Signal, index: int) -> dict[str, list[str] | float]:
    """The keys of a site that say to whom a movement gives way; none if it never does."""
    movement = signal.movements[index]
    others = [other for other in signal.movements if other.edge != movement.edge and not _is_walked(other)]
    found = {other: links for other in others if (links := _yielding_links(signal, movement, other))}
    if _is_walked(movement) or not found:
        return {}
    share = len(set().union(*found.values())) / len(movement.links)
    return {
        "gives_way": [f"m{at}" for at, other in enumerate(signal.movements) if other in found],
        "gives_way_share": round(max(share, 0.01), 2),
    }


def _yielding_links(signal: Signal, movement: LaneGroup, other: LaneGroup) -> set[int]:
    """Links of a movement that show g in a stage in which both go, while one of the other that they cross has G."""
    return {
        link
        for stage, state in zip(signal.stages, signal.states, strict=True)
        if stage & movement.groups == movement.groups and stage & other.groups == other.groups
        for link in movement.links
        for against in other.links
        if state[link] == "g" and state[against] == "G" and (link, against) in signal.foes
    }


def _is_walked(movement: LaneGroup) -> bool:
    """Crossings and walking areas are internal edges, whose names begin with a colon."""
    return movement.edge.startswith(":")


def letters(signal: Signal, shown: int, target: int, aspects: str) -> str:
    """SUMO's state for the lamps of a moment: `aspects` are the library's digits, a group each.

    `shown` is the last stage that was shown and `target` the one that is shown or on its way. While they differ, a link
    that is green in both gives way if it does so in either, and one that has just begun gives way.
    """
    state = list(signal.states[target])
    for group, links in enumerate(signal.group_links):
        for link in links:
            state[link] = _letter(aspects[group], signal.states[shown][link], signal.states[target][link])
    return "".join(state)


def transition(signal: Signal, before: int, after: int) -> tuple[str, str]:
    """SUMO's states of amber and of all red between two stages; the second equals the target where nothing waits.

    The same rule as the plan's: who ends shows amber, who starts waits for those he conflicts with.
    """
    ends = signal.stages[before] & ~signal.stages[after]
    amber, red = [], []
    for group in range(len(signal.group_links)):
        stays = (signal.stages[before] & signal.stages[after]) >> group & 1
        starts = signal.stages[after] >> group & 1 and not signal.conflict[group] & ends
        green = bool(stays or starts)
        amber.append("3" if green else "4" if ends >> group & 1 else "1")
        red.append("3" if green else "1")
    return letters(signal, before, after, "".join(amber)), letters(signal, before, after, "".join(red))


def _letter(aspect: str, shown: str, target: str) -> str:
    if aspect == "3":
        if shown in GREEN and target not in GREEN:
            return shown  # it has not ended yet
        return "G" if shown == target == "G" else "g"
    if aspect == "4":
        return SHOWN_AMBER
    return target if target not in GREEN + AMBER else RED


def _green_phases(programme: Programme) -> list[Phase]:
    """Phases that let somebody go and end nobody's green; of several with the same links the first."""
    found: dict[frozenset[int], Phase] = {}
    for phase in programme.phases:
        if not any(letter in AMBER for letter in phase.state):
            green = frozenset(link for link, letter in enumerate(phase.state) if letter in GREEN)
            if green:
                found.setdefault(green, phase)
    if not found:
        shown = " ".join(phase.state for phase in programme.phases)
        raise SignalError(
            f"signal {programme.name} has no green phase ({shown}); right would be one with a letter G or g and no y"
        )
    return list(found.values())


def _check_green(programme: Programme, phase: Phase) -> None:
    """Two links that cross and are both told that they need not give way."""
    green = [link for link, letter in enumerate(phase.state) if letter == "G" and link < len(programme.lanes)]
    for first in green:
        for second in green:
            if first < second and (first, second) in programme.foes:
                raise SignalError(
                    f"signal {programme.name} has conflicting greens in phase {phase.state}: links {first} and "
                    f"{second} cross and both have G; right would be g for the one that gives way"
                )


def _columns(phases: Sequence[Phase]) -> dict[tuple[bool, ...], list[int]]:
    """Links by the stages in which they are green, without those that always or never are where there is a choice."""
    columns: dict[tuple[bool, ...], list[int]] = {}
    for link in range(len(phases[0].state)):
        pattern = tuple(phase.state[link] in GREEN for phase in phases)
        if any(pattern) and (len(phases) == 1 or not all(pattern)):
            columns.setdefault(pattern, []).append(link)
    return columns


def _conflicts(programme: Programme, group_links: Sequence[Sequence[int]], stages: Sequence[int]) -> tuple[int, ...]:
    together = [0] * len(group_links)
    for stage in stages:
        for group in bits_of(stage):
            together[group] |= stage
    return tuple(
        sum(
            cross(links, others, programme.foes) << other
            for other, others in enumerate(group_links)
            if other != group and not together[group] >> other & 1
        )
        for group, links in enumerate(group_links)
    )


def _movements(
    programme: Programme, group_links: Sequence[Sequence[int]], stages: Sequence[int]
) -> tuple[LaneGroup, ...]:
    group_of = {link: group for group, links in enumerate(group_links) for link in links}
    links_of: dict[tuple[str, str], list[int]] = {}
    for link, lanes in enumerate(programme.lanes):
        for place in lanes:
            if link in group_of:
                links_of.setdefault(place, []).append(link)
    joined: dict[tuple[str, int], tuple[list[str], set[int]]] = {}
    edges: dict[str, None] = {}
    for (edge, lane), links in links_of.items():
        edges.setdefault(edge)
        needed = _needed([group_of[link] for link in links], stages)
        lanes_there, links_there = joined.setdefault((edge, needed), ([], set()))
        lanes_there.append(lane)
        links_there.update(links)
    return tuple(
        LaneGroup(edge, tuple(lanes), tuple(sorted(links)), groups)
        for at in edges
        for (edge, groups), (lanes, links) in joined.items()
        if edge == at
    )


def _needed(groups: Sequence[int], stages: Sequence[int]) -> int:
    """Mask of the groups that a lane needs to go: all of its links', or as many links' as any stage lets go."""
    wanted = sum(1 << group for group in set(groups))
    best = max(stages, key=lambda stage: sum(stage >> group & 1 for group in groups))
    return wanted & best


def _approaches(movements: Sequence[LaneGroup]) -> tuple[tuple[int, ...], ...]:
    """Movements by edge, at most as many together as an approach may have; edges share one where there are too many."""
    by_edge: dict[str, list[int]] = {}
    for index, movement in enumerate(movements):
        by_edge.setdefault(movement.edge, []).append(index)
    pieces = [piece for members in by_edge.values() for piece in _cut(members)]
    return tuple(pieces if len(pieces) <= APPROACH_MAX else _cut(range(len(movements))))


def _cut(members: Sequence[int]) -> list[tuple[int, ...]]:
    size = APPROACH_MOVEMENT_MAX
    return [tuple(members[at : at + size]) for at in range(0, len(members), size)]


def _check_count(programme: Programme, what: str, count: int, most: int) -> None:
    if count > most:
        raise SignalError(f"signal {programme.name} has {count} {what}; right would be at most {most}")
