# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Makes a Junction of a site document: names become indices and masks, seconds become tenths, defaults are filled in.

Refuses what cannot be expressed (unknown names, odd resolutions, asymmetric conflicts, wrong stages); whether the
result is a junction that may stand in a street is said by site_rules.
"""

import re
import struct
from collections import ChainMap
from collections.abc import Sequence
from typing import Any

from elmopp_tools.site_model import (
    APPROACH_MAX,
    GROUP_MAX,
    MOVEMENT_MAX,
    NAME_SIZE,
    SITE_NAME_SIZE,
    STAGE_MAX,
    Group,
    Junction,
    Movement,
    SiteError,
)
from elmopp_tools.stages import addable_group, conflict_pair, enumerate_stages

# A queued car takes its own length and the gap to the next one: 7.5 m from bumper to bumper is the usual figure.
QUEUED_VEHICLE_M = 7.5

Document = dict[str, Any]


def build_junction(document: Document) -> Junction:
    """The Junction that a schema-checked document describes."""
    approaches = _names(document["approaches"], "approaches", "ELMOPP_APPROACH_MAX", APPROACH_MAX)
    group_names = _names(document["groups"], "groups", "ELMOPP_GROUP_MAX", GROUP_MAX)
    _names(document["movements"], "movements", "ELMOPP_MOVEMENT_MAX", MOVEMENT_MAX)
    _check_arithmetic(document)
    conflict = _conflict_masks(document["conflicts"], group_names)
    return Junction(
        name=_checked_name("name", document["name"], SITE_NAME_SIZE),
        simulation_only=document.get("simulation_only", False),
        discharge=document.get("discharge", "saturation"),
        chooser=document["chooser"],
        forecast=document["forecast"],
        hold_min_s=int(document["hold_s"][0]),
        hold_max_s=int(document["hold_s"][1]),
        reach_m=single(document["reach_m"]),
        free_flow_m_per_s=_free_flow(document),
        approaches=approaches,
        movements=tuple(_movement(document, item, approaches, group_names) for item in document["movements"]),
        groups=tuple(_group(item) for item in document["groups"]),
        conflict=conflict,
        stages=_stages(document.get("stages"), conflict, group_names),
        intergreen_ds=_intergreen(document["intergreen_ds"], conflict, group_names),
    )


def single(number: float) -> float:
    """The nearest IEEE 754 single-precision number, which is what the struct holds."""
    rounded: float = struct.unpack("<f", struct.pack("<f", number))[0]
    return rounded + 0.0  # no negative zero


def tenths(path: str, time_s: float) -> int:
    """Seconds as a whole number of tenths; a finer time is refused, not rounded."""
    time_ds = round(time_s * 10)
    if time_ds / 10 != time_s:
        raise SiteError(f"{path} is finer than a tenth of a second", time_s, f"for example {time_ds / 10}")
    return time_ds


def _names(items: Sequence[Document], what: str, bound_name: str, bound: int) -> tuple[str, ...]:
    """The names of a list of tables: not too many, well-formed, each once."""
    if len(items) > bound:
        raise SiteError(f"has too many {what}", len(items), f"{bound_name} is {bound}")
    names = tuple(_checked_name(f"{what}[{index}].name", item["name"], NAME_SIZE) for index, item in enumerate(items))
    for index, name in enumerate(names):
        if name in names[:index]:
            raise SiteError(f"{what}[{index}].name is taken", name, "every name once in its list")
    return names


def _checked_name(path: str, name: str, size: int) -> str:
    if re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.+-]*", name) is None:
        raise SiteError(f"{path} is not a name", name, "ASCII letters, digits and _ . + -, a letter or digit first")
    if len(name) >= size:
        raise SiteError(f"{path} has {len(name)} bytes", name, f"at most {size - 1}")
    return name


def _index(names: Sequence[str], name: str, path: str) -> int:
    if name not in names:
        raise SiteError(f"{path} is not known", name, f"one of {', '.join(names)}")
    return names.index(name)


def _mask(names: Sequence[str], chosen: Sequence[str], path: str) -> int:
    return sum(1 << _index(names, name, path) for name in chosen)


def _check_arithmetic(document: Document) -> None:
    arithmetic = document.get("arithmetic", "float")
    if arithmetic != "float":
        raise SiteError("arithmetic is not built", arithmetic, 'only "float" is built')


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
    return Movement(
        name=name,
        approach=_index(approaches, item["approach"], f"approach of movement {name}"),
        groups=_mask(group_names, item["groups"], f"group of movement {name}"),
        lanes=lanes,
        capacity_veh=single(item.get("capacity_veh", lanes * document["reach_m"] / QUEUED_VEHICLE_M)),
        saturation_veh_per_s=single(lanes * own_or_common["saturation_veh_per_s"]),
        startup_ds=tenths(f"startup_s of movement {name}", own_or_common["startup_s"]),
    )


def _group(item: Document) -> Group:
    name = item["name"]
    return Group(
        name=name,
        amber_ds=tenths(f"amber_s of group {name}", item["amber_s"]),
        red_amber_ds=tenths(f"red_amber_s of group {name}", item.get("red_amber_s", 0)),
        min_green_ds=tenths(f"min_green_s of group {name}", item["min_green_s"]),
        max_green_ds=tenths(f"max_green_s of group {name}", item.get("max_green_s", 0)),
    )


def _conflict_masks(conflicts: dict[str, list[str]], names: Sequence[str]) -> tuple[int, ...]:
    """The symmetric conflict masks; an entry that is written from one side only is refused, not completed."""
    for name, against in conflicts.items():
        _index(names, name, "conflicts: group")
        _mask(names, against, f"conflicts.{name}: group")
        if name in against:
            raise SiteError(f"conflicts.{name} names itself", name, "only other groups")
        for other in against:
            if name not in conflicts.get(other, []):
                wrong = f"conflicts is asymmetric: {name} names {other}, {other} does not name {name}"
                raise SiteError(
                    wrong, f"{name}, {other}", f"{name} in conflicts.{other}, or {other} not in conflicts.{name}"
                )
    return tuple(_mask(names, conflicts.get(name, []), f"conflicts.{name}") for name in names)


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
        end = _index(names, ending, "intergreen_ds: ending group")
        for starting, time_ds in row.items():
            start = _index(names, starting, f"intergreen_ds.{ending}: starting group")
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


def _stages(written: list[list[str]] | None, conflict: Sequence[int], names: Sequence[str]) -> tuple[int, ...]:
    """The stages: as enumerated, or in the written order if that is the same set."""
    enumerated = enumerate_stages(conflict)
    if len(enumerated) > STAGE_MAX:
        wrong = f"has {len(enumerated)} stages, ELMOPP_STAGE_MAX is {STAGE_MAX}"
        raise SiteError(wrong, len(enumerated), "fewer groups: let movements share one, or add conflicts")
    if written is None:
        return tuple(enumerated)
    order: list[int] = []
    for index, stage_names in enumerate(written):
        stage = _mask(names, stage_names, f"stages[{index}]: group")
        _check_stage(f"stages[{index}]", stage, stage_names, conflict, names)
        if stage in order:
            raise SiteError(f"stages[{index}] is stage {order.index(stage)} again", stage_names, "every stage once")
        order.append(stage)
    for stage in enumerated:
        if stage not in order:
            missing = [name for group, name in enumerate(names) if stage >> group & 1]
            raise SiteError("stages lacks a stage", missing, f"all {len(enumerated)} maximal sets, or no stages at all")
    return tuple(order)


def _check_stage(path: str, stage: int, shown: list[str], conflict: Sequence[int], names: Sequence[str]) -> None:
    pair = conflict_pair(conflict, stage)
    if pair is not None:
        first, second = names[pair[0]], names[pair[1]]
        raise SiteError(f"{path} holds {first} and {second}, which conflict", shown, "only compatible groups")
    more = addable_group(conflict, stage)
    if more is not None:
        raise SiteError(f"{path} is not maximal", shown, f"{names[more]} conflicts with none of it and belongs in")
