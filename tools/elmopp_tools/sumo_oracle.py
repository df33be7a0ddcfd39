# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""An oracle for a SUMO simulation: what one run has counted is what the next one is told.

Vehicles and their departures are those of the seed, whatever signals do, so who comes to the reach of a lane, and when,
hangs little on the signals as long as no queue is longer than the reach and no other signal lies before it. How little
is not assumed: foretold() compares what was recorded with what then came. Pure: it knows no SUMO.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from elmopp_tools.library import FORESEEN_MAX_S
from elmopp_tools.sumo_report import number
from elmopp_tools.sumo_signal import Signal

FORETOLD_COLUMNS = ("scenario", "chooser", "seed", "vehicles", "within_0_s", "within_1_s", "within_3_s", "skill")


class Record:
    """Who came into the reach of every signal, second by second of a run."""

    def __init__(self, signals: Sequence[Signal]) -> None:
        self._approaches = [signal.approaches for signal in signals]
        self.came_veh: list[list[list[float]]] = [[[] for _ in signal.approaches] for signal in signals]
        self.first_s: list[dict[str, int]] = [{} for _ in signals]  # [signal] in which second who came first
        self.seconds = 0

    def note(self, arrived_veh: Sequence[Sequence[float]], came: Sequence[Iterable[str]]) -> None:
        """The next second. Both by signal: arrivals of its movements, and who they were."""
        self.seconds += 1
        for signal, approaches in enumerate(self._approaches):
            for series, movements in zip(self.came_veh[signal], approaches, strict=True):
                series.append(sum(arrived_veh[signal][movement] for movement in movements))
            for who in came[signal]:
                self.first_s[signal].setdefault(who, self.seconds)

    def rows(self, signal: int, second: int) -> list[list[float]]:
        """For each approach who comes in the seconds after a second; nobody after the end of the run."""
        last = second + FORESEEN_MAX_S
        nobody = [0.0] * FORESEEN_MAX_S
        return [(series[second:last] + nobody)[:FORESEEN_MAX_S] for series in self.came_veh[signal]]


@dataclass(frozen=True)
class Foretold:
    """How well a record has foretold a run.

    Shares are of those who came in the run, at each signal: in how many seconds of the recorded one. `skill` is that of
    the rows, second by second: 1 for a record that was right, 0 for one that is as good as each approach's mean.
    """

    vehicles: int
    within_0_s: float
    within_1_s: float
    within_3_s: float
    skill: float

    def cells(self) -> dict[str, str]:
        """By the name of the column."""
        shares = {name: number(getattr(self, name)) for name in FORETOLD_COLUMNS[4:]}
        return {"vehicles": str(self.vehicles), **shares}


def foretold(recorded: Record, seen: Record) -> Foretold:
    """Of two runs with the same signals."""
    apart_s = [
        abs(second - before.get(who, -FORESEEN_MAX_S))
        for before, now in zip(recorded.first_s, seen.first_s, strict=True)
        for who, second in now.items()
    ]
    shares = [sum(1 for apart in apart_s if apart <= most) / max(1, len(apart_s)) for most in (0, 1, 3)]
    missed = varied = 0.0
    for before_rows, now_rows in zip(recorded.came_veh, seen.came_veh, strict=True):
        for before, now in zip(before_rows, now_rows, strict=True):
            said = (before + [0.0] * len(now))[: len(now)]
            mean = sum(now) / max(1, len(now))
            missed += sum((a - b) ** 2 for a, b in zip(said, now, strict=True))
            varied += sum((a - mean) ** 2 for a in now)
    return Foretold(len(apart_s), shares[0], shares[1], shares[2], 1.0 - missed / varied if varied else 0.0)
