# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Lists of seeds as people write them."""

import argparse

SEED_MAX = 2**31 - 1  # SUMO's


def seeds_of(text: str) -> tuple[int, ...]:
    """The seeds of `1-5` or `1,3,8-9`; an argparse error for anything else."""
    seeds: list[int] = []
    for piece in text.split(","):
        first, dash, last = piece.partition("-")
        last = last if dash else first
        if not first.isdecimal() or not last.isdecimal() or not int(first) <= int(last) <= SEED_MAX:
            raise argparse.ArgumentTypeError(f"'{text}'; right would be numbers such as 1-5 or 1,3,8")
        seeds.extend(range(int(first), int(last) + 1))
    if len(set(seeds)) != len(seeds):
        raise argparse.ArgumentTypeError(f"'{text}' names a seed twice; right would be every seed once")
    return tuple(seeds)
