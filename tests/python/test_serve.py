# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""host_sim serve without a browser: what it streams, what it can be told, whom it answers, and how it ends."""

from __future__ import annotations

import contextlib
import http.client
import json
import os
import re
import signal
import socket
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]
HOST_SIM = os.environ.get("ELMOPP_HOST_SIM", str(ROOT / "build" / "host" / "bin" / "host_sim"))
ONE_WAY = str(ROOT / "sites" / "one_way.toml")
START_S = 60.0  # under sanitizers
ONLOOKERS_MAX = 16


class Served:
    """host_sim serve, while it runs."""

    def __init__(self, *options: str) -> None:
        command = [HOST_SIM, "serve", *([] if "--port" in options else ["--port", "0"]), *options]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=ROOT)
        assert self.process.stdout is not None
        line = self.process.stdout.readline()
        found = re.fullmatch(r"host_sim: http://127\.0\.0\.1:(\d+)/ shows \w+; ctrl-C ends it\n", line)
        assert found, line + (self.process.communicate()[1] if not line else "")
        self.port = int(found[1])

    def ask(
        self, method: str, path: str, body: str | bytes | None = None, **headers: str
    ) -> tuple[int, str, dict[str, str]]:
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=30)
        connection.request(method, path, body, {name.replace("_", "-"): value for name, value in headers.items()})
        answer = connection.getresponse()
        text = answer.read().decode()
        connection.close()
        return answer.status, text, dict(answer.getheaders())

    def wish(self, body: object, **headers: str) -> tuple[int, str]:
        text = body if isinstance(body, str) else json.dumps(body)
        return self.ask(
            "POST",
            "/control",
            text.encode("utf-8", "surrogateescape"),
            **{"Content_Type": "application/json", **headers},
        )[:2]

    def stop(self, how: signal.Signals = signal.SIGINT) -> tuple[int, str]:
        self.process.send_signal(how)
        _, said = self.process.communicate(timeout=30)
        return self.process.returncode, said


class Onlooker:
    """Reads the stream."""

    def __init__(self, served: Served) -> None:
        self.connection = http.client.HTTPConnection("127.0.0.1", served.port, timeout=30)
        self.connection.request("GET", "/events")
        self.answer = self.connection.getresponse()
        assert self.answer.status == 200
        assert self.answer.getheader("Content-Type") == "text/event-stream"

    def events(self) -> Iterator[tuple[str, str]]:
        kind = ""
        while line := self.answer.readline().decode():
            if line.startswith("event: "):
                kind = line[7:-1]
            elif line.startswith("data: "):
                yield kind, line[6:-1]

    def of(self, kind: str) -> Iterator[str]:
        return (data for found, data in self.events() if found == kind)

    def seconds(self) -> Iterator[dict[str, Any]]:
        return map(json.loads, self.of("second"))

    def close(self) -> None:
        self.answer.close()
        self.connection.close()


@contextlib.contextmanager
def serving(*options: str) -> Iterator[Served]:
    served = Served(*options)
    try:
        yield served
    finally:
        if served.process.poll() is None:
            served.stop(signal.SIGKILL)


@pytest.fixture(scope="module")
def quick() -> Iterator[Served]:
    """A small junction at a high speed, for whoever only reads."""
    with serving("--site", ONE_WAY, "--speed", "100") as served:
        yield served


# --- what it streams --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "link"),
    [
        (["--chooser", "cumulative:lstm", "--vehicles", "400", "--trial", "3"], ["--link", "inproc"]),
        (["--chooser", "pressure", "--seed", "7", "--straight"], []),
    ],
)
def test_the_stream_is_the_log_of_run_byte_for_byte(options: list[str], link: list[str]) -> None:
    seconds = 40
    same = [option for option in options if option != "--straight"]
    if "--vehicles" not in same:
        same += ["--vehicles", "600"]
    run = [HOST_SIM, "run", "--site", ONE_WAY, "--full", "--log", "-", "--summary", "/dev/null", *same, *link]
    log = subprocess.run(run, capture_output=True, text=True, check=True).stdout.splitlines()[:seconds]
    with serving("--site", ONE_WAY, "--speed", "100", *options) as served:
        lines = Onlooker(served).of("second")
        streamed = [next(lines) for _ in range(seconds)]
    assert [re.sub(r',"model":"[^"]*"\}$', "}", line) for line in streamed] == log
    assert {json.loads(line)["model"] for line in streamed} <= {"lstm", "none", "mean (cold)", "mean (distrusted)"}


def test_who_comes_late_is_told_what_was_before(quick: Served) -> None:
    first = Onlooker(quick)
    early = first.seconds()
    while next(early)["t_s"] < 20:
        pass
    first.close()
    late = Onlooker(quick).events()
    assert next(late)[0] == "run"
    seen = [next(late) for _ in range(20)]
    assert [json.loads(data)["t_s"] for kind, data in seen if kind == "second"][:10] == list(range(10))


