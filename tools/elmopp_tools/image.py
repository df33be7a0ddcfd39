# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The envelope of a site or weights image, as firmware/include/elmopp/image.h reads it."""

import struct
import zlib

_ENVELOPE = struct.Struct("<4sIII")  # magic, version, length of the body, CRC-32 of the body


def envelope(magic: bytes, version: int, body: bytes) -> bytes:
    """The whole image."""
    return _ENVELOPE.pack(magic, version, len(body), zlib.crc32(body)) + body
