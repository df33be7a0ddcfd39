# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Controller, lamp node and simulator on real sockets, and what goes wrong on a bus. tests/socketcan/run starts it.

Without cameras a controller runs its fixed times: enough for lamps. A second is one of the virtual machine's.
"""

import contextlib
import http.client
import itertools
import json
import os
import re
import signal
import statistics
import struct
import subprocess
import time
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from bus import (
    CONFIRM,
    LOCKSTEP_SITES,
    OUT,
    PREPARE,
    PROGRAMS,
    ROOT,
    SITE,
    Bus,
    Program,
    controller,
    interface,
    ip,
    lamp_node,
    refused,
    wait_for_listener,
)
from bus_frames import COMMAND, LAMP_COMMAND, LAMP_FEEDBACK, MODES, NEIGHBOUR_OUTFLOW, STATUS, sealed

STEADY = "fixed_time"
BUS_OFF, RESTARTED, CONTROLLER = 0x40, 0x100, 0x04
ERROR_FLAG = 0x20000000
FLOOD_PER_S = 4000  # about what 500 kbit/s carries
COLOURED = {2, 3, 4}  # red-amber, green, amber


def host_sim(*words: str, seconds: float = 200.0) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [str(PROGRAMS / "host_sim"), *words], capture_output=True, text=True, check=False, timeout=seconds, cwd=ROOT
    )


@dataclass
class Junction:
    """A bus with a controller and a lamp node on it."""

    name: str
    bus: Bus
    node: Program
    program: Program


class Junctions:
    """All that are needed, started together: a start-up takes seconds."""

    def __init__(self, stack: contextlib.ExitStack, *names: str) -> None:
        self._made = {name: self._make(stack, name) for name in names}

    @staticmethod
    def _make(stack: contextlib.ExitStack, name: str) -> Junction:
        stack.enter_context(interface(name))
        node, program = (stack.enter_context(start(name)) for start in (lamp_node, controller))
        return Junction(name, Bus(name), node, program)

    def steady(self, name: str) -> Junction:
        """The junction in its steady mode."""
        junction = self._made[name]
        junction.bus.clear()
        junction.bus.mode(STEADY)
        return junction


@pytest.fixture(scope="session")
def junctions() -> Iterator[Junctions]:
    """A bus for each test that wants one for itself."""
    with contextlib.ExitStack() as stack:
        yield Junctions(stack, "die0", "two0", "down0", "plug0", "err0")


@pytest.fixture(scope="session", autouse=True)
def street() -> Iterator[subprocess.Popen[str]]:
    """host_sim in real time, beside everything else: it takes most of a minute."""
    with interface("real0") as name, lamp_node(name), controller(name):
        time.sleep(1.0)
        words = ["run", "--site", SITE, "--link", f"can:{name}", "--clock", "real", "--seconds", "60"]
        with subprocess.Popen(
            [str(PROGRAMS / "host_sim"), *words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd=ROOT
        ) as simulator:
            yield simulator
            simulator.kill()


@dataclass
class Replacement:
    """A junction to which other weights are sent: a trial takes five minutes, beside everything else."""

    bus: Bus
    program: Program
    sender: Program
    store: Path
    weights_id: int


def other_weights(folder: Path) -> tuple[Path, int]:
    """Good weights that are not the shipped ones, and the id that a controller gives them."""
    image = bytearray(Path(os.environ["ELMOPP_WEIGHTS"]).read_bytes())
    struct.pack_into("<f", image, len(image) - 4, struct.unpack_from("<f", image, len(image) - 4)[0] / 2 + 0.125)
    struct.pack_into("<I", image, 12, zlib.crc32(image[16:]))
    file = folder / "other.bin"
    file.write_bytes(image)
    return file, ~zlib.crc32(image[16:]) & 0xFFF


@pytest.fixture(scope="session", autouse=True)
def replacement(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Replacement]:
    """Somebody sends weights and waits until they are kept."""
    folder = tmp_path_factory.mktemp("replacement")
    file, weights_id = other_weights(folder)
    store = folder / "store"
    store.mkdir()
    with interface("keep0") as name, lamp_node(name), controller(name, "--store", str(store)) as program:
        bus = Bus(name, STATUS)
        with Program("elmopp-send", "--can", name, "--weights", str(file), "--until-kept") as sender:
            yield Replacement(bus, program, sender, store, weights_id)


# --- in lockstep ---


@pytest.mark.parametrize("site", LOCKSTEP_SITES, ids=lambda site: Path(site).stem)
def test_the_log_over_the_bus_is_the_log_in_process_byte_for_byte(site: str) -> None:
    run = ["run", "--site", site, "--seconds", "60", "--vehicles", "500"]
    inproc, wire = OUT / "inproc.jsonl", OUT / "wire.jsonl"
    done = host_sim(*run, "--link", "inproc", "--log", str(inproc), "--summary", str(OUT / "inproc.json"))
    assert done.returncode == 0, done.stderr
    with interface("lock0") as name, controller(name, "--clock", "bus", site=site):
        wait_for_listener(name)
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
    assert (
        done.stderr.count("\n") == 1
        and "no answer within 5 s; right would be a running elmopp-controller" in done.stderr
    )


# --- bad requests ---


@pytest.mark.parametrize("program", ["elmopp-controller", "elmopp-lamp-node"])
def test_what_is_no_can_interface_is_refused_in_one_line(program: str) -> None:
    assert "there is no such interface" in refused(program, "--can", "vcan77", "--site", SITE)
    assert '"lo" is no CAN interface' in refused(program, "--can", "lo", "--site", SITE)


# --- a junction on a bus ---


def test_controller_and_node_start_run_and_stop_at_red() -> None:
    with interface("go0") as name:
        bus = Bus(name)
        with lamp_node(name) as node, controller(name) as program:
            bus.mode(STEADY)
            bus.until(LAMP_COMMAND, lambda frame: 3 in frame.aspects, 20.0, "a green")
            words = [str(PROGRAMS / "elmopp-monitor-tool"), "--can", name, "--site", SITE, "--once"]
            seen = subprocess.run(words, capture_output=True, text=True, check=True, timeout=30, cwd=ROOT).stdout
            assert "four_way on go0\ncontroller  fixed time" in seen
            assert "GREEN" in seen and "camera silent" in seen and "node silent" not in seen
            before_s = (node.cpu_s(), program.cpu_s())
            for _ in bus.hear(5.0):
                pass
            # An emulated processor takes its time; whoever does not wait takes all of it.
            assert node.cpu_s() - before_s[0] < 1.5
            assert program.cpu_s() - before_s[1] < 1.5
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
            # 300 ms of silence after the last command, 20 ms of its clock, 100 ms to the next feedback, an emulator.
            assert flashing.at_s - killed_s < 0.7
            # A new one starts from the beginning, and the node comes back.
            with controller(name):
                bus.until(STATUS, lambda frame: frame.mode == "starting", 10.0, "a new start")
                bus.mode(STEADY)


def test_a_lamp_node_that_dies_is_a_fault_that_only_a_person_at_the_cabinet_clears(
    junctions: Junctions,
) -> None:
    junction = junctions.steady("die0")
    bus, program = junction.bus, junction.program
    junction.node.process.kill()
    bus.clear()
    assert bus.mode("fail_safe", 3.0).fault == "feedback_lost"
    with lamp_node(junction.name):
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


def test_two_controllers_on_one_bus_both_flash(junctions: Junctions) -> None:
    junction = junctions.steady("two0")
    with controller(junction.name) as second:
        junction.program.says("fault second controller", 5.0)
        second.says("fault second controller", 5.0)


BROKEN = {
    "brk0": ("lose:2@25000", "none"),
    "brk1": ("late:40@25000", "none"),
    "brk2": ("lose:20@25000", "feedback_lost"),
    "brk3": ("stuck:0:green@25000", "feedback_differs"),
}


def test_a_broken_node_is_found_and_a_small_hitch_is_none() -> None:
    with contextlib.ExitStack() as stack:
        buses = {}
        for name, (broken, _) in BROKEN.items():
            stack.enter_context(interface(name))
            buses[name] = Bus(name, STATUS)
            stack.enter_context(lamp_node(name, "--break", broken))
            stack.enter_context(controller(name))
        began_s = time.monotonic()
        for bus in buses.values():
            bus.mode(STEADY)
        time.sleep(max(1.0, began_s + 26.0 - time.monotonic()))
        for name, (broken, fault) in BROKEN.items():
            last = list(buses[name].hear(2.5))[-1]
            assert (broken, last.fault) == (broken, fault)
            assert last.mode == (STEADY if fault == "none" else "fail_safe")


def test_an_interface_that_goes_down_and_comes_back_is_survived(junctions: Junctions) -> None:
    junction = junctions.steady("down0")
    ip("set", junction.name, "down")
    junction.program.says("fault feedback lost", 5.0)
    junction.program.says("unsent frames", 5.0)
    ip("set", junction.name, "up")
    assert Bus(junction.name).mode("fail_safe", 5.0).fault == "feedback_lost"
    assert junction.program.process.poll() is None


def test_an_adapter_that_is_unplugged_and_plugged_in_again_is_found(junctions: Junctions) -> None:
    junction = junctions.steady("plug0")
    ip("del", junction.name)
    junction.program.says("fault feedback lost", 5.0)
    junction.node.says("by itself", 5.0)
    ip("add", junction.name, "type", "vcan")
    ip("set", junction.name, "up")
    fresh = Bus(junction.name)
    assert fresh.mode("fail_safe", 10.0).fault == "feedback_lost"
    fresh.until(LAMP_FEEDBACK, bool, 10.0, "feedback again")
    junction.program.says("opened again 1", 5.0)


def test_error_frames_are_understood_and_change_no_lamp(junctions: Junctions) -> None:
    junction = junctions.steady("err0")
    bus, program = junction.bus, junction.program
    bus.clear()
    bus.send(ERROR_FLAG | BUS_OFF, bytes(8))
    program.says("bus-off 1", 5.0)
    bus.send(ERROR_FLAG | RESTARTED, bytes(8))
    bus.send(ERROR_FLAG | CONTROLLER, bytes([0, 0x10, 0, 0, 0, 0, 0, 0]))
    program.says("restarted 1", 5.0)
    program.says("error-passive 1", 5.0)
    for frame in bus.hear(1.0):
        assert frame.id != STATUS or frame.mode == STEADY


def test_every_neighbour_is_heard(junctions: Junctions) -> None:
    """The kernel's filter lets its frames through: spoilt ones are counted."""
    bus = junctions.steady("err0").bus
    before = bus.until(STATUS, bool, 3.0, "a status").refused
    for approach in range(4):
        bus.send(NEIGHBOUR_OUTFLOW + approach, sealed(NEIGHBOUR_OUTFLOW + approach, 3)[:7] + b"\x55")
    bus.until(STATUS, lambda frame: frame.refused == (before + 4) % 256, 3.0, "four refused frames")


