# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""An emulated board with elmopp-mps2 on it, and the other end of its serial line, for the tests beside this file.

The other end is written after the CAN232 manual and firmware/can/elmopp.dbc, apart from host_sim's and the firmware's.
Standard library only. Time is the simulator's: a test sends SimTime, so nothing depends on how busy this machine is.
"""

import json
import os
import select
import shlex
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Self

from bus_frames import LAMP_COMMAND, LAMP_FEEDBACK, SIM_TIME, STATUS, Frame, sealed

ROOT = Path(__file__).resolve().parents[2]
IMAGE = Path(os.environ.get("ELMOPP_MPS2", ROOT / "build" / "cortex-m4" / "bin" / "elmopp-mps2"))
SITE_SLOT, WEIGHTS_SLOT, WEIGHTS_STORE = 0x00300000, 0x00310000, 0x00320000  # firmware/port/mps2/mps2.ld
ANSWER_S = 60.0

COLOURS = [0, 1, 3, 4, 2, 0, 0, 0]  # of an aspect: red 1, amber 2, green 4; what flashes is dark just now


class Emulator:
    """QEMU with the image, or another one; images in its slots and store; a socket a serial line, or a terminal."""

    def __init__(
        self,
        *,
        image: Path = IMAGE,
        site: Path | None = None,
        weights: Path | None = None,
        kept: Path | None = None,
        terminal: bool = False,
    ) -> None:
        self.folder = tempfile.TemporaryDirectory(prefix="elmopp-")  # short: a socket's path may have 107 characters
        names = ("bus", "people", "qmp", "plug")
        self.bus, self.people_line, self.control, self.plug = (Path(self.folder.name) / name for name in names)
        words = ["qemu-system-arm", "-M", "mps2-an386", "-icount", "shift=6", "-nodefaults", "-display", "none"]
        words += ["-monitor", "none", "-nic", "user,restrict=on,ipv6=off", "-audiodev", "none,id=none"]
        for name, path in (("bus", self.bus), ("people", self.people_line)):
            socket_of = f"socket,id={name},path={path},server=on,wait=off"
            words += ["-chardev", f"pty,id={name}" if terminal and name == "bus" else socket_of]
            words += ["-serial", f"chardev:{name}"]
        for path in (self.control, self.plug):
            words += ["-qmp", f"unix:{path},server=on,wait=off"]
        words += ["-S", "-kernel", str(image)]
        for slot, file in ((SITE_SLOT, site), (WEIGHTS_SLOT, weights), (WEIGHTS_STORE, kept)):
            if file is not None:
                words += ["-device", f"loader,file={file},addr={slot:#x},force-raw=on"]
        self.process = subprocess.Popen(
            words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        self.people = self.connect(self.people_line)
        self.qmp = self.connect(self.control)
        self.qmp_lines = self.qmp.makefile("rb")
        self.qmp_lines.readline()
        self.ask("qmp_capabilities")
        self.ask("cont")  # not before somebody hears what it says first

    def connect(self, path: Path) -> socket.socket:
        """One of its sockets, as soon as it is there."""
        line = socket.socket(socket.AF_UNIX)
        end = time.monotonic() + ANSWER_S
        while True:
            try:
                line.connect(str(path))
            except (FileNotFoundError, ConnectionRefusedError):
                assert self.process.poll() is None, self.process.communicate()[1]
                assert time.monotonic() < end, f"{path} does not come"
                time.sleep(0.02)
            else:
                return line

    def ask(self, command: str, **arguments: object) -> object:
        """A command to the emulator itself."""
        self.qmp.sendall(json.dumps({"execute": command, "arguments": arguments}).encode() + b"\n")
        while True:
            answer = json.loads(self.qmp_lines.readline())
            if "event" not in answer:
                assert "return" in answer, answer
                return answer["return"]

    def link(self) -> str:
        """The first serial line as host_sim calls it."""
        lines = self.ask("query-chardev")
        assert isinstance(lines, list)
        name = next(line["filename"] for line in lines if line["label"] == "bus")
        return f"slcan:tty:{name[4:]}" if name.startswith("pty:") else f"slcan:unix:{self.bus}"

    def reset(self) -> None:
        """Pulls the plug and puts it in again."""
        self.ask("system_reset")

    def reset_command(self) -> str:
        """The same as a command, for a program that pulls the plug by itself."""
        return shlex.join([sys.executable, str(Path(__file__).with_name("reset_board.py")), str(self.plug)])

    def hears(self, words: str) -> str:
        """Waits until the line for people has these words; returns everything that it said."""
        said = b""
        end = time.monotonic() + ANSWER_S
        while words.encode() not in said:
            assert time.monotonic() < end, f'the board did not say "{words}" but: {said!r}'
            if select.select([self.people], [], [], 0.5)[0]:
                said += self.people.recv(4096)
        return said.decode("ascii")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.process.kill()
        self.process.wait(timeout=20)
        for line in (self.people, self.qmp):
            line.close()
        self.folder.cleanup()


class Bus:
    """The other end of the serial line: a simulator that plays a lamp node and gives the time."""

    def __init__(self, board: Emulator) -> None:
        self.line = board.connect(board.bus)
        self.line.setblocking(False)
        self.text = b""
        self.counters: dict[int, int] = {}
        self.now_ms = 0
        self.lamps: list[int] = [0] * 16
        self.status: Frame | None = None
        self.seen: list[Frame] = []
        self.answers: list[str] = []
        self.open()

    def open(self) -> None:
        """Opens the channel and begins anew with time 0."""
        self.write(b"\r\rC\rV\r")
        self.until("V1013")
        self.write(b"S6\rO\rV\r")
        self.until("V1013")
        self.now_ms, self.status, self.seen = 0, None, []
        self.send(SIM_TIME, 0)
        self.until("z")

    def write(self, text: bytes) -> None:
        """Characters as they are; what comes back meanwhile is read, so that nobody stands still."""
        end = time.monotonic() + ANSWER_S
        while text:
            assert time.monotonic() < end, "the board does not read"
            ready, room, _ = select.select([self.line], [self.line], [], 1.0)
            if ready:
                self.read()
            if room:
                text = text[self.line.send(text[:4096]) :]

    def read(self) -> None:
        """Sorts what has come into frames and answers."""
        try:
            came = self.line.recv(65536)
        except BlockingIOError:
            return
        assert came, "the line was closed"
        self.text += came
        *lines, self.text = self.text.replace(b"\a", b"refused\r").split(b"\r")
        for raw in lines:
            line = raw.decode("ascii")
            if line.startswith("t"):
                self.hear(Frame(int(line[1:4], 16), bytes.fromhex(line[5:])))
            else:
                self.answers.append(line)

    def hear(self, frame: Frame) -> None:
        """Remembers lamps and status."""
        self.seen.append(frame)
        if frame.id == LAMP_COMMAND:
            self.lamps = frame.aspects
        if frame.id == STATUS:
            self.status = frame

    def until(self, answer: str) -> None:
        """Waits for this answer; what came before it is gone."""
        end = time.monotonic() + ANSWER_S
        while answer not in self.answers:
            assert time.monotonic() < end, f"no answer {answer!r} but {self.answers}"
            select.select([self.line], [], [], 0.5)
            self.read()
        del self.answers[: self.answers.index(answer) + 1]

    def send(self, frame_id: int, payload: int) -> None:
        """A good frame."""
        counter = self.counters.get(frame_id, 0) if frame_id != SIM_TIME or payload else 0
        self.counters[frame_id] = (counter + 1) % 15
        self.write(b"t%03X8" % frame_id + sealed(frame_id, counter, payload).hex().upper().encode() + b"\r")

    def tick(self, *, feedback: bool = True) -> None:
        """A lamp tick: what the lamp node measures, the time, and the LampCommand that answers."""
        if feedback:
            measured = sum(COLOURS[aspect] << 3 * g for g, aspect in enumerate(self.lamps))
            self.send(LAMP_FEEDBACK, measured << 4)
        self.now_ms += 100
        before = len(self.seen)
        self.send(SIM_TIME, self.now_ms << 4)
        end = time.monotonic() + ANSWER_S
        while not any(frame.id == LAMP_COMMAND for frame in self.seen[before:]):
            assert time.monotonic() < end, "no LampCommand answers"
            select.select([self.line], [], [], 0.5)
            self.read()

    def ticks(self, count: int) -> None:
        """So many lamp ticks."""
        for _ in range(count):
            self.tick()

    def mode(self, wanted: str, seconds: int = 60) -> Frame:
        """Ticks until the controller is in this mode; its status then."""
        for _ in range(seconds * 10):
            if self.status is not None and self.status.mode == wanted:
                return self.status
            self.tick()
        raise AssertionError(f"not {wanted} within {seconds} s but {self.status}")

    def reported(self) -> Frame:
        """The status of the next second."""
        self.status = None
        self.ticks(11)
        assert self.status is not None
        return self.status
