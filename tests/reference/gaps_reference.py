# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""Flow through gaps in double precision, three ways that share nothing with the C: by the sum over gaps, by drawing
gaps, and by straight lines between the sum's values, which is what a table can say.
"""

from __future__ import annotations

import math
import random
from functools import cache

CRITICAL = 4.5
FOLLOW_UP = 2.5
KNOTS_PER_VEHICLE = 32
MOST = 1.5


@cache
def by_sum(opposing: float) -> float:
    """A gap of at least t_c + n t_f lets an (n+1)-th go: the sum of how often such gaps come."""
    if opposing <= 0.0:
        return 1.0 / FOLLOW_UP
    terms: list[float] = []
    n = 0
    while n == 0 or terms[-1] > 1e-15 * terms[0]:
        terms.append(opposing * math.exp(-opposing * (CRITICAL + n * FOLLOW_UP)))
        n += 1
    return math.fsum(terms)


def by_drawing(opposing: float, gaps: int, seed: int) -> float:
    """Exponential gaps one after the other, and who goes in each."""
    source = random.Random(seed)
    through, time = 0, 0.0
    for _ in range(gaps):
        gap = source.expovariate(opposing)
        time += gap
        through += int((gap - CRITICAL) / FOLLOW_UP) + 1 if gap >= CRITICAL else 0
    return through / time


def by_lines(opposing: float) -> float:
    """Straight between flows of 0, 1/32, 2/32 ...; nobody from 1.5 on."""
    if opposing >= MOST:
        return 0.0
    place = max(opposing, 0.0) * KNOTS_PER_VEHICLE
    before = int(place)
    low, high = by_sum(before / KNOTS_PER_VEHICLE), by_sum((before + 1) / KNOTS_PER_VEHICLE)
    return low + (place - before) * (high - low)


def shared(saturation: float, through: float, share: float) -> float:
    """Each vehicle takes as long as its kind does."""
    through = min(through, saturation)
    return 0.0 if through <= 0.0 else 1.0 / (share / through + (1.0 - share) / saturation)
