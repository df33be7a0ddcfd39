# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""elmopp-mps2 on its emulated board: bad input, floods, bad memory, faults, resets.

ctest's preset cortex-m4 runs it. Without cameras a controller runs its fixed times: enough for lamps.
"""

import random
import re
import select
import socket
import struct
import subprocess
import time
import zlib
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pytest
from bus_frames import COMMAND, LAMP_COMMAND, TRANSFER, TRANSFER_ACK, segments
from elmopp_tools.site import load_site
from elmopp_tools.site_image import image_bytes
from emulator import ANSWER_S, IMAGE, ROOT, Bus, Emulator
from images import changed_weights, site_image, tool, with_flipped_bit

STEADY = "fixed_time"
FLASHING, GREEN = {5, 6}, 3
PREPARE, CONFIRM = 8, 9
CODES = {"site_changed": 18, "weights_changed": 19, "memory": 24, "processor": 25}


@pytest.fixture(scope="session")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return site_image(tmp_path_factory.mktemp("site"), "cumulative:lstm")


@pytest.fixture(scope="session")
def weights(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Weights that are good and not those compiled in."""
    return changed_weights(tmp_path_factory.mktemp("weights"), -4, lambda last: last / 2 + 0.125)


# --- what is built ---


def test_the_program_has_no_heap_no_output_and_no_double_precision() -> None:
    done = subprocess.run(["arm-none-eabi-nm", str(IMAGE)], capture_output=True, text=True, check=True)
    names = {line.split()[-1] for line in done.stdout.splitlines()}
    assert "elmopp_board_run" in names
    kept_out = re.compile(r"_*(malloc|calloc|realloc|free|sbrk|[a-z]*printf|exit)(_r)?|__aeabi_d.*")
    assert not [name for name in names if kept_out.fullmatch(name)]


