# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""A site as checked data: what elmopp_junction_t holds, with names instead of fixed-width cells.

The bounds are those of firmware/include/elmopp/bounds.h, the positions in CHOOSERS, FORECASTS and DISCHARGES the
values of the enums in junction.h. Floats are already rounded to single precision, times are tenths of a second.
"""

import json
from dataclasses import dataclass

APPROACH_MAX = 8
MOVEMENT_MAX = 24
GROUP_MAX = 16
STAGE_MAX = 32
SITE_NAME_SIZE = 24
NAME_SIZE = 12

DISCHARGES = ("saturation", "greenshields", "nolock")
CHOOSERS = ("naive", "cumulative", "pressure")
FORECASTS = ("none", "mean", "persistence", "ewma", "ar8", "lstm", "nlstm")

SHOWN_LENGTH_MAX = 80
SHOWN_BITS_MAX = 64


class SiteError(Exception):
    """What is wrong with a site file, with which value, and what would be right."""

    def __init__(self, wrong: str, value: object, right: str) -> None:
        super().__init__(f"{wrong} ({show(value)}) ; {right}")


def show(value: object) -> str:
    """A value as one short line for a message."""
    if isinstance(value, int) and value.bit_length() > SHOWN_BITS_MAX:
        return f"an integer of {value.bit_length()} bits"
    text = json.dumps(value, ensure_ascii=False, default=str)
    return text if len(text) <= SHOWN_LENGTH_MAX else text[: SHOWN_LENGTH_MAX - 3] + "..."


def seconds(time_ds: int) -> str:
    """Tenths of a second as people write them."""
    return f"{time_ds / 10:.1f} s"


@dataclass(frozen=True)
class Movement:
    """The lanes of one approach that are served by the same groups in every stage."""

    name: str
    approach: int
    groups: int
    lanes: int
    capacity_veh: float
    saturation_veh_per_s: float
    startup_ds: int


@dataclass(frozen=True)
class Group:
    """A set of lamps that always show the same."""

    name: str
    amber_ds: int
    red_amber_ds: int
    min_green_ds: int
    max_green_ds: int


@dataclass(frozen=True)
class Junction:
    """One site. Group sets are masks, bit g is groups[g]; intergreen_ds is [ending][starting]."""

    name: str
    simulation_only: bool
    discharge: str
    chooser: str
    forecast: str
    hold_min_s: int
    hold_max_s: int
    reach_m: float
    free_flow_m_per_s: float
    approaches: tuple[str, ...]
    movements: tuple[Movement, ...]
    groups: tuple[Group, ...]
    conflict: tuple[int, ...]
    stages: tuple[int, ...]
    intergreen_ds: tuple[tuple[int, ...], ...]

    def group_names(self, mask: int) -> list[str]:
        """Names of the groups of a mask, in site order."""
        return [group.name for index, group in enumerate(self.groups) if mask >> index & 1]

    def conflict_count(self) -> int:
        """Unordered pairs of groups that conflict."""
        return sum(mask.bit_count() for mask in self.conflict) // 2
