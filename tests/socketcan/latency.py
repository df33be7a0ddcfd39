# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""What a log of a bus says about times. Knows no bus."""

import itertools
import statistics
from collections.abc import Iterable, Sequence


def gaps_ms(times_s: Iterable[float]) -> list[float]:
    """Between one and the next."""
    return [1000 * (after - before) for before, after in itertools.pairwise(times_s)]


def changes_s(lamps: Iterable[tuple[float, Sequence[int]]]) -> list[float]:
    """When a command came whose aspects are not those of the one before it."""
    return [after[0] for before, after in itertools.pairwise(lamps) if list(before[1]) != list(after[1])]


def ages_ms(causes_s: Sequence[float], effects_s: Sequence[float]) -> list[float]:
    """How old a cause is at the first effect after it. One that a newer cause has overtaken has none of its own."""
    ages = []
    for cause_s, next_s in itertools.zip_longest(causes_s, causes_s[1:], fillvalue=float("inf")):
        effect_s = next((effect_s for effect_s in effects_s if effect_s > cause_s), None)
        if effect_s is not None and effect_s <= next_s:
            ages.append(1000 * (effect_s - cause_s))
    return ages


def quantiles(values: Sequence[float]) -> dict[str, float]:
    """Smallest, median, 99 %, largest; of nothing only how many there are."""
    if not values:
        return {"n": 0}
    ordered = sorted(values)
    return {
        "n": len(ordered),
        "min": round(ordered[0], 1),
        "p50": round(statistics.median(ordered), 1),
        "p99": round(ordered[int(0.99 * (len(ordered) - 1))], 1),
        "max": round(ordered[-1], 1),
    }
