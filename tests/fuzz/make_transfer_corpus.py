#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Writes tests/fuzz/corpus/transfer: the scenarios of test_transfer and test_keeper in the bytes of fuzz_transfer.c.

A fuzzer that begins with none of them would have to find a whole image, segment after segment. With --check it says
whether the files are those that it would write; files beside them, which a fuzzer has found, are left alone.
"""

import sys
from pathlib import Path

CORPUS = Path(__file__).resolve().parent / "corpus" / "transfer"

# First byte: odd for a keeper; + 2 for weights, not a site; + 4: what is under way ends by time, not by a fault.
SITE, WEIGHTS, BY_TIME = 1, 3, 4
RAW, FIRST, GO_ON, RUSH, JUMP, SPOILT, TICKS, CHANGE, ASK, TROUBLE, LEARN = range(11)
ALL = bytes([FIRST, TICKS, 0, GO_ON, 21])  # the segments of a site, and some
ALL_WEIGHTS = bytes([FIRST, TICKS, 0, GO_ON, 255, GO_ON, 255])
POWER_CUT, LAMP_FAULT, MEDIUM_FAILS_SOON, MEDIUM_IS_WELL = 0, 1, 2 + 4 * 30, 3
KEY_LET_GO = 4


def receiver(length: int, *steps: int) -> bytes:
    """The receiver alone, with a first frame of this length."""
    head = (
        bytes([0x10 | (length >> 8), length & 0xFF]) if length < 4096 else bytes([0x10, 0, *length.to_bytes(4, "big")])
    )
    return bytes([0, 0, *head.ljust(8, b"\x55"), *steps])


def rights(count: int) -> tuple[int, ...]:
    """Steps of so many right segments."""
    return tuple(2 | (min(63, count - k) << 2) for k in range(0, count, 63))


SEEDS = {
    "receiver_short": receiver(8, *rights(1)),
    "receiver_blocks": receiver(500, *rights(71)),
    "receiver_longest": receiver(5000, *rights(715)),
    "receiver_lost": receiver(500, *rights(9), 1, 0, 0x2C, *range(7), *rights(3)),
    "receiver_too_short": receiver(100, *rights(2), 1, 2, 3, 0x23, *range(7)),
    "receiver_silence": receiver(100, *rights(3), *[0] * 9, *rights(3), *[0] * 10, *rights(1)),
    "site_by_fault": bytes([SITE]) + ALL + bytes([TICKS, 40]),
    "site_by_time": bytes([SITE | BY_TIME]) + ALL + bytes([TICKS, 40]),
    "site_power_cut_in_its_trial": bytes([SITE]) + ALL + bytes([TICKS, 90, TROUBLE, POWER_CUT]),
    "site_lamp_fault_in_its_start": bytes([SITE]) + ALL + bytes([TICKS, 0, TROUBLE, LAMP_FAULT, TICKS, 3]),
    "site_without_the_key": bytes([SITE, ASK, KEY_LET_GO]) + ALL + bytes([TICKS, 3]),
    "site_key_let_go": bytes([SITE, FIRST, TICKS, 0, GO_ON, 9, ASK, KEY_LET_GO, GO_ON, 10, TICKS, 3]),
    "site_that_breaks_a_rule": bytes([SITE, CHANGE, 40, 0, 255]) + ALL + bytes([TICKS, 3]),
    "site_spoilt": bytes([SITE, FIRST, TICKS, 0, GO_ON, 10, RUSH, 8, SPOILT, 1, 1, GO_ON, 21, TICKS, 3]),
    "site_for_simulation": bytes([SITE, CHANGE, 28, 0, 1]) + ALL + bytes([TICKS, 3]),
    "site_lost": bytes([SITE, FIRST, TICKS, 0, GO_ON, 1, JUMP, 1, GO_ON, 1, TICKS, 3]) + ALL + bytes([TICKS, 3]),
    "site_unheeded": bytes([SITE, FIRST, RUSH, 40, TICKS, 12]) + ALL + bytes([TICKS, 3]),
    "site_twice": bytes([SITE]) + ALL + ALL + bytes([TICKS, 3]),
    "site_medium_fails": bytes([SITE | BY_TIME]) + ALL + bytes([TICKS, 3, TROUBLE, MEDIUM_FAILS_SOON]),
    "weights_by_fault": bytes([WEIGHTS]) + ALL_WEIGHTS + bytes([TICKS, 20]),
    "weights_by_time": bytes([WEIGHTS | BY_TIME]) + ALL_WEIGHTS + bytes([TICKS, 20]),
    "weights_spoilt": bytes([WEIGHTS, FIRST, TICKS, 0, GO_ON, 8, SPOILT, 3, 1, GO_ON, 255, GO_ON, 255, TICKS, 20]),
    "weights_too_long": bytes([WEIGHTS, RAW, 0, 0x10, 0, 0, 0, 0x9C, 0x40, 1, 2, TICKS, 3]),
    "weights_silence": bytes([WEIGHTS, FIRST, TICKS, 0, GO_ON, 30, TICKS, 20]),
    "weights_fault_while_receiving": bytes(
        [WEIGHTS, FIRST, TICKS, 0, GO_ON, 30, TROUBLE, LAMP_FAULT, GO_ON, 255, GO_ON, 255]
    ),
    "weights_learned": bytes([WEIGHTS, TICKS, 60, LEARN, TICKS, 70, TROUBLE, POWER_CUT]),
    "weights_learned_twice": bytes([WEIGHTS, TICKS, 60, *[LEARN, TICKS, 250] * 2, TROUBLE, POWER_CUT]),
    "weights_learned_medium_fails": bytes(
        [WEIGHTS, TICKS, 60, TROUBLE, MEDIUM_FAILS_SOON, LEARN, TICKS, 9, TROUBLE, MEDIUM_IS_WELL]
    ),
    "raw": bytes([SITE, RAW, 0, 0x18, 0xB4, *range(6), RAW, 1, 0x23, 1, 0x21, *range(7), RAW, 2, 3, 0x21, *range(7)]),
}


def main() -> int:
    """0: written, or as it should be; 1: a file differs; 2: the request cannot be run."""
    if sys.argv[1:] not in ([], ["--check"]):
        print(f'make_transfer_corpus: unknown argument "{sys.argv[1]}" ; right would be --check', file=sys.stderr)
        return 2
    stale = [name for name, seed in SEEDS.items() if sys.argv[1:] and read(CORPUS / name) != seed]
    for name in stale:
        print(f"make_transfer_corpus: {name} is stale ; run tests/fuzz/make_transfer_corpus.py", file=sys.stderr)
    if not sys.argv[1:]:
        CORPUS.mkdir(parents=True, exist_ok=True)
        for name, seed in SEEDS.items():
            (CORPUS / name).write_bytes(seed)
    return 1 if stale else 0


def read(file: Path) -> bytes:
    """Its bytes; none if it is not there."""
    return file.read_bytes() if file.exists() else b""


if __name__ == "__main__":
    sys.exit(main())
