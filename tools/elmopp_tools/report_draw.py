# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Figures that only tools/report has: ours against the best rival by scenario, one run, and paths of vehicles.

Each is returned as SVG; the same data give the same bytes. Colours are those of plot_look, which colour-blind readers
tell apart; where a colour alone would carry a meaning, a letter or a place carries it, too.
"""

import io
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure as Sheet
from matplotlib.patches import Patch

from elmopp_tools.plot_look import BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILLION, our_settings
from elmopp_tools.report_data import Log, Table, Way

WIDTH = 7.5  # inches
ROW_HEIGHT = 0.22
SECONDS_FORESEEN = 60  # what the decision log's forecast is the sum of
APPROACHES_MAX = 4

MARKERS = "os^Dv<>ph"
COLORS = (BLUE, VERMILLION, GREEN, ORANGE, PURPLE, SKY, GREY)
# By the digit of the decision log: dark, red, red and amber, green, amber, flashing amber, flashing red.
LAMPS = {"0": "#ffffff", "1": VERMILLION, "2": PURPLE, "3": GREEN, "4": ORANGE, "5": "#F0E442", "6": "#7a2f00"}
LAMP_NAMES = ("dark", "red", "red and amber", "green", "amber", "flashing amber", "flashing red")


def ratios(ours: Table) -> bytes:
    """Delay as a share of the best rival's, by scenario, with the interval of the paired difference."""
    scenarios = sorted({row["scenario"] for row in ours})
    names = list(dict.fromkeys(row["chooser"] for row in ours))
    with our_settings():
        sheet = Sheet(figsize=(WIDTH, 1.1 + ROW_HEIGHT * len(scenarios)), layout="constrained")
        axes = sheet.add_subplot()
        axes.axvline(1.0, color=GREY, linewidth=1.0)
        step = 0.7 / max(1, len(names))
        for index, name in enumerate(names):
            rows = [row for row in ours if row["chooser"] == name]
            rival = np.array([float(row["rival_delay_s"]) for row in rows])
            low, high = (np.array([float(row[key]) for row in rows]) / rival for key in ("ci_low_s", "ci_high_s"))
            middle = 1.0 + 0.5 * (low + high)
            y = np.array([scenarios.index(row["scenario"]) for row in rows]) + (index - (len(names) - 1) / 2.0) * step
            color, marker = COLORS[index % len(COLORS)], MARKERS[index % len(MARKERS)]
            axes.hlines(y, 1.0 + low, 1.0 + high, color=color, linewidth=1.2)
            axes.plot(middle, y, marker, color=color, markersize=4.5, label=name)
        _limit(axes, ours)
        axes.set_yticks(range(len(scenarios)), scenarios)
        axes.invert_yaxis()
        axes.set_xlabel("mean delay, best rival of the scenario = 1; bars: 95 % interval of the paired difference")
        sheet.legend(loc="outside upper left", ncols=4)
        return _svg(sheet, "Mean delay beside the best rival of each scenario")


def _limit(axes: Axes, ours: Table) -> None:
    """What is far off would press all else together: it is cut off, and the tables have it."""
    values = sorted(float(row["ratio"]) for row in ours)
    axes.set_xlim(min(0.75, values[0] - 0.05), max(1.15, min(values[-1] + 0.1, 1.6)))


def run(log: Log) -> bytes:
    """Vehicles of each movement, lamps of each group, and the forecast beside what came."""
    t_s = np.array(log.t_s)
    present = np.array(log.present).T
    groups = _groups(log)
    heights = [ROW_HEIGHT * len(present) + 0.5, ROW_HEIGHT * len(groups) + 0.5, 1.7]
    with our_settings():
        sheet = Sheet(figsize=(WIDTH, sum(heights) + 0.9), layout="constrained")
        queues, lamps, foresight = sheet.subplots(3, 1, sharex=True, height_ratios=heights)
        _draw_present(sheet, queues, t_s, present)
        _draw_lamps(lamps, t_s, groups)
        _draw_forecast(foresight, t_s, log)
        foresight.set_xlabel("seconds")
        handles = [Patch(facecolor=LAMPS[str(d)], edgecolor=GREY, label=LAMP_NAMES[d]) for d in range(1, 5)]
        sheet.legend(handles=handles, loc="outside lower center", ncols=len(handles))
        return _svg(sheet, "One run: queues, lamps and forecast")


