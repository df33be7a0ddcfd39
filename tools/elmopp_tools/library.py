# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""libelmopp.so from Python: one junction, counts in, lamps out. library/elmopp.h is the manual."""

import ctypes
import os
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from types import TracebackType
from typing import Self

ROOT = Path(__file__).resolve().parents[2]

ABI_VERSION = 1
NO_STAGE = -1
TRAVEL_OF_SITE = 0xFFFFFFFF
ASPECT_BYTES = 17
MESSAGE_BYTES = 256
FORESEEN_MAX_S = 150
REFUSED = 1
FAULT = 2

# Of the source tree around this file, the fastest first, and of an installed copy (PREFIX/share/elmopp/tools).
_PLACES = (
    ROOT / "build" / "release" / "lib" / "libelmopp.so",
    ROOT / "build" / "host" / "lib" / "libelmopp.so",
    ROOT.parents[1] / "lib" / "libelmopp.so.1",
)


class LibraryError(Exception):
    """The library is not there, is another one, or refuses a request; the text says what would be right."""


class FaultError(Exception):
    """The conflict monitor has found a fault."""


class _Options(ctypes.Structure):
    _fields_ = (
        ("size", ctypes.c_uint32),
        ("site_bytes", ctypes.c_uint32),
        ("site", ctypes.c_char_p),
        ("chooser", ctypes.c_char_p),
        ("weights", ctypes.c_char_p),
        ("weights_bytes", ctypes.c_uint32),
        ("travel_s", ctypes.c_uint32),
        ("seed", ctypes.c_uint64),
    )


class Announced(ctypes.Structure):
    """What the neighbour of an approach says of those who have left it; nothing at all by default."""

    _fields_ = tuple((name, ctypes.c_float) for name in ("next10_veh", "next30_veh", "next60_veh", "ahead_s"))
    next10_veh: float
    next30_veh: float
    next60_veh: float
    ahead_s: float


class _Second(ctypes.Structure):
    _fields_ = (
        ("size", ctypes.c_uint32),
        ("recall", ctypes.c_uint32),
        ("present_veh", ctypes.POINTER(ctypes.c_float)),
        ("arrived_veh", ctypes.POINTER(ctypes.c_float)),
        ("downstream_veh", ctypes.POINTER(ctypes.c_float)),
        ("occupied", ctypes.c_uint32),
        ("announced", ctypes.POINTER(Announced)),
        ("foreseen_veh", ctypes.POINTER(ctypes.c_float)),
        ("foreseen_s", ctypes.c_uint32),
    )


class Shape(ctypes.Structure):
    """How many approaches, movements, groups and stages a junction has."""

    _fields_ = tuple((name, ctypes.c_uint32) for name in ("size", "approaches", "movements", "groups", "stages"))
    approaches: int
    movements: int
    groups: int
    stages: int


@cache
def load(place: Path | None = None) -> ctypes.CDLL:
    """The library at a place, at $ELMOPP_LIBRARY, or the first one found.

    LibraryError if there is none or it is of another version.
    """
    named = os.environ.get("ELMOPP_LIBRARY")
    place = place or (Path(named) if named else None)
    found = [path for path in ((place,) if place else _PLACES) if path.exists()]
    if not found:
        looked = place or _PLACES[0]
        raise LibraryError(f"{looked} is missing ; make it with cmake --workflow --preset release, or name another")
    library = ctypes.CDLL(str(found[0]))
    if library.elmopp_abi_version() != ABI_VERSION:
        version = library.elmopp_abi_version()
        raise LibraryError(f"{found[0]} has interface {version} ; this program needs interface {ABI_VERSION}")
    _declare(library)
    return library


def _declare(library: ctypes.CDLL) -> None:
    handle = ctypes.c_void_p
    library.elmopp_open.restype = handle
    library.elmopp_open.argtypes = (ctypes.POINTER(_Options), ctypes.c_char_p, ctypes.c_uint32)
    library.elmopp_close.argtypes = (handle,)
    library.elmopp_close.restype = None
    library.elmopp_shape.argtypes = (handle, ctypes.POINTER(Shape))
    library.elmopp_count.argtypes = (handle, ctypes.POINTER(_Second))
    library.elmopp_tick.argtypes = (handle, ctypes.c_int32, ctypes.c_char_p)
    for name in ("elmopp_stage", "elmopp_target", "elmopp_wish"):
        getattr(library, name).argtypes = (handle,)
        getattr(library, name).restype = ctypes.c_int32
    for name in ("elmopp_stage_groups", "elmopp_served"):
        getattr(library, name).argtypes = (handle, ctypes.c_uint32)
        getattr(library, name).restype = ctypes.c_uint32
    for name in ("elmopp_score", "elmopp_foreseen_veh"):
        getattr(library, name).argtypes = (handle, ctypes.c_uint32)
        getattr(library, name).restype = ctypes.c_float
    library.elmopp_fault.argtypes = (handle,)
    library.elmopp_fault.restype = ctypes.c_char_p


