# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""The image elmopp-stm32f4 in QEMU's netduinoplus2, an STM32F405 that has neither crystal nor CAN controller.

Nor has QEMU 7.2 its core-coupled memory: ELMOPP_IMAGE names the image with what lies there somewhere else,
ELMOPP_FLASHED the one that is written into boards, ELMOPP_OTHER_IMAGE one that may be told the time over the bus, to
show that what is looked for can be found. Images are patched as ELF files and sealed anew, so that a fault happens
where a test wants it.
"""

from __future__ import annotations

import os
import queue
import re
import struct
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
IMAGE = Path(os.environ.get("ELMOPP_IMAGE", ""))
FLASHED = Path(os.environ.get("ELMOPP_FLASHED", ""))
OTHER_IMAGE = Path(os.environ.get("ELMOPP_OTHER_IMAGE", ""))
PATIENCE_S = 60.0
QEMU = ["qemu-system-arm", "-M", "netduinoplus2", "-icount", "shift=6", "-nodefaults", "-display", "none"]
QEMU += ["-monitor", "none", "-serial", "stdio", "-kernel"]

UNDEFINED_INSTRUCTION = b"\x00\xde"
PUSH_FOR_EVER = b"\x00\xb5\xfd\xe7"  # push {lr}; b to it


class Board:
    """An emulated board and what it says on its serial line."""

    def __init__(self, image: Path, *options: str) -> None:
        self.said: list[str] = []
        self._lines: queue.Queue[str | None] = queue.Queue()
        self._process = subprocess.Popen(
            [*QEMU, str(image), *options],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        threading.Thread(target=self._listen, daemon=True).start()

    def _listen(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            self._lines.put(line.strip())
        self._lines.put(None)

    def hear(self, wanted: str, times: int = 1) -> None:
        """Waits until this line has been said so often, since the start."""
        end = time.monotonic() + PATIENCE_S
        while self.said.count(wanted) < times:
            try:
                line = self._lines.get(timeout=max(0.0, end - time.monotonic()))
            except queue.Empty:
                line = None
            assert line is not None, f"not heard {times} times: '{wanted}'; but: {self.said}"
            self.said.append(line)

    def after(self, line: str) -> str:
        return self.said[self.said.index(line) + 1]

    def end(self) -> None:
        self._process.kill()
        self._process.wait()


@pytest.fixture
def boards() -> Iterator[list[Board]]:
    made: list[Board] = []
    yield made
    for board in made:
        board.end()


def start(boards: list[Board], image: Path, *options: str) -> Board:
    boards.append(Board(image, *options))
    return boards[-1]


def symbols(image: Path) -> dict[str, int]:
    lines = subprocess.run(["arm-none-eabi-nm", str(image)], check=True, capture_output=True, text=True).stdout
    return {parts[2]: int(parts[0], 16) for parts in map(str.split, lines.splitlines()) if len(parts) == 3}


def offset_of(elf: bytes, address: int) -> int:
    """Where in the file the byte at this address of the memory is."""
    table, size, count = struct.unpack_from("<I10xHH", elf, 28)
    for k in range(count):
        kind, offset, place, _, length = struct.unpack_from("<IIIII", elf, table + k * size)
        if kind == 1 and place <= address < place + length:
            return int(offset + address - place)
    raise AssertionError(f"the image has nothing at {address:#x}")


def patched(folder: Path, symbol: str, code: bytes) -> Path:
    """A copy of the image, sealed, in which a function begins otherwise."""
    elf = bytearray(IMAGE.read_bytes())
    at = offset_of(bytes(elf), symbols(IMAGE)[symbol] & ~1)
    elf[at : at + len(code)] = code
    copy = folder / "patched"
    copy.write_bytes(elf)
    subprocess.run([sys.executable, str(ROOT / "cmake" / "seal_image.py"), str(copy)], check=True)
    return copy


def test_without_crystal_and_can_controller_it_ends_in_fail_safe_and_says_why(boards: list[Board]) -> None:
    board = start(boards, IMAGE)
    board.hear("CAN: given up; turning the key begins anew:")
    board.hear("it does not answer", times=10)
    assert board.after("oscillator: internal, 16 MHz, so that CAN is tried and stays silent:") == (
        "the crystal does not swing"
    )
    assert board.after("fail-safe, the lamps flash; fault:") == "oscillator"
    assert board.after("CAN: given up; turning the key begins anew:") == "it does not answer"
    assert "stopped, begins anew:" not in board.said
    assert not any("on the bus" in line for line in board.said)


def test_a_flipped_bit_of_the_program_is_a_fault_of_the_memory(boards: list[Board], tmp_path: Path) -> None:
    elf = bytearray(IMAGE.read_bytes())
    elf[offset_of(bytes(elf), symbols(IMAGE)["elmopp_weights_nlstm"] + 1000)] ^= 0x10
    copy = tmp_path / "flipped"
    copy.write_bytes(elf)
    board = start(boards, copy)
    board.hear("memory test")
    assert board.after("fail-safe, the lamps flash; fault:") == "memory test"


def test_a_fault_handler_begins_anew_and_the_next_run_tells_it(boards: list[Board], tmp_path: Path) -> None:
    board = start(boards, patched(tmp_path, "elmopp_bxcan_trouble_name", UNDEFINED_INSTRUCTION))
    board.hear("stopped, begins anew:", times=2)
    board.hear("fault handler", times=2)
    second = board.said[board.said.index("fault handler") + 1 :]
    assert second[0] == "elmopp-stm32f4 starts; last reset:"
    assert second[second.index("fail-safe, the lamps flash; fault:") + 1] == "processor"


def test_a_stack_that_overflows_ends_in_the_fault_handler_with_variables_intact(
    boards: list[Board], tmp_path: Path
) -> None:
    board = start(boards, patched(tmp_path, "elmopp_controller_tick", PUSH_FOR_EVER))
    board.hear("fault handler", times=2)
    lines = [line for line in board.said if line]
    assert lines[0] == "elmopp-stm32f4 starts; last reset:"
    # What variables hold, here the lines that still waited, was not overwritten.
    assert lines[lines.index("stopped, begins anew:") + 1] == "fault handler"


@pytest.fixture
def stored_site(tmp_path: Path) -> Path:
    """Another junction than the one that is compiled in, as an image."""
    file = tmp_path / "site.bin"
    command = [
        sys.executable,
        str(ROOT / "tools" / "site"),
        str(ROOT / "sites" / "three_way.toml"),
        "--image",
        str(file),
    ]
    subprocess.run(command, check=True, capture_output=True)
    return file


def stored(file: Path) -> tuple[str, str]:
    """Options that put it where a site may be stored, sector 10 of the flash."""
    return "-device", f"loader,file={file},addr=0x080C0000,force-raw=on"


def test_a_stored_site_is_taken(boards: list[Board], stored_site: Path) -> None:
    board = start(boards, IMAGE, *stored(stored_site))
    board.hear("fail-safe, the lamps flash; fault:")
    board.hear("oscillator")
    assert not [line for line in board.said if "refused" in line]


def test_a_stored_site_with_a_flipped_bit_is_refused_and_named(boards: list[Board], stored_site: Path) -> None:
    changed = bytearray(stored_site.read_bytes())
    changed[100] ^= 0x01
    stored_site.write_bytes(changed)
    board = start(boards, IMAGE, *stored(stored_site))
    board.hear("the stored site is refused:")
    board.hear("site data changed")
    assert board.after("fail-safe, the lamps flash; fault:") == "site data changed"


def sections(image: Path) -> dict[str, tuple[int, int]]:
    """Address and size of what takes memory."""
    listing = subprocess.run(["arm-none-eabi-readelf", "-SW", str(image)], check=True, capture_output=True, text=True)
    row = re.compile(r"\] (\.\w+) +\w+ +([0-9a-f]{8}) [0-9a-f]+ ([0-9a-f]+) [0-9a-f]+ +\w*A")
    return {name: (int(at, 16), int(size, 16)) for name, at, size in row.findall(listing.stdout)}


def test_what_learns_has_the_core_coupled_memory_for_itself() -> None:
    at, size = sections(FLASHED)[".aside"]
    assert (at, symbols(FLASHED)["learning"]) == (0x10000000, 0x10000000)
    assert 40000 < size <= 65536
    assert (symbols(FLASHED)["elmopp_aside_start"], symbols(FLASHED)["elmopp_aside_end"]) == (0x10000000, 0x10010000)


def test_the_image_in_the_emulator_is_the_one_for_boards_but_for_the_place_of_what_learns() -> None:
    assert {name: size for name, (_, size) in sections(IMAGE).items()} == {
        name: size for name, (_, size) in sections(FLASHED).items()
    }
    moved = {name for name, at in symbols(IMAGE).items() if symbols(FLASHED).get(name) != at}
    assert moved == {"learning", "elmopp_aside", "elmopp_aside_start", "elmopp_aside_end"}


def words(image: Path, address: int, count: int) -> tuple[int, ...]:
    elf = image.read_bytes()
    return struct.unpack_from(f"<{count}I", elf, offset_of(elf, address))


def test_every_exception_leads_where_it_must() -> None:
    known = symbols(IMAGE)
    stack, reset, *exceptions = words(IMAGE, 0x08000000, 16)
    assert 0x20000000 < stack <= 0x20020000
    assert reset == known["elmopp_reset_handler"] | 1
    assert set(exceptions[:13]) == {known["fault"] | 1}  # NMI, which tells that the crystal has stopped, among them
    assert exceptions[13] == known["elmopp_systick_handler"] | 1
    devices = list(words(IMAGE, 0x08000040, 82))
    assert devices.pop(20) == known["can_handler"] | 1  # CAN1_RX0
    assert set(devices) == {known["elmopp_unexpected_handler"] | 1}


def test_the_image_has_no_heap_no_output_and_no_double_precision() -> None:
    unwanted = re.compile(r"malloc|_sbrk|printf|^expf?$|^tanhf?$|^__aeabi_d|^__aeabi_f2d")
    assert not [name for name in symbols(IMAGE) if unwanted.search(name)]


def test_nothing_in_the_image_knows_simulated_time() -> None:
    told = re.compile(r"bus_clock|sim_time|decision_trace")
    assert [name for name in symbols(OTHER_IMAGE) if told.search(name)], "what is looked for is not in the other one"
    assert not [name for name in symbols(IMAGE) if told.search(name)]
    assert not constants(IMAGE) & {0x7E0, 0x7E1}
    assert constants(OTHER_IMAGE) >= {0x7E0}


def constants(image: Path) -> set[int]:
    """Numbers that instructions of this image name."""
    listing = subprocess.run(["arm-none-eabi-objdump", "-d", str(image)], check=True, capture_output=True, text=True)
    return {int(number) for number in re.findall(r"#(\d+)\b", listing.stdout)}
