# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""The lane editor in a browser: what is drawn is what is saved, and it judges lane files as our programs do.

Pictures of it go to the folder ELMOPP_PICTURES, if that is set.
"""

from __future__ import annotations

import contextlib
import copy
import http.client
import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from elmopp_tools import draw_lanes, edit_lanes
from elmopp_tools.browser import Browser
from page_checks import expect_contrast, expect_fits, expect_names, expect_quiet
from PIL import Image, ImageDraw

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "tools" / "elmopp_tools" / "lane_editor.html").as_uri()
CAMERA = os.environ["ELMOPP_CAMERA"]
SIZE = (640, 400)

# A road seen from above its end, two lanes towards the camera, drawn in test_a_drawing below.
DRAWN = """\
{
 "format": "elmopp-lanes/1",
 "width": 640,
 "height": 400,
 "lanes": [
  {"name": "inner", "line": [[200, 250], [300, 250]], "direction": "down", "zone": [[240, 100], [300, 100], [300, 240], [200, 240]], "approach": 2, "movement": 1},
  {"name": "lane1", "line": [[300, 250], [400, 252]], "direction": "down", "mask": [[[350, 110], [380, 110], [380, 140]]]}
 ],
 "junction": [[150, 300], [500, 300], [500, 390], [150, 390]]
}
"""  # noqa: E501  its bytes

GOOD: dict[str, Any] = {
    "width": 320,
    "height": 240,
    "lanes": [
        {
            "name": "a",
            "line": [[50, 150], [100, 150]],
            "direction": "down",
            "approach": 1,
            "movement": 0,
            "zone": [[60, 50], [90, 50], [100, 150], [50, 150]],
            "mask": [[[60, 60], [70, 60], [70, 80]]],
        },
        {"name": "b", "line": [[100, 150], [150.5, 150]], "direction": "up"},
        {"name": "c", "line": [[200, 50], [205, 100]], "direction": "left"},
    ],
    "junction": [[10, 200], [300, 200], [300, 230]],
}


def road() -> Image.Image:
    """A picture of a road, plain but not empty."""
    picture = Image.new("RGB", SIZE, (96, 110, 92))
    pen = ImageDraw.Draw(picture)
    pen.polygon([(250, 0), (390, 0), (520, 400), (120, 400)], fill=(92, 94, 98))
    pen.line([(320, 0), (315, 400)], fill=(210, 210, 200), width=3)
    for x, y, length in ((265, 120, 34), (240, 200, 44), (360, 160, 40)):
        pen.rectangle([x, y, x + 26, y + length], fill=(50, 60, 120))
    return picture


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with Browser() as browser:
        yield browser


@pytest.fixture(scope="module")
def frame(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("frame") / "frame.png"
    road().save(file)
    return file


def visit(browser: Browser, address: str = PAGE) -> None:
    browser.look(1280, 900)
    browser.errors.clear()
    browser.requests.clear()
    browser.open(address)
    browser.wait("document.body && document.body.dataset.ready === 'yes'")


@pytest.fixture
def page(browser: Browser, frame: Path) -> Browser:
    visit(browser)
    browser.choose("#open-picture", frame)
    browser.wait("picture !== null")
    return browser


def says(browser: Browser) -> str:
    return str(browser.run("document.getElementById('say').textContent"))


def place(browser: Browser, x: float, y: float) -> tuple[float, float]:
    """Where a pixel of the picture is in the window."""
    at = browser.run(
        f"(() => {{ const p = new DOMPoint({x}, {y}).matrixTransform(stage.getScreenCTM()); return [p.x, p.y]; }})()"
    )
    return float(at[0]), float(at[1])


def pick(browser: Browser, tool: str) -> None:
    browser.click(f"label:has([value={tool}])")
    browser.run("scrollTo(0, 0)")


def click(browser: Browser, *points: tuple[int, int]) -> None:
    for x, y in points:
        browser.click_at(*place(browser, x, y))


def fill(browser: Browser, field: str, text: str) -> None:
    browser.run(f"document.getElementById('{field}').focus(); document.getElementById('{field}').select()")
    browser.type(text)
    browser.key("Tab")


def choose(browser: Browser, field: str, value: str) -> None:
    browser.run(
        f"(() => {{ const e = document.getElementById('{field}'); e.value = '{value}';"
        " e.dispatchEvent(new Event('change')); })()"
    )


def saved(browser: Browser, folder: Path, name: str = "camera.lanes.json") -> str:
    """What the button saves. A browser keeps the name with an empty file until the whole one takes its place."""
    browser.keep_downloads(folder)
    browser.click("#save")
    until = time.monotonic() + 10
    file = folder / name
    while not file.exists() or file.stat().st_size == 0:
        assert time.monotonic() < until, says(browser)
        time.sleep(0.02)
    return file.read_text(encoding="utf-8")


def accepted_by_draw_lanes(lanes: Path, frame: Path, out: Path) -> bool:
    return draw_lanes.main(["--lanes", str(lanes), "--frame", str(frame), "--out", str(out)]) == 0


# --- drawing ----------------------------------------------------------------------------------------------------------


def test_a_drawing_by_mouse_is_the_file_to_the_byte(page: Browser, frame: Path, tmp_path: Path) -> None:
    pick(page, "line")
    click(page, (200, 250), (300, 250))
    fill(page, "name", "inner")
    choose(page, "approach", "2")
    choose(page, "movement", "1")
    pick(page, "zone")
    click(page, (240, 100), (300, 100), (300, 240), (200, 240), (241, 102))  # closed at its first corner
    pick(page, "line")
    click(page, (303, 247), (400, 252))  # joins the end of the other line
    pick(page, "mask")
    click(page, (350, 110), (380, 110))
    for clicks in (1, 2):  # a double click closes it
        for kind in ("mousePressed", "mouseReleased"):
            page.mouse(kind, *place(page, 380, 140), clicks=clicks)
    pick(page, "junction")
    click(page, (150, 300), (500, 300), (500, 390), (150, 390), (150, 300))
    text = saved(page, tmp_path)
    assert text == DRAWN
    assert accepted_by_draw_lanes(tmp_path / "camera.lanes.json", frame, tmp_path / "drawn.png")
    picture(page, "editor")
    expect_quiet(page, PAGE)


def test_the_same_drawing_by_keys(page: Browser, tmp_path: Path) -> None:
    at = [SIZE[0] // 2, SIZE[1] // 2]

    def go(x: int, y: int) -> None:
        for axis, (less, more), to in ((0, ("ArrowLeft", "ArrowRight"), x), (1, ("ArrowUp", "ArrowDown"), y)):
            by = to - at[axis]
            for _ in range(abs(by) // 10):
                page.key(more if by > 0 else less, shift=True)
            for _ in range(abs(by) % 10):
                page.key(more if by > 0 else less)
            at[axis] = to

    def draw(tool: str, *points: tuple[int, int]) -> None:
        page.run(f"document.querySelector('[value={tool}]').focus()")
        page.key(" ")
        page.run("stage.focus()")
        at[:] = [SIZE[0] // 2, SIZE[1] // 2]
        page.key("ArrowUp")
        page.key("ArrowDown")
        for point in points:
            go(*point)
            page.key("Enter")

    draw("line", (200, 250), (300, 250))
    fill(page, "name", "inner")
    page.run("document.getElementById('approach').focus()")
    for _ in range(3):
        page.key("ArrowDown")
    page.run("document.getElementById('movement').focus()")
    page.key("ArrowDown")
    draw("zone", (240, 100), (300, 100), (300, 240), (200, 240), (240, 100))
    draw("line", (300, 250), (400, 252))
    draw("mask", (350, 110), (380, 110), (380, 140), (350, 110))
    draw("junction", (150, 300), (500, 300), (500, 390), (150, 390), (150, 300))
    assert saved(page, tmp_path) == DRAWN


def test_a_point_is_moved_by_dragging_by_clicks_by_keys_and_as_a_number(page: Browser) -> None:
    pick(page, "line")
    click(page, (200, 250), (300, 250))
    pick(page, "move")
    x, y = place(page, 300, 250)
    page.mouse("mouseMoved", x, y)
    page.mouse("mousePressed", x, y)
    page.mouse("mouseMoved", *place(page, 330, 260))
    page.mouse("mouseReleased", *place(page, 330, 260))
    assert page.run("file.lanes[0].line") == [[200, 250], [330, 260]]
    click(page, (200, 250), (180, 240))
    assert page.run("file.lanes[0].line") == [[180, 240], [330, 260]]
    page.run("stage.focus(); cursor = [330, 260]")
    page.key("Enter")
    page.key("ArrowRight", shift=True)
    page.key("ArrowUp")
    page.key("Enter")
    assert page.run("file.lanes[0].line") == [[180, 240], [340, 259]]
    page.run("document.getElementById('numbers').open = true")
    fill(page, "p-line-1-y", "255")
    assert page.run("file.lanes[0].line") == [[180, 240], [340, 255]]
    for wanted in ([340, 259], [330, 260]):  # and back
        page.click("#undo")
        assert page.run("file.lanes[0].line[1]") == wanted


def test_everything_can_be_undone_and_done_again(page: Browser) -> None:
    states = [page.run("textOf(file)")]
    pick(page, "line")
    click(page, (200, 250), (300, 250))
    states.append(page.run("textOf(file)"))
    choose(page, "direction", "up")
    states.append(page.run("textOf(file)"))
    page.click("#drop-lane")
    states.append(page.run("textOf(file)"))
    for state in states[-2::-1]:
        page.run("stage.focus()")
        page.key("z", control=True)
        assert page.run("textOf(file)") == state
    assert page.run("document.getElementById('undo').disabled") is True
    for state in states[1:]:
        page.click("#redo")
        assert page.run("textOf(file)") == state


def test_half_a_shape_is_given_up(page: Browser) -> None:
    pick(page, "junction")
    click(page, (150, 300), (500, 300), (500, 390))
    page.key("Backspace")
    assert page.run("drawing.length") == 2
    page.key("Escape")
    assert page.run("[drawing.length, 'junction' in file]") == [0, False]
    pick(page, "zone")
    click(page, (150, 300))
    assert says(page).startswith("Draw the line of a lane first")


# --- files ------------------------------------------------------------------------------------------------------------


def test_a_lane_file_is_opened_and_saved_again(page: Browser, tmp_path: Path) -> None:
    (tmp_path / "there.json").write_text(DRAWN, encoding="utf-8")
    page.choose("#open-lanes", tmp_path / "there.json")
    page.wait("file.lanes.length === 2")
    assert page.run("document.getElementById('lanes').options[0].textContent") == "inner – down, zone"  # noqa: RUF001
    out = tmp_path / "out"
    out.mkdir()
    assert saved(page, out, "there.json") == DRAWN


def test_a_dropped_picture_and_a_dropped_file_are_opened(page: Browser) -> None:
    page.run(
        "(() => { const all = new DataTransfer();"
        f" all.items.add(new File([{json.dumps(DRAWN)}], 'x.lanes', {{type: ''}}));"
        " document.dispatchEvent(new DragEvent('drop', {dataTransfer: all, cancelable: true})); })()"
    )
    page.wait("file.lanes.length === 2")
    assert page.run("document.getElementById('verdict').textContent") == "Good."


def test_a_picture_of_another_size_is_named(page: Browser, tmp_path: Path) -> None:
    (tmp_path / "there.json").write_text(DRAWN, encoding="utf-8")
    Image.new("RGB", (320, 200)).save(tmp_path / "small.png")
    page.choose("#open-lanes", tmp_path / "there.json")
    page.wait("file.lanes.length === 2")
    page.choose("#open-picture", tmp_path / "small.png")
    page.wait("picture.width === 320")
    problem = page.run("document.getElementById('problems').textContent")
    assert problem == "the picture is 320 x 200 and the lane file is for 640 x 400"
    assert page.run("document.getElementById('save').disabled") is True


def test_what_is_no_picture_and_no_lane_file_changes_nothing(page: Browser, tmp_path: Path) -> None:
    before = page.run("textOf(file)")
    for name, content, selector, words in [
        ("x.png", "rubbish", "#open-picture", "x.png is no picture"),
        ("x.json", "{", "#open-lanes", "x.json is no JSON"),
        ("y.json", '{"width": 5}', "#open-lanes", "y.json is no good lane file: width is 5"),
    ]:
        (tmp_path / name).write_text(content, encoding="utf-8")
        page.choose(selector, tmp_path / name)
        page.wait(f"document.getElementById('say').textContent.startsWith({json.dumps(words)})")
    assert page.run("textOf(file)") == before


# --- the same judgement as the programs' ------------------------------------------------------------------------------


def changed(work: Callable[[dict[str, Any]], object]) -> dict[str, Any]:
    lanes = copy.deepcopy(GOOD)
    work(lanes)
    return lanes


def at_lane(i: int, **values: Any) -> dict[str, Any]:
    return changed(lambda lanes: lanes["lanes"][i].update(values))


BAD: list[tuple[Any, str]] = [
    ([], "the file"),
    (changed(lambda f: f.update(speed=3)), "the file.speed"),
    (changed(lambda f: f.update(format="elmopp-lanes/2")), "format"),
    (changed(lambda f: f.pop("width")), "the file.width"),
    (changed(lambda f: f.update(width=15)), "width"),
    (changed(lambda f: f.update(width=16385)), "width"),
    (changed(lambda f: f.update(width=320.5)), "width"),
    (changed(lambda f: f.update(height="240")), "height"),
    (changed(lambda f: f.update(lanes=[])), "lanes"),
    (changed(lambda f: f.pop("lanes")), "the file.lanes"),
    (changed(lambda f: f["lanes"].append(7)), "lanes[3]"),
    (at_lane(0, naem="x"), "lanes[0].naem"),
    (at_lane(0, name=""), "lanes[0].name"),
    (at_lane(0, name=4), "lanes[0].name"),
    (at_lane(1, name="a"), "lanes[1].name"),
    (changed(lambda f: f["lanes"][1].pop("line")), "lanes[1].line"),
    (at_lane(1, line=[[1, 1]]), "lanes[1].line"),
    (at_lane(1, line=[[1, 1], [9, 1, 1]]), "lanes[1].line[1]"),
    (at_lane(1, line=[[1, 1], [9, "1"]]), "lanes[1].line[1]"),
    (at_lane(1, line=[[-1, 1], [9, 1]]), "lanes[1].line[0]"),
    (at_lane(1, line=[[1, 1], [320.5, 1]]), "lanes[1].line[1]"),
    (at_lane(1, line=[[1, 1], [4.9, 1]]), "lanes[1].line"),
    (at_lane(1, direction="left"), "lanes[1].direction"),
    (at_lane(1, direction="sideways"), "lanes[1].direction"),
    (at_lane(1, direction=None), "lanes[1].direction"),
    (at_lane(2, direction="up"), "lanes[2].direction"),
    (at_lane(1, zone=[[1, 1], [9, 9]]), "lanes[1].zone"),
    (at_lane(1, zone=[[1, 1], [9, 9], [17, 17]]), "lanes[1].zone"),
    (at_lane(1, zone=[[1, 1], [9, 9], [9, 300]]), "lanes[1].zone[2]"),
    (at_lane(1, zone=[[10, 10], [15, 10], [15, 15]]), "lanes[1].zone"),  # 12.5 pixels
    (at_lane(1, mask={}), "lanes[1].mask"),
    (at_lane(1, mask=[[[1, 1], [9, 9], [9, 300]]]), "lanes[1].mask[0][2]"),
    (at_lane(0, approach=8), "lanes[0].approach"),
    (at_lane(0, movement=3), "lanes[0].movement"),
    (at_lane(0, movement=-1), "lanes[0].movement"),
    (at_lane(1, movement=1), "lanes[1]"),
    (changed(lambda f: f.update(junction=[[1, 1], [9, 1]])), "junction"),
    (changed(lambda f: f.update(junction=[[1, 1], [9, 1], [9, 241]])), "junction[2]"),
    (changed(lambda f: f.update(reference="")), "reference"),
    (changed(lambda f: f.update(model=3)), "model"),
]
FINE: list[dict[str, Any]] = [
    GOOD,
    json.loads(DRAWN),
    changed(lambda f: f.pop("junction")),
    changed(lambda f: f.update(format="elmopp-lanes/1")),
    at_lane(1, line=[[0, 0], [320, 240]]),
    at_lane(1, line=[[1, 1], [5, 1]]),
    at_lane(1, mask=[]),
    at_lane(1, zone=[[10, 10], [14, 10], [14, 18]]),  # 16 pixels
    at_lane(2, line=[[200, 50], [215, 54.8]]),  # just across enough for "left"
    at_lane(1, name='ü / "quoted" <b>'),
]


def camera_says(lanes: Any, folder: Path) -> str:
    """Empty if the lane file is good; the source, which is not there, is looked at after it."""
    file = folder / "x.json"
    file.write_text(json.dumps(lanes), encoding="utf-8")
    done = subprocess.run(
        [CAMERA, "--source", "nowhere.avi", "--lanes", str(file), "--jsonl", "-"],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 2
    said = [line for line in done.stderr.splitlines() if line.startswith("elmopp-camera: ") and ": lane " not in line]
    found = re.match(rf"elmopp-camera: {re.escape(str(file))}: (.*)", said[0])
    return found[1] if found else ""


def test_a_good_file_is_good_to_all_three(browser: Browser, tmp_path: Path) -> None:
    visit(browser)
    for lanes in FINE:
        assert browser.run(f"checkFile({json.dumps(lanes)})") == [], lanes
        assert camera_says(lanes, tmp_path) == "", lanes
        assert draw_lanes.read_lanes(tmp_path / "x.json") == lanes
        # What is saved of it is it.
        assert json.loads(browser.run(f"textOf({json.dumps(lanes)})")) == lanes


def test_a_bad_file_is_bad_to_all_three_for_the_same_key(browser: Browser, tmp_path: Path) -> None:
    visit(browser)
    for lanes, key in BAD:
        ours = browser.run(f"checkFile({json.dumps(lanes)})")
        assert ours, key
        assert ours[0]["key"] == key
        said = camera_says(lanes, tmp_path)
        assert said.startswith(f"{key} ") or (key in said and "comes twice" in said), (key, said)
        with pytest.raises(draw_lanes.RequestError):
            draw_lanes.read_lanes(tmp_path / "x.json")


def test_what_will_hardly_work_is_said_by_page_and_program(browser: Browser, tmp_path: Path) -> None:
    visit(browser)
    for lane in ({"line": [[150, 150], [158, 150]]}, {"line": [[150, 236], [200, 236]]}, {"line": [[0, 1], [6, 1]]}):
        lanes = at_lane(1, **lane)
        ours = browser.run(f"warningsOf({json.dumps(lanes)})")
        file = tmp_path / "x.json"
        file.write_text(json.dumps(lanes), encoding="utf-8")
        command = [CAMERA, "--source", "nowhere.avi", "--lanes", str(file), "--jsonl", "-"]
        said = subprocess.run(command, capture_output=True, text=True, check=False).stderr.splitlines()
        theirs = [line.partition("x.json: ")[2] for line in said if "x.json: lane " in line]
        assert ours == theirs
        assert ours


# --- everybody can use it ---------------------------------------------------------------------------------------------


def picture(browser: Browser, name: str) -> None:
    folder = Path(os.environ.get("ELMOPP_PICTURES", "build/pictures"))
    folder.mkdir(parents=True, exist_ok=True)
    browser.picture(folder / f"{name}.png")


@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
def test_every_text_stands_out_and_every_control_has_a_name(page: Browser, tmp_path: Path, dark: bool) -> None:
    (tmp_path / "there.json").write_text(DRAWN.replace("[200, 250], [300, 250]", "[200, 397], [300, 397]"))
    page.choose("#open-lanes", tmp_path / "there.json")
    page.wait("file.lanes.length === 2")
    page.look(1280, 1400, dark=dark)
    page.run("document.getElementById('numbers').open = true")
    expect_contrast(page)
    names = expect_names(page)
    assert {"open-picture", "undo", "stage", "lanes", "name", "direction", "p-line-0-x", "save"} <= set(names)
    expect_fits(page)
    picture(page, "editor-dark" if dark else "editor-light")


def test_it_fits_on_a_telephone(page: Browser, tmp_path: Path) -> None:
    (tmp_path / "there.json").write_text(DRAWN, encoding="utf-8")
    page.choose("#open-lanes", tmp_path / "there.json")
    page.wait("file.lanes.length === 2")
    page.look(360, 780, scale=2.0)
    expect_fits(page)
    picture(page, "editor-phone")


# --- tools/edit-lanes -------------------------------------------------------------------------------------------------


@contextlib.contextmanager
def editing(*options: str) -> Iterator[tuple[int, subprocess.Popen[str]]]:
    command = [sys.executable, str(ROOT / "tools" / "edit-lanes"), "--port", "0", *options]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        line = process.stdout.readline()
        found = re.fullmatch(r"edit-lanes: http://127\.0\.0\.1:(\d+)/; ctrl-C ends it\n", line)
        assert found, line
        yield int(found[1]), process
        process.kill()


def ask(port: int, path: str, host: str | None = None) -> tuple[int, bytes]:
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=10)
    connection.request("GET", path, headers={"Host": host or f"localhost:{port}"})
    answer = connection.getresponse()
    return answer.status, answer.read()


def test_the_program_hands_over_picture_and_lane_file(browser: Browser, frame: Path, tmp_path: Path) -> None:
    out, file = tmp_path / "out", tmp_path / "äst.json"
    out.mkdir()
    file.write_text(DRAWN, encoding="utf-8")
    with editing("--frame", str(frame), "--lanes", str(file)) as (port, process):
        visit(browser, f"http://127.0.0.1:{port}/")
        browser.wait("picture !== null && file.lanes.length === 2")
        assert browser.run("[picture.width, picture.height]") == list(SIZE)
        assert browser.run("document.getElementById('file-name').value") == "äst.json"
        assert saved(browser, out, "äst.json") == DRAWN
        expect_quiet(browser, f"http://127.0.0.1:{port}/")
        assert ask(port, "/frame")[1] == frame.read_bytes()
        for path in ("/x", "/../edit_lanes.py", "/frame/.."):
            assert ask(port, path)[0] == 404
        for host in ("elsewhere.example", "localhost", f"localhost:{port + 1}"):
            assert ask(port, "/frame", host)[0] == 403
        process.send_signal(signal.SIGTERM)
        assert process.communicate(timeout=10) == ("", "")
        assert process.returncode == 0


def test_the_program_refuses_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bad = tmp_path / "bad.json"
    bad.write_text("{}", encoding="utf-8")
    with editing() as (port, _):
        for arguments, word in [
            (["--port", str(port)], f"--port {port}: cannot be had"),
            (["--port", "x"], '--port "x"'),
            (["--port", "65536"], "0 to 65535"),
            (["--frame", str(bad)], "bad.json"),
            (["--frame", "nowhere.png"], "--frame nowhere.png: is no picture that can be read: No such file"),
            (["--lanes", "nowhere.json"], "--lanes nowhere.json: cannot be read as JSON: No such file"),
            (["--lanes", str(bad)], "bad.json"),
        ]:
            assert edit_lanes.main(arguments) == 2
            error = capsys.readouterr().err
            assert word in error
            assert len(error.splitlines()) == 1
