# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Says whether a Junction may stand in a street: the rules of elmopp_site_check() in the firmware, in people's words.

A simulation_only site may have zero amber and intergreens, one second of minimum green, no maximum green, no bound on
red, no programme, and groups that no movement needs; all else holds for it too.
"""

from elmopp_tools.site_model import (
    APPROACH_MOVEMENT_MAX,
    NODE_MAX,
    SCHEDULE_FLASH,
    STEP_MAX,
    WEEKDAYS,
    Group,
    Junction,
    Movement,
    Program,
    SiteError,
    Step,
    seconds,
)
from elmopp_tools.stages import bits_of, conflict_pair

HOLD_MAX_S = 150  # ELMOPP_HORIZON_MAX: the urgency looks as far as the window is long
AMBER_MIN_DS = 30
AMBER_MAX_DS = 60
MIN_GREEN_STREET_DS = 50
MIN_GREEN_SIMULATION_DS = 10
TIME_MAX_DS = 6000  # ELMOPP_SITE_TIME_MAX_DS: an age of 16 bits that saturates cannot hide that it is over
JUNCTION_WAIT_MAX_DS = 100  # ELMOPP_SITE_JUNCTION_WAIT_MAX_DS
LIMIT_MIN_KM_PER_H = 5  # ELMOPP_SITE_LIMIT_MIN_KM_PER_H
LIMIT_MAX_KM_PER_H = 200  # ELMOPP_SITE_LIMIT_MAX_KM_PER_H
MINUTES_PER_DAY = 1440


def check_junction(junction: Junction) -> None:
    """Raises SiteError at the first rule that the junction breaks."""
    _check_hold(junction)
    _check_discharge(junction)
    _check_start(junction)
    for group in junction.groups:
        _check_amber(junction, group)
        _check_green(junction, group)
        _check_lamps(group)
    for index, movement in enumerate(junction.movements):
        _check_movement(junction, movement)
        _check_rescue(junction, movement, junction.rescue_stages[index])
        _check_right_of_way(junction, index, movement)
    _check_use(junction)
    _check_intergreens(junction)
    _check_red_bound(junction)
    _check_programs(junction)
    _check_schedule(junction)


def _check_hold(junction: Junction) -> None:
    hold_s = [junction.hold_min_s, junction.hold_max_s]
    if not 1 <= junction.hold_min_s <= junction.hold_max_s <= HOLD_MAX_S:
        raise SiteError("hold_s is not a window", hold_s, f"1 <= min <= max <= {HOLD_MAX_S}")


def _check_discharge(junction: Junction) -> None:
    if not junction.simulation_only and junction.discharge != "saturation":
        raise SiteError("discharge of a street is no saturation flow", junction.discharge, '"saturation"')


def _check_start(junction: Junction) -> None:
    if junction.first_stage >= len(junction.stages):
        raise SiteError("first_stage does not exist", junction.first_stage, f"below {len(junction.stages)}")
    if junction.cameras >> len(junction.approaches):
        wrong = "cameras names an approach that does not exist"
        raise SiteError(wrong, junction.cameras, f"a mask of {len(junction.approaches)} bits")
    _check_time("start_flash_s", junction.start_flash_ds)
    _check_time("start_red_s", junction.start_red_ds)
    if junction.junction_wait_ds > JUNCTION_WAIT_MAX_DS:
        raise SiteError(
            "junction_wait_ds is too long",
            junction.junction_wait_ds,
            f"at most {JUNCTION_WAIT_MAX_DS}: who stands in "
            "the junction for longer is held up by something that red does not clear",
        )


def _check_time(path: str, time_ds: int) -> None:
    if time_ds > TIME_MAX_DS:
        raise SiteError(f"{path} is too long", time_ds / 10, f"at most {seconds(TIME_MAX_DS)}")


def _check_amber(junction: Junction, group: Group) -> None:
    least_ds = 0 if junction.simulation_only else AMBER_MIN_DS
    if not least_ds <= group.amber_ds <= AMBER_MAX_DS:
        wrong = f"amber_s of group {group.name} is out of range"
        raise SiteError(wrong, group.amber_ds / 10, f"{seconds(least_ds)} to {seconds(AMBER_MAX_DS)}")
    _check_time(f"red_amber_s of group {group.name}", group.red_amber_ds)


def _check_green(junction: Junction, group: Group) -> None:
    least_ds = MIN_GREEN_SIMULATION_DS if junction.simulation_only else MIN_GREEN_STREET_DS
    if group.min_green_ds < least_ds:
        wrong = f"min_green_s of group {group.name} is too short"
        raise SiteError(wrong, group.min_green_ds / 10, f"at least {seconds(least_ds)}")
    if group.max_green_ds == 0 and not junction.simulation_only:
        wrong = f"max_green_s of group {group.name} is missing"
        raise SiteError(wrong, 0, f"{seconds(group.min_green_ds)} or more: a street bounds every green")
    if group.max_green_ds != 0 and group.max_green_ds < group.min_green_ds:
        wrong = f"max_green_s of group {group.name} is below its min_green_s"
        raise SiteError(wrong, group.max_green_ds / 10, f"at least {seconds(group.min_green_ds)}")
    _check_time(f"min_green_s of group {group.name}", group.min_green_ds)
    _check_time(f"max_green_s of group {group.name}", group.max_green_ds)


def _check_lamps(group: Group) -> None:
    if group.node >= NODE_MAX:
        raise SiteError(f"node of group {group.name} does not exist", group.node, f"0 to {NODE_MAX - 1}")


def _check_movement(junction: Junction, movement: Movement) -> None:
    pair = conflict_pair(junction.conflict, movement.groups)
    if pair is not None:
        first, second = (junction.groups[group].name for group in pair)
        wrong = f"movement {movement.name} needs {first} and {second}, which conflict"
        raise SiteError(wrong, junction.group_names(movement.groups), "groups that can be green together")
    if not movement.saturation_veh_per_s > 0.0:
        wrong = f"saturation_veh_per_s of movement {movement.name} lets nobody go"
        raise SiteError(wrong, movement.saturation_veh_per_s, "more than 0, a lane has about 0.5")
    if not movement.capacity_veh >= 0.0:
        wrong = f"capacity_veh of movement {movement.name} is negative"
        raise SiteError(wrong, movement.capacity_veh, "at least 0")
    if movement.limit_km_per_h and not LIMIT_MIN_KM_PER_H <= movement.limit_km_per_h <= LIMIT_MAX_KM_PER_H:
        wrong = f"speed_km_per_h of the approach of movement {movement.name} is no speed limit"
        raise SiteError(wrong, movement.limit_km_per_h, f"{LIMIT_MIN_KM_PER_H} to {LIMIT_MAX_KM_PER_H}")


def _check_rescue(junction: Junction, movement: Movement, stage: int) -> None:
    if stage >= len(junction.stages) or not junction.serves(stage, movement):
        wrong = f"the rescue stage of movement {movement.name} does not serve it"
        raise SiteError(wrong, stage, f"a stage with {' '.join(junction.group_names(movement.groups))}")


def _check_right_of_way(junction: Junction, index: int, movement: Movement) -> None:
    path = f"gives_way of movement {movement.name}"
    least, most = (1, 100) if movement.gives_way else (0, 0)
    if movement.gives_way >> len(junction.movements):
        wrong = f"{path} names a movement that does not exist"
        raise SiteError(wrong, movement.gives_way, f"a mask of {len(junction.movements)} bits")
    if not least <= movement.gives_way_percent <= most:
        wrong = f"gives_way_share of movement {movement.name} is out of range"
        raise SiteError(wrong, movement.gives_way_percent / 100, f"{least / 100} to {most / 100}")
    if movement.gives_way and junction.discharge != "saturation":
        raise SiteError(f"{path} has no meaning with discharge {junction.discharge}", junction.discharge, "saturation")
    for other in bits_of(movement.gives_way):
        if other == index:
            raise SiteError(f"{path} names itself", movement.name, "only other movements")
        if not junction.go_together(movement, junction.movements[other]):
            name = junction.movements[other].name
            raise SiteError(
                f"{path} names {name}, which never goes with it", name, "movements that some stage lets go too"
            )


def _check_use(junction: Junction) -> None:
    for index, name in enumerate(junction.approaches):
        count = sum(movement.approach == index for movement in junction.movements)
        if count > APPROACH_MOVEMENT_MAX:
            wrong = f"approach {name} has too many movements"
            raise SiteError(wrong, count, f"at most {APPROACH_MOVEMENT_MAX}: its counts travel in one frame")
        if all(movement.approach != index for movement in junction.movements):
            raise SiteError(f"approach {name} has no movement", name, "at least one movement, or no such approach")
    for index, group in enumerate(junction.groups):
        idle = all(not movement.groups >> index & 1 for movement in junction.movements)
        if idle and not junction.simulation_only:
            raise SiteError(f"group {group.name} is used by no movement", group.name, "use it, or leave it out")


def _check_intergreens(junction: Junction) -> None:
    for end in range(len(junction.groups)):
        for start in range(len(junction.groups)):
            _check_intergreen(junction, end, start)


def _check_intergreen(junction: Junction, end: int, start: int) -> None:
    ending, starting = junction.groups[end], junction.groups[start]
    time_ds = junction.intergreen_ds[end][start]
    pair = f"intergreen_ds from {ending.name} to {starting.name}"
    if not junction.conflict[end] >> start & 1:
        if time_ds != 0:
            raise SiteError(f"{pair}, which do not conflict", time_ds, "0")
        return
    least_ds = ending.amber_ds + starting.red_amber_ds
    if time_ds < least_ds:
        right = f"at least {least_ds}: amber {ending.amber_ds} + red-amber {starting.red_amber_ds}"
        raise SiteError(f"{pair} is too short", time_ds, right)
    if time_ds > TIME_MAX_DS:
        raise SiteError(f"{pair} is too long", time_ds, f"at most {TIME_MAX_DS}")


def _check_red_bound(junction: Junction) -> None:
    if junction.red_bound_ds == 0 and junction.simulation_only:
        return
    least_ds = junction.red_bound_min_ds()
    if not least_ds <= junction.red_bound_ds <= TIME_MAX_DS:
        wrong = "red_bound_s cannot be kept" if junction.red_bound_ds else "red_bound_s of a street is missing"
        changes = f"{len(set(junction.rescue_stages))} stages serve everybody, a change takes"
        right = f"{seconds(least_ds)} to {seconds(TIME_MAX_DS)}: {changes} up to {seconds(junction.change_ds())}"
        raise SiteError(wrong, junction.red_bound_ds / 10, right)


def _check_programs(junction: Junction) -> None:
    if not junction.programs and not junction.simulation_only:
        raise SiteError("a street has no programme", "none", "at least one, for the hours without a trusted camera")
    for program in junction.programs:
        _check_program(junction, program)


def _check_program(junction: Junction, program: Program) -> None:
    if not 1 <= len(program.steps) <= STEP_MAX:
        wrong = f"programme {program.name} has a wrong number of steps"
        raise SiteError(wrong, len(program.steps), f"1 to {STEP_MAX}")
    for index, step in enumerate(program.steps):
        _check_step(junction, f"step {index} of programme {program.name}", step)
    for movement in junction.movements:
        if not any(junction.serves(step.stage, movement) for step in program.steps):
            wrong = f"programme {program.name} never serves movement {movement.name}"
            right = f"a step whose stage has {' '.join(junction.group_names(movement.groups))}"
            raise SiteError(wrong, movement.name, right)


def _check_step(junction: Junction, path: str, step: Step) -> None:
    if step.stage >= len(junction.stages):
        raise SiteError(f"the stage of {path} does not exist", step.stage, f"below {len(junction.stages)}")
    for group in (junction.groups[index] for index in bits_of(junction.stages[step.stage])):
        if step.green_ds < group.min_green_ds:
            wrong = f"green_s of {path} is too short for group {group.name}"
            raise SiteError(wrong, step.green_ds / 10, f"at least {seconds(group.min_green_ds)}")
    _check_time(f"green_s of {path}", step.green_ds)


def _check_schedule(junction: Junction) -> None:
    for index, line in enumerate(junction.schedule):
        if line.from_min >= MINUTES_PER_DAY:
            raise SiteError(f"schedule[{index}].from is no time of day", line.from_min, f"below {MINUTES_PER_DAY}")
        if not 0 < line.weekdays < 1 << len(WEEKDAYS):
            raise SiteError(
                f"schedule[{index}].weekdays names no day, or none that there is", line.weekdays, "1 to 127"
            )
        if line.program >= len(junction.programs) and line.program != SCHEDULE_FLASH:
            raise SiteError(
                f"schedule[{index}].program does not exist", line.program, f"below {len(junction.programs)}"
            )
    for index, day in enumerate(junction.special_days):
        if day.weekday >= len(WEEKDAYS):
            raise SiteError(f"special_days[{index}].as is no weekday", day.weekday, f"below {len(WEEKDAYS)}")
