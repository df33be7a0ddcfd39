# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The 95 % interval of Student's t: of a mean, and of paired differences."""

import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass

from scipy import stats

CONFIDENCE = 0.95


@dataclass(frozen=True)
class Pair:
    """Mean of one less the other, and the ends of its interval."""

    mean: float
    low: float
    high: float


def half_width(values: Sequence[float]) -> float:
    """Of the interval of the mean; 0 of a single value."""
    count = len(values)
    if count == 1:
        return 0.0
    mean = math.fsum(values) / count
    variance = math.fsum((value - mean) ** 2 for value in values) / (count - 1)
    return float(stats.t.ppf((1.0 + CONFIDENCE) / 2.0, count - 1)) * math.sqrt(variance / count)


def paired(one: Sequence[float], other: Sequence[float]) -> Pair | None:
    """Of values in the same order; None with fewer than two."""
    differences = [a - b for a, b in zip(one, other, strict=True)]
    if len(differences) < 2:
        return None
    mean, half = statistics.fmean(differences), half_width(differences)
    return Pair(mean, mean - half, mean + half)
