# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""What one run records and the next one is told, worked out by hand; test_sumo_run.py has it in the real SUMO."""

from dataclasses import astuple

import pytest
from elmopp_tools.library import FORESEEN_MAX_S
from elmopp_tools.sumo_oracle import FORETOLD_COLUMNS, Record, foretold
from elmopp_tools.sumo_signal import Phase, Programme, Signal, read_signal

# Movements 0 and 1 of N are one approach, 2 of E the other.
CROSS = Programme(
    "J",
    tuple(Phase(state, 30.0) for state in ("Ggr", "yyr", "rGr", "ryr", "rrG", "rry")),
    ((("N", "N_0"),), (("N", "N_1"),), (("E", "E_0"),)),
    frozenset({(0, 2), (2, 0), (1, 2), (2, 1)}),
)


@pytest.fixture
def signal() -> Signal:
    found = read_signal(CROSS)
    assert found.approaches == ((0, 1), (2,))
    return found


def record_of(signal: Signal, *seconds: tuple[list[float], str]) -> Record:
    """Of one signal; who came is a letter each."""
    record = Record([signal])
    for arrived_veh, came in seconds:
        record.note([arrived_veh], [came])
    return record


def test_a_row_begins_with_the_next_second_and_ends_with_nobody(signal: Signal) -> None:
    record = record_of(signal, ([1.0, 0.5, 0.0], ""), ([0.0, 0.0, 2.0], ""), ([0.0, 3.0, 0.0], ""))
    for second, north, east in ((0, [1.5, 0.0, 3.0], [0.0, 2.0, 0.0]), (1, [0.0, 3.0], [2.0, 0.0]), (3, [], [])):
        rows = record.rows(0, second)
        assert rows == [row + [0.0] * (FORESEEN_MAX_S - len(row)) for row in (north, east)]


def test_a_row_is_as_long_as_a_chooser_can_look(signal: Signal) -> None:
    record = record_of(signal, *(([float(t), 0.0, 0.0], "") for t in range(400)))
    assert record.rows(0, 100)[0] == [float(t) for t in range(100, 100 + FORESEEN_MAX_S)]


def test_signals_are_kept_apart(signal: Signal) -> None:
    record = Record([signal, signal])
    record.note([[1.0, 0.0, 0.0], [0.0, 0.0, 4.0]], ["a", "b"])
    assert [[row[0] for row in record.rows(index, 0)] for index in (0, 1)] == [[1.0, 0.0], [0.0, 4.0]]
    assert record.first_s == [{"a": 1}, {"b": 1}]


def test_shares_are_of_who_came_against_his_first_recorded_second(signal: Signal) -> None:
    nobody = [0.0, 0.0, 0.0]
    recorded = record_of(signal, *((nobody, came) for came in ("a", "b", "c", "ad", "", "", "", "", "")))
    seen = record_of(signal, *((nobody, came) for came in ("a", "", "b", "", "c", "", "", "d", "x")))
    # a at once, b a second late, c two, d four; x was never recorded.
    assert astuple(foretold(recorded, seen)) == (5, 0.2, 0.4, 0.6, 0.0)


def test_skill_is_one_minus_the_error_over_that_of_the_mean(signal: Signal) -> None:
    def of(*north: float) -> Record:
        return record_of(signal, *(([veh, 0.0, 1.0], "") for veh in north))

    came = of(0.0, 2.0, 0.0, 2.0)  # the mean 1 errs by 1 in every second; E never varies
    for recorded, skill in ((came, 1.0), (of(1.0, 1.0, 1.0, 1.0), 0.0), (of(0.0, 2.0, 1.0, 2.0), 0.75)):
        assert foretold(recorded, came).skill == skill
    assert foretold(of(0.0, 2.0), came).skill == -0.5, "a record that ends sooner says nobody, also of E"


def test_its_cells_are_the_columns(signal: Signal) -> None:
    cells = foretold(record_of(signal), record_of(signal)).cells()
    assert ("scenario", "chooser", "seed", *cells) == FORETOLD_COLUMNS
    assert cells == {"vehicles": "0", "within_0_s": "0", "within_1_s": "0", "within_3_s": "0", "skill": "0"}
