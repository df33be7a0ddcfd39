# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""docs/tour.md: every command in it runs; one that needs what is not here names programs, presets, options there are.

In the order of the page, in the project's root, with what the presets release and cortex-m4 have built. The emulated
board takes its time and is a test of its own (`others`, at night): that its log is the one in process is shown by
tests/board/test_loop.py every day.
"""

from __future__ import annotations

import re
import shlex
import shutil
import signal
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest
from elmopp_tools import tour_pictures
from PIL import Image, ImageChops, ImageStat

ROOT = Path(__file__).resolve().parents[2]
TOUR = ROOT / "docs" / "tour.md"
FIGURES = ROOT / "docs" / "figures"
OUT = ROOT / "out" / "tour"
KINDS = ("run", "install", "until ctrl-C", "bus", "board", "emulator")
MOST_BYTES = 150_000
MOST_DIFFERENCE = 8.0  # grey levels of 255, on the average: another version of the browser smooths letters otherwise


@dataclass(frozen=True)
class Command:
    """A line of a block."""

    text: str
    kind: str


def commands_of(text: str) -> list[Command]:
    commands = []
    for block in re.findall(r"^```sh\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
        first, *rest = block.splitlines()
        kind = first[2:] if first.startswith("# ") else "emulator" if first.startswith("qemu-") else "run"
        lines = rest if first.startswith("# ") else [first, *rest]
        commands += [Command(line, kind) for line in lines]
    return commands


COMMANDS = commands_of(TOUR.read_text(encoding="utf-8"))


def shell(command: str, timeout_s: float = 120.0) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["/bin/bash", "-c", command], cwd=ROOT, capture_output=True, text=True, check=False, timeout=timeout_s
    )


def succeed(command: str, timeout_s: float = 120.0) -> str:
    done = shell(command, timeout_s)
    assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
    return done.stdout + done.stderr


def stopped(command: str) -> None:
    """Runs until ctrl-C, and says where it is to be found."""
    with subprocess.Popen(
        shlex.split(command), cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        line = process.stdout.readline()
        process.send_signal(signal.SIGINT)
        said = process.communicate(timeout=30)[1]
        assert re.search(r"http://127\.0\.0\.1:\d+/", line), said
        assert (process.returncode, said) == (0, "")


def known_options(command: str) -> None:
    """Program, subcommand and options are in the program's own help."""
    program, *words = shlex.split(command)
    shown = shell(f"{shlex.quote(program)} --help")
    assert shown.returncode == 0, shown.stderr
    for option in (word for word in words if word.startswith("-")):
        assert re.search(rf"(^|[\s,\[]){re.escape(option)}\b", shown.stdout), f"{program} --help knows no {option}"


def dry(command: str) -> None:
    """The same without doing it."""
    words = shlex.split(command)
    if words[:2] == ["git", "clone"]:
        assert "git" in succeed("git --version")
    elif words[0] == "./tools/setup":
        assert f"  {words[1]} " in succeed("./tools/setup --help")
    elif words[:2] == ["cmake", "--build"]:
        succeed(f"{command} -- -n")
    elif words[:2] == ["cmake", "--preset"]:
        assert f'"{words[2]}"' in succeed("cmake --list-presets")
        for name in re.findall(r"-D(\w+)=", command):
            cache = (ROOT / "build" / words[2] / "CMakeCache.txt").read_text(encoding="utf-8")
            assert re.search(rf"^{name}:", cache, re.MULTILINE), f"{name} is no option of the preset {words[2]}"
    else:
        raise AssertionError(f"the test knows no way to try without doing it: {command}")


def test_the_page_is_read_as_it_says() -> None:
    assert len(COMMANDS) > 25
    assert {command.kind for command in COMMANDS} == set(KINDS)
    assert COMMANDS[0].text.startswith("git clone")
    assert commands_of("a\n```sh\n# bus\nx --y\nz\n```\n```sh\nw\n```\n") == [
        Command("x --y", "bus"),
        Command("z", "bus"),
        Command("w", "run"),
    ]


@pytest.fixture(scope="module")
def from_the_beginning() -> None:
    shutil.rmtree(OUT, ignore_errors=True)


@pytest.mark.usefixtures("from_the_beginning")
@pytest.mark.parametrize(
    "command", [each for each in COMMANDS if each.kind != "emulator"], ids=lambda command: command.text[:50]
)
def test_every_command_runs(command: Command) -> None:
    if command.kind == "run":
        succeed(command.text)
    elif command.kind == "until ctrl-C":
        stopped(command.text)
    elif command.kind == "bus":
        known_options(command.text)
    else:
        dry(command.text)


def test_the_tour_has_written_what_it_says() -> None:
    for name in ("run.jsonl", "report.html", "choosers.html", "mine.bin", "counts.jsonl", "lanes.png", "seen.png"):
        assert (OUT / name).stat().st_size > 0
    assert len((OUT / "run.jsonl").read_text(encoding="utf-8").splitlines()) == 600


@pytest.mark.others
def test_the_emulated_board_decides_what_the_same_code_decides_here() -> None:
    commands = [each.text for each in COMMANDS if each.kind == "emulator"]
    assert len(commands) == 5
    OUT.mkdir(parents=True, exist_ok=True)
    try:
        for command in commands:
            succeed(command, timeout_s=600.0)
    finally:
        shell('kill "$(cat out/tour/board.pid)"')
    assert len((OUT / "board.jsonl").read_text(encoding="utf-8").splitlines()) == 20


def test_the_pictures_are_those_of_today(tmp_path: Path) -> None:
    assert tour_pictures.main(["--out", str(tmp_path)]) == 0
    named = set(re.findall(r"\]\(figures/(tour-[\w-]+\.png)\)", TOUR.read_text(encoding="utf-8")))
    assert named == {path.name for path in FIGURES.glob("tour-*.png")} == {path.name for path in tmp_path.glob("*.png")}
    for name in named:
        assert (FIGURES / name).stat().st_size < MOST_BYTES
        there, fresh = (Image.open(folder / name).convert("L") for folder in (FIGURES, tmp_path))
        assert there.size == fresh.size, name
        assert ImageStat.Stat(ImageChops.difference(there, fresh)).mean[0] < MOST_DIFFERENCE, name


def test_pictures_that_cannot_be_made_are_refused_in_one_line(tmp_path: Path) -> None:
    for arguments, word in [(["--tour", str(tmp_path)], "report.html is missing"), (["--out", "nowhere"], "nowhere")]:
        command = [sys.executable, str(ROOT / "tools" / "tour-pictures"), *arguments]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert (done.returncode, done.stdout) == (2, "")
        assert word in done.stderr
        assert len(done.stderr.splitlines()) == 1
