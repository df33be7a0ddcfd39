# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Controller, lamp node and simulator on real sockets, and what goes wrong on a bus. tests/socketcan/run starts it.

Without cameras a controller runs its fixed times: enough for lamps. Times are generous: an emulator runs this.
"""

import os
import signal
import statistics
import subprocess
import threading
import time

import pytest
from bus import (
    COMMAND,
    CONFIRM,
    LAMP_COMMAND,
    LAMP_FEEDBACK,
    OUT,
    PREPARE,
    PROGRAMS,
    ROOT,
    SITE,
    STATUS,
    Bus,
    Program,
    controller,
    interface,
    ip,
    lamp_node,
    refused,
    sealed,
)

STEADY = "fixed_time"
BUS_OFF, RESTARTED, CONTROLLER = 0x40, 0x100, 0x04
ERROR_FLAG = 0x20000000
COLOURED = {2, 3, 4}  # red-amber, green, amber


def host_sim(*words: str, seconds: float = 200.0) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [str(PROGRAMS / "host_sim"), *words], capture_output=True, text=True, check=False, timeout=seconds, cwd=ROOT
    )


# --- in lockstep ---


def test_the_log_over_the_bus_is_the_log_in_process_byte_for_byte() -> None:
    run = ["run", "--site", SITE, "--seconds", "60", "--vehicles", "500"]
    inproc, wire = OUT / "inproc.jsonl", OUT / "wire.jsonl"
    done = host_sim(*run, "--link", "inproc", "--log", str(inproc), "--summary", str(OUT / "inproc.json"))
    assert done.returncode == 0, done.stderr
    with interface("lock0") as name, controller(name, "--clock", "bus"):
        time.sleep(1.0)
        done = host_sim(*run, "--link", f"can:{name}", "--log", str(wire), "--summary", str(OUT / "wire.json"))
        assert done.returncode == 0, done.stderr
    assert len(inproc.read_text().splitlines()) == 60
    assert '"forecast":[0,' not in inproc.read_text().splitlines()[-1]
    assert wire.read_bytes() == inproc.read_bytes()
    assert (OUT / "wire.json").read_bytes() == (OUT / "inproc.json").read_bytes()


def test_a_simulator_without_a_controller_says_so() -> None:
    with interface("lock1") as name:
        done = host_sim("run", "--site", SITE, "--link", f"can:{name}")
    assert done.returncode == 1
    assert done.stderr.count("\n") == 1 and "no answer within 5 s; right would be a running elmopp-controller" in done.stderr


# --- bad requests ---


def test_requests_that_cannot_be_run_are_one_line() -> None:
    with interface("bad0") as name:
        for program in ("elmopp-controller", "elmopp-lamp-node"):
            assert "there is no such interface" in refused(program, "--can", "vcan77", "--site", SITE)
            assert '"lo" is no CAN interface' in refused(program, "--can", "lo", "--site", SITE)
            assert "simulation_only" in refused(program, "--can", name, "--site", "sites/paper.toml")
            assert "cannot be read" in refused(program, "--can", name, "--site", "none.bin")
        assert "right would be real or bus" in refused(
            "elmopp-controller", "--can", name, "--site", SITE, "--clock", "wall"
        )
        assert "--node 5" in refused("elmopp-lamp-node", "--can", name, "--site", SITE, "--node", "5")
        for text in ("stuck:N1:green", "stuck:X:green@5", "lose:0@5", "late:x@5", "melt@5", "stuck:0:blue@5", ""):
            assert "right would be" in refused("elmopp-lamp-node", "--can", name, "--site", SITE, "--break", text)


# --- a junction on a bus ---


def test_controller_and_node_start_run_and_stop_at_red() -> None:
    with interface("go0") as name:
        bus = Bus(name)
        with lamp_node(name) as node, controller(name) as program:
            bus.mode(STEADY)
            bus.until(LAMP_COMMAND, lambda frame: 3 in frame.aspects, 20.0, "a green")
            program.ask(signal.SIGTERM)
            assert program.ends() == 0
            last = [frame for frame in bus.hear(0.2) if frame.id == LAMP_COMMAND][-1]
            assert not COLOURED & set(last.aspects)
            assert program.text().splitlines()[-1].endswith("stopped; 0 lamp ticks were missed")
            node.says("by itself", 5.0)


def test_a_controller_that_is_killed_leaves_flashing_within_its_time() -> None:
    with interface("kill0") as name:
        bus = Bus(name)
        with lamp_node(name), controller(name) as program:
            bus.mode(STEADY)
            program.process.kill()
            killed_s = time.monotonic()
            flashing = bus.until(
                LAMP_FEEDBACK, lambda frame: frame.data[0] >> 5 & 1 == 1, 3.0, "the node's own fail-safe"
            )
            # 300 ms of silence after the last command, 20 ms of its clock, 100 ms to the next feedback, and an emulator.
            assert flashing.at_s - killed_s < 0.7
            # A new one starts from the beginning, and the node comes back.
            with controller(name):
                bus.until(STATUS, lambda frame: frame.mode == "starting", 10.0, "a new start")
                bus.mode(STEADY)


def test_a_lamp_node_that_dies_is_a_fault_that_only_a_person_at_the_cabinet_clears() -> None:
    with interface("die0") as name:
        bus = Bus(name)
        with controller(name) as program:
            with lamp_node(name):
                bus.mode(STEADY)
            fault = bus.mode("fail_safe", 3.0)
            assert fault.fault == "feedback_lost"
            with lamp_node(name):
                bus.command(PREPARE, 12)
                bus.command(CONFIRM, 12)
                refusals = bus.until(STATUS, lambda frame: frame.data[6] >= 2, 3.0, "two refused commands")
                assert refusals.mode == "fail_safe"
                program.ask(signal.SIGUSR1)
                program.says("the local reset is held")
                bus.command(PREPARE, 12)
                bus.command(CONFIRM, 12)
                bus.mode("starting", 3.0)
                program.ask(signal.SIGUSR2)
                bus.mode(STEADY)


def test_two_controllers_on_one_bus_both_flash() -> None:
    with interface("two0") as name:
        bus = Bus(name)
        with lamp_node(name), controller(name) as first:
            bus.mode(STEADY)
            with controller(name) as second:
                first.says("fault second controller", 5.0)
                second.says("fault second controller", 5.0)


@pytest.mark.parametrize(
    ("broken", "fault"),
    [
        ("lose:2@6000", "none"),
        ("late:40@6000", "none"),
        ("lose:20@6000", "feedback_lost"),
        ("stuck:0:green@6000", "feedback_differs"),
    ],
)
def test_a_broken_node_is_found_and_a_small_hitch_is_none(broken: str, fault: str) -> None:
    with interface("brk0") as name:
        bus = Bus(name)
        with lamp_node(name, "--break", broken) as node, controller(name) as program:
            bus.mode(STEADY, 40.0)
            if fault == "none":
                for frame in bus.hear(4.0):
                    assert frame.id != STATUS or frame.fault == "none"
            else:
                assert bus.mode("fail_safe", 20.0).fault == fault
            assert node.process.poll() is None and program.process.poll() is None


def test_an_interface_that_goes_down_and_comes_back_is_survived() -> None:
    with interface("down0") as name:
        bus = Bus(name)
        with lamp_node(name), controller(name) as program:
            bus.mode(STEADY)
            ip("set", name, "down")
            program.says("fault feedback lost", 5.0)
            program.says("unsent frames", 5.0)
            ip("set", name, "up")
            fresh = Bus(name)
            assert fresh.mode("fail_safe", 5.0).fault == "feedback_lost"
            assert program.process.poll() is None


def test_an_adapter_that_is_unplugged_and_plugged_in_again_is_found() -> None:
    with interface("plug0") as name:
        bus = Bus(name)
        with lamp_node(name) as node, controller(name) as program:
            bus.mode(STEADY)
            ip("del", name)
            program.says("fault feedback lost", 5.0)
            node.says("by itself", 5.0)
            ip("add", name, "type", "vcan")
            ip("set", name, "up")
            fresh = Bus(name)
            assert fresh.mode("fail_safe", 10.0).fault == "feedback_lost"
            fresh.until(LAMP_FEEDBACK, lambda frame: True, 10.0, "feedback again")
            program.says("opened again 1", 5.0)


def test_error_frames_are_understood_and_change_no_lamp() -> None:
    with interface("err0") as name:
        bus = Bus(name)
        with lamp_node(name), controller(name) as program:
            bus.mode(STEADY)
            bus.send(ERROR_FLAG | BUS_OFF, bytes(8))
            program.says("bus-off 1", 5.0)
            bus.send(ERROR_FLAG | RESTARTED, bytes(8))
            bus.send(ERROR_FLAG | CONTROLLER, bytes([0, 0x10, 0, 0, 0, 0, 0, 0]))
            program.says("restarted 1", 5.0)
            program.says("error-passive 1", 5.0)
            for frame in bus.hear(1.0):
                assert frame.id != STATUS or frame.mode == STEADY


def flood(name: str, frame_id: int, per_s: int, stop: threading.Event) -> None:
    """Rubbish at a rate."""
    bus = Bus(name)
    rubbish = sealed(frame_id, 3)[:7] + b"\x55"
    begun_s, sent = time.monotonic(), 0
    while not stop.is_set():
        while sent < (time.monotonic() - begun_s) * per_s:
            bus.send(frame_id, rubbish)
            sent += 1
        bus.clear()
        time.sleep(0.002)
    (OUT / "flood.txt").write_text(f"{sent / (time.monotonic() - begun_s):.0f} frames/s\n")


def test_a_flooded_bus_does_not_keep_the_lamps_waiting() -> None:
    """About what 500 kbit/s carries, of a frame that the controller listens to and refuses."""
    with interface("flood0") as name:
        bus = Bus(name)
        with lamp_node(name), controller(name):
            bus.mode(STEADY)
            stop = threading.Event()
            flooder = threading.Thread(target=flood, args=(name, COMMAND, 4000, stop))
            flooder.start()
            try:
                times = [frame.at_s for frame in bus.hear(8.0) if frame.id == LAMP_COMMAND]
            finally:
                stop.set()
                flooder.join()
            gaps_ms = [1000 * (b - a) for a, b in zip(times, times[1:], strict=False)]
            (OUT / "flood_gaps.txt").write_text("\n".join(f"{gap:.1f}" for gap in gaps_ms) + "\n")
            assert len(times) >= 75, len(times)
            assert 95.0 < statistics.median(gaps_ms) < 105.0
            status = bus.until(STATUS, lambda frame: True, 3.0, "a status")
            assert (status.mode, status.fault) == (STEADY, "none")


# --- everybody by his own clock ---


def test_a_simulated_street_in_real_time_has_figures_of_its_own() -> None:
    with interface("real0") as name, lamp_node(name), controller(name) as program:
        time.sleep(1.0)
        done = host_sim(
            "run", "--site", SITE, "--link", f"can:{name}", "--clock", "real", "--seconds", "15", "--vehicles", "500"
        )
        assert done.returncode == 0, done.stderr
        assert '"seconds": 15' in done.stdout
        program.says("mode automatic")


# --- the real driver ---


def test_two_emulated_controllers_carry_a_junction() -> None:
    assert os.environ["ELMOPP_CAN_CONTROLLERS"] == "2"
    bus = Bus("can0")
    with lamp_node("can1"), controller("can0") as program:
        bus.mode(STEADY)
        assert "does not come back" not in program.text()


def test_another_bit_rate_is_refused() -> None:
    ip("set", "can1", "down")
    ip("set", "can1", "type", "can", "bitrate", "250000", "restart-ms", "0")
    assert "can1: runs at 250000 bit/s; right would be 500000" in refused(
        "elmopp-lamp-node", "--can", "can1", "--site", SITE
    )
    ip("set", "can1", "type", "can", "bitrate", "500000", "restart-ms", "0")
    with Program("elmopp-lamp-node", "--can", "can1", "--site", SITE) as node:
        node.says("can1 is down; nothing is heard before somebody brings it up", 10.0)
    ip("set", "can1", "up")
    with Program("elmopp-lamp-node", "--can", "can1", "--site", SITE) as node:
        node.says("can1 does not come back from bus-off by itself", 10.0)
