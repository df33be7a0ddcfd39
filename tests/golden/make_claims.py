# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""Makes the two made-up sets of results that tests/host_sim/test_claims.cpp feeds to the judge.

claims_hold_*.csv: every claim of the paper that can hold does; claims_fail_*.csv: none does. No random numbers: each
sample has the mean and the standard deviation that its claim needs, so that Welch's t comes out as printed.

    python tests/golden/make_claims.py            writes the files
    python tests/golden/make_claims.py --check    compares them with what it would write
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
HEADER = (
    "profile,chooser,forecast,vehicles,trial,seed,throughput_veh_per_s,served_share,mean_delay_s,longest_red_s,"
    "switches,figure_throughput_veh_per_s,vehicles_in,vehicles_out,vehicles_queued,vehicles_outside"
)
VEHICLES = (200, 400, 600, 800, 1000)
TRIALS = 6

PRINTED_T = {"elmopp_itlc": 17.6799, "elmopp_oaf": 69.4727, "itlc_oaf": 85.0275}
PRINTED_MEAN = {"elmopp": 2.09133, "itlc": 1.83414, "oaf": 1.12108}


def variances() -> dict[str, float]:
    """Variance of each player's mean that gives the three printed t values with the printed means."""

    def of_difference(first: str, second: str) -> float:
        return ((PRINTED_MEAN[first] - PRINTED_MEAN[second]) / PRINTED_T[f"{first}_{second}"]) ** 2

    elmopp_itlc, elmopp_oaf, itlc_oaf = (
        of_difference("elmopp", "itlc"),
        of_difference("elmopp", "oaf"),
        of_difference("itlc", "oaf"),
    )
    return {
        "elmopp": (elmopp_itlc + elmopp_oaf - itlc_oaf) / 2,
        "itlc": (elmopp_itlc + itlc_oaf - elmopp_oaf) / 2,
        "oaf": (elmopp_oaf + itlc_oaf - elmopp_itlc) / 2,
    }


def sample(mean: float, variance_of_mean: float, curve: Sequence[float]) -> list[float]:
    """One value for each number of vehicles and trial: the curve around the mean, trials above and below in turn."""
    n = len(VEHICLES) * TRIALS
    between = sum(step * step for step in curve) * TRIALS
    spread = math.sqrt((variance_of_mean * n * (n - 1) - between) / n)
    return [mean + step + (spread if trial % 2 == 0 else -spread) for step in curve for trial in range(TRIALS)]


def rows(
    label: tuple[str, str, str], throughput: Sequence[float], delay_s: float, vary_s: float = 0.0, trials: int = TRIALS
) -> Iterator[str]:
    """The rows of one chooser; its delay is `delay_s`, and every third trial `vary_s` more."""
    for index, value in enumerate(throughput):
        vehicles, trial = VEHICLES[index // TRIALS], index % TRIALS
        if trial < trials:
            delay = delay_s + 0.5 * trial + vehicles / 100 + (vary_s if trial % 3 == 0 else 0.0)
            yield f"{','.join(label)},{vehicles},{trial},1,{value:.9g},0.9,{delay:.9g},70,190,2,4000,3600,400,0"


FLAT = (0.0,) * 5
FALLING = (0.08, 0.04, 0.0, -0.04, -0.08)
RISING = (-0.08, -0.04, 0.0, 0.04, 0.08)


def constant(value: float) -> list[float]:
    return [value] * (len(VEHICLES) * TRIALS)


def holding() -> dict[str, list[str]]:
    variance = variances()
    elmopp = sample(PRINTED_MEAN["elmopp"], variance["elmopp"], FALLING)
    itlc = sample(PRINTED_MEAN["itlc"], variance["itlc"], FLAT)
    oaf = sample(PRINTED_MEAN["oaf"], variance["oaf"], FLAT)
    trials = [
        *rows(("paper", "naive", "none"), constant(1.9), 100.0),
        *rows(("paper", "cumulative", "none"), constant(1.8), 99.0, 0.25),
        *rows(("paper", "cumulative", "ar8"), elmopp, 90.0, 1.0),
        # The plain rivals are worse than the best of their sweeps, which are the ones to be compared with.
        *rows(("paper", "itlc", "none"), constant(1.0), 110.0),
        *rows(("paper", "oaf", "none"), constant(0.9), 120.0),
        # Another profile says the contrary, which is beside the point.
        *rows(("saturation", "cumulative", "ar8"), constant(0.5), 300.0),
        *rows(("saturation", "itlc", "none"), constant(3.0), 10.0),
    ]
    beside = [
        *rows(("paper", "itlc@ready=60", "none"), itlc, 110.0),
        # Too few trials for a comparison, else it would be the best.
        *rows(("paper", "itlc@ready=5", "none"), constant(5.0), 110.0, trials=2),
        *rows(("paper", "oaf@platoon=20", "none"), oaf, 120.0),
        *rows(("literal", "naive", "none"), constant(0.91 * 1.9), 100.0),
        *rows(("literal", "cumulative", "none"), constant(0.91 * 1.9), 100.0),
    ]
    return {"claims_hold_trials.csv": trials, "claims_hold_beside.csv": beside}


def failing() -> dict[str, list[str]]:
    trials = [
        *rows(("paper", "naive", "none"), constant(1.9), 100.0),
        *rows(("paper", "cumulative", "none"), constant(1.8), 90.5),
        # Better than naive beyond doubt, but not than cumulative without a forecast.
        *rows(("paper", "cumulative", "ar8"), sample(1.5, 2e-4, RISING), 90.0, 1.5),
        *rows(("paper", "itlc", "none"), sample(1.7, 2e-5, FLAT), 110.0),
        *rows(("paper", "oaf", "none"), sample(1.8, 2e-5, FLAT), 120.0),
    ]
    beside = [
        *rows(("paper", "itlc@ready=60", "none"), constant(1.6), 110.0),
        # One of the two works, which is not enough.
        *rows(("literal", "naive", "none"), constant(0.89 * 1.9), 100.0),
        *rows(("literal", "cumulative", "none"), constant(1.9), 100.0),
    ]
    return {"claims_fail_trials.csv": trials, "claims_fail_beside.csv": beside}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="write nothing, fail if a file differs")
    check = parser.parse_args().check
    differing = []
    for name, lines in {**holding(), **failing()}.items():
        text = "\n".join([HEADER, *lines]) + "\n"
        path = FOLDER / name
        if not check:
            path.write_text(text, encoding="ascii")
        elif not path.exists() or path.read_text(encoding="ascii") != text:
            differing.append(name)
    if differing:
        print(f"{', '.join(differing)}: not what make_claims.py makes; run it without --check", file=sys.stderr)
    return 1 if differing else 0


if __name__ == "__main__":
    raise SystemExit(main())