def sent_frames(name: str) -> int:
    return int(Path(f"/sys/class/net/{name}/statistics/tx_packets").read_text())


@contextlib.contextmanager
def flood(name: str) -> Iterator[None]:
    """More than 500 kbit/s carries, of a Command that the controller listens to and refuses: its checksum is wrong."""
    rubbish = (sealed(COMMAND, 3)[:7] + b"\x55").hex()
    words = ["cangen", name, "-g", "1", "-I", f"{COMMAND:03X}", "-L", "8", "-D", rubbish]
    generators = [subprocess.Popen(words) for _ in range(6)]
    begun_s, begun = time.monotonic(), sent_frames(name)
    try:
        yield
    finally:
        per_s = (sent_frames(name) - begun) / (time.monotonic() - begun_s)
        for generator in generators:
            generator.kill()
            generator.wait()
        (OUT / "flood.txt").write_text(f"{per_s:.0f} frames/s\n")
    assert per_s > FLOOD_PER_S


def test_a_flooded_bus_does_not_keep_the_lamps_waiting() -> None:
    with interface("flood0") as name:
        bus = Bus(name, LAMP_COMMAND, STATUS)
        with lamp_node(name), controller(name):
            bus.mode(STEADY)
            with flood(name):
                times = [frame.at_s for frame in bus.hear(8.0) if frame.id == LAMP_COMMAND]
            gaps_ms = [1000 * (b - a) for a, b in itertools.pairwise(times)]
            (OUT / "flood_gaps.txt").write_text("\n".join(f"{gap:.1f}" for gap in gaps_ms) + "\n")
            assert len(times) >= 75, len(times)
            assert max(gaps_ms) < 150.0
            assert 95.0 < statistics.median(gaps_ms) < 105.0
            status = bus.until(STATUS, bool, 3.0, "a status")
            assert (status.mode, status.fault) == (STEADY, "none")


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


