# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The column of labels beside a panel.

It lists the lines in the order in which they end, each with a sample of its look and the mean at its end, so that
lines that coincide can still be told apart.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.figure import Figure as Sheet
from matplotlib.lines import Line2D
from matplotlib.text import Text
from matplotlib.transforms import Affine2D

from elmopp_tools.plot_figures import Line, Panel
from elmopp_tools.plot_look import INK, NO_LINE, Look

POINTS_PER_INCH = 72.0

# Points, from the right edge of a panel.
LEADER = (2.0, 12.0)
SAMPLE = (15.0, 26.0, 37.0)
NAME_WITHOUT_VALUE = 43.0
VALUE_RIGHT = 66.0
NAME = 72.0
STEP = 11.5
SIZE = 8.0


@dataclass(frozen=True)
class Range:
    """What the vertical axis of a panel shows."""

    low: float
    high: float
    log: bool

    def share(self, value: float) -> float:
        """Where a value stands, 0 at the bottom and 1 at the top."""
        if self.log:
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)


class Margin:
    """The space right of a panel, measured in points from the panel's lower right corner."""

    def __init__(self, sheet: Sheet, axes: Axes) -> None:
        box = axes.get_position()
        x, y = box.x1 * sheet.get_figwidth(), box.y0 * sheet.get_figheight()
        self._sheet = sheet
        self._transform = Affine2D().scale(1.0 / POINTS_PER_INCH).translate(x, y) + sheet.dpi_scale_trans
        self.height = box.height * sheet.get_figheight() * POINTS_PER_INCH

    def line(self, artist: Line2D) -> None:
        artist.set_transform(self._transform)
        self._sheet.add_artist(artist)

    def text(self, x: float, y: float, text: str, size: float, align: str) -> None:
        artist = Text(x, y, text, size=size, color=INK, ha=align, va="center_baseline")
        artist.set_transform(self._transform)
        self._sheet.add_artist(artist)


@dataclass(frozen=True)
class _Style:
    """What the labels of one panel have in common; without decimals no mean is shown."""

    size: float
    decimals: int | None
    dots: bool


def draw_labels(margin: Margin, panel: Panel, looks: Mapping[str, Look], scale: Range) -> None:
    """All labels of a panel, with leaders from the lines that reach its right side."""
    lines = sorted(panel.lines, key=lambda line: line.points[-1].mean, reverse=True)
    ends = [margin.height * scale.share(line.points[-1].mean) for line in lines]
    low, high = -STEP / 2.0, margin.height + STEP / 2.0
    step = min(STEP, (high - low) / len(lines))
    decimals = None if panel.scattered else _decimals(lines[0].points[-1].mean)
    style = _Style(SIZE * step / STEP, decimals, panel.scattered or panel.single)
    last = max(line.points[-1].vehicles for line in lines)
    for line, end, y in zip(lines, ends, _spread(ends, step, low, high), strict=True):
        look = looks[line.name]
        if line.points[-1].vehicles == last and (line.printed or not style.dots):
            margin.line(Line2D(LEADER, (end, y), color=look.color, linewidth=0.6, alpha=0.7))
        _draw_label(margin, line, look, y, style)


def _draw_label(margin: Margin, line: Line, look: Look, y: float, style: _Style) -> None:
    sample = look.artist(SAMPLE, [y] * len(SAMPLE), linestyle=NO_LINE if style.dots and not line.printed else None)
    sample.set_markevery([1])
    margin.line(sample)
    if style.decimals is None:
        margin.text(NAME_WITHOUT_VALUE, y, line.name, style.size, "left")
        return
    margin.text(VALUE_RIGHT, y, f"{line.points[-1].mean:.{style.decimals}f}", style.size, "right")
    margin.text(NAME, y, line.name, style.size, "left")


def _spread(wanted: Sequence[float], step: float, low: float, high: float) -> list[float]:
    """Places in falling order, at least a step apart and between low and high, as near to the wanted as can be.

    Wanted places that are too near are pooled; a pool is centred on the mean of what it holds.
    """
    pools: list[list[float]] = []
    for place in wanted:
        pools.append([place])
        while len(pools) > 1 and _touch(pools[-2], pools[-1], step, low, high):
            pools[-2:] = [pools[-2] + pools[-1]]
    return [
        _centre(pool, step, low, high) + step * ((len(pool) - 1) / 2.0 - index)
        for pool in pools
        for index in range(len(pool))
    ]


def _touch(upper: Sequence[float], lower: Sequence[float], step: float, low: float, high: float) -> bool:
    needed = step * (len(upper) + len(lower)) / 2.0
    return _centre(upper, step, low, high) - _centre(lower, step, low, high) < needed


def _centre(pool: Sequence[float], step: float, low: float, high: float) -> float:
    reach = step * (len(pool) - 1) / 2.0
    return max(low + reach, min(high - reach, sum(pool) / len(pool)))


def _decimals(largest: float) -> int:
    """So many that the largest number shows four digits, at most three."""
    return max(0, min(3, 3 - math.floor(math.log10(max(abs(largest), 1.0)))))
