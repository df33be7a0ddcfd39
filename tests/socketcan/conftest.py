# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""A test in which the machine stood still is tried again.

A lamp node that hears nothing for 300 ms flashes, and the controller with it: that is what they are for. In a virtual
machine whose host is busy nothing runs for so long now and then, whatever its priority, and then a test has seen the
right answer to the wrong question. A watcher of the programs' own priority notes when it was not woken in time. Only a
test that failed and during which that happened is tried again, and it is said.
"""

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from _pytest.runner import runtestprotocol
from bus import OUT

TRIES = 4
STILL_S = 0.15
STILL_LOG = OUT / "still.txt"
SLICE, SLICE_MS = Path("/proc/sys/kernel/sched_rr_timeslice_ms"), 10

WATCHER = f"""
import time
last = time.monotonic()
with open({str(STILL_LOG)!r}, "w", buffering=1) as log:
    while True:
        time.sleep(0.02)
        now = time.monotonic()
        if now - last > {STILL_S}:
            log.write(f"{{now:.3f}} {{now - last:.3f}}\\n")
        last = now
"""


@pytest.fixture(scope="session", autouse=True)
def watcher() -> Iterator[None]:
    """Runs beside everything."""
    OUT.mkdir(parents=True, exist_ok=True)
    urgent: list[str] = []
    if os.geteuid() == 0:
        SLICE.write_text(f"{SLICE_MS}\n", encoding="ascii")
        urgent = ["chrt", "--rr", "50"]
    with subprocess.Popen([*urgent, sys.executable, "-c", WATCHER]) as process:
        yield
        process.kill()


def longest_still_s(since_s: float, log: Path = STILL_LOG) -> float:
    """The longest time since then in which nothing ran."""
    if not log.exists():
        return 0.0
    gaps = [line.split() for line in log.read_text(encoding="utf-8").splitlines()]
    return max((float(gap) for at, gap in gaps if float(at) >= since_s), default=0.0)


def pytest_runtest_protocol(item: pytest.Item, nextitem: pytest.Item | None) -> bool:
    """Runs a test, and again if it failed while the machine stood still."""
    item.ihook.pytest_runtest_logstart(nodeid=item.nodeid, location=item.location)
    for attempt in range(1, TRIES + 1):
        began_s = time.monotonic()
        reports = runtestprotocol(item, nextitem=nextitem, log=False)
        still_s = longest_still_s(began_s)
        if attempt == TRIES or still_s == 0.0 or not any(report.failed for report in reports):
            break
        reporter = item.config.pluginmanager.get_plugin("terminalreporter")
        assert reporter is not None
        reporter.write_line(f"{item.name}: the machine stood still for {still_s:.2f} s, tried again")
        item._initrequest()  # type: ignore[attr-defined]
    for report in reports:
        item.ihook.pytest_runtest_logreport(report=report)
    item.ihook.pytest_runtest_logfinish(nodeid=item.nodeid, location=item.location)
    return True
