# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""What is in each figure of tools/plot: profiles, lines, titles, units and the curves printed in the paper.

Nothing here draws; see plot_draw.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean

from elmopp_tools.plot_data import Point, Row, points_of, trials_of

# With more different numbers of vehicles each trial is a point: few of them would share a number and have a mean.
LINES_MAX_N = 12

# Of the cumulative chooser's forecasts, which all but coincide, those that say something: without one, with those
# that are fitted, with a perfect one.
CUMULATIVE_DRAWN = ("none", "ar8", "lstm", "oracle")


@dataclass(frozen=True)
class Kind:
    """One figure; an axis whose largest mean is log_ratio times the smallest is logarithmic."""

    name: str
    title: str
    metric: str
    unit: str
    profiles: tuple[str, ...]
    log_ratio: float


@dataclass(frozen=True)
class Line:
    """A curve; its look follows from chooser and forecast."""

    name: str
    chooser: str
    forecast: str
    printed: bool
    points: list[Point]


@dataclass(frozen=True)
class Panel:
    title: str
    x_label: str
    y_label: str
    log_ratio: float
    lines: list[Line]

    @property
    def ours(self) -> list[Line]:
        return [line for line in self.lines if not line.printed]

    @property
    def counts(self) -> set[int]:
        """The numbers of vehicles of our lines."""
        return {point.vehicles for line in self.ours for point in line.points}

    @property
    def scattered(self) -> bool:
        return len(self.counts) > LINES_MAX_N

    @property
    def single(self) -> bool:
        """All at one number of vehicles: no line, but points side by side."""
        return len(self.counts) == 1


@dataclass(frozen=True)
class Figure:
    title: str
    panels: list[Panel]
    left_out: list[str]

    @property
    def has_best(self) -> bool:
        return any("@" in line.name for panel in self.panels for line in panel.ours)

    @property
    def trials(self) -> set[int]:
        """How many trials the points stand for."""
        return {point.trials for panel in self.panels for line in panel.ours for point in line.points}

    @property
    def has_printed(self) -> bool:
        return any(line.printed for panel in self.panels for line in panel.lines)


BOTH = ("paper", "saturation")
KINDS = (
    Kind("throughput", "Throughput", "throughput_veh_per_s", "vehicles/s", (*BOTH, "figure"), float("inf")),
    Kind("delay", "Mean delay", "mean_delay_s", "seconds per vehicle", BOTH, 20.0),
    # A logarithmic axis of less than a factor three has hardly a round number on it.
    Kind("longest_red", "Longest red that a waiting vehicle saw", "longest_red_s", "seconds", BOTH, 3.0),
)

TITLES = {
    "paper": "Profile paper: discharge by Greenshields, window 10 to 60 s",
    "saturation": "Profile saturation: queues leave at 0.5 vehicle/s a lane",
    "figure": "Profile figure: the reading nearest to the printed curve of ELMOPP",
}
X_LABEL = "vehicles per approach, N"

# The profile figure shares N among the approaches and measures a throughput of its own.
FIGURE_METRIC = "figure_throughput_veh_per_s"
FIGURE_X_LABEL = "vehicles on all approaches together, N"
FIGURE_Y_LABEL = "figure_throughput: Σo²/Σo\nof the outflow o, vehicles/s"

PRINTED_IN = ("paper", "figure")
PRINTED_N = (200, 400, 600, 800, 1000)
PRINTED = {
    ("ELMOPP", "cumulative", "ar8"): (2.31937, 2.17839, 2.06249, 1.97497, 1.92143),
    ("ITLC", "itlc", "none"): (1.692, 1.883, 1.8520, 1.8593, 1.8844),
    ("OAF", "oaf", "none"): (1.2174, 1.05736, 1.1540, 1.1057, 1.07094),
}


def make_figure(kind: Kind, rows: Sequence[Row]) -> Figure:
    """The panels for which there are rows; perhaps none."""
    here = [row for row in rows if row.profile in kind.profiles]
    plain = [row for profile in kind.profiles for row in _with_best([row for row in here if row.profile == profile])]
    drawn = _without_twins(plain)
    panels = [
        _panel(kind, profile, lines)
        for profile in kind.profiles
        if (lines := [row for row in drawn if row.profile == profile])
    ]
    kept = {row.name for row in drawn}
    return Figure(kind.title, panels, list(dict.fromkeys(row.name for row in plain if row.name not in kept)))


def _with_best(rows: list[Row]) -> list[Row]:
    """Each sweep of beside.csv gives way to its best value, by mean delay, which stands for the chooser."""
    swept = {row.family for row in rows if row.beside and row.family != row.chooser}
    best = {family: _best([row for row in rows if row.family == family]) for family in swept}
    return [row for row in rows if best.get(row.family, row.chooser) == row.chooser]


def _best(rows: list[Row]) -> str:
    delays: dict[str, list[float]] = {}
    for row in rows:
        delays.setdefault(row.chooser, []).append(row.metrics["mean_delay_s"])
    return min(delays, key=lambda chooser: fmean(delays[chooser]))


def _without_twins(rows: list[Row]) -> list[Row]:
    """Without the forecasts of the cumulative chooser that need not be shown, unless there are no others."""
    shown = [row for row in rows if row.chooser != "cumulative" or row.forecast in CUMULATIVE_DRAWN]
    return shown if any(row.chooser == "cumulative" for row in shown) else rows


def _panel(kind: Kind, profile: str, rows: list[Row]) -> Panel:
    is_figure = profile == "figure"
    return Panel(
        title=TITLES.get(profile, f"Profile {profile}"),
        x_label=FIGURE_X_LABEL if is_figure else X_LABEL,
        y_label=FIGURE_Y_LABEL if is_figure else f"{kind.title.split(' that ')[0].lower()}, {kind.unit}",
        log_ratio=kind.log_ratio,
        lines=_ours(rows, FIGURE_METRIC if is_figure else kind.metric)
        + (_printed() if kind.name == "throughput" and profile in PRINTED_IN else []),
    )


def _ours(rows: Sequence[Row], metric: str) -> list[Line]:
    make_points = trials_of if len({row.vehicles for row in rows}) > LINES_MAX_N else points_of
    by_name: dict[tuple[str, str, str], list[Row]] = {}
    for row in rows:
        by_name.setdefault((row.name, row.chooser, row.forecast), []).append(row)
    return [Line(*name, printed=False, points=make_points(here, metric)) for name, here in by_name.items()]


def _printed() -> list[Line]:
    return [
        Line(
            name=f"{name}, printed",
            chooser=chooser,
            forecast=forecast,
            printed=True,
            points=[Point(vehicles, value, 0.0, 1) for vehicles, value in zip(PRINTED_N, values, strict=True)],
        )
        for (name, chooser, forecast), values in PRINTED.items()
    ]
