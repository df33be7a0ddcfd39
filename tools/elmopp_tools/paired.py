# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Paired differences with the 95 % interval of Student's t."""

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


def paired(one: Sequence[float], other: Sequence[float]) -> Pair | None:
    """Of values in the same order; None with fewer than two."""
    differences = [a - b for a, b in zip(one, other, strict=True)]
    if len(differences) < 2:
        return None
    mean = statistics.fmean(differences)
    spread = statistics.stdev(differences) / math.sqrt(len(differences))
    half = float(stats.t.ppf(0.5 + CONFIDENCE / 2.0, len(differences) - 1)) * spread
    return Pair(mean, mean - half, mean + half)
