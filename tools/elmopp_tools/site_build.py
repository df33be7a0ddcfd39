# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Makes a Junction of a site document: names become indices and masks, seconds become tenths, defaults are filled in.

Refuses what cannot be expressed (unknown names, odd resolutions, asymmetric conflicts, wrong stages); whether the
result is a junction that may stand in a street is said by site_rules.
"""

import struct
from collections import ChainMap
from collections.abc import Sequence
from dataclasses import replace

from elmopp_tools import site_hours
from elmopp_tools.site_model import (
    APPROACH_MAX,
    FORECASTS,
    GROUP_MAX,
    LEARNING,
    LOOKING_AHEAD,
    MOVEMENT_MAX,
    SITE_NAME_SIZE,
    STAGE_MAX,
    Group,
    Junction,
    Movement,
    SiteError,
)
from elmopp_tools.site_words import Document, checked_name, index_of, list_names, mask_of, percent, tenths
from elmopp_tools.stages import addable_group, conflict_pair, enumerate_stages

# A queued car takes its own length and the gap to the next one: 7.5 m from bumper to bumper is the usual figure.
QUEUED_VEHICLE_M = 7.5

# What a street does after its self-test unless it says otherwise: flashing is long enough to be seen by those who come
# and for a lamp node to leave its own flashing; red is long enough for those who are in the junction to leave it.
START_FLASH_S = 10
START_RED_S = 6


def build_junction(document: Document) -> Junction:
    """The Junction that a schema-checked document describes."""
    approaches = list_names(document["approaches"], "approaches", "ELMOPP_APPROACH_MAX", APPROACH_MAX)
    group_names = list_names(document["groups"], "groups", "ELMOPP_GROUP_MAX", GROUP_MAX)
    movement_names = list_names(document["movements"], "movements", "ELMOPP_MOVEMENT_MAX", MOVEMENT_MAX)
    conflict = _conflict_masks(document["conflicts"], group_names)
    simulation_only = document.get("simulation_only", False)
    stages = _stages(document.get("stages"), conflict, group_names, some_will_do=simulation_only)
    movements = tuple(
        _with_right_of_way(_movement(document, item, approaches, group_names), item, movement_names)
        for item in document["movements"]
    )
    groups = tuple(_group(item) for item in document["groups"])
    rescue = site_hours.rescue_stages(stages, movements)
    programs = site_hours.programs(document.get("programs", []), stages, group_names)
    if not programs and not simulation_only:
        programs = (site_hours.default_program(rescue, stages, groups),)
    detectors = document.get("detectors", {})
    return Junction(
        name=checked_name("name", document["name"], SITE_NAME_SIZE),
        simulation_only=simulation_only,
        discharge=document.get("discharge", "saturation"),
        chooser=document["chooser"],
        forecast=_forecast(document),
        learning=_learning(document),
        hold_min_s=int(document["hold_s"][0]),
        hold_max_s=int(document["hold_s"][1]),
        red_bound_ds=tenths("red_bound_s", document.get("red_bound_s", 0)),
        start_flash_ds=tenths("start_flash_s", document.get("start_flash_s", 0 if simulation_only else START_FLASH_S)),
        start_red_ds=tenths("start_red_s", document.get("start_red_s", 0 if simulation_only else START_RED_S)),
        junction_wait_ds=int(document.get("junction_wait_ds", 0)),
        first_stage=_first_stage(document, stages, group_names),
        cameras=mask_of(approaches, document.get("cameras", approaches), "cameras: approach"),
        no_activity_min=int(detectors.get("no_activity_min", 0)),
        max_presence_min=int(detectors.get("max_presence_min", 0)),
        erratic_per_min=int(detectors.get("erratic_per_min", 0)),
        reach_m=single(document["reach_m"]),
        free_flow_m_per_s=_free_flow(document),
        approaches=approaches,
        movements=movements,
        groups=groups,
        conflict=conflict,
        stages=stages,
        intergreen_ds=_intergreen(document["intergreen_ds"], conflict, group_names),
        rescue_stages=rescue,
        programs=programs,
        schedule=site_hours.schedule(document.get("schedule", []), programs),
        special_days=site_hours.special_days(document.get("special_days", [])),
    )


def single(number: float) -> float:
    """The nearest IEEE 754 single-precision number, which is what the struct holds."""
    rounded: float = struct.unpack("<f", struct.pack("<f", number))[0]
    return rounded + 0.0  # no negative zero


def _forecast(document: Document) -> str:
    """In the firmware's words: a network in whole numbers is a forecast of its own."""
    forecast: str = document["forecast"]
    if document.get("arithmetic", "float") == "float":
        return forecast
    if f"{forecast}-q15" not in FORECASTS:
        wrong = f"forecast {forecast} has no arithmetic q15"
        raise SiteError(wrong, "q15", 'arithmetic = "float", or forecast "lstm" or "nlstm"')
    return f"{forecast}-q15"


