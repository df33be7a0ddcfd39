# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""Target flash: with OpenOCD, with st-flash, and with neither; the programmers are pretended."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

FLASH = Path(__file__).resolve().parents[2] / "firmware" / "port" / "stm32f4" / "flash.sh"


def pretend(folder: Path, name: str, status: int = 0) -> None:
    program = folder / name
    program.write_text(f'#!/bin/sh\necho "{name} $*"\nexit {status}\n', encoding="utf-8")
    program.chmod(0o755)


@pytest.fixture
def image(tmp_path: Path) -> Path:
    file = tmp_path / "elmopp-stm32f4"
    file.write_bytes(b"\x7fELF")
    pretend(tmp_path, "objcopy")
    return file


def flash(image: Path, programmers: Path) -> subprocess.CompletedProcess[str]:
    command = ["/bin/sh", str(FLASH), str(image), str(image.parent / "objcopy")]
    return subprocess.run(command, check=False, env={"PATH": str(programmers)}, capture_output=True, text=True)


def test_openocd_programs_verifies_and_starts(image: Path, tmp_path: Path) -> None:
    pretend(tmp_path, "openocd")
    pretend(tmp_path, "st-flash")
    done = flash(image, tmp_path)
    assert done.returncode == 0
    assert (
        done.stdout
        == f"openocd -f interface/stlink.cfg -f target/stm32f4x.cfg -c program {{{image}}} verify reset exit\n"
    )


def test_st_flash_writes_the_bytes_to_where_flash_begins(image: Path, tmp_path: Path) -> None:
    pretend(tmp_path, "st-flash")
    done = flash(image, tmp_path)
    assert done.returncode == 0
    assert done.stdout.splitlines() == [
        f"objcopy -O binary {image} {image}.bin",
        f"st-flash --reset write {image}.bin 0x08000000",
    ]


@pytest.mark.parametrize("name", ["openocd", "st-flash"])
def test_a_programmer_that_fails_is_a_failure(image: Path, tmp_path: Path, name: str) -> None:
    pretend(tmp_path, name, status=3)
    assert flash(image, tmp_path).returncode == 1


def test_without_a_programmer_one_line_says_what_would_be_right(image: Path, tmp_path: Path) -> None:
    done = flash(image, tmp_path / "nothing")
    assert done.returncode == 2
    assert done.stderr == (
        "flash: neither openocd nor st-flash is installed; right would be one of them, on Debian apt-get install "
        "openocd or stlink-tools\n"
    )


def test_an_image_that_is_not_there_is_named(tmp_path: Path) -> None:
    done = flash(tmp_path / "none", tmp_path)
    assert done.returncode == 2
    assert done.stderr == f"flash: {tmp_path / 'none'} cannot be read; right would be flash.sh IMAGE OBJCOPY\n"