def test_the_controls_of_a_run_come_with_it(quick: Served) -> None:
    kind, state = next(event for event in Onlooker(quick).events() if event[0] == "controls")
    assert (kind, json.loads(state)) == (
        "controls",
        {"chooser": "naive", "vehicles": 600, "speed": 100.0, "paused": False, "straight": False},
    )


def test_who_reads_nothing_holds_up_nobody(quick: Served) -> None:
    with socket.create_connection(("127.0.0.1", quick.port)) as lazy:
        lazy.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1024)
        lazy.sendall(f"GET /events HTTP/1.1\r\nHost: 127.0.0.1:{quick.port}\r\n\r\n".encode())
        other = Onlooker(quick).seconds()
        begun, first = time.monotonic(), next(other)["t_s"]
        while next(other)["t_s"] < first + 150:
            pass
        assert time.monotonic() - begun < 15


def test_sixteen_may_look_on_and_places_are_given_back(quick: Served) -> None:
    onlookers = [Onlooker(quick) for _ in range(ONLOOKERS_MAX)]
    numbers = [next(onlooker.seconds())["t_s"] for onlooker in onlookers]
    assert len(numbers) == ONLOOKERS_MAX
    status, text, _ = quick.ask("GET", "/events")
    assert status == 503
    assert text == "16 look on already; right would be fewer pages\n"
    assert quick.ask("GET", "/site")[0] == 200  # everything else goes on
    for onlooker in onlookers:
        onlooker.close()
    until = time.monotonic() + 15
    while True:
        try:
            Onlooker(quick).close()
            break
        except AssertionError:
            assert time.monotonic() < until
            time.sleep(0.2)


def test_the_site_is_told_as_its_file_has_it(quick: Served) -> None:
    site = json.loads(quick.ask("GET", "/site")[1])
    assert site["approaches"] == ["N", "W"]
    assert [movement["approach"] for movement in site["movements"]] == [0, 1]
    assert [stage["groups"] for stage in site["stages"]] == [[0], [1]]
    assert site["groups"][0]["conflicts"] == [1]
    assert site["modes"][4] == "automatic"
    assert site["faults"][12] != ""
    names = [chooser["name"] for chooser in site["choosers"]]
    assert {"naive", "cumulative:lstm", "pressure", "rollout:ar8", "surtrac"} <= set(names)
    assert not [name for name in names if name.endswith(":oracle")]


# --- what it can be told ----------------------------------------------------------------------------------------------


def test_it_waits_and_goes_on_second_by_second() -> None:
    with serving("--site", ONE_WAY, "--paused") as served:
        onlooker = Onlooker(served)
        seconds = onlooker.seconds()
        assert next(seconds)["t_s"] == 0
        assert served.wish({"step": 1})[0] == 200
        assert next(seconds)["t_s"] == 1
        assert json.loads(served.wish({"step": 3})[1])["paused"] is True
        assert [next(seconds)["t_s"] for _ in range(3)] == [2, 3, 4]
        time.sleep(0.5)
        late = Onlooker(served)
        told = []
        for kind, data in late.events():
            if kind == "controls":
                break
            told.append(data)
        assert json.loads(told[-1])["t_s"] == 4  # and not a second further
        assert served.wish({"paused": False, "speed": 100})[0] == 200
        while next(seconds)["t_s"] < 30:
            pass


def test_more_vehicles_come_from_the_next_second_on() -> None:
    with serving("--site", ONE_WAY, "--straight", "--paused", "--vehicles", "100") as served:
        seconds = Onlooker(served).seconds()
        served.wish({"step": 50})
        before = [next(seconds)["arrived"] for _ in range(51)]
        served.wish({"vehicles": 1000})
        served.wish({"step": 50})
        after = [next(seconds)["arrived"] for _ in range(50)]
    run = [HOST_SIM, "run", "--site", ONE_WAY, "--log", "-", "--summary", "/dev/null", "--vehicles"]
    thousand = subprocess.run([*run, "1000"], capture_output=True, text=True, check=True).stdout.splitlines()
    wanted = [json.loads(line)["arrived"] for line in thousand[:101]]
    assert after == wanted[51:101]
    assert before[10][0] == pytest.approx(wanted[10][0] / 10)


