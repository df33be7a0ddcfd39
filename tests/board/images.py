# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Images for the emulated board: sites made by tools/site from sites/ with another chooser and a quick start-up, and
weights like the shipped ones.
"""

import re
import struct
import subprocess
import sys
import zlib
from collections.abc import Callable
from pathlib import Path

from emulator import ROOT


def tool(name: str, *words: str) -> None:
    """Runs a program of tools/."""
    done = subprocess.run(
        [sys.executable, f"tools/{name}", *words], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


def site_image(folder: Path, chooser: str, name: str = "four_way") -> Path:
    """A site with this chooser, in whole numbers or learning on if its forecast says so, that starts quickly."""
    rule, _, forecast = chooser.partition(":")
    network, _, how = forecast.partition("-")
    learning = "\nlearning = true" if how == "learn" else ""
    arithmetic = "q15" if how == "q15" else "float"
    text = (ROOT / "sites" / f"{name}.toml").read_text(encoding="utf-8")
    text = re.sub(r"^chooser = .*$", f'chooser = "{rule}"', text, flags=re.MULTILINE)
    text = re.sub(r"^arithmetic = .*$", f'arithmetic = "{arithmetic}"', text, flags=re.MULTILINE)
    quick = f'forecast = "{network or "none"}"{learning}\nstart_flash_s = 1\nstart_red_s = 1'
    text = re.sub(r"^forecast = .*$", quick, text, flags=re.MULTILINE)
    toml = folder / "site.toml"
    toml.write_text(text, encoding="utf-8")
    tool("site", str(toml), "--image", str(folder / "site.bin"))
    return folder / "site.bin"


def changed_weights(folder: Path, at: int, change: Callable[[float], float]) -> Path:
    """The shipped weights with another number at a place of the image, as a whole image."""
    image = folder / "weights.bin"
    tool("weights", "weights/forecast.safetensors", "--image-lstm", str(image))
    data = bytearray(image.read_bytes())
    place = at % len(data)
    struct.pack_into("<f", data, place, change(struct.unpack_from("<f", data, place)[0]))
    struct.pack_into("<I", data, 12, zlib.crc32(data[16:]))
    image.write_bytes(data)
    return image


def with_flipped_bit(image: Path, at: int) -> Path:
    """A copy of a file in which one bit is another."""
    data = bytearray(image.read_bytes())
    data[at] ^= 0x10
    copy = image.with_name(f"flipped-{at}-{image.name}")
    copy.write_bytes(data)
    return copy