def _learning(document: Document) -> bool:
    """Only what somebody looks at, and what the firmware has a learner for."""
    learning: bool = document.get("learning", False)
    forecast, chooser = _forecast(document), document["chooser"]
    if learning and forecast not in LEARNING:
        wrong = f"forecast {forecast} does not learn on"
        raise SiteError(wrong, learning, 'learning = false, or forecast "lstm" or "nlstm" with arithmetic = "float"')
    if learning and chooser not in LOOKING_AHEAD:
        wrong = f"chooser {chooser} looks at no forecast, so that nothing would learn on"
        raise SiteError(wrong, learning, 'learning = false, or chooser "cumulative" or "rollout"')
    return learning


def _free_flow(document: Document) -> float:
    discharge = document.get("discharge", "saturation")
    free_flow_m_per_s = single(document.get("free_flow_m_per_s", 0.0))
    if discharge == "saturation" and free_flow_m_per_s != 0.0:
        wrong = "free_flow_m_per_s has no meaning with discharge saturation"
        raise SiteError(wrong, free_flow_m_per_s, "leave it out, or discharge greenshields or nolock")
    if discharge != "saturation" and free_flow_m_per_s <= 0.0:
        wrong = f"discharge {discharge} lacks free_flow_m_per_s"
        raise SiteError(wrong, free_flow_m_per_s, "more than 0, the paper has 10")
    return free_flow_m_per_s


def _movement(document: Document, item: Document, approaches: Sequence[str], group_names: Sequence[str]) -> Movement:
    name = item["name"]
    lanes = int(item.get("lanes", 1))
    own_or_common = ChainMap(item, document)
    approach = index_of(approaches, item["approach"], f"approach of movement {name}")
    return Movement(
        name=name,
        approach=approach,
        groups=mask_of(group_names, item["groups"], f"group of movement {name}"),
        lanes=lanes,
        capacity_veh=single(item.get("capacity_veh", lanes * document["reach_m"] / QUEUED_VEHICLE_M)),
        saturation_veh_per_s=single(lanes * own_or_common["saturation_veh_per_s"]),
        startup_ds=tenths(f"startup_s of movement {name}", own_or_common["startup_s"]),
        limit_km_per_h=_limit(document, approach),
    )


def _with_right_of_way(movement: Movement, item: Document, names: Sequence[str]) -> Movement:
    """The movement with whom it gives way to, and which part of its vehicles does."""
    name = item["name"]
    foes = mask_of(names, item.get("gives_way", []), f"gives_way of movement {name}")
    share = item.get("gives_way_share")
    if share is not None and not foes:
        wrong = f"gives_way_share of movement {name}, which gives way to nobody"
        raise SiteError(wrong, share, "leave it out, or gives_way with the movements that go first")
    part = percent(f"gives_way_share of movement {name}", 1 if share is None else share)
    return replace(movement, gives_way=foes, gives_way_percent=part if foes else 0)


def _limit(document: Document, approach: int) -> int:
    """Of an approach: its own, the site's, or 0 where nobody says."""
    own_or_common = ChainMap(document["approaches"][approach], document)
    return int(own_or_common.get("speed_km_per_h", 0))


def _group(item: Document) -> Group:
    name = item["name"]
    return Group(
        name=name,
        amber_ds=tenths(f"amber_s of group {name}", item["amber_s"]),
        red_amber_ds=tenths(f"red_amber_s of group {name}", item.get("red_amber_s", 0)),
        min_green_ds=tenths(f"min_green_s of group {name}", item["min_green_s"]),
        max_green_ds=tenths(f"max_green_s of group {name}", item.get("max_green_s", 0)),
        node=int(item.get("node", 0)),
        flash=item.get("flash", "amber"),
    )


def _first_stage(document: Document, stages: Sequence[int], names: Sequence[str]) -> int:
    written = document.get("first_stage")
    return 0 if written is None else site_hours.stage_of("first_stage", written, stages, names)