def test_another_chooser_begins_anew_with_the_same_traffic() -> None:
    with serving("--site", ONE_WAY, "--straight", "--speed", "100") as served:
        events = Onlooker(served).events()
        assert next(json.loads(data)["chooser"] for kind, data in events if kind == "run") == "naive"
        first = [json.loads(data) for _, data in (next(events) for _ in range(30))]
        assert json.loads(served.wish({"chooser": "pressure@h=2"})[1])["chooser"] == "pressure@h=2"
        again: dict[str, Any] = {}
        while "trial" not in again:
            again = json.loads(next(events)[1])
        assert (again["chooser"], again["trial"]) == ("pressure@h=2", 0)
        second = [json.loads(data) for kind, data in (next(events) for _ in range(12)) if kind == "second"]
    arrived = [line["arrived"] for line in first if "arrived" in line]
    assert [line["arrived"] for line in second] == arrived[: len(second)]


def test_after_the_last_second_comes_the_next_trial() -> None:
    with serving("--site", ONE_WAY, "--straight", "--paused") as served:
        trials, last, asked = [], 0, -300
        for kind, data in Onlooker(served).events():
            line = json.loads(data)
            if kind == "run":
                trials.append(line["trial"])
                if line["trial"] > 0:
                    break
            elif kind == "second":
                last = line["t_s"]
            if last - asked >= 300:
                asked = last
                served.wish({"step": 600})  # as fast as it goes: seconds may be left out for whoever is slower
    assert set(trials) == {0, 1}
    assert last > 1000


BAD_WISHES = [
    ({"vehicles": 0}, "vehicles is 0; right would be a whole number from 1 to 100000"),
    ({"vehicles": 1.5}, "vehicles is 1.5; right would be a whole number from 1 to 100000"),
    ({"vehicles": "600"}, 'vehicles is "600"; right would be a whole number from 1 to 100000'),
    ({"vehicles": None}, "vehicles is null; right would be a whole number"),
    ({"speed": 0}, "speed is 0; right would be a number from 0.1 to 100"),
    ({"speed": 101}, "speed is 101; right would be a number from 0.1 to 100"),
    ({"paused": "yes"}, 'paused is "yes"; right would be true or false'),
    ({"straight": 1}, "straight is 1; right would be true or false"),
    ({"step": 601}, "step is 601; right would be a whole number from 1 to 600"),
    ({"chooser": 7}, "chooser is 7; right would be a text such as cumulative:lstm"),
    ({"chooser": "naiv"}, 'unknown chooser "naiv"'),
    ({"chooser": "naive@min=0"}, '"0"'),
    ({"chooser": "cumulative:oracle"}, "nobody on a street knows the future"),
    ({"frob": 1}, 'unknown key "frob"; right would be some of vehicles, chooser'),
    ({"vehicles": 700, "speed": -1}, "speed is -1"),
    ('{"chooser": "\udcff"}', "the body is no JSON object"),  # sent as the byte 0xff: no UTF-8
    ({}, "the body is no JSON object"),
    ([], "the body is no JSON object"),
    ("{", "the body is no JSON object"),
    ("", "the body is no JSON object"),
    ('{"vehicles": 1e999}', "the body is no JSON object"),
    ("[" * 1000, "the body is no JSON object"),
    ('{"chooser": "' + "\\u0000" * 5 + '"}', "unknown chooser"),
    ('{"chooser": "\u00ff"}', 'unknown chooser "\u00ff"'),
]


@pytest.mark.parametrize(("body", "words"), BAD_WISHES, ids=lambda value: repr(value)[:40])
def test_a_bad_wish_is_refused_in_one_line_and_changes_nothing(quick: Served, body: object, words: str) -> None:
    status, text = quick.wish(body)
    assert status == 400
    assert words in text
    assert text.count("\n") == 1
    state = next(data for kind, data in Onlooker(quick).events() if kind == "controls")
    assert json.loads(state) == {
        "chooser": "naive",
        "vehicles": 600,
        "speed": 100.0,
        "paused": False,
        "straight": False,
    }


# --- whom it answers --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("host", ["elsewhere.example", "127.0.0.1", "localhost", "127.0.0.1:1", "localhost:1", ""])
@pytest.mark.parametrize("path", ["/", "/site", "/events"])
def test_who_calls_by_another_name_is_refused(quick: Served, host: str, path: str) -> None:
    status, text, _ = quick.ask("GET", path, Host=host)
    assert status == 403
    assert text == f"Host is not this machine; right would be http://127.0.0.1:{quick.port}/\n"


def test_localhost_is_a_name_of_ours(quick: Served) -> None:
    assert quick.ask("GET", "/site", Host=f"localhost:{quick.port}")[0] == 200


@pytest.mark.parametrize(
    "origin", ["http://elsewhere.example", "null", "https://127.0.0.1:{port}", "http://127.0.0.1:1"]
)
def test_another_page_cannot_wish(quick: Served, origin: str) -> None:
    status, text = quick.wish({"vehicles": 700}, Origin=origin.format(port=quick.port))
    assert (status, text) == (403, f"Origin is another page; right would be http://127.0.0.1:{quick.port}/\n")


