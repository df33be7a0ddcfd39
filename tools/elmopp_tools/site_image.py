# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Writes a Junction as a site image: an envelope and the little-endian bytes of elmopp_junction_t."""

import struct

from elmopp_tools.image import envelope
from elmopp_tools.site_model import (
    APPROACH_MAX,
    CHOOSERS,
    DISCHARGES,
    FLASHES,
    FORECASTS,
    GROUP_MAX,
    MOVEMENT_MAX,
    NAME_SIZE,
    PROGRAM_MAX,
    SCHEDULE_MAX,
    SITE_NAME_SIZE,
    SPECIAL_DAY_MAX,
    STAGE_MAX,
    STEP_MAX,
    Group,
    Junction,
    Movement,
    Program,
)

MAGIC = b"ELMS"
VERSION = 5

WORD_SIZE = 2

_HEAD = struct.Struct(f"<{SITE_NAME_SIZE}s8B5H8BH2f")
_MOVEMENT = struct.Struct(f"<{NAME_SIZE}sffHHBBBB")
_GROUP = struct.Struct(f"<{NAME_SIZE}s4H2B")
_STEP = struct.Struct("<HBx")
_PROGRAM_TAIL = struct.Struct("<B3x")
_SCHEDULE = struct.Struct("<HBB")
_SPECIAL_DAY = struct.Struct("<HBx")
_MASK = struct.Struct("<I")
_TAIL = struct.Struct("<B3x")
_PROGRAM_SIZE = STEP_MAX * _STEP.size + _PROGRAM_TAIL.size


def image_bytes(junction: Junction) -> bytes:
    """The whole image."""
    return envelope(MAGIC, VERSION, body_bytes(junction))


def body_bytes(junction: Junction) -> bytes:
    """elmopp_junction_t as the firmware's compiler lays it out; unused rows are zero."""
    return b"".join(
        [
            _head(junction),
            _rows([_name(name) for name in junction.approaches], APPROACH_MAX, NAME_SIZE),
            _rows([_movement(item) for item in junction.movements], MOVEMENT_MAX, _MOVEMENT.size),
            _rows([_group(item) for item in junction.groups], GROUP_MAX, _GROUP.size),
            _rows([_word(mask) for mask in junction.conflict], GROUP_MAX, WORD_SIZE),
            _rows([_word(mask) for mask in junction.stages], STAGE_MAX, WORD_SIZE),
            _rows([_intergreen_row(row) for row in junction.intergreen_ds], GROUP_MAX, GROUP_MAX * WORD_SIZE),
            bytes(junction.rescue_stages).ljust(MOVEMENT_MAX, b"\0"),
            _rows([_program(program) for program in junction.programs], PROGRAM_MAX, _PROGRAM_SIZE),
            _rows(
                [_SCHEDULE.pack(line.from_min, line.weekdays, line.program) for line in junction.schedule],
                SCHEDULE_MAX,
                _SCHEDULE.size,
            ),
            _rows(
                [_SPECIAL_DAY.pack(day.day, day.weekday) for day in junction.special_days],
                SPECIAL_DAY_MAX,
                _SPECIAL_DAY.size,
            ),
            _rows([_MASK.pack(item.gives_way) for item in junction.movements], MOVEMENT_MAX, _MASK.size),
            _TAIL.pack(junction.learning),
        ]
    )


def _rows(rows: list[bytes], count: int, row_size: int) -> bytes:
    """The rows of an array, the unused ones zero."""
    return b"".join(rows).ljust(count * row_size, b"\0")


def _name(name: str) -> bytes:
    return name.encode("ascii").ljust(NAME_SIZE, b"\0")


def _word(number: int) -> bytes:
    return number.to_bytes(WORD_SIZE, "little")


def _intergreen_row(row: tuple[int, ...]) -> bytes:
    return _rows([_word(time_ds) for time_ds in row], GROUP_MAX, WORD_SIZE)


def _head(junction: Junction) -> bytes:
    return _HEAD.pack(
        junction.name.encode("ascii"),
        len(junction.approaches),
        len(junction.movements),
        len(junction.groups),
        len(junction.stages),
        junction.simulation_only,
        DISCHARGES.index(junction.discharge),
        CHOOSERS.index(junction.chooser),
        FORECASTS.index(junction.forecast),
        junction.hold_min_s,
        junction.hold_max_s,
        junction.red_bound_ds,
        junction.start_flash_ds,
        junction.start_red_ds,
        junction.first_stage,
        junction.cameras,
        junction.no_activity_min,
        junction.max_presence_min,
        junction.erratic_per_min,
        len(junction.programs),
        len(junction.schedule),
        len(junction.special_days),
        junction.junction_wait_ds,
        junction.reach_m,
        junction.free_flow_m_per_s,
    )


def _movement(movement: Movement) -> bytes:
    return _MOVEMENT.pack(
        _name(movement.name),
        movement.capacity_veh,
        movement.saturation_veh_per_s,
        movement.startup_ds,
        movement.groups,
        movement.approach,
        movement.lanes,
        movement.limit_km_per_h,
        movement.gives_way_percent,
    )


def _group(group: Group) -> bytes:
    return _GROUP.pack(
        _name(group.name),
        group.amber_ds,
        group.red_amber_ds,
        group.min_green_ds,
        group.max_green_ds,
        group.node,
        FLASHES.index(group.flash),
    )


def _program(program: Program) -> bytes:
    steps = _rows([_STEP.pack(step.green_ds, step.stage) for step in program.steps], STEP_MAX, _STEP.size)
    return steps + _PROGRAM_TAIL.pack(len(program.steps))
