# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""A bus, and the programs on it, for the tests beside this file.

Standard library only: quick to start in an emulator.
"""

import contextlib
import os
import re
import select
import signal
import socket
import struct
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Self

from bus_frames import COMMAND, STATUS, Frame, sealed

ROOT = Path(__file__).resolve().parents[2]
PROGRAMS = Path(os.environ["ELMOPP_PROGRAMS"])
SITE = os.environ["ELMOPP_QUICK_SITE"]
LOCKSTEP_SITES = os.environ.get("ELMOPP_LOCKSTEP_SITES", SITE).split(":")
SLICE_MS = Path("/proc/sys/kernel/sched_rr_timeslice_ms")
OUT = Path(os.environ["ELMOPP_SOCKETCAN_OUT"])

RUN, PREPARE, CONFIRM = 2, 8, 9
FRAME = struct.Struct("=IB3x8s")


@dataclass
class Heard(Frame):
    """A frame, and when it came."""

    at_s: float


class Bus:
    """A raw socket that hears these ids, or everything."""

    def __init__(self, interface: str, *ids: int) -> None:
        self.socket = socket.socket(socket.PF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
        if ids:
            filters = b"".join(struct.pack("=II", frame_id, 0x7FF) for frame_id in ids)
            self.socket.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FILTER, filters)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 21)
        self.socket.bind((interface,))
        self.counters: dict[int, int] = {}

    def send(self, frame_id: int, data: bytes) -> None:
        """Sends a frame as it is."""
        self.socket.send(FRAME.pack(frame_id, len(data), data.ljust(8, b"\0")))

    def tell(self, frame_id: int, payload: int) -> None:
        """Sends a good frame."""
        counter = self.counters.get(frame_id, 0)
        self.counters[frame_id] = (counter + 1) % 15
        self.send(frame_id, sealed(frame_id, counter, payload))

    def command(self, request: int, argument: int = 0) -> None:
        """Sends a Command."""
        self.tell(COMMAND, request | argument << 4)

    def hear(self, seconds: float) -> Iterator[Heard]:
        """Frames until the time is up."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            if select.select([self.socket], [], [], left)[0]:
                frame_id, length, data = FRAME.unpack(self.socket.recv(16))
                yield Heard(frame_id, data[:length], time.monotonic())

    def clear(self) -> None:
        """Forgets what has come."""
        for _ in self.hear(0.001):
            pass

    def until(self, frame_id: int, wanted: Callable[[Heard], object], seconds: float, what: str) -> Heard:
        """The first such frame."""
        last = None
        for frame in self.hear(seconds):
            if frame.id == frame_id:
                last = frame
                if wanted(frame):
                    return frame
        raise AssertionError(f"not within {seconds} s: {what}; last heard: {last}")

    def mode(self, mode: str, seconds: float = 40.0) -> Heard:
        """Waits for a mode."""
        return self.until(STATUS, lambda frame: frame.mode == mode, seconds, f"mode {mode}")


def ip(*words: str) -> None:
    """Changes an interface."""
    subprocess.run(["ip", "link", *words], check=True, capture_output=True, timeout=120)


@contextlib.contextmanager
def interface(name: str) -> Iterator[str]:
    """A vcan interface of a test's own."""
    ip("add", name, "type", "vcan")
    ip("set", name, "up")
    try:
        yield name
    finally:
        subprocess.run(["ip", "link", "del", name], check=False, capture_output=True, timeout=120)


def wait_for_listener(name: str) -> None:
    """Until somebody listens on this interface, as the kernel says."""
    entry = re.compile(rf"^\s+{re.escape(name)}\s", re.MULTILINE)
    end = time.monotonic() + 120.0
    while not any(entry.search(path.read_text(encoding="utf-8")) for path in Path("/proc/net/can").glob("rcvlist_*")):
        assert time.monotonic() < end, f"nobody listens on {name}"
        time.sleep(0.05)


def by_turns() -> list[str]:
    """The words before an urgent program, of which a dozen share a processor by short turns.

    The unit file's policy is fifo, for one controller on a machine: here one that starts would keep the processor for
    longer than a lamp node waits.
    """
    SLICE_MS.write_text("10\n", encoding="ascii")
    return ["chrt", "--rr", "50"]


class Program:
    """One of our programs, and what it has said."""

    def __init__(self, name: str, *words: str) -> None:
        self.name = name
        # In memory: where waiting takes no time, a file of the machine outside is a long wait.
        self.said = Path(tempfile.mkdtemp(prefix="elmopp-")) / f"{name}.txt"
        with self.said.open("wb") as out:
            # In lockstep nobody is late.
            urgent = [] if "bus" in words or os.geteuid() != 0 else by_turns()
            command = [*urgent, str(PROGRAMS / name), *words]
            self.process = subprocess.Popen(command, stdout=out, stderr=out, cwd=ROOT)

    def text(self) -> str:
        """Everything said so far."""
        return self.said.read_text(encoding="utf-8")

    def says(self, words: str, seconds: float = 10.0) -> None:
        """Waits until it has said this."""
        end = time.monotonic() + seconds
        while words not in self.text():
            assert time.monotonic() < end, f'{self.name} did not say "{words}" within {seconds} s but:\n{self.text()}'
            time.sleep(0.02)

    def cpu_s(self) -> float:
        """Processor time that it has used."""
        words = Path(f"/proc/{self.process.pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
        return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")

    def ask(self, number: signal.Signals) -> None:
        """Sends a signal."""
        self.process.send_signal(number)

    def ends(self, seconds: float = 30.0) -> int:
        """Its exit code."""
        return self.process.wait(timeout=seconds)

    def __enter__(self) -> Self:
        return self

    def stop(self) -> None:
        """Ends it at once; a second time it does nothing."""
        self.process.kill()
        self.process.wait(timeout=10)

    def __exit__(self, *_: object) -> None:
        self.stop()


def controller(name: str, *words: str, site: str = SITE) -> Program:
    """elmopp-controller with the quick site, or another."""
    return Program("elmopp-controller", "--can", name, "--site", site, *words)


def lamp_node(name: str, *words: str) -> Program:
    """elmopp-lamp-node with the quick site."""
    return Program("elmopp-lamp-node", "--can", name, "--site", SITE, *words)


def refused(program: str, *words: str) -> str:
    """The one line with which a request is refused."""
    done = subprocess.run(
        [str(PROGRAMS / program), *words], capture_output=True, text=True, check=False, timeout=60, cwd=ROOT
    )
    assert done.returncode == 2, (done.returncode, done.stderr)
    assert done.stdout == ""
    assert done.stderr.count("\n") == 1, done.stderr
    return done.stderr
