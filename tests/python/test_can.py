# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""The bus's definition: it opens, it fits, the firmware's codec and enums say the same, and a recorded log decodes.

`PYTHONPATH=tools python tests/python/test_can.py` records tests/golden/bus.log anew, with ELMOPP_CAN_PROBE set: only
after a change of what the controller sends, on purpose.
"""

from __future__ import annotations

import os
import random
import re
import struct
import subprocess
from collections import defaultdict
from pathlib import Path
from typing import Any

import cantools
import pytest
from cantools.database.can import Database, Message
from elmopp_tools.can_codec import DefinitionError, codec, families_of, layout, main

ROOT = Path(__file__).resolve().parents[2]
DBC = ROOT / "firmware" / "can" / "elmopp.dbc"
HEADERS = ROOT / "firmware" / "include" / "elmopp"
LOG = ROOT / "tests" / "golden" / "bus.log"
UNPROTECTED = {"Transfer", "TransferAck"}
CYCLES_MS = {
    "LampCommand": 100,
    "LampFeedback": 100,
    "DetectorCounts": 1000,
    "JunctionOccupied": 200,
    "ControllerStatus": 1000,
    "Forecast": 1000,
    "NeighbourOutflow": 1000,
}
IDS = {
    "LampCommand": 0x080,
    "LampFeedback": 0x090,
    "DetectorCounts": 0x100,
    "JunctionOccupied": 0x110,
    "ControllerStatus": 0x180,
    "Forecast": 0x190,
    "NeighbourOutflow": 0x1A0,
    "Command": 0x200,
    "Transfer": 0x300,
    "TransferAck": 0x301,
    "SimTime": 0x7E0,
    "DecisionTrace": 0x7E1,
}


def load() -> Database:
    database = cantools.database.load_file(DBC, strict=True)
    assert isinstance(database, Database)
    return database


BUS = load()


def probe(command: str, text: str = "") -> str:
    program = os.environ["ELMOPP_CAN_PROBE"]
    done = subprocess.run([program, command], input=text, capture_output=True, text=True, check=True)
    return done.stdout


def crc8(data: bytes) -> int:
    """SAE J1850, by table: another way than the firmware's."""
    table = []
    for byte in range(256):
        rest = byte
        for _ in range(8):
            rest = (rest << 1) ^ (0x11D if rest & 0x80 else 0)
        table.append(rest)
    crc = 0xFF
    for byte in data:
        crc = table[crc ^ byte]
    return crc ^ 0xFF


def decoded_of(frame_id: int, data: bytes) -> dict[str, Any]:
    decoded = BUS.decode_message(frame_id, data)
    assert isinstance(decoded, dict)
    return dict(decoded)


def family(message: Message) -> str:
    return re.sub(r"\d$", "", message.name)


# --- the definition -------------------------------------------------------------------------------------------------


def test_every_frame_of_the_bus_is_there_with_its_id_and_cycle() -> None:
    families = families_of(BUS)
    assert {name: messages[0].frame_id for name, messages in families.items()} == IDS
    for name, messages in families.items():
        several = name in {"LampFeedback", "DetectorCounts", "Forecast", "NeighbourOutflow"}
        assert len(messages) == (8 if several else 1)
        assert all((message.cycle_time or 0) == CYCLES_MS.get(name, 0) for message in messages)


@pytest.mark.parametrize("message", BUS.messages, ids=lambda message: message.name)
def test_a_message_has_eight_bytes_one_sender_a_comment_and_its_protection(message: Message) -> None:
    assert message.length == 8
    assert len(message.senders) == 1
    assert message.comment
    assert all(signal.byte_order == "little_endian" for signal in message.signals)
    if message.name not in UNPROTECTED:
        counter, crc = message.get_signal_by_name("Counter"), message.get_signal_by_name("Crc")
        assert (counter.start, counter.length, crc.start, crc.length) == (0, 4, 56, 8)


def test_no_two_instances_of_a_family_have_the_same_sender_but_the_controller() -> None:
    for messages in families_of(BUS).values():
        senders = [message.senders[0] for message in messages if message.senders[0] not in {"Controller", "Gateway"}]
        assert len(set(senders)) == len(senders)
        assert all(layout(message) == layout(messages[0]) for message in messages)


def test_a_zeroed_lamp_command_is_dark() -> None:
    decoded = decoded_of(0x080, bytes(8))
    assert {str(decoded[f"Aspect{k}"]) for k in range(16)} == {"dark"}


def enum_of(header: str, prefix: str) -> dict[int, str]:
    """The named numbers of a header's enums, in the words of the definition."""
    text = (HEADERS / header).read_text(encoding="utf-8")
    return {int(number): name.lower() for name, number in re.findall(rf"\b{prefix}(\w+) = (\d+)", text)}


def choices(message: str, signal: str) -> dict[int, str]:
    found = BUS.get_message_by_name(message).get_signal_by_name(signal).choices
    assert found is not None
    return {int(number): str(name) for number, name in found.items()}


