#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""seal_image.py IMAGE: writes the checksum of a board's program into its section .seal (firmware/port/cortex_m/seal.h).

IMAGE is a 32-bit little-endian ELF file. Summed up is what lies in flash before the seal, by the addresses
that it is loaded to. Standard library only.
"""

import struct
import sys
import zlib
from pathlib import Path

ELF_HEADER = struct.Struct("<16sHHIIIIIHHHHHH")
PROGRAM_HEADER = struct.Struct("<IIIIIIII")
SECTION_HEADER = struct.Struct("<IIIIIIIIII")
LOADED = 1


class ImageError(Exception):
    """The text says what is wrong."""


def seal(elf: bytearray) -> int:
    """Seals the image in place; returns the sum."""
    header = ELF_HEADER.unpack_from(elf)
    if header[0][:6] != b"\x7fELF\x01\x01":
        raise ImageError("no 32-bit little-endian ELF file")
    at = seal_in_file(elf, header)
    segments = [PROGRAM_HEADER.unpack_from(elf, header[5] + k * header[9]) for k in range(header[10])]
    pieces = sorted((paddr, offset, size) for kind, offset, _, paddr, size, *_ in segments if kind == LOADED and size)
    end = next((paddr + at - offset for paddr, offset, size in pieces if offset <= at < offset + size), None)
    if end is None:
        raise ImageError("its section .seal is not loaded")
    begin = pieces[0][0]
    flash = bytearray(end - begin)
    for paddr, offset, size in pieces:
        if paddr < end:
            piece = elf[offset : offset + min(size, end - paddr)]
            flash[paddr - begin : paddr - begin + len(piece)] = piece
    checksum = zlib.crc32(flash)
    struct.pack_into("<I", elf, at, checksum)
    return checksum


def seal_in_file(elf: bytearray, header: tuple[object, ...]) -> int:
    """Where in the file the section .seal is."""
    table, size, count, names = (int(str(header[k])) for k in (6, 11, 12, 13))
    sections = [SECTION_HEADER.unpack_from(elf, table + k * size) for k in range(count)]
    strings = sections[names][4]
    for name, _, _, _, offset, *_ in sections:
        if bytes(elf[strings + name : strings + name + 6]) == b".seal\0":
            return int(offset)
    raise ImageError("it has no section .seal")


def main() -> int:
    """Runs the command; returns its exit code."""
    if len(sys.argv) != 2:
        print("seal_image.py: right would be seal_image.py IMAGE", file=sys.stderr)
        return 2
    path = Path(sys.argv[1])
    try:
        elf = bytearray(path.read_bytes())
        seal(elf)
        path.write_bytes(elf)
    except (OSError, ImageError, struct.error) as error:
        print(f"seal_image.py: {path}: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
