# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Frames of the junction's bus, made and taken apart by hand for the tests that stand at the bus's other end.

After firmware/can/elmopp.dbc and apart from the generated codec. Standard library only: quick to start in an emulator.
"""

from dataclasses import dataclass

LAMP_COMMAND, LAMP_FEEDBACK, COUNTS, STATUS, COMMAND, SIM_TIME = 0x080, 0x090, 0x100, 0x180, 0x200, 0x7E0
NEIGHBOUR_OUTFLOW = 0x1A0
TRANSFER, TRANSFER_ACK = 0x300, 0x301
MODES = ["starting", "start_flash", "start_red", "first_stage", "automatic", "fixed_time", "manual", "all_red"]
MODES += ["flashing", "dark", "fail_safe"]
FAULTS = {0: "none", 11: "feedback_differs", 12: "feedback_lost", 16: "lamp_node", 18: "site_changed"}
FAULTS |= {19: "weights_changed", 20: "clock", 21: "second_controller", 24: "memory", 25: "processor"}


def crc8(data: bytes) -> int:
    """CRC-8 SAE J1850."""
    rest = 0xFF
    for byte in data:
        rest ^= byte
        for _ in range(8):
            rest = ((rest << 1) ^ 0x1D if rest & 0x80 else rest << 1) & 0xFF
    return rest ^ 0xFF


def sealed(frame_id: int, counter: int, payload: int = 0) -> bytes:
    """Eight bytes with counter, payload from bit 4 on, and checksum."""
    body = (counter | payload << 4).to_bytes(7, "little")
    return body + bytes([crc8(frame_id.to_bytes(2, "little") + body)])


def segments(image: bytes) -> list[bytes]:
    """The frames of an image, segmented after ISO 15765-2."""
    if len(image) > 4095:
        head, begun = bytes([0x10, 0]) + len(image).to_bytes(4, "big"), 2
    else:
        head, begun = (0x1000 | len(image)).to_bytes(2, "big"), 6
    pieces = [image[at : at + 7].ljust(7, b"\0") for at in range(begun, len(image), 7)]
    return [head + image[:begun]] + [bytes([0x20 | k % 16]) + piece for k, piece in enumerate(pieces, start=1)]


def bits(data: bytes, first: int, count: int) -> int:
    """A little-endian signal."""
    return int.from_bytes(data, "little") >> first & ((1 << count) - 1)


@dataclass
class Frame:
    """One that came."""

    id: int
    data: bytes

    @property
    def aspects(self) -> list[int]:
        """Of a LampCommand."""
        return [bits(self.data, 8 + 3 * g, 3) for g in range(16)]

    @property
    def mode(self) -> str:
        """Of a ControllerStatus."""
        return MODES[bits(self.data, 4, 4)]

    @property
    def fault(self) -> str:
        """Of a ControllerStatus."""
        code = bits(self.data, 26, 6)
        return FAULTS.get(code, str(code))

    @property
    def weights_id(self) -> int:
        """Of a ControllerStatus."""
        return bits(self.data, 36, 12)

    @property
    def go_on(self) -> int:
        """Of a TransferAck: how many segments flow control lets go; 0 if it is none."""
        return self.data[1] if self.data[0] == 0x30 else 0

    @property
    def report(self) -> tuple[int, int, int] | None:
        """Of a TransferAck: kind, state, reason, if it is a report."""
        return (self.data[1] & 15, self.data[1] >> 4, self.data[2]) if self.data[0] == 0x07 else None

    @property
    def refused(self) -> int:
        """Of a ControllerStatus."""
        return bits(self.data, 48, 8)