# --- everybody by his own clock ---


def events(port: int) -> Iterator[tuple[str, dict[str, Any]]]:
    """What the live page is told."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
    connection.request("GET", "/events")
    answer, kind = connection.getresponse(), ""
    while line := answer.readline().decode():
        if line.startswith("event: "):
            kind = line[7:-1]
        elif line.startswith("data: "):
            yield kind, json.loads(line[6:])


def test_the_live_page_of_a_bus_shows_it_and_never_says_a_word() -> None:
    ip("set", "lo", "up")
    with interface("view0") as name, Program("elmopp-view", "--can", name, "--site", SITE, "--port", "0") as view:
        view.says("ctrl-C ends it")
        port = int(re.findall(r":(\d+)/", view.text())[0])
        told, lonely = events(port), Bus(name)
        assert next(told) == ("run", {"site": "four_way", "can": name})
        assert "mode" not in next(told)[1]
        assert list(lonely.hear(2.5)) == []
        assert Path(f"/sys/class/net/{name}/statistics/tx_packets").read_text() == "0\n"
        with lamp_node(name), controller(name):
            bus = Bus(name, LAMP_COMMAND)
            line = next(line for _, line in told if line.get("mode") == MODES.index(STEADY))
            bus.clear()
            line = [next(told)[1] for _ in range(3)][-1]
            shown = {"".join(map(str, frame.aspects)) for frame in bus.hear(0.5)}
            commands = {"".join(map(str, frame.aspects)) for frame in lonely.hear(0.1) if frame.id == LAMP_COMMAND}
            assert line["aspects"] in shown | commands
            assert line["uncounted"] == list(range(12))  # there is no camera
        lonely.clear()
        assert list(lonely.hear(2.5)) == []
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
        connection.request("POST", "/control", "{}", {"Content-Type": "application/json"})
        assert connection.getresponse().status == 405
        view.ask(signal.SIGTERM)
        assert view.ends() == 0


def test_a_simulated_street_in_real_time_has_figures_of_its_own(street: subprocess.Popen[str]) -> None:
    said, _ = street.communicate(timeout=120)
    assert street.returncode == 0, said
    (OUT / "street.txt").write_text(said)
    assert '"seconds": 60' in said


# --- other weights, another site ---


def send(name: str, *words: str) -> subprocess.CompletedProcess[str]:
    """elmopp-send, to its end."""
    command = [str(PROGRAMS / "elmopp-send"), "--can", name, *words]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=60, cwd=ROOT)


@pytest.mark.night
def test_weights_that_were_sent_are_kept_and_a_site_is_not_taken_from_the_bus_alone(replacement: Replacement) -> None:
    assert replacement.sender.ends(seconds=400.0) == 0, replacement.sender.text()
    assert "weights: on trial, " in replacement.sender.text()
    assert "weights: kept: it outlives a reset" in replacement.sender.text()
    replacement.bus.clear()
    status = replacement.bus.mode(STEADY)
    assert (status.weights_id, status.fault) == (replacement.weights_id, "none")
    assert len(list(replacement.store.glob("weights.*"))) == 1
    refusal = send("keep0", "--site", SITE)
    assert refusal.returncode == 1
    assert "site: refused, a site is taken only while the local key is held" in refusal.stderr
    replacement.program.stop()
    with controller("keep0", "--store", str(replacement.store)) as again:
        again.says("the weights are those that were kept")
        assert replacement.bus.mode("starting").weights_id == replacement.weights_id
    assert "no controller answers" in send("keep0", "--site", SITE).stderr
