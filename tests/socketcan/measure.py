# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Figures of a controller on virtual CAN: gaps between its LampCommands, and how old counts are when they act.

tests/socketcan/run PROGRAMS OUT --measure runs it. One line of JSON each, idle and under stress-ng. In an emulator no
figure says anything about hardware.

`count_age_ms` is from a DetectorCounts frame to the tick that decides with it, `lamp_age_ms` to the first LampCommand
that shows other aspects because of it. For that only N.M or only E.M is waited on, and whoever has green keeps it until
his minimum green and the chooser's are over; then everybody has gone from there and waits on the other.
"""

import contextlib
import json
import subprocess
import time
from collections.abc import Iterator

from bus import Bus, Heard, controller, interface, lamp_node
from bus_frames import COUNTS, LAMP_COMMAND, STATUS
from latency import ages_ms, changes_s, gaps_ms, quantiles

FORECAST = 0x190  # the first of a decision's ...
FORECAST_AFTER_S = 0.1  # ... a lamp tick after it
SETTLE_MAX_S = 60
SECONDS = 180.0
APPROACHES = 4
BUSY = (0, 1)  # N and E, whose second movements conflict
WAITING_VEH = 9
PERIOD_S = 1.037  # a camera's second begins at any moment of the controller's
REST_S = 12.0  # longer than hold_s, min_green_s and the unbelieving first seconds of a detector


@contextlib.contextmanager
def stress() -> Iterator[None]:
    """Two workers a kind, as busy as they can be."""
    words = ["stress-ng", "--quiet", "--cpu", "2", "--io", "1", "--vm", "1", "--vm-bytes", "64M", "--timeout", "300"]
    with subprocess.Popen(words) as process:
        try:
            yield
        finally:
            process.terminate()


class Cameras:
    """Of all approaches: somebody waits on one of two movements."""

    def __init__(self, bus: Bus) -> None:
        self._bus = bus
        self._busy = 0
        self._arrivals = [0] * APPROACHES
        self.counted_s: list[float] = []
        self.news_s: list[float] = []

    def count(self, *, news: bool) -> None:
        """Sends every approach's counts; `news`: they now wait on the other movement."""
        if news:
            self._busy = 1 - self._busy
            self._arrivals[BUSY[self._busy]] = (self._arrivals[BUSY[self._busy]] + 1) % 64
        for approach in range(APPROACHES):
            self._bus.tell(COUNTS + approach, self._payload(approach))
        self.counted_s.append(time.monotonic())
        if news:
            self.news_s.append(self.counted_s[-1])

    def _payload(self, approach: int) -> int:
        """After four bits of counter: reason, three presences of 9 bits, three arrivals of 6, three times valid."""
        waiting_veh = WAITING_VEH if approach == BUSY[self._busy] else 0
        return waiting_veh << 4 + 9 | self._arrivals[approach] << 4 + 27 + 6 | 0b111 << 4 + 27 + 18


def settle(bus: Bus, cameras: Cameras) -> None:
    """Counts until the controller believes them."""
    for _ in range(SETTLE_MAX_S):
        cameras.count(news=False)
        if "automatic" in [frame.mode for frame in bus.hear(1.0) if frame.id == STATUS]:
            return
    raise AssertionError(f"not in automatic operation within {SETTLE_MAX_S} s of counts")


def measure(bus: Bus, cameras: Cameras) -> dict[str, object]:
    """Some minutes of counts, and everything that the controller sends meanwhile."""
    cameras.counted_s, cameras.news_s = [], []
    end = time.monotonic() + SECONDS
    frames: list[Heard] = []
    rested_s = due_s = time.monotonic()
    shown: list[int] = []
    while (now := time.monotonic()) < end:
        if now >= due_s:
            news = now - rested_s > REST_S
            cameras.count(news=news)
            rested_s, due_s = now if news else rested_s, due_s + PERIOD_S
        for frame in bus.hear(0.02):
            frames.append(frame)
            if frame.id == LAMP_COMMAND and frame.aspects != shown:
                shown, rested_s = frame.aspects, frame.at_s
    return figures(frames, cameras)


def figures(frames: list[Heard], cameras: Cameras) -> dict[str, object]:
    """Of one load."""
    lamps = [(frame.at_s, frame.aspects) for frame in frames if frame.id == LAMP_COMMAND]
    decisions_s = [frame.at_s - FORECAST_AFTER_S for frame in frames if frame.id == FORECAST]
    gaps = gaps_ms(at_s for at_s, _ in lamps)
    return {
        "modes": sorted({frame.mode for frame in frames if frame.id == STATUS}),
        "lamp_gap_ms": quantiles(gaps),
        "missed": sum(gap > 150 for gap in gaps),
        "count_age_ms": quantiles(ages_ms(cameras.counted_s, decisions_s)),
        "lamp_age_ms": quantiles(ages_ms(cameras.news_s, changes_s(lamps))),
    }


def main() -> None:
    """Both."""
    with interface("meas0") as name, lamp_node(name), controller(name) as program:
        bus, cameras = Bus(name, LAMP_COMMAND, FORECAST, STATUS), Cameras(Bus(name, 0x7FF))
        bus.mode("fixed_time")
        settle(bus, cameras)
        print(json.dumps({"load": "none", **measure(bus, cameras)}), flush=True)
        with stress():
            print(json.dumps({"load": "stress-ng", **measure(bus, cameras)}), flush=True)
        print(json.dumps({"said": program.text().splitlines()[-3:]}))


if __name__ == "__main__":
    main()
