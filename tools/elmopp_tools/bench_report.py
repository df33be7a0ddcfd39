# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""What tools/bench-forecast measured, what it says about it, and the verdict. Nothing is measured here."""

import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from statistics import median

# Of onnxruntime's marginal step, with the flags x86-64-v3.
RATIO_MOST = 0.5
RATIO_AIM = 0.3

# Most to least ratio of the rounds; more than this, and the machine was busy with something else.
CALM = 1.25

# Flags of the compiler: the CMake preset that has them.
PORTABLE = "portable"
V3 = "x86-64-v3"
PRESETS = {PORTABLE: "release", V3: "release-v3"}


@dataclass(frozen=True)
class Ours:
    """What `host_sim bench --forecast-only` says of one build."""

    lstm_step_ns: float
    nlstm_step_ns: float
    rollout60_us: float
    lstm_digest: str


@dataclass(frozen=True)
class Theirs:
    """What onnxruntime takes. A rollout feeds what the network says back to it, so that no step can be given ahead."""

    step_ns: float  # marginal: (a run of 61 steps - a run of 1) / 60
    long_step_ns: float  # marginal: (a run of 1,060 steps - a run of 61) / 999
    run_us: float  # a run of 1 step
    rollout60_runs_us: float  # 60 runs of a step with the head
    rollout60_unrolled_us: float  # one run of a graph that holds 60 steps, each with the head

    @property
    def rollout60_us(self) -> float:
        return min(self.rollout60_runs_us, self.rollout60_unrolled_us)


@dataclass(frozen=True)
class Round:
    """Measured one right after the other, so that all of it saw the same machine. Keys of `ours`: those of PRESETS."""

    ours: dict[str, Ours]
    theirs: Theirs


@dataclass(frozen=True)
class Spread:
    """Of some values, one a round."""

    median: float
    low: float
    high: float


@dataclass(frozen=True)
class Verdict:
    """What is asked, and whether it is so."""

    digests_equal: bool
    ratio: float | None  # median, with the flags x86-64-v3; None: this processor cannot run them

    @property
    def exit_code(self) -> int:
        if self.ratio is None:
            return 2
        return 0 if self.digests_equal and self.ratio <= RATIO_MOST else 1


def spread(values: Sequence[float]) -> Spread:
    return Spread(median(values), min(values), max(values))


def spread_of(rounds: Sequence[Round], value: Callable[[Round], float]) -> Spread:
    return spread([value(each) for each in rounds])


def step_ratio(rounds: Sequence[Round], flags: str) -> Spread:
    """Of our LSTM step to onnxruntime's marginal step, paired by round."""
    return spread_of(rounds, lambda each: each.ours[flags].lstm_step_ns / each.theirs.step_ns)


def rollout_ratio(rounds: Sequence[Round], flags: str) -> Spread:
    """Of our rollout to the faster of onnxruntime's two, paired by round."""
    return spread_of(rounds, lambda each: each.ours[flags].rollout60_us / each.theirs.rollout60_us)


def digests(rounds: Sequence[Round]) -> list[str]:
    """All that were seen, of every build in every round."""
    return sorted({ours.lstm_digest for each in rounds for ours in each.ours.values()})


def verdict(rounds: Sequence[Round]) -> Verdict:
    there = V3 in rounds[0].ours
    return Verdict(len(digests(rounds)) == 1, step_ratio(rounds, V3).median if there else None)


def lines_of_table(rounds: Sequence[Round]) -> list[str]:
    """Medians over the rounds, ratios with their range."""
    flags = list(rounds[0].ours)
    none = [""] * len(flags)

    def theirs(value: Callable[[Theirs], float], digits: int) -> str:
        return f"{median(value(each.theirs) for each in rounds):.{digits}f}"

    rows = [
        ["", *flags, "onnxruntime"],
        ["LSTM step, ns", *_ours(rounds, lambda ours: ours.lstm_step_ns, 1), theirs(lambda each: each.step_ns, 1)],
        ["  in a run of 1,060 steps", *none, theirs(lambda each: each.long_step_ns, 1)],
        ["nested LSTM step, ns", *_ours(rounds, lambda ours: ours.nlstm_step_ns, 1), "has none"],
        [
            "60-step rollout, µs",
            *_ours(rounds, lambda ours: ours.rollout60_us, 2),
            theirs(lambda each: each.rollout60_us, 2),
        ],
        ["  as 60 runs of one step", *none, theirs(lambda each: each.rollout60_runs_us, 2)],
        ["  as one run of 60 steps", *none, theirs(lambda each: each.rollout60_unrolled_us, 2)],
        ["a run of one step, µs", *none, theirs(lambda each: each.run_us, 2)],
        ["ratio of the LSTM step", *[_range(step_ratio(rounds, name)) for name in flags], "1"],
        ["ratio of the rollout", *[_range(rollout_ratio(rounds, name)) for name in flags], "1"],
    ]
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    return ["  ".join([row[0].ljust(widths[0]), *map(str.rjust, row[1:], widths[1:])]).rstrip() for row in rows]


def _ours(rounds: Sequence[Round], value: Callable[[Ours], float], digits: int) -> list[str]:
    """A median for each build."""
    columns = zip(*(map(value, each.ours.values()) for each in rounds), strict=True)
    return [f"{median(column):.{digits}f}" for column in columns]


def _range(ratio: Spread) -> str:
    return f"{ratio.median:.3f} ({ratio.low:.3f} to {ratio.high:.3f})"


def lines_of_verdict(rounds: Sequence[Round]) -> list[str]:
    found = verdict(rounds)
    seen = digests(rounds)
    whose = "both builds" if found.ratio is not None else "the portable build"
    bits = f"{whose}: the same bits in every round, digest {seen[0]}"
    lines = [bits if found.digests_equal else f"NOT the same bits: digests {', '.join(seen)}"]
    if found.ratio is None:
        return [*lines, f"{V3}: not measured, this processor cannot run it"]
    ratio = step_ratio(rounds, V3)
    if ratio.high > CALM * ratio.low:
        lines.append(f"the rounds differ, {_range(ratio)}: leave the machine alone and measure again")
    limits = "; ".join([_kept("at most", found.ratio, RATIO_MOST), _kept("aim", found.ratio, RATIO_AIM)])
    return [*lines, f"{V3}: {found.ratio:.3f} of onnxruntime's marginal step; {limits}"]


def _kept(what: str, ratio: float, limit: float) -> str:
    return f"{what} {limit}: {'yes' if ratio <= limit else 'NO'}"


def json_text(rounds: Sequence[Round], about: dict[str, str]) -> str:
    """Everything: what was compared, the verdict, the ratios, and each round as measured."""
    found = verdict(rounds)
    flags = list(rounds[0].ours)
    whole = {
        **about,
        "digests_equal": found.digests_equal,
        "ratio_most": RATIO_MOST,
        "ratio_aim": RATIO_AIM,
        "met": found.exit_code == 0,
        "step_ratio": {name: asdict(step_ratio(rounds, name)) for name in flags},
        "rollout_ratio": {name: asdict(rollout_ratio(rounds, name)) for name in flags},
        "rounds": [asdict(each) for each in rounds],
    }
    return json.dumps(whole, indent=1) + "\n"