@pytest.mark.parametrize(
    ("message", "signal", "header", "prefix"),
    [
        ("LampCommand", "Aspect0", "lamps.h", "ELMOPP_ASPECT_"),
        ("LampCommand", "Aspect15", "lamps.h", "ELMOPP_ASPECT_"),
        ("ControllerStatus", "Mode", "mode.h", "ELMOPP_MODE_"),
        ("ControllerStatus", "FirstFault", "fault.h", "ELMOPP_FAULT_"),
        ("Command", "Request", "frames.h", "ELMOPP_REQUEST_"),
    ],
)
def test_value_tables_are_the_enums_of_the_firmware(message: str, signal: str, header: str, prefix: str) -> None:
    enum = {number: name for number, name in enum_of(header, prefix).items() if name != "count"}
    table = {number: name for number, name in choices(message, signal).items() if name != "invalid"}
    assert table == enum


def test_reasons_and_models_are_those_of_the_firmware() -> None:
    reasons = {n: name for n, name in enum_of("detector.h", "ELMOPP_REASON_").items() if name != "count"}
    assert reasons.items() <= choices("DetectorCounts0", "Reason").items()
    models = {n: name for n, name in enum_of("junction.h", "ELMOPP_FORECAST_").items() if name != "count"}
    models |= enum_of("frames.h", "ELMOPP_MODEL_")
    assert choices("Forecast0", "Model") == models


def test_a_family_that_is_laid_out_differently_is_refused(tmp_path: Path) -> None:
    text = DBC.read_text(encoding="utf-8")
    other = tmp_path / "elmopp.dbc"
    line = re.search(r"BO_ 257 DetectorCounts1.*?\n\n", text, re.DOTALL)
    assert line is not None
    other.write_text(text.replace(line[0], line[0].replace("Reason : 4|4", "Reason : 4|3")))
    with pytest.raises(DefinitionError, match="DetectorCounts1"):
        codec(other)


def test_a_definition_that_is_not_there_is_refused_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([str(tmp_path / "nix.dbc")]) == 2
    said = capsys.readouterr().err
    assert (
        said == f"can: {tmp_path / 'nix.dbc'}: No such file or directory ; right would be a DBC file that can be read\n"
    )


# --- the codec ------------------------------------------------------------------------------------------------------


def values_of(length: int, rng: random.Random) -> list[int]:
    top = (1 << length) - 1
    if length <= 12:
        return list(range(top + 1))
    return [0, 1, top, top - 1, *(rng.getrandbits(length) for _ in range(200))]


def test_every_value_of_every_signal_survives_unpacking_and_packing() -> None:
    rng = random.Random(3)
    lines = []
    for message in BUS.messages:
        for signal in message.signals:
            for value in values_of(signal.length, rng):
                lines.append((message.frame_id, (value << signal.start).to_bytes(8, "little")))
    answer = probe("repack", "".join(f"{frame_id:X} {data.hex()}\n" for frame_id, data in lines)).split()
    assert len(answer) == len(lines) > 100_000
    for (frame_id, data), again in zip(lines, answer, strict=True):
        if frame_id == 0x7E1:  # a float that is no number need not keep its bits
            number = struct.unpack("<f", data[2:6])[0]
            if number != number:
                continue
        assert bytes.fromhex(again) == data, hex(frame_id)


# --- the recorded bus -----------------------------------------------------------------------------------------------


def frames() -> list[tuple[float, int, bytes]]:
    pattern = re.compile(r"\((\d+\.\d{6})\) can0 ([0-9A-F]{3})#([0-9A-F]{16})")
    found = [pattern.fullmatch(line) for line in LOG.read_text(encoding="ascii").splitlines()]
    assert all(found)
    return [(float(m[1]), int(m[2], 16), bytes.fromhex(m[3])) for m in found if m is not None]


def test_the_recorded_log_is_what_the_firmware_sends_today() -> None:
    assert probe("record") == LOG.read_text(encoding="ascii")


def test_every_frame_of_the_recorded_log_decodes_and_is_protected() -> None:
    counters: dict[int, int] = {}
    seen: dict[str, int] = defaultdict(int)
    for _, frame_id, data in frames():
        message = BUS.get_message_by_frame_id(frame_id)
        decoded = decoded_of(frame_id, data)
        assert data[7] == crc8(struct.pack("<H", frame_id) + data[:7])
        assert decoded["Counter"] == (counters.get(frame_id, 14) + 1) % 15
        counters[frame_id] = int(decoded["Counter"])
        seen[family(message)] += 1
    assert seen.keys() == {"LampCommand", "LampFeedback", "DetectorCounts", "ControllerStatus", "Forecast"}
    assert seen["LampCommand"] == seen["LampFeedback"] == 300
    assert seen["DetectorCounts"] == seen["Forecast"] == 4 * 30


def test_the_recorded_log_tells_of_a_start() -> None:
    modes = []
    aspects = set()
    for _, frame_id, data in frames():
        name = BUS.get_message_by_frame_id(frame_id).name
        decoded = decoded_of(frame_id, data)
        if name == "ControllerStatus":
            modes.append(str(decoded["Mode"]))
            assert str(decoded["FirstFault"]) == "none"
        elif name == "LampCommand":
            aspects |= {str(decoded[f"Aspect{k}"]) for k in range(4)}
    order = list(dict.fromkeys(modes))
    assert order == ["starting", "start_flash", "start_red", "first_stage", "automatic"]
    assert aspects == {"flash_amber", "red", "red_amber", "green", "amber"}


if __name__ == "__main__":
    LOG.write_text(probe("record"), encoding="ascii")
