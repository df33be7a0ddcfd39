# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Draws a figure of plot_figures with matplotlib and returns the bytes of its files.

Panels stand one below the other, each with its labels beside it; see plot_labels.
"""

import io
import math
import textwrap

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Sheet
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator
from matplotlib.transforms import ScaledTranslation, Transform

from elmopp_tools.plot_figures import LINES_MAX_N, Figure, Line, Panel
from elmopp_tools.plot_labels import POINTS_PER_INCH, Margin, Range, draw_labels
from elmopp_tools.plot_look import DASHED, NO_LINE, QUIET, SOLID, Look, looks_of, our_settings

PNG_DPI = 150

# Inches.
WIDTH = 7.5
LEFT = 0.72
PLOT_WIDTH = 4.45
PLOT_HEIGHT = 2.3
ABOVE_PLOT = 0.42
BELOW_PLOT = 0.5
HEAD = 0.27
FOOT = 0.3
FOOT_LINE = 0.16
NOTE_WIDTH = 110  # characters

LOG_TICKS_MAX = 10  # of those that are powers of ten

SHIFT_STEP = 16.0  # points between dots that stand side by side

Array = npt.NDArray[np.float64]


def draw_figure(figure: Figure) -> dict[str, bytes]:
    """The files of a figure by suffix; the same figure gives the same bytes, whatever settings the user has."""
    with our_settings():
        sheet = _sheet(figure)
        return {
            "png": _bytes(sheet, "png", {"Software": None}),
            "svg": _bytes(sheet, "svg", {"Date": None, "Creator": None, "Title": figure.title}),
        }


def _bytes(sheet: Sheet, suffix: str, metadata: dict[str, str | None]) -> bytes:
    stream = io.BytesIO()
    sheet.savefig(stream, format=suffix, metadata=metadata)
    return stream.getvalue()


def _sheet(figure: Figure) -> Sheet:
    notes = _notes(figure)
    foot = FOOT + FOOT_LINE * len(notes)
    step = ABOVE_PLOT + PLOT_HEIGHT + BELOW_PLOT
    height = HEAD + step * len(figure.panels) + foot
    sheet = Sheet(figsize=(WIDTH, height), dpi=PNG_DPI)
    sheet.text(LEFT / WIDTH, 1 - 0.12 / height, figure.title, size=12, weight="bold", va="top")
    looks = looks_of([panel.lines for panel in figure.panels])
    for index, panel in enumerate(figure.panels):
        bottom = height - HEAD - index * step - ABOVE_PLOT - PLOT_HEIGHT
        axes = sheet.add_axes((LEFT / WIDTH, bottom / height, PLOT_WIDTH / WIDTH, PLOT_HEIGHT / height))
        _draw_panel(sheet, axes, panel, looks)
    _draw_key(sheet, figure, (foot - 0.05) / height)
    for index, note in enumerate(reversed(notes)):
        sheet.text(LEFT / WIDTH, (0.09 + index * FOOT_LINE) / height, note, size=7.5, color=QUIET)
    return sheet


def _notes(figure: Figure) -> list[str]:
    notes = []
    if any(not panel.scattered for panel in figure.panels):
        notes.append("Numbers beside the names: the mean at the largest N.")
    if any(panel.single for panel in figure.panels):
        notes.append("With a single number of vehicles, the points of ours stand side by side.")
    if figure.has_best:
        notes.append("A name with @ is the best value of that chooser's sweep, by mean delay.")
    if figure.left_out:
        notes += textwrap.wrap(f"Not drawn: {', '.join(figure.left_out)}.", NOTE_WIDTH)
    return notes


def _draw_key(sheet: Sheet, figure: Figure, top: float) -> None:
    """What line, shade and dashes mean; the names are beside the lines."""
    several = max(figure.trials) > 1
    trials = f"{max(figure.trials)} trials" if len(figure.trials) == 1 else "the trials"
    dots = all(panel.scattered or panel.single for panel in figure.panels)
    ours = Look(QUIET, "o", 0, linestyle=NO_LINE if dots else SOLID, size=4.0)
    handles: list[Line2D | Patch] = [ours.artist([], [])]
    labels = [f"ours, mean of {trials}" if several else "ours, each point one trial"]
    if several:
        shade = Patch(color=QUIET, alpha=0.25, linewidth=0)
        handles.append(Look(QUIET, "|", 0, linestyle=NO_LINE, size=9.0).artist([], []) if dots else shade)
        labels.append("95 % interval of the mean")
    if figure.has_printed:
        handles.append(Look(QUIET, "", 0, linestyle=DASHED).artist([], []))
        labels.append("printed in the paper")
    sheet.legend(
        handles=handles,
        labels=labels,
        loc="upper left",
        bbox_to_anchor=(LEFT / WIDTH, top),
        ncols=len(handles),
        borderaxespad=0.0,
        borderpad=0.0,
        handlelength=2.6,
        columnspacing=1.8,
    )


def _draw_panel(sheet: Sheet, axes: Axes, panel: Panel, looks: dict[str, Look]) -> None:
    axes.set_title(panel.title, loc="left", size=9, pad=6)
    axes.set_xlabel(panel.x_label)
    axes.set_ylabel(panel.y_label)
    counts = sorted({point.vehicles for line in panel.lines for point in line.points})
    _set_x(axes, counts)
    scale = _range(panel)
    _set_y(axes, scale)
    shifts = _shifts(panel)
    for line in panel.lines:
        if line.printed or not (panel.scattered or panel.single):
            _draw_line(axes, line, looks[line.name], scale)
        else:
            move = ScaledTranslation(shifts[line.name] / POINTS_PER_INCH, 0.0, sheet.dpi_scale_trans)
            _draw_dots(axes, line, looks[line.name], scale, axes.transData + move)
    draw_labels(Margin(sheet, axes), panel, looks, scale)


def _set_x(axes: Axes, counts: list[int]) -> None:
    low, high = counts[0], counts[-1]
    pad = 0.035 * (high - low) if high > low else max(1.0, 0.1 * low)
    axes.set_xlim(low - pad, high + pad)
    if len(counts) > LINES_MAX_N:
        return
    # Ticks where the points are, as far as there is room for their numbers.
    room = 0.07 * (high - low)
    ticks: list[int] = []
    for count in counts:
        if not ticks or count - ticks[-1] >= room:
            ticks.append(count)
    axes.xaxis.set_major_locator(FixedLocator(ticks))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.0f}"))


def _range(panel: Panel) -> Range:
    points = [point for line in panel.lines for point in line.points]
    means = [point.mean for point in points]
    if min(means) > 0.0 and max(means) > panel.log_ratio * min(means):
        return Range(min(means) / 1.2, max(means) * 1.2, log=True)
    low = min(point.mean - point.half_width for point in points)
    high = max(point.mean + point.half_width for point in points)
    pad = 0.05 * (high - low) if high > low else max(0.1 * abs(high), 0.1)
    # Nothing measured here can be below zero, so an interval is cut there.
    floor = 0.0 if min(means) > 0.0 else min(means) - pad
    return Range(max(floor, low - pad), high + pad, log=False)


def _set_y(axes: Axes, scale: Range) -> None:
    axes.set_yscale("log" if scale.log else "linear")
    axes.set_ylim(scale.low, scale.high)
    if scale.log:
        axes.yaxis.set_major_locator(FixedLocator(_log_ticks(scale)))
        axes.yaxis.set_minor_locator(NullLocator())
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))


def _log_ticks(scale: Range) -> list[float]:
    decades = range(math.floor(math.log10(scale.low)), math.ceil(math.log10(scale.high)) + 1)
    steps = (1, 2, 5) if len(decades) <= 5 else (1,)
    every = math.ceil(len(decades) / LOG_TICKS_MAX)
    ticks = [step * 10.0**decade for decade in decades[::every] for step in steps]
    return [tick for tick in ticks if scale.low <= tick <= scale.high]


def _shifts(panel: Panel) -> dict[str, float]:
    """By how many points our dots stand beside their place, so that they do not hide each other."""
    if not panel.single:
        return dict.fromkeys((line.name for line in panel.ours), 0.0)
    step = min(SHIFT_STEP, 0.8 * PLOT_WIDTH * POINTS_PER_INCH / len(panel.ours))
    middle = (len(panel.ours) - 1) / 2.0
    return {line.name: step * (index - middle) for index, line in enumerate(panel.ours)}


def _draw_line(axes: Axes, line: Line, look: Look, scale: Range) -> None:
    x, mean, low, high = _arrays(line, scale)
    if (high > low).any():
        axes.fill_between(x, low, high, color=look.color, alpha=0.13, linewidth=0, zorder=1)
    axes.add_line(look.artist(x, mean))


def _draw_dots(axes: Axes, line: Line, look: Look, scale: Range, transform: Transform) -> None:
    x, mean, low, high = _arrays(line, scale)
    for at, *interval in zip(x, low, high, strict=True):
        if interval[1] > interval[0]:
            bar = Line2D([at, at], interval, color=look.color, linewidth=0.9, alpha=0.6)
            bar.set_transform(transform)
            axes.add_line(bar)
    dots = look.artist(x, mean, linestyle=NO_LINE)
    dots.set_transform(transform)
    axes.add_line(dots)


def _arrays(line: Line, scale: Range) -> tuple[Array, Array, Array, Array]:
    """Numbers of vehicles, means, and the ends of the intervals as far as the axis goes."""
    x = np.array([point.vehicles for point in line.points], dtype=np.float64)
    mean = np.array([point.mean for point in line.points])
    half = np.array([point.half_width for point in line.points])
    return x, mean, np.maximum(mean - half, scale.low), mean + half
