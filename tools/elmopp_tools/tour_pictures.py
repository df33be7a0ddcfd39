# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The pictures of docs/tour.md, from what the tour's own commands wrote to out/tour and from its two pages."""

from __future__ import annotations

import argparse
import http
import http.client
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import NoReturn

from PIL import Image

from elmopp_tools.browser import Browser, BrowserError

ROOT = Path(__file__).resolve().parents[2]
HOST_SIM = ROOT / "build" / "release" / "bin" / "host_sim"
EDITOR = Path(__file__).with_name("lane_editor.html")
EXIT_DONE = 0
EXIT_REFUSED = 2
COLOURS = 256  # a lamp is a small part of a picture, and with fewer its red turns brown
EDITOR_SCALE = 0.65  # the road is noise, which a PNG cannot make small
SECOND = 300
STEP = 300
NEEDED = ("report.html", "plain.png", "plain.lanes.json", "seen.png")

DESCRIPTION = """\
Makes the pictures of docs/tour.md: tour-run, tour-live, tour-editor and tour-seen, PNG with few colours. Reads what the
tour's commands have written to out/tour, and takes the pages in a headless Chromium (tools/setup check installs it)."""

EPILOG = """\
Exit codes: 0 done; 2 the request cannot be run.

Example:
  tools/tour-pictures --out docs/figures"""


class RequestError(Exception):
    """It cannot be run; the text says what is wrong and what would be right."""


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        self.exit(EXIT_REFUSED, f"tour-pictures: {message} (tour-pictures --help)\n")


def save_small(picture: Image.Image, file: Path) -> None:
    few = picture.convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)
    few.save(file, format="PNG", optimize=True)


@contextmanager
def live_page(*options: str) -> Iterator[str]:
    """Its address."""
    command = [str(HOST_SIM), "serve", "--port", "0", *options]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        found = re.search(r"http://\S+/", process.stdout.readline() if process.stdout else "")
        try:
            if found is None:
                raise RequestError(f"{HOST_SIM} serve says no address")
            yield found[0]
        finally:
            process.terminate()


def wish(address: str, body: str) -> None:
    host = address.removeprefix("http://").rstrip("/")
    connection = http.client.HTTPConnection(host, timeout=30)
    connection.request("POST", "/control", body, {"Content-Type": "application/json"})
    if connection.getresponse().status != http.HTTPStatus.OK:
        raise RequestError(f"{address} refuses {body}")
    connection.close()


def take_live(browser: Browser, raw: Path) -> None:
    with live_page("--chooser", "cumulative:lstm", "--straight", "--paused") as address:
        wish(address, f'{{"step": {STEP}}}')
        browser.look(1200, 1240)
        browser.open(address)
        browser.wait(f"document.body.dataset.second === '{SECOND}'", 60)
        browser.picture(raw, whole=False)
        browser.open("about:blank")


def take_editor(browser: Browser, tour: Path, raw: Path) -> None:
    browser.look(1100, 880, scale=EDITOR_SCALE)
    browser.open(EDITOR.as_uri())
    browser.wait("document.body && document.body.dataset.ready === 'yes'")
    browser.choose("#open-picture", tour / "plain.png")
    browser.wait("picture !== null")
    browser.choose("#open-lanes", tour / "plain.lanes.json")
    browser.wait("file.lanes.length > 0")
    browser.run("document.activeElement.blur()")
    browser.picture(raw, whole=False)


def take_run(browser: Browser, tour: Path, raw: Path) -> None:
    browser.look(800, 900)
    browser.open((tour / "report.html").as_uri())
    box = browser.run(
        "(() => { const b = document.querySelector('figure img').getBoundingClientRect();"
        " return [b.x, b.y + scrollY, b.width, b.height]; })()"
    )
    browser.picture(raw)
    picture = Image.open(raw)
    x, y, width, height = box
    picture.crop((round(x), round(y), round(x + width), round(y + height))).save(raw)


def run(request: argparse.Namespace) -> None:
    tour, out = Path(request.tour), Path(request.out)
    missing = [name for name in NEEDED if not (tour / name).exists()]
    if missing:
        raise RequestError(f"--tour {tour}: {missing[0]} is missing; right would be the commands of docs/tour.md first")
    if not HOST_SIM.exists():
        raise RequestError(f"{HOST_SIM} is missing; right would be: cmake --build --preset release")
    if not out.is_dir():
        raise RequestError(f"--out {out}: is no folder")
    with tempfile.TemporaryDirectory() as folder, Browser() as browser:
        raw = Path(folder) / "raw.png"
        takes: dict[str, Callable[[], None]] = {
            "tour-live": lambda: take_live(browser, raw),
            "tour-editor": lambda: take_editor(browser, tour, raw),
            "tour-run": lambda: take_run(browser, tour, raw),
        }
        for name, take in takes.items():
            take()
            save_small(Image.open(raw), out / f"{name}.png")
    save_small(Image.open(tour / "seen.png"), out / "tour-seen.png")


def main(arguments: Sequence[str] | None = None) -> int:
    parser = _Parser(
        prog="tour-pictures",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--tour", metavar="DIR", default=str(ROOT / "out" / "tour"), help="default: out/tour")
    parser.add_argument("--out", metavar="DIR", default=str(ROOT / "docs" / "figures"), help="default: docs/figures")
    try:
        run(parser.parse_args(arguments))
    except (RequestError, BrowserError) as error:
        print(f"tour-pictures: {error}", file=sys.stderr)
        return EXIT_REFUSED
    return EXIT_DONE