def _groups(log: Log) -> list[list[int]]:
    """The aspects of the groups that are ever lit."""
    columns = [[int(aspects[g]) for aspects in log.aspects] for g in range(len(log.aspects[0]))]
    return [column for column in columns if any(column)] or columns[:1]


def _draw_present(sheet: Sheet, axes: Axes, t_s: np.ndarray, present: np.ndarray) -> None:
    mesh = axes.imshow(
        present, aspect="auto", cmap="cividis", interpolation="nearest", extent=(t_s[0], t_s[-1] + 1.0, len(present), 0)
    )
    axes.set_yticks(np.arange(len(present)) + 0.5, [str(j) for j in range(len(present))])
    axes.grid(visible=False)
    axes.set_ylabel("movement")
    axes.set_title("vehicles counted", loc="left", size=9)
    sheet.colorbar(mesh, ax=axes, label="vehicles", fraction=0.04, pad=0.01)


def _draw_lamps(axes: Axes, t_s: np.ndarray, groups: list[list[int]]) -> None:
    colors = ListedColormap([LAMPS[str(d)] for d in range(7)])
    axes.imshow(
        np.array(groups),
        aspect="auto",
        cmap=colors,
        norm=BoundaryNorm(np.arange(-0.5, 7.0), 7),
        interpolation="nearest",
        extent=(t_s[0], t_s[-1] + 1.0, len(groups), 0),
    )
    axes.set_yticks(np.arange(len(groups)) + 0.5, [str(g) for g in range(len(groups))])
    axes.grid(visible=False)
    axes.set_ylabel("group")
    axes.set_title("lamps", loc="left", size=9)


def _draw_forecast(axes: Axes, t_s: np.ndarray, log: Log) -> None:
    arrived = np.array(log.arrived).sum(axis=1)
    before = np.concatenate(([0.0], np.cumsum(arrived)))
    came = before[1 + SECONDS_FORESEEN :] - before[1:-SECONDS_FORESEEN]
    axes.plot(t_s, np.array(log.forecast).sum(axis=1), color=BLUE, linestyle=(0.0, (5.0, 2.0)), label="forecast")
    axes.plot(t_s[: len(came)], came, color=VERMILLION, label="came")
    axes.set_ylabel("vehicles")
    axes.set_title("the next 60 s, all approaches", loc="left", size=9)
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.1, ncols=2)  # above: no line is there


def ways(all_ways: Sequence[Way]) -> bytes:
    """Distance to the stop line over time, a panel each for the approaches with most vehicles."""
    counts: dict[str, int] = {}
    for way in all_ways:
        counts[way.approach] = counts.get(way.approach, 0) + 1
    shown = sorted(counts, key=lambda approach: (-counts[approach], approach))[:APPROACHES_MAX]
    with our_settings():
        sheet = Sheet(figsize=(WIDTH, 0.5 + 1.8 * len(shown)), layout="constrained")
        for axes, approach in zip(np.atleast_1d(sheet.subplots(len(shown), 1, sharex=True)), shown, strict=True):
            lines = [np.column_stack((way.t_s, way.distance_m)) for way in all_ways if way.approach == approach]
            axes.add_collection(LineCollection(lines, colors=BLUE, linewidths=0.6))
            axes.autoscale_view()
            axes.invert_yaxis()
            axes.set_title(approach, loc="left", size=9)
            axes.set_ylabel("metres to go")
        axes.set_xlabel("seconds")
        return _svg(sheet, "Time and space")


def _svg(sheet: Sheet, title: str) -> bytes:
    stream = io.BytesIO()
    sheet.savefig(stream, format="svg", metadata={"Date": None, "Creator": None, "Title": title})
    return stream.getvalue()
