# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""What a site does by the clock and when a bound on red is near: rescue stages, programmes, schedule, special days."""

import datetime
import re
from collections.abc import Sequence

from elmopp_tools.site_model import (
    NAME_SIZE,
    PROGRAM_MAX,
    SCHEDULE_FLASH,
    SCHEDULE_MAX,
    SPECIAL_DAY_MAX,
    STEP_MAX,
    WEEKDAYS,
    Group,
    Movement,
    Program,
    ScheduleLine,
    SiteError,
    SpecialDay,
    Step,
)
from elmopp_tools.site_words import Document, check_count, checked_name, mask_of, tenths
from elmopp_tools.stages import bits_of, smallest_cover

DAY_0 = datetime.date(2000, 1, 1)
LAST_DAY = 65535
DEFAULT_GREEN_DS = 150
FLASH = "flash"  # what a line of the schedule says instead of a programme's name


def rescue_stages(stages: Sequence[int], movements: Sequence[Movement]) -> tuple[int, ...]:
    """For each movement a stage that serves it, from the smallest set of stages that serves all; the first such set.

    A movement that no stage serves gets 0, and is refused elsewhere by name.
    """
    served = [sum((stage & m.groups == m.groups) << j for j, m in enumerate(movements)) for stage in stages]
    servable = 0
    for mask in served:
        servable |= mask
    cover = smallest_cover(served, servable)
    return tuple(next((stage for stage in cover if served[stage] >> j & 1), 0) for j in range(len(movements)))


def default_program(rescue: Sequence[int], stages: Sequence[int], groups: Sequence[Group]) -> Program:
    """The rescue stages one after the other, for streets that name no programme."""
    steps = []
    for stage in sorted(set(rescue)):
        shortest_ds = max(groups[group].min_green_ds for group in bits_of(stages[stage]))
        steps.append(Step(stage, max(DEFAULT_GREEN_DS, shortest_ds)))
    check_count(steps, "stages for a programme that serves all movements", "ELMOPP_STEP_MAX", STEP_MAX)
    return Program("default", tuple(steps))


def programs(items: Sequence[Document], stages: Sequence[int], group_names: Sequence[str]) -> tuple[Program, ...]:
    """The written programmes."""
    check_count(items, "programs", "ELMOPP_PROGRAM_MAX", PROGRAM_MAX)
    made: list[Program] = []
    for index, item in enumerate(items):
        name = checked_name(f"programs[{index}].name", item["name"], NAME_SIZE)
        if name == FLASH or any(program.name == name for program in made):
            raise SiteError(f"programs[{index}].name is taken", name, "every name once, and not flash")
        check_count(item["steps"], f"steps in programme {name}", "ELMOPP_STEP_MAX", STEP_MAX)
        steps = enumerate(item["steps"])
        made.append(
            Program(name, tuple(_step(f"step {i} of programme {name}", s, stages, group_names) for i, s in steps))
        )
    return tuple(made)


def stage_of(path: str, written: Sequence[str], stages: Sequence[int], group_names: Sequence[str]) -> int:
    """The index of a stage that is written as its groups."""
    mask = mask_of(group_names, written, f"{path}: group")
    if mask not in stages:
        raise SiteError(
            f"{path} is no stage", list(written), f"all groups of one stage{_nearest(mask, stages, group_names)}"
        )
    return stages.index(mask)


def _nearest(mask: int, stages: Sequence[int], group_names: Sequence[str]) -> str:
    """The stage that shares most with a set of groups, as an example for a message."""
    near = max(stages, key=lambda stage: (stage & mask).bit_count() - (mask & ~stage).bit_count())
    return f", for example {' '.join(group_names[group] for group in bits_of(near))}"


def schedule(items: Sequence[Document], made: Sequence[Program]) -> tuple[ScheduleLine, ...]:
    """The weekly schedule. Two lines that begin together would leave open which one holds."""
    check_count(items, "lines in schedule", "ELMOPP_SCHEDULE_MAX", SCHEDULE_MAX)
    lines = tuple(_line(index, item, made) for index, item in enumerate(items))
    for index, line in enumerate(lines):
        for earlier in lines[:index]:
            both = line.weekdays & earlier.weekdays
            if both and line.from_min == earlier.from_min:
                day = WEEKDAYS[next(bits_of(both))]
                wrong = f"schedule[{index}] begins with another line on {day}"
                raise SiteError(wrong, items[index]["from"], "one line for each weekday and minute")
    return lines


def special_days(items: Sequence[Document]) -> tuple[SpecialDay, ...]:
    """The dates that follow another weekday."""
    check_count(items, "special_days", "ELMOPP_SPECIAL_DAY_MAX", SPECIAL_DAY_MAX)
    days = tuple(
        SpecialDay(_day(f"special_days[{i}].date", d["date"]), WEEKDAYS.index(d["as"])) for i, d in enumerate(items)
    )
    for index, day in enumerate(days):
        if any(day.day == earlier.day for earlier in days[:index]):
            raise SiteError(f"special_days[{index}].date is taken", items[index]["date"], "every date once")
    return days


def _step(path: str, item: Document, stages: Sequence[int], group_names: Sequence[str]) -> Step:
    return Step(stage_of(path, item["stage"], stages, group_names), tenths(f"green_s of {path}", item["green_s"]))


def _line(index: int, item: Document, made: Sequence[Program]) -> ScheduleLine:
    name = item["program"]
    known = [program.name for program in made]
    if name not in (*known, FLASH):
        raise SiteError(f"schedule[{index}].program is not known", name, f"one of {', '.join([*known, FLASH])}")
    return ScheduleLine(
        from_min=_minute(f"schedule[{index}].from", item["from"]),
        weekdays=mask_of(WEEKDAYS, item["weekdays"], f"schedule[{index}].weekdays: day"),
        program=SCHEDULE_FLASH if name == FLASH else known.index(name),
    )


def _minute(path: str, text: str) -> int:
    found = re.fullmatch(r"([01][0-9]|2[0-3]):([0-5][0-9])", text)
    if found is None:
        raise SiteError(f"{path} is no time of day", text, "HH:MM from 00:00 to 23:59")
    return int(found[1]) * 60 + int(found[2])


def _day(path: str, text: str) -> int:
    if re.fullmatch(r"[0-9]{4}-[0-9]{2}-[0-9]{2}", text) is None:
        raise SiteError(f"{path} is no date", text, "YYYY-MM-DD")
    try:
        day = (datetime.date.fromisoformat(text) - DAY_0).days
    except ValueError:
        raise SiteError(f"{path} is no date", text, "a day that the calendar has") from None
    if not 0 <= day <= LAST_DAY:
        last = DAY_0 + datetime.timedelta(days=LAST_DAY)
        raise SiteError(f"{path} is out of range", text, f"{DAY_0} to {last}")
    return day
