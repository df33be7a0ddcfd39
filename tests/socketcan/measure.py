# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Figures of a controller on virtual CAN: gaps between its LampCommands, and how old counts are when they act.

tests/socketcan/run PROGRAMS OUT --measure runs it. One line of JSON each, idle and under stress-ng. In an emulator no
figure says anything about hardware.
"""

import contextlib
import itertools
import json
import statistics
import subprocess
import time
from collections.abc import Iterator

from bus import COUNTS, LAMP_COMMAND, STATUS, Bus, controller, interface, lamp_node

FORECAST = 0x190
SECONDS = 60.0


@contextlib.contextmanager
def stress() -> Iterator[None]:
    """Two workers a kind, as busy as they can be."""
    words = ["stress-ng", "--quiet", "--cpu", "2", "--io", "1", "--vm", "1", "--vm-bytes", "64M", "--timeout", "300"]
    with subprocess.Popen(words) as process:
        try:
            yield
        finally:
            process.terminate()


def quantiles(values: list[float]) -> dict[str, float]:
    """Smallest, median, 99 %, largest."""
    ordered = sorted(values)
    return {
        "n": len(ordered),
        "min": round(ordered[0], 1),
        "p50": round(statistics.median(ordered), 1),
        "p99": round(ordered[int(0.99 * (len(ordered) - 1))], 1),
        "max": round(ordered[-1], 1),
    }


def measure(bus: Bus, camera: Bus) -> dict[str, object]:
    """One minute: a camera frame a second at changing moments, and everything that the controller sends."""
    end = time.monotonic() + SECONDS
    lamps: list[float] = []
    ages: list[float] = []
    counted_s = None
    due_s = time.monotonic()
    while time.monotonic() < end:
        if time.monotonic() >= due_s:
            camera.tell(COUNTS, 0)
            counted_s, due_s = time.monotonic(), due_s + 1.037
        for frame in bus.hear(0.02):
            if frame.id == LAMP_COMMAND:
                lamps.append(frame.at_s)
            if frame.id == FORECAST and counted_s is not None:
                ages.append(1000 * (frame.at_s - counted_s))
                counted_s = None
    gaps = [1000 * (b - a) for a, b in itertools.pairwise(lamps)]
    return {"lamp_gap_ms": quantiles(gaps), "missed": sum(gap > 150 for gap in gaps), "count_age_ms": quantiles(ages)}


def main() -> None:
    """Both."""
    with interface("meas0") as name, lamp_node(name), controller(name) as program:
        bus, camera = Bus(name, LAMP_COMMAND, FORECAST, STATUS), Bus(name, 0x7FF)
        bus.mode("fixed_time")
        print(json.dumps({"load": "none", **measure(bus, camera)}), flush=True)
        with stress():
            print(json.dumps({"load": "stress-ng", **measure(bus, camera)}), flush=True)
        print(json.dumps({"said": program.text().splitlines()[-3:]}))


if __name__ == "__main__":
    main()
