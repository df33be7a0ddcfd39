# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Says whether a Junction may stand in a street: the rules of elmopp_site_check() in the firmware, in people's words.

A simulation_only site may have zero amber and intergreens and one second of minimum green; all else holds for it too.
"""

from elmopp_tools.site_model import Group, Junction, Movement, SiteError, seconds
from elmopp_tools.stages import conflict_pair

HOLD_MAX_S = 150  # ELMOPP_HORIZON_MAX: the urgency looks as far as the window is long
AMBER_MIN_DS = 30
AMBER_MAX_DS = 60
MIN_GREEN_STREET_DS = 50
MIN_GREEN_SIMULATION_DS = 10


def check_junction(junction: Junction) -> None:
    """Raises SiteError at the first rule that the junction breaks."""
    _check_hold(junction)
    _check_discharge(junction)
    for group in junction.groups:
        _check_amber(junction, group)
        _check_green(junction, group)
    for movement in junction.movements:
        _check_movement(junction, movement)
    _check_use(junction)
    _check_intergreens(junction)


def _check_hold(junction: Junction) -> None:
    hold_s = [junction.hold_min_s, junction.hold_max_s]
    if not 1 <= junction.hold_min_s <= junction.hold_max_s <= HOLD_MAX_S:
        raise SiteError("hold_s is not a window", hold_s, f"1 <= min <= max <= {HOLD_MAX_S}")


def _check_discharge(junction: Junction) -> None:
    if not junction.simulation_only and junction.discharge != "saturation":
        raise SiteError("discharge of a street is no saturation flow", junction.discharge, '"saturation"')


def _check_amber(junction: Junction, group: Group) -> None:
    least_ds = 0 if junction.simulation_only else AMBER_MIN_DS
    if not least_ds <= group.amber_ds <= AMBER_MAX_DS:
        wrong = f"amber_s of group {group.name} is out of range"
        raise SiteError(wrong, group.amber_ds / 10, f"{seconds(least_ds)} to {seconds(AMBER_MAX_DS)}")


def _check_green(junction: Junction, group: Group) -> None:
    least_ds = MIN_GREEN_SIMULATION_DS if junction.simulation_only else MIN_GREEN_STREET_DS
    if group.min_green_ds < least_ds:
        wrong = f"min_green_s of group {group.name} is too short"
        raise SiteError(wrong, group.min_green_ds / 10, f"at least {seconds(least_ds)}")
    if group.max_green_ds != 0 and group.max_green_ds < group.min_green_ds:
        wrong = f"max_green_s of group {group.name} is below its min_green_s"
        raise SiteError(wrong, group.max_green_ds / 10, f"at least {seconds(group.min_green_ds)}, or 0 for no bound")


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


def _check_use(junction: Junction) -> None:
    for index, name in enumerate(junction.approaches):
        if all(movement.approach != index for movement in junction.movements):
            raise SiteError(f"approach {name} has no movement", name, "at least one movement, or no such approach")
    for index, group in enumerate(junction.groups):
        if all(not movement.groups >> index & 1 for movement in junction.movements):
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