class CoreJunction:
    """One junction. Close it, or use it in a with statement."""

    def __init__(
        self,
        site: bytes,
        chooser: str | None = None,
        *,
        travel_s: int = TRAVEL_OF_SITE,
        seed: int = 0,
        weights: bytes | None = None,
        library: Path | None = None,
    ) -> None:
        self._library = load(library)
        options = _Options(
            size=ctypes.sizeof(_Options),
            site_bytes=len(site),
            site=site,
            chooser=None if chooser is None else chooser.encode(),
            weights=weights,
            weights_bytes=len(weights or b""),
            travel_s=travel_s,
            seed=seed,
        )
        message = ctypes.create_string_buffer(MESSAGE_BYTES)
        self._handle = self._library.elmopp_open(ctypes.byref(options), message, MESSAGE_BYTES)
        if not self._handle:
            raise LibraryError(message.value.decode(errors="replace"))
        self.shape = Shape(size=ctypes.sizeof(Shape))
        self._library.elmopp_shape(self._handle, ctypes.byref(self.shape))
        row = ctypes.c_float * max(1, self.shape.movements)
        self._rows = (row(), row(), row())
        self._announced = (Announced * max(1, self.shape.approaches))()
        self._oracle = (chooser or "").endswith(":oracle")
        self._foreseen = (ctypes.c_float * (max(1, self.shape.approaches) * FORESEEN_MAX_S))()
        self._second = _Second(ctypes.sizeof(_Second), 0, *self._rows, 0, self._announced, self._foreseen, 0)
        self._aspects = ctypes.create_string_buffer(ASPECT_BYTES)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Frees the junction; a second time it does nothing."""
        handle, self._handle = self._handle, None
        self._library.elmopp_close(handle)

    def count(
        self,
        present_veh: Sequence[float],
        arrived_veh: Sequence[float],
        downstream_veh: Sequence[float] | None = None,
        recall: int = 0,
        *,
        occupied: bool = False,
        announced: Sequence[Announced] = (),
        foreseen_veh: Sequence[Sequence[float]] = (),
    ) -> None:
        """Takes one second's counts, a value a movement; LibraryError for values that are no counts.

        `occupied`: somebody is known to stand inside the junction. `announced`: what neighbours say, a value an
        approach, or none at all. `foreseen_veh`: who will come, a row of seconds an approach, all of one length: for
        the forecast oracle and nobody else.
        """
        nothing = [0.0] * self.shape.movements
        for row, values in zip(self._rows, (present_veh, arrived_veh, downstream_veh or nothing), strict=True):
            row[: self.shape.movements] = list(values)
        self._second.recall, self._second.occupied = recall, occupied
        self._announced[: self.shape.approaches] = list(announced) or [Announced()] * self.shape.approaches
        self._foresee(foreseen_veh)
        if self._library.elmopp_count(self._handle, ctypes.byref(self._second)) == REFUSED:
            counts = ", ".join(str(list(row[: self.shape.movements])) for row in self._rows)
            raise LibraryError(f"counts {counts} ; finite numbers from 0 to a million")

    def _foresee(self, rows_veh: Sequence[Sequence[float]]) -> None:
        """Lays the rows one after another, as the library wants them."""
        seconds = len(rows_veh[0]) if rows_veh else 0
        if bool(rows_veh) != self._oracle:
            right = "a row of seconds an approach" if self._oracle else "none, or forecast oracle"
            raise LibraryError(f"{len(rows_veh)} foreseen rows ; {right}")
        if any(len(row) != seconds for row in rows_veh) or len(rows_veh) not in (0, self.shape.approaches):
            lengths = [len(row) for row in rows_veh]
            raise LibraryError(f"foreseen rows of {lengths} seconds ; {self.shape.approaches} of one length")
        if rows_veh and not 1 <= seconds <= FORESEEN_MAX_S:
            raise LibraryError(f"foreseen rows of {seconds} seconds ; 1 to {FORESEEN_MAX_S}")
        self._foreseen[: seconds * len(rows_veh)] = [veh for row in rows_veh for veh in row]
        self._second.foreseen_s = seconds

    def tick(self, wish: int = NO_STAGE) -> str:
        """Moves the lamps by 100 ms: the aspect of every group, one digit each."""
        answer = self._library.elmopp_tick(self._handle, wish, self._aspects)
        if answer == REFUSED:
            raise LibraryError(f"wish {wish} ; a stage below {self.shape.stages}, or {NO_STAGE}")
        if answer == FAULT:
            raise FaultError(self._library.elmopp_fault(self._handle).decode())
        return self._aspects.value.decode()

    @property
    def stage(self) -> int:
        """The stage that is shown, or NO_STAGE."""
        return int(self._library.elmopp_stage(self._handle))

    @property
    def target(self) -> int:
        """The stage that is shown or being brought up, or NO_STAGE."""
        return int(self._library.elmopp_target(self._handle))

    @property
    def wish(self) -> int:
        """The stage that the chooser wishes, or NO_STAGE."""
        return int(self._library.elmopp_wish(self._handle))

    def stage_groups(self, stage: int) -> int:
        """Mask of the groups that are green in a stage."""
        return int(self._library.elmopp_stage_groups(self._handle, stage))

    def served(self, groups: int) -> int:
        """Mask of the movements that go when exactly these groups are green."""
        return int(self._library.elmopp_served(self._handle, groups))

    def score(self, stage: int) -> float:
        """The chooser's score of a stage in the last second."""
        return float(self._library.elmopp_score(self._handle, stage))

    def foreseen_veh(self, approach: int) -> float:
        """The vehicles that an approach is to get in the next 60 s."""
        return float(self._library.elmopp_foreseen_veh(self._handle, approach))
