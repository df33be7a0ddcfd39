# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""How lines look in the figures: always the same for the same chooser, and told apart by colour-blind readers."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any, Literal

import matplotlib as mpl
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike

from elmopp_tools.plot_figures import Line

Dashes = Literal["solid", "none"] | tuple[float, tuple[float, ...]]

INK = "#1a1a1a"
QUIET = "#555555"

SOLID: Dashes = "solid"
DASHED: Dashes = (0.0, (5.0, 2.5))
DOTTED: Dashes = (0.0, (1.0, 1.6))
DASH_DOTTED: Dashes = (0.0, (6.0, 1.5, 1.0, 1.5))
NO_LINE: Dashes = "none"

# The palette of Okabe and Ito.
ORANGE, SKY, GREEN, BLUE = "#E69F00", "#56B4E9", "#009E73", "#0072B2"
VERMILLION, PURPLE, BLACK, GREY = "#D55E00", "#CC79A7", "#000000", "#8c8c8c"

# For matplotlib; the rest as it comes.
SETTINGS: dict[Any, Any] = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "font.size": 8.5,
    "axes.edgecolor": QUIET,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#e4e4e4",
    "grid.linewidth": 0.6,
    "xtick.color": QUIET,
    "ytick.color": QUIET,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.major.width": 0.7,
    "ytick.major.width": 0.7,
    "xtick.major.size": 3.0,
    "ytick.major.size": 3.0,
    "legend.frameon": False,
    "legend.fontsize": 8.0,
    "text.parse_math": False,
    "svg.fonttype": "none",
    "svg.hashsalt": "elmopp",
}


@contextmanager
def our_settings() -> Iterator[None]:
    """Within it matplotlib draws by SETTINGS, whatever settings the user has."""
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(SETTINGS)
        yield


@dataclass(frozen=True)
class Look:
    """depth orders the lines: what is drawn first is wide and pale enough to show below what follows."""

    color: str
    marker: str
    depth: int
    linestyle: Dashes = SOLID
    width: float = 1.2
    size: float = 4.5
    filled: bool = True

    def artist(self, x: ArrayLike, y: ArrayLike, *, linestyle: Dashes | None = None) -> Line2D:
        return Line2D(
            x,
            y,
            color=self.color,
            linestyle=self.linestyle if linestyle is None else linestyle,
            linewidth=self.width,
            marker=self.marker,
            markersize=self.size,
            markerfacecolor=self.color if self.filled else "white",
            markeredgecolor=self.color,
            markeredgewidth=0.9,
            zorder=2.0 + 0.01 * self.depth,
        )


CHOOSERS = {
    "fixed": Look(BLACK, "x", 1, size=5.0),
    "pressure": Look(GREEN, "^", 2, size=5.0),
    "oaf": Look(PURPLE, "v", 3, size=5.0),
    "itlc": Look(VERMILLION, "D", 4, size=4.0),
    # What nearly coincides is nested: the orange shows on both sides of the blue.
    "naive": Look(ORANGE, "s", 20, width=2.8, size=6.0),
}
# One hue for the cumulative chooser: dashes and markers for its forecasts.
FORECASTS = {
    "none": Look(BLUE, "o", 21, linestyle=DOTTED, size=4.5, filled=False),
    "ar8": Look(BLUE, "o", 24, width=1.0, size=3.2),
    "lstm": Look(BLUE, "*", 23, linestyle=(0.0, (3.0, 1.2)), size=5.5),
    "oracle": Look(BLUE, "+", 22, linestyle=DASH_DOTTED, size=6.5),
}
# Choosers that have no look of their own yet, in the order in which they appear.
SPARE_COLORS = (SKY, GREY, GREEN, VERMILLION, PURPLE, BLACK)
SPARE_MARKERS = ("P", "*", "<", ">", "h", "p", "d", "8")


def looks_of(panels: Sequence[Sequence[Line]]) -> dict[str, Look]:
    """The look of each line by its name, the same in every panel."""
    looks: dict[str, Look] = {}
    spare = 0
    for line in (line for lines in panels for line in lines):
        if line.name in looks:
            continue
        look = _known(line)
        # Two of one kind may share a look only if no panel shows both.
        together = [lines for lines in panels if any(other.name == line.name for other in lines)]
        taken = {looks.get(other.name) for lines in together for other in lines}
        if look is None or look in taken:
            color = SPARE_COLORS[spare % len(SPARE_COLORS)]
            marker = SPARE_MARKERS[spare % len(SPARE_MARKERS)]
            look = Look(color, marker, 5 + spare)
            spare += 1
        looks[line.name] = look
    return looks


def _known(line: Line) -> Look | None:
    look = (
        FORECASTS.get(line.forecast) if line.chooser == "cumulative" else CHOOSERS.get(line.chooser.partition("@")[0])
    )
    if look is not None and line.printed:
        return replace(look, marker="", linestyle=DASHED, width=1.2, depth=30)
    return look