def test_a_build_for_a_site_that_is_simulation_only_is_refused_by_name(tmp_path: Path) -> None:
    command = ["cmake", "-S", str(ROOT), "-B", str(tmp_path), "-G", "Ninja", "-DBUILD_TESTING=OFF"]
    command += ["--toolchain", str(ROOT / "cmake" / "cortex-m4.cmake"), "-DELMOPP_BOARD_SITE=paper"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode != 0
    assert "ELMOPP_BOARD_SITE=paper: it is simulation_only" in done.stderr


# --- what comes over the line ---


def rubbish(count: int, seed: int) -> bytes:
    """Random characters, line ends among them, that close no channel."""
    return bytes(random.Random(seed).randbytes(count)).replace(b"C", b"c") + b"\r"


def test_rubbish_is_dropped_and_counted_and_the_lamps_go_on(site: Path) -> None:
    with Emulator(site=site) as board:
        bus = Bus(board)
        assert bus.mode(STEADY).refused == 0
        for k in range(20):
            bus.write(rubbish(5000, k))
            bus.tick()
        status = bus.reported()
    assert (status.mode, status.fault) == (STEADY, "none")
    assert status.refused > 0


def test_a_line_without_an_end_is_one_that_is_dropped(site: Path) -> None:
    with Emulator(site=site) as board:
        bus = Bus(board)
        bus.mode(STEADY)
        bus.write(b"t" + b"0" * 100_000 + b"\r")
        status = bus.reported()
    assert (status.mode, status.fault, status.refused) == (STEADY, "none", 1)


def test_a_frame_that_is_cut_in_the_middle_costs_itself_alone(site: Path) -> None:
    with Emulator(site=site) as board:
        bus = Bus(board)
        bus.mode(STEADY)
        for at in range(1, 21):
            bus.write(b"t09080102030405060708"[:at] + b"\r")
            bus.tick()
        status = bus.reported()
    assert (status.mode, status.fault, status.refused) == (STEADY, "none", 20)


def stamps_while(board: Emulator, flood: bytes, seconds: int) -> list[int]:
    """Milliseconds of the board's own clock at which LampCommands came while it was flooded, channel open, own time.

    The flood begins after the first: the emulator fills the receive ring in no time, which no wire can, and in the tick
    of a decision that would be 8 ms of interrupts.
    """
    line = board.connect(board.bus)
    line.setblocking(False)
    line.send(b"\rZ1\rO\r")
    text = b""
    stamps: list[int] = []
    end = time.monotonic() + ANSWER_S
    while len(stamps) < seconds * 10:
        assert time.monotonic() < end, f"{len(stamps)} LampCommands"
        ready, room, _ = select.select([line], [line] if flood and stamps else [], [], 1.0)
        if room:
            line.send(flood)
        if ready:
            text += line.recv(65536)
            *lines, text = text.replace(b"\a", b"\r").split(b"\r")
            stamps += [int(one[-4:], 16) for one in lines if one.startswith(b"t%03X8" % LAMP_COMMAND)]
    line.close()
    return stamps


@pytest.mark.parametrize(
    "flood", [b"", rubbish(4096, 7), b"t7FF80102030405060708\r" * 200], ids=["none", "rubbish", "frames"]
)
def test_a_flood_keeps_no_lamp_waiting(site: Path, flood: bytes) -> None:
    with Emulator(site=site) as board:
        stamps = stamps_while(board, flood, seconds=5)
    gaps = [(later - earlier) % 60000 for earlier, later in pairwise(stamps)]
    assert min(gaps) >= 90
    assert max(gaps) <= 110


# --- what is stored ---


def test_stored_weights_that_are_good_are_those_that_run(site: Path, weights: Path) -> None:
    with Emulator(site=site, weights=weights) as board:
        status = Bus(board).mode(STEADY)
    body = weights.read_bytes()[16:]
    assert status.weights_id == ~zlib.crc32(body) & 0xFFF
    assert status.fault == "none"


def clear(bus: Bus, fault: str) -> None:
    for request in (PREPARE, CONFIRM):
        bus.send(COMMAND, request | CODES[fault] << 4)
        bus.tick()


def expect_only_flashing(bus: Bus, fault: str) -> None:
    status = bus.mode("fail_safe")
    assert status.fault == fault
    for _ in range(50):
        bus.tick()
        assert set(bus.lamps[:12]) <= FLASHING


@pytest.mark.parametrize("at", [0, 4, 8, 12, 16, 5000, 34499])
def test_weights_with_a_flipped_bit_are_named_and_the_last_good_ones_kept(site: Path, weights: Path, at: int) -> None:
    with Emulator(site=site) as board:
        shipped = Bus(board).mode(STEADY).weights_id
    with Emulator(site=site, weights=with_flipped_bit(weights, at)) as board:
        bus = Bus(board)
        expect_only_flashing(bus, "weights_changed")
        assert "the stored weights are refused" in board.hears("refused:")
        clear(bus, "weights_changed")  # without the key
        assert bus.reported().fault == "weights_changed"
        board.people.send(b"h")
        bus.ticks(2)
        clear(bus, "weights_changed")
        status = bus.mode(STEADY)
        assert (status.fault, status.weights_id) == ("none", shipped)


@pytest.mark.parametrize("at", [0, 4, 8, 12, 16, 1000, 2227])
def test_a_site_with_a_flipped_bit_is_named_and_moves_nobody(site: Path, at: int) -> None:
    with Emulator(site=with_flipped_bit(site, at)) as board:
        bus = Bus(board)
        expect_only_flashing(bus, "site_changed")
        said = board.hears("counted from 0")
    what = {0: "not an ELMS image", 4: "another version", 8: "another length"}.get(at, "whose checksum does not fit")
    assert "the stored site is refused:" in said
    assert what in said


def test_a_site_that_breaks_a_rule_is_refused_with_the_rule_and_the_pair(tmp_path: Path) -> None:
    """Groups 0 and 4 conflict, and only 4 knows."""
    junction, _ = load_site(ROOT / "sites" / "four_way.toml")
    first, *others = junction.conflict
    assert first & 1 << 4
    image = tmp_path / "site.bin"
    image.write_bytes(image_bytes(replace(junction, conflict=(first & ~(1 << 4), *others))))
    with Emulator(site=image) as board:
        expect_only_flashing(Bus(board), "site_changed")
        said = board.hears("counted from 0")
    assert "two groups conflict one-sidedly" in said
    assert "at 000 and 004" in said


def test_a_site_that_is_simulation_only_is_refused_by_name(tmp_path: Path) -> None:
    tool("site", "sites/paper.toml", "--image", str(tmp_path / "paper.bin"))
    with Emulator(site=tmp_path / "paper.bin") as board:
        expect_only_flashing(Bus(board), "site_changed")
        said = board.hears("paper")
    assert "simulation_only" in said


# --- what comes over the bus ---

RECEIVING, ON_TRIAL, KEPT, REFUSED = 1, 2, 4, 5
FLASHING_COMMAND, BY_HAND, NOT_SAFE = 6, 5, 6
TRIAL_TICKS = 3000


def send_image(bus: Bus, image: bytes) -> tuple[int, int, int]:
    """Segment by segment, as flow control lets; the report that ends it."""
    frames = segments(image)
    bus.write(b"t%03X8" % TRANSFER + frames.pop(0).hex().upper().encode() + b"\r")
    while True:
        before = len(bus.seen)
        bus.tick()
        for ack in [frame for frame in bus.seen[before:] if frame.id == TRANSFER_ACK]:
            if ack.report is not None and ack.report[1] != RECEIVING:
                return ack.report
            for data in frames[: ack.go_on]:
                bus.write(b"t%03X8" % TRANSFER + data.hex().upper().encode() + b"\r")
            del frames[: ack.go_on]


def until_kept(bus: Bus) -> None:
    for _ in range(TRIAL_TICKS + 400):
        before = len(bus.seen)
        bus.tick()
        reports = [frame.report for frame in bus.seen[before:] if frame.id == TRANSFER_ACK]
        if any(report is not None and report[1] == KEPT for report in reports):
            return
    raise AssertionError("not kept")


def test_weights_over_the_bus_run_are_kept_and_outlive_a_reset_and_a_site_by_hand_stays(
    site: Path, weights: Path
) -> None:
    image = weights.read_bytes()
    wanted = ~zlib.crc32(image[16:]) & 0xFFF
    with Emulator(site=site) as board:
        bus = Bus(board)
        shipped = bus.mode(STEADY).weights_id
        assert send_image(bus, image) == (1, ON_TRIAL, 0)
        assert bus.reported().weights_id == wanted != shipped
        board.reset()  # in the trial
        bus.open()
        assert bus.mode(STEADY).weights_id == shipped
        assert send_image(bus, image) == (1, ON_TRIAL, 0)
        until_kept(bus)
        board.reset()
        bus.open()
        status = bus.mode(STEADY)
        assert (status.weights_id, status.fault) == (wanted, "none")
        assert send_image(bus, site.read_bytes()) == (2, REFUSED, BY_HAND)


def test_a_site_over_the_bus_needs_the_key_and_flashing_and_begins_anew(site: Path) -> None:
    with Emulator() as board:  # nothing by hand: the site that is compiled in
        bus = Bus(board)
        bus.mode(STEADY, seconds=90)
        assert send_image(bus, site.read_bytes()) == (2, REFUSED, NOT_SAFE)
        bus.send(COMMAND, FLASHING_COMMAND)
        bus.mode("flashing")
        assert send_image(bus, site.read_bytes()) == (2, REFUSED, NOT_SAFE)
        board.people.send(b"h")
        bus.ticks(2)
        assert send_image(bus, site.read_bytes()) == (2, ON_TRIAL, 0)
        board.people.send(b"l")
        assert bus.mode(STEADY).weights_id != 0  # this site has a network
        board.reset()  # in the trial: the one that is compiled in has none
        bus.open()
        assert bus.mode("starting").weights_id == 0


# --- the board itself ---


def test_a_program_with_a_flipped_bit_is_found_and_no_command_helps(site: Path, tmp_path: Path) -> None:
    image = tmp_path / "image"
    image.write_bytes(IMAGE.read_bytes())
    at = image.read_bytes().index(b"NE386\0") + 2
    with Emulator(image=with_flipped_bit(image, at), site=site) as board:
        bus = Bus(board)
        expect_only_flashing(bus, "memory")
        board.people.send(b"h")
        bus.ticks(2)
        clear(bus, "memory")
        bus.ticks(5)
        expect_only_flashing(bus, "memory")


def until_green(bus: Bus) -> None:
    bus.mode(STEADY)
    for _ in range(600):
        if GREEN in bus.lamps:
            return
        bus.tick()
    raise AssertionError(f"no green but {bus.lamps}")


def test_a_reset_in_the_middle_of_a_green_restarts_in_starting(site: Path) -> None:
    with Emulator(site=site) as board:
        bus = Bus(board)
        until_green(bus)
        board.reset()
        bus.open()
        bus.tick()
        assert bus.status is not None
        assert (bus.status.mode, bus.status.fault) == ("starting", "none")
        assert set(bus.lamps[:12]) <= FLASHING
        until_green(bus)


def packet(gdb: socket.socket, text: str) -> str:
    """One packet to the emulator's debugger, and its answer."""
    gdb.sendall(f"+${text}#{sum(text.encode()) & 0xFF:02x}".encode())
    gdb.settimeout(ANSWER_S)
    seen = b""
    while (found := re.search(rb"\+\$([^#]*)#..", seen)) is None:
        seen += gdb.recv(4096)
    return found[1].decode("ascii")


def jump(board: Emulator, address: int) -> None:
    """The processor goes on somewhere else: the program counter is the sixteenth of its registers."""
    path = Path(board.folder.name) / "gdb"
    board.ask("human-monitor-command", **{"command-line": f"gdbserver unix:{path},server=on,wait=off"})
    gdb = board.connect(path)
    assert packet(gdb, "?").startswith("T")
    registers = packet(gdb, "g")
    assert packet(gdb, "G" + registers[:120] + struct.pack("<I", address).hex() + registers[128:]) == "OK"
    assert packet(gdb, "D") == "OK"
    gdb.close()


def endless_loop() -> int:
    """Where in the program an instruction is that leads to itself: the file's offset is not the address."""
    elf = IMAGE.read_bytes()
    segment = struct.unpack_from("<IIIIII", elf, struct.unpack_from("<I", elf, 28)[0])
    code = elf[segment[1] : segment[1] + segment[4]]
    at = next(found.start() for found in re.finditer(b"\xfe\xe7", code) if found.start() % 2 == 0)
    return int(segment[2]) + at


def test_a_fault_handler_ends_in_the_fail_safe_after_the_restart(site: Path) -> None:
    with Emulator(site=site) as board:
        bus = Bus(board)
        until_green(bus)
        jump(board, 0xF0000000)  # where no code can be
        board.hears("fault handler\r\nelmopp-mps2 starts")
        bus.open()
        expect_only_flashing(bus, "processor")


def test_a_program_that_hangs_is_started_anew_by_the_watchdog_and_flashes(site: Path) -> None:
    with Emulator(site=site) as board:
        bus = Bus(board)
        until_green(bus)
        jump(board, endless_loop())
        board.hears("fault handler\r\nelmopp-mps2 starts")
        bus.open()
        expect_only_flashing(bus, "processor")
