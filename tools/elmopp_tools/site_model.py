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
APPROACH_MOVEMENT_MAX = 3
NODE_MAX = 8
PROGRAM_MAX = 4
STEP_MAX = 16
SCHEDULE_MAX = 16
SPECIAL_DAY_MAX = 16
SITE_NAME_SIZE = 24
NAME_SIZE = 12

# Those that look at a forecast, and those forecasts that can learn on.
LOOKING_AHEAD = ("cumulative", "rollout")
LEARNING = ("lstm", "nlstm")

DISCHARGES = ("saturation", "greenshields", "nolock")
CHOOSERS = ("naive", "cumulative", "pressure", "priced", "rollout")
FORECASTS = ("none", "mean", "persistence", "ewma", "ar8", "lstm", "nlstm", "ann", "gcn", "lstm-q15", "nlstm-q15")

FLASHES = ("amber", "red", "dark")
WEEKDAYS = ("Mon", "Tue", "Wed", "Thu", "Fri", "Sat", "Sun")
SCHEDULE_FLASH = 255
CHANGE_TICKS = 2  # elmopp_junction_change_ds(): the tick that asks, and the one that sees

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
    limit_km_per_h: int = 0  # of its approach; 0: nobody says
    gives_way: int = 0  # mask of the movements that go first where both have green
    gives_way_percent: int = 0  # of its vehicles, those that do give way


@dataclass(frozen=True)
class Group:
    """A set of lamps that always show the same."""

    name: str
    amber_ds: int
    red_amber_ds: int
    min_green_ds: int
    max_green_ds: int
    node: int
    flash: str


@dataclass(frozen=True)
class Step:
    """One step of a programme: the index of a stage and how long it is shown."""

    stage: int
    green_ds: int


@dataclass(frozen=True)
class Program:
    """A fixed-time programme."""

    name: str
    steps: tuple[Step, ...]


@dataclass(frozen=True)
class ScheduleLine:
    """From this minute of these weekdays (a mask) a programme holds, an index or SCHEDULE_FLASH."""

    from_min: int
    weekdays: int
    program: int


@dataclass(frozen=True)
class SpecialDay:
    """A date, days since 2000-01-01, that follows another weekday's lines."""

    day: int
    weekday: int


@dataclass(frozen=True)
class Junction:
    """One site. Group sets are masks, bit g is groups[g]; intergreen_ds is [ending][starting]."""

    name: str
    simulation_only: bool
    discharge: str
    chooser: str
    forecast: str
    learning: bool
    hold_min_s: int
    hold_max_s: int
    red_bound_ds: int
    start_flash_ds: int
    start_red_ds: int
    junction_wait_ds: int
    first_stage: int
    cameras: int
    no_activity_min: int
    max_presence_min: int
    erratic_per_min: int
    reach_m: float
    free_flow_m_per_s: float
    approaches: tuple[str, ...]
    movements: tuple[Movement, ...]
    groups: tuple[Group, ...]
    conflict: tuple[int, ...]
    stages: tuple[int, ...]
    intergreen_ds: tuple[tuple[int, ...], ...]
    rescue_stages: tuple[int, ...]
    programs: tuple[Program, ...]
    schedule: tuple[ScheduleLine, ...]
    special_days: tuple[SpecialDay, ...]

    def group_names(self, mask: int) -> list[str]:
        """Names of the groups of a mask, in site order."""
        return [group.name for index, group in enumerate(self.groups) if mask >> index & 1]

    def change_ds(self) -> int:
        """Longest time from the moment a stage may be left until any other is shown."""
        own = [group.amber_ds + group.red_amber_ds for group in self.groups]
        clearances = [time_ds for row in self.intergreen_ds for time_ds in row] + own
        green_ds = max(group.min_green_ds for group in self.groups)
        return green_ds + max(clearances) + self.junction_wait_ds + CHANGE_TICKS

    def red_bound_min_ds(self) -> int:
        """The shortest bound on red that can be kept: a change under way, and one for each rescue stage."""
        return (1 + len(set(self.rescue_stages))) * self.change_ds()

    def serves(self, stage: int, movement: "Movement") -> bool:
        """True if a stage lets a movement go."""
        return self.stages[stage] & movement.groups == movement.groups

    def movement_names(self, mask: int) -> list[str]:
        """Names of the movements of a mask, in site order."""
        return [movement.name for index, movement in enumerate(self.movements) if mask >> index & 1]

    def go_together(self, one: "Movement", other: "Movement") -> bool:
        """True if some stage lets both go."""
        return any(self.serves(stage, one) and self.serves(stage, other) for stage in range(len(self.stages)))

    def conflict_count(self) -> int:
        """Unordered pairs of groups that conflict."""
        return sum(mask.bit_count() for mask in self.conflict) // 2
