# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""The live page in a browser: what it shows is what the stream says, and everybody can use it.

Pictures of it go to the folder ELMOPP_PICTURES, if that is set.
"""

from __future__ import annotations

import json
import os
import threading
import time
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any, ClassVar

import pytest
from elmopp_tools.browser import Browser
from page_checks import contrasts, expect_contrast, expect_fits, expect_names, expect_quiet
from PIL import Image
from test_serve import ONE_WAY, ROOT, Onlooker, Served, serving

FOUR_WAY = str(ROOT / "sites" / "four_way.toml")
WORDS = ["dark", "red", "red and amber", "green", "amber", "flashing amber", "flashing red"]
LETTERS = ["–", "R", "RA", "G", "A", "F", "F"]  # noqa: RUF001  the page's dash
LAMP = {"dark": "R", "red": "R", "green": "G", "amber": "A"}

ROWS = """[...document.querySelectorAll('#movements tbody tr')].map((r) => [...r.children].map((c) => c.textContent))"""
HEADS = """[...document.querySelectorAll('#movements .head')].map((head) =>
  [head.querySelector('span').textContent, [...head.querySelectorAll('.letter')].map((l) => l.textContent)])"""
MAP_LETTERS = "[...document.querySelectorAll('#map .letter')].map((l) => l.textContent)"
STAGES = """[...document.querySelectorAll('#urgency tbody tr')].map((r) =>
  [r.getAttribute('aria-current'), parseFloat(r.querySelector('i').style.width), r.lastChild.textContent])"""


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with Browser() as browser:
        yield browser


@pytest.fixture
def paused() -> Iterator[Served]:
    with serving("--site", FOUR_WAY, "--chooser", "cumulative:lstm", "--paused") as served:
        yield served


def address(served: Served) -> str:
    return f"http://127.0.0.1:{served.port}/"


def visit(browser: Browser, served: Served, second: int = 0) -> None:
    browser.look()
    browser.open("about:blank")  # the page before may look for a program that is gone
    browser.errors.clear()
    browser.requests.clear()
    browser.open(address(served))
    browser.wait(f"+document.body.dataset.second >= {second}")


def told(served: Served) -> list[dict[str, Any]]:
    """The seconds of the stream until the one at which it waits."""
    onlooker, lines = Onlooker(served), []
    for kind, data in onlooker.events():
        if kind == "second":
            lines.append(json.loads(data))
        elif kind == "controls":
            break
    onlooker.close()
    return lines


def text(browser: Browser, name: str) -> str:
    return str(browser.run(f"document.getElementById('{name}').textContent"))


def picture(browser: Browser, name: str) -> Image.Image:
    folder = Path(os.environ.get("ELMOPP_PICTURES", "build/pictures"))
    folder.mkdir(parents=True, exist_ok=True)
    browser.picture(folder / f"{name}.png")
    return Image.open(folder / f"{name}.png").convert("RGB")


def test_the_page_shows_what_the_stream_says(browser: Browser, paused: Served) -> None:
    visit(browser, paused)
    seen: set[str] = set()
    for step in range(12):
        paused.wish({"step": 3})
        browser.wait(f"+document.body.dataset.second === {3 * step + 3}")
        line = told(paused)[-1]
        assert line["t_s"] == 3 * step + 3
        rows, heads = browser.run(ROWS), browser.run(HEADS)
        aspects = [int(aspect) for aspect in line["aspects"]]  # in this site group j is movement j's
        for j, (row, (word, letters)) in enumerate(zip(rows, heads, strict=True)):
            assert word == WORDS[aspects[j]]
            lit = {1: "R", 2: "RA", 3: "G", 4: "A"}[aspects[j]]
            assert [letter for letter in letters if letter] == list(lit)
            assert [place for place in range(3) if letters[place]] == ["RAG".index(letter) for letter in lit]
            assert float(row[2]) == pytest.approx(line["queue_veh"][j], abs=0.051)
            assert float(row[4].split()[0]) == pytest.approx(line["red_s"][j], abs=0.51)
        seen |= set(line["aspects"][: len(rows)])
        assert sorted(browser.run(MAP_LETTERS)) == sorted(LETTERS[aspects[j]] for j in range(len(rows)))
        for s, (shown, width, value) in enumerate(browser.run(STAGES)):
            assert (shown == "true") == (s == line["stage"])
            assert float(value) == pytest.approx(line["urgency"][s], rel=0.01)
            assert width == pytest.approx(100 * line["urgency"][s] / max(line["urgency"]), abs=0.1)
        assert text(browser, "mode") == "automatic"
        assert text(browser, "fault") == "none"
    assert seen >= {"1", "3"}
    expect_quiet(browser, address(paused))


def test_the_chart_is_the_forecast_and_what_came(browser: Browser, paused: Served) -> None:
    paused.wish({"step": 99})
    visit(browser, paused, 99)
    for last in range(100, 106):
        paused.wish({"step": 1})
        browser.wait(f"+document.body.dataset.second === {last}")
        lines = told(paused)
        came = sum(sum(line["arrived"]) for line in lines[last - 59 :])
        foreseen, now = (sum(lines[at]["forecast"]) for at in (last - 60, last))
        words = text(browser, "forecast-words")
        assert f"Foreseen for the next 60 s: {now:.1f} vehicles" in words
        assert f"In the last 60 s {came:.1f} came; {foreseen:.1f} had been foreseen." in words
        assert ("the network has lately done worse" in words) == (lines[last]["model"] == "mean (distrusted)")
    assert browser.run("document.querySelectorAll('#chart path.came, #chart path.foreseen').length") == 2
    # One approach alone, by the keys.
    browser.run("document.getElementById('approach').focus()")
    browser.key("ArrowDown")
    north = f"In the last 60 s {sum(sum(line['arrived'][0:3]) for line in lines[-60:]):.1f} came"
    browser.wait(f"document.getElementById('forecast-words').textContent.includes({json.dumps(north)})")


def test_everything_can_be_done_by_keys(browser: Browser) -> None:
    with serving("--site", FOUR_WAY, "--speed", "2") as served:
        visit(browser, served)
        names = expect_names(browser)
        assert names == [
            "skip",
            "pause",
            "step",
            "speed",
            "vehicles",
            "set-vehicles",
            "chooser",
            "straight",
            "start",
            "approach",
        ]
        browser.key("Tab")
        assert browser.run("document.activeElement.className") == "skip"
        for name in names[1:]:
            browser.key("Tab")
            assert browser.run("document.activeElement.id") == name
            outline = browser.run("getComputedStyle(document.activeElement).outlineStyle")
            assert outline != "none"  # whoever uses keys sees where he is

        def focus(name: str) -> None:
            browser.run(f"document.getElementById('{name}').focus()")

        focus("pause")
        browser.key(" ")
        browser.wait("document.getElementById('pause').textContent === 'Run'")
        browser.wait("document.getElementById('answer').textContent === 'Paused.'")
        stood = told(served)[-1]["t_s"]
        focus("step")
        browser.key("Enter")
        browser.wait(f"document.body.dataset.second === '{stood + 1}'")
        focus("vehicles")
        browser.key("a", control=True)
        browser.run("document.getElementById('vehicles').select()")
        browser.type("900")
        browser.key("Enter")
        browser.wait("document.getElementById('answer').textContent === 'Demand 900.'")
        assert "1620 an hour" in text(browser, "per-hour")
        focus("chooser")
        for letter in "pressure":
            browser.key(letter)
        focus("start")
        browser.key("Enter")
        browser.wait("document.getElementById('under').textContent.startsWith('pressure, ')")
        focus("vehicles")
        browser.run("document.getElementById('vehicles').select()")
        browser.type("0")
        browser.key("Enter")
        refused = "document.getElementById('answer').textContent.startsWith('Refused: vehicles is 0; right would be')"
        browser.wait(refused)
        # What the junction says of a new run does not wipe the refusal away.
        served.wish({"restart": True, "chooser": "naive"})
        served.wish({"step": 99})
        browser.wait("document.getElementById('under').textContent.startsWith('naive, ')")
        browser.wait("+document.body.dataset.second >= 90")
        assert text(browser, "say") == "Mode automatic, fault: none."
        assert browser.run(refused)
        # A refusal is what the page is for; the browser notes it on its own.
        browser.errors = [error for error in browser.errors if "400" not in error]
        expect_quiet(browser, address(served))


@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
def test_every_text_stands_out(browser: Browser, paused: Served, dark: bool) -> None:
    paused.wish({"step": 120})
    visit(browser, paused, 120)
    browser.look(1280, 2000, dark=dark)
    browser.wait(f"matchMedia('(prefers-color-scheme: dark)').matches === {str(dark).lower()}")
    expect_contrast(browser)
    expect_fits(browser)
    corner = picture(browser, "live-dark" if dark else "live").getpixel((3, 3))
    assert isinstance(corner, tuple)
    assert (max(corner) < 60) == dark


def test_the_contrast_check_sees_a_pale_text(browser: Browser, paused: Served) -> None:
    visit(browser, paused)
    browser.run("document.getElementById('mode').style.color = '#999'")
    assert min(contrasts(browser))[1] == "automatic"
    assert min(contrasts(browser))[0] < 3.0


def test_it_fits_on_a_telephone(browser: Browser, paused: Served) -> None:
    paused.wish({"step": 120})
    visit(browser, paused, 120)
    browser.look(360, 780, scale=2.0)
    expect_fits(browser)
    cut = """[...document.querySelectorAll('.scroll')].filter((e) => e.scrollWidth > e.clientWidth).length"""
    assert browser.run(cut) == 0
    small = """[...document.querySelectorAll('button, select, input')].filter((e) => e.getClientRects().length
      && e.getBoundingClientRect().height < 36).length"""
    assert browser.run(small) == 0
    picture(browser, "live-phone")


def test_lamps_differ_without_colour(browser: Browser, paused: Served) -> None:
    """Red and green by shape, by letter, by place, and by how bright they are."""
    visit(browser, paused)
    browser.look(grey=True)
    drawn = browser.run(
        """(() => { const out = {};
        for (const letter of document.querySelectorAll('#map .letter')) {
          const shape = [...letter.parentNode.children].find((e) => e.style.display !== 'none' && e.tagName !== 'text');
          const box = shape.getBoundingClientRect();
          out[letter.textContent] = [shape.tagName, box.x + box.width * .5, box.y + box.height * .13];
        } return out; })()"""
    )
    assert drawn["R"][0] == "rect"
    assert drawn["G"][0] == "circle"
    grey = picture(browser, "live-grey")
    red, green = (grey.getpixel((round(drawn[a][1]), round(drawn[a][2]))) for a in "RG")
    assert isinstance(red, tuple)
    assert isinstance(green, tuple)
    assert max(red) - min(red) <= 2  # it is grey indeed
    assert green[0] - red[0] > 60
    browser.look()


@pytest.mark.parametrize("site", sorted(path.stem for path in (ROOT / "sites").glob("*.toml")))
def test_every_site_is_drawn(browser: Browser, site: str) -> None:
    with serving(
        "--site", str(ROOT / "sites" / f"{site}.toml"), "--chooser", "pressure", "--straight", "--paused"
    ) as served:
        visit(browser, served)
        facts = json.loads(served.ask("GET", "/site")[1])
        lamps = sum(len(movement["groups"]) for movement in facts["movements"])
        assert browser.run("document.querySelectorAll('#map .letter').length") == lamps
        assert browser.run("document.querySelectorAll('#urgency tbody tr').length") == len(facts["stages"])
        inside = """[...document.querySelectorAll('#map text')].every((t) => { const a = t.getBoundingClientRect(),
          b = document.getElementById('map').getBoundingClientRect();
          return !t.textContent || (a.x >= b.x && a.right <= b.right && a.y >= b.y && a.bottom <= b.bottom); })"""
        assert browser.run(inside)
        expect_quiet(browser, address(served))


class Bus(BaseHTTPRequestHandler):
    """Plays elmopp-view: a controller whose second camera is silent, and which then falls silent itself."""

    site = ""
    lines: ClassVar[list[str]] = []

    def do_GET(self) -> None:
        page = (ROOT / "live_page" / "page.html").read_text(encoding="utf-8")
        told = "".join(f"event: second\ndata: {line}\n\n" for line in self.lines)
        run = 'event: run\ndata: {"site": "one_way", "can": "can0"}\n\n'
        answers = {"/": ("text/html", page), "/site": ("application/json", self.site)}
        kind, text = answers.get(self.path, ("text/event-stream", run + told))
        self.send_response(200)
        self.send_header("Content-Type", kind)
        self.end_headers()
        self.wfile.write(text.encode())

    def log_message(self, format: str, *args: object) -> None:  # noqa: A002  the name of the base class
        """Says nothing."""


def test_a_controller_on_a_bus_is_looked_at_only(browser: Browser) -> None:
    with serving("--site", ONE_WAY, "--paused") as served:
        site = json.loads(served.ask("GET", "/site")[1])
    Bus.site = json.dumps(
        {**{key: site[key] for key in site if key not in ("choosers", "demand_s")}, "controls": False}
    )
    line = {"t_s": 0, "stage": 0, "aspects": "31" + "0" * 14, "present": [4, 0], "arrived": [1, 0], "urgency": [0, 0]}
    line |= {"forecast": [7.5, 0], "fault": 12, "uncounted": [1]}
    Bus.lines = [json.dumps({**line, "mode": 5, "model": "mean (cold)", "differs": {"1": "shows dark"}})]
    with ThreadingHTTPServer(("127.0.0.1", 0), Bus) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        address = f"http://127.0.0.1:{server.server_port}/"
        browser.look()
        browser.open("about:blank")
        browser.errors.clear()
        browser.open(address)
        browser.wait("document.body.dataset.second === '0'")
        assert (
            browser.run("[...document.querySelectorAll('button, input')].filter((e) => e.getClientRects().length)")
            == []
        )
        assert text(browser, "under") == "on can0"
        assert text(browser, "mode") == "fixed time"
        assert text(browser, "fault") == "feedback lost (12)"
        rows = browser.run(ROWS)
        assert [row[2] for row in rows] == ["4", "?"]
        assert [row[1] for row in rows] == ["Ggreen", "Rred but shows dark"]
        assert text(browser, "differ") == "not W"
        assert browser.run(MAP_LETTERS) == ["G", "R!"]
        assert "does not send its urgencies" in text(browser, "no-urgency")
        assert "The mean stands in: the forecast has seen too little." in text(browser, "forecast-words")
        picture(browser, "live-bus")
        Bus.lines = [json.dumps({**line, "differs": {}})]
        browser.wait("document.getElementById('mode').textContent === 'controller silent'")
        assert text(browser, "differ") == "all"
        browser.open("about:blank")
        server.shutdown()


def test_a_page_that_lost_its_program_says_so_and_comes_back(browser: Browser) -> None:
    served = Served("--site", ONE_WAY, "--speed", "10")
    visit(browser, served)
    assert served.stop()[0] == 0
    browser.wait("document.getElementById('say').textContent.startsWith('The connection is lost')")
    port = str(served.port)
    until = time.monotonic() + 10
    while True:
        try:
            again = Served("--site", ONE_WAY, "--port", port)
            break
        except AssertionError:
            assert time.monotonic() < until
    browser.wait("document.getElementById('say').textContent.startsWith('Mode automatic')", 20)
    again.stop()
    browser.errors.clear()
