# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""elmopp-mps2 at a site that learns on: it goes on with what was kept, falls back from what is damaged, says what it
cannot do; and, at night, it learns, keeps, and knows it after a reset.

What is kept in the board's memory is made here by hand, after firmware/include/elmopp/store.h.
"""

import struct
from pathlib import Path

import pytest
from bus_frames import COUNTS, TRANSFER_ACK, Frame, bits
from emulator import Bus, Emulator
from images import changed_weights, site_image

FORECAST = 0x190
LSTM, LEARNT, KEPT = 5, 11, 4
MARK = 0x4B455054
APPROACHES, MOVEMENTS = 4, 3
TURN_S, LATER_S = 100, 37
WARM_S = 70  # a network says the mean for a minute
LEARNING_S = 1500
TRUSTED_S = 400  # until then its account, which begins anew, takes the learnt weights and the mean by turns
LSTM_AT = 92  # of an image: behind its header, what the network is held in, and the regression


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return site_image(tmp_path_factory.mktemp("site"), "cumulative:lstm-learn")


@pytest.fixture(scope="module")
def learnt(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """Weights as a board could have learnt them: the shipped ones, with another bias of the head."""
    image = changed_weights(tmp_path_factory.mktemp("weights"), LSTM_AT + 4, lambda bias: bias + 0.0625)
    assert struct.unpack_from("<I", image.read_bytes(), LSTM_AT) == (1,)  # levels: the bias is behind them
    return image.read_bytes()


def kept(folder: Path, image: bytes, changed: int | None = None) -> Path:
    """A slot that is complete, perhaps with a bit that has changed since."""
    data = bytearray(struct.pack("<IIII", 1, 0xFFFFFFFE, MARK, 0xFFFFFFFF) + image)
    if changed is not None:
        data[changed] ^= 0x04
    file = folder / "kept.bin"
    file.write_bytes(data)
    return file


class Cameras:
    """Much and little traffic by turns, a hundred seconds each, so that the mean is never right."""

    def __init__(self, bus: Bus) -> None:
        self.bus = bus
        self.now_s = 0
        self.arrived = [[0] * MOVEMENTS for _ in range(APPROACHES)]

    def second(self) -> list[Frame]:
        """Everybody counts, ten lamp ticks pass; what the board expects after that."""
        for approach, arrived in enumerate(self.arrived):
            much = (self.now_s + LATER_S * approach) // TURN_S % 2 == 0
            for movement in range(MOVEMENTS):
                arrived[movement] += 1 if much or self.now_s % MOVEMENTS == movement else 0
            slots = enumerate(arrived)
            payload = sum(3 << 4 + 9 * m | (total % 64) << 31 + 6 * m | 1 << 49 + m for m, total in slots)
            self.bus.send(COUNTS + approach, payload)
        self.now_s += 1
        before = len(self.bus.seen)
        self.bus.ticks(10)
        return [frame for frame in self.bus.seen[before:] if FORECAST <= frame.id < FORECAST + APPROACHES]

    def seconds(self, count: int) -> list[list[bytes]]:
        """Model and expected vehicles of every approach, second by second."""
        return [[frame.data[:6] for frame in self.second()] for _ in range(count)]


def is_kept(frame: Frame) -> bool:
    return frame.id == TRANSFER_ACK and frame.report is not None and frame.report[1] == KEPT


def models(said: list[list[bytes]]) -> set[int]:
    return {bits(data, 4, 4) for second in said for data in second}


def test_a_site_that_learns_goes_on_with_what_was_kept(site: Path, learnt: bytes, tmp_path: Path) -> None:
    with Emulator(site=site) as board:
        shipped = Cameras(Bus(board)).seconds(WARM_S)[-1]
    with Emulator(site=site, kept=kept(tmp_path, learnt)) as board:
        bus = Bus(board)
        said = Cameras(bus).seconds(WARM_S)[-1]
        assert bus.reported().fault == "none"
    assert models([shipped]) == {LSTM}
    assert models([said]) == {LEARNT}
    assert [data[1:] for data in said] != [data[1:] for data in shipped]


@pytest.mark.parametrize("at", [16 + 12, 16 + 20, 20000])
def test_weights_damaged_where_they_lay_are_named_and_the_shipped_ones_run(
    site: Path, learnt: bytes, tmp_path: Path, at: int
) -> None:
    with Emulator(site=site, kept=kept(tmp_path, learnt, at)) as board:
        bus = Bus(board)
        assert bus.mode("fail_safe").fault == "weights_changed"
        assert models(Cameras(bus).seconds(WARM_S)[-1:]) == {LSTM}
        assert "the weights that were kept are damaged" in board.hears("in force")


def test_a_network_that_the_board_has_no_room_to_train_runs_as_it_is(tmp_path: Path) -> None:
    with Emulator(site=site_image(tmp_path, "cumulative:nlstm-learn")) as board:
        bus = Bus(board)
        said = board.hears("it does not learn")
        assert "the site asks to learn on, and this board has no room for such a network" in said
        assert bus.mode("fixed_time").fault == "none"


def test_what_the_board_learns_is_kept_and_is_what_it_says_after_a_reset(site: Path, tmp_path: Path) -> None:
    with Emulator(site=site) as board:
        bus = Bus(board)
        cameras = Cameras(bus)
        before = 0
        while not any(is_kept(frame) for frame in bus.seen[before:]):
            assert cameras.now_s < LEARNING_S, "nothing was kept"
            before = len(bus.seen)
            cameras.second()
        board.ask("pmemsave", val=0x00320000, size=0xA000, filename=str(tmp_path / "kept.bin"))
        board.reset()
        bus.open()
        again = Cameras(bus).seconds(TRUSTED_S + TURN_S)
        assert bus.reported().fault == "none"
    assert models(again[TRUSTED_S:]) == {LEARNT}
    with Emulator(site=site, kept=tmp_path / "kept.bin") as board:  # another board with the same memory
        assert Cameras(Bus(board)).seconds(WARM_S + 60) == again[: WARM_S + 60]