def _conflict_masks(conflicts: dict[str, list[str]], names: Sequence[str]) -> tuple[int, ...]:
    """The symmetric conflict masks; an entry that is written from one side only is refused, not completed."""
    for name, against in conflicts.items():
        index_of(names, name, "conflicts: group")
        mask_of(names, against, f"conflicts.{name}: group")
        if name in against:
            raise SiteError(f"conflicts.{name} names itself", name, "only other groups")
        for other in against:
            if name not in conflicts.get(other, []):
                wrong = f"conflicts is asymmetric: {name} names {other}, {other} does not name {name}"
                raise SiteError(
                    wrong, f"{name}, {other}", f"{name} in conflicts.{other}, or {other} not in conflicts.{name}"
                )
    return tuple(mask_of(names, conflicts.get(name, []), f"conflicts.{name}") for name in names)


def _intergreen(
    written: int | dict[str, dict[str, int]], conflict: Sequence[int], names: Sequence[str]
) -> tuple[tuple[int, ...], ...]:
    """The full matrix [ending][starting], 0 where the groups are compatible."""
    if not isinstance(written, dict):
        everywhere = int(written)
        return tuple(tuple(everywhere * (mask >> start & 1) for start in range(len(names))) for mask in conflict)
    _check_intergreen_names(written, conflict, names)
    return tuple(
        tuple(_intergreen_entry(written, ending, starting, conflict, names) for starting in range(len(names)))
        for ending in range(len(names))
    )


def _check_intergreen_names(written: dict[str, dict[str, int]], conflict: Sequence[int], names: Sequence[str]) -> None:
    for ending, row in written.items():
        end = index_of(names, ending, "intergreen_ds: ending group")
        for starting, time_ds in row.items():
            start = index_of(names, starting, f"intergreen_ds.{ending}: starting group")
            if not conflict[end] >> start & 1:
                wrong = f"intergreen_ds from {ending} to {starting}, which do not conflict"
                raise SiteError(wrong, time_ds, "leave it out, or make them conflict in conflicts")


def _intergreen_entry(
    written: dict[str, dict[str, int]], ending: int, starting: int, conflict: Sequence[int], names: Sequence[str]
) -> int:
    if not conflict[ending] >> starting & 1:
        return 0
    time_ds = written.get(names[ending], {}).get(names[starting])
    if time_ds is None:
        wrong = f"intergreen_ds lacks the conflicting pair {names[ending]} to {names[starting]}"
        raise SiteError(wrong, "no entry", "tenths of a second from end of green to start of green")
    return int(time_ds)


def _stages(
    written: list[list[str]] | None, conflict: Sequence[int], names: Sequence[str], *, some_will_do: bool
) -> tuple[int, ...]:
    """The stages: as enumerated, or as written; a street's must then be the same set, a simulation's need not."""
    if written is not None and some_will_do:
        return _written_stages(written, conflict, names, maximal=False)
    enumerated = enumerate_stages(conflict)
    if len(enumerated) > STAGE_MAX:
        wrong = f"has {len(enumerated)} stages, ELMOPP_STAGE_MAX is {STAGE_MAX}"
        raise SiteError(wrong, len(enumerated), "fewer groups: let movements share one, or add conflicts")
    if written is None:
        return tuple(enumerated)
    order = _written_stages(written, conflict, names, maximal=True)
    for stage in enumerated:
        if stage not in order:
            missing = [name for group, name in enumerate(names) if stage >> group & 1]
            raise SiteError("stages lacks a stage", missing, f"all {len(enumerated)} maximal sets, or no stages at all")
    return order


def _written_stages(
    written: list[list[str]], conflict: Sequence[int], names: Sequence[str], *, maximal: bool
) -> tuple[int, ...]:
    order: list[int] = []
    if len(written) > STAGE_MAX:
        raise SiteError(f"has {len(written)} stages, ELMOPP_STAGE_MAX is {STAGE_MAX}", len(written), "fewer stages")
    for index, stage_names in enumerate(written):
        path = f"stages[{index}]"
        stage = mask_of(names, stage_names, f"{path}: group")
        _check_stage(path, stage, stage_names, conflict, names)
        more = addable_group(conflict, stage)
        if more is not None and maximal:
            raise SiteError(
                f"{path} is not maximal", stage_names, f"{names[more]} conflicts with none of it and belongs in"
            )
        if stage in order:
            raise SiteError(f"{path} is stage {order.index(stage)} again", stage_names, "every stage once")
        order.append(stage)
    return tuple(order)


def _check_stage(path: str, stage: int, shown: list[str], conflict: Sequence[int], names: Sequence[str]) -> None:
    pair = conflict_pair(conflict, stage)
    if pair is not None:
        first, second = names[pair[0]], names[pair[1]]
        raise SiteError(f"{path} holds {first} and {second}, which conflict", shown, "only compatible groups")
    if not stage:
        raise SiteError(f"{path} is empty", shown, "at least one group")