def test_our_own_page_can_wish(quick: Served) -> None:
    assert quick.wish({"vehicles": 600}, Origin=f"http://127.0.0.1:{quick.port}")[0] == 200


def test_a_form_of_another_page_is_no_wish(quick: Served) -> None:
    status, text = quick.wish('{"vehicles": 700}', Content_Type="text/plain")
    assert (status, text) == (415, "Content-Type is not JSON; right would be application/json\n")


def test_a_large_body_is_refused_unread(quick: Served) -> None:
    status, text = quick.wish({"chooser": "x" * 2000})
    assert (status, text) == (413, "the body is too large; right would be 1024 bytes or less\n")


def test_there_is_nothing_else(quick: Served) -> None:
    for method, path in [
        ("GET", "/x"),
        ("GET", "/../etc/passwd"),
        ("GET", "/control"),
        ("POST", "/"),
        ("PUT", "/site"),
    ]:
        assert quick.ask(method, path, "" if method != "GET" else None)[0] == 404, (method, path)


def test_only_this_machine_can_reach_it(quick: Served) -> None:
    listening = [line.split() for line in Path("/proc/net/tcp").read_text().splitlines()[1:]]
    addresses = [words[1] for words in listening if words[3] == "0A" and words[1].endswith(f":{quick.port:04X}")]
    assert addresses == [f"0100007F:{quick.port:04X}"]
    listening6 = [line.split() for line in Path("/proc/net/tcp6").read_text().splitlines()[1:]]
    assert not [w for w in listening6 if w[3] == "0A" and w[1].endswith(f":{quick.port:04X}")]


def test_the_page_is_the_source_and_may_load_nothing(quick: Served) -> None:
    status, text, headers = quick.ask("GET", "/")
    assert status == 200
    assert text == (ROOT / "live_page" / "page.html").read_text(encoding="utf-8")
    policy = headers["Content-Security-Policy"]
    for words in ("default-src 'none'", "connect-src 'self'", "frame-ancestors 'none'", "form-action 'none'"):
        assert words in policy
    assert "http:" not in policy
    assert headers["X-Content-Type-Options"] == "nosniff"


@pytest.mark.parametrize(
    "rubbish",
    [
        b"\x00" * 300,
        b"GET / HTTP/1.1\r\n" + b"A: b\r\n" * 10 + b"\r\n",
        b"GET /" + b"a" * 9000 + b" HTTP/1.1\r\n\r\n",
        b"POST /control HTTP/1.1\r\nHost: x\r\nContent-Length: 99999999999999999999\r\n\r\n",
        b"POST /control HTTP/1.1\r\nContent-Length: -1\r\n\r\n",
    ],
)
def test_rubbish_does_not_end_it(quick: Served, rubbish: bytes) -> None:
    with socket.create_connection(("127.0.0.1", quick.port)) as connection:
        connection.settimeout(10)
        connection.sendall(rubbish)
        connection.shutdown(socket.SHUT_WR)
        with contextlib.suppress(ConnectionError):
            answer = connection.recv(1000)
            assert not answer.startswith(b"HTTP/1.1 200")
    assert quick.ask("GET", "/site")[0] == 200


# --- how it begins and ends -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("state", ["--speed=1", "--paused"])
def test_it_ends_cleanly_whoever_looks_on(how: signal.Signals, state: str) -> None:
    with serving("--site", ONE_WAY, state) as served:
        onlooker = Onlooker(served)
        next(onlooker.seconds())
        begun = time.monotonic()
        assert served.stop(how) == (0, "")
        assert time.monotonic() - begun < 5
        assert "second" not in [kind for kind, _ in onlooker.events()]  # its stream has an end


def refused(*options: str) -> str:
    done = subprocess.run([HOST_SIM, "serve", *options], capture_output=True, text=True, check=False, timeout=START_S)
    assert done.returncode == 2, done
    assert done.stdout == ""
    assert done.stderr.count("\n") == 1
    return done.stderr


def test_a_port_that_somebody_has_is_refused(quick: Served) -> None:
    said = refused("--port", str(quick.port))
    assert f"--port {quick.port}: cannot be had, somebody may be using it; right would be another, or 0 for any" in said


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--port", "65536"], '--port "65536"'),
        (["--port", "x"], '--port "x"'),
        (["--speed", "0"], '--speed "0"'),
        (["--speed", "1000"], "0.1 to 100"),
        (["--vehicles", "0"], '"0"'),
        (["--chooser", "naiv"], '"naiv"'),
        (["--chooser", "cumulative:oracle"], "the future"),
        (["--site", "nowhere.toml"], "nowhere.toml"),
    ],
)
def test_what_cannot_be_served_is_refused_in_one_line(options: list[str], words: str) -> None:
    assert words in refused("--port", "0", *options) if "--port" not in options else words in refused(*options)
