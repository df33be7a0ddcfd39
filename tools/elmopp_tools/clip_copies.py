# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Changed copies of clips with counted truth: what a change of the picture does to the truth.

The pictures are changed by the program copy_clip (tests/perception/copy_clip.cpp), which knows the kinds by name.
"""

from __future__ import annotations

import copy
import json
import math
import os
import subprocess
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

KINDS = (
    "noise", "light", "dark", "dusk", "fog", "blur", "shake", "drift", "compressed", "half", "third", "mirrored",
    "turned", "small", "reversed", "stopped", "against",
)  # fmt: skip

STOPPED_FRAMES = 900  # of copy_clip
TURNED = {"up": "left", "down": "right", "left": "up", "right": "down"}
BACKWARDS = {"up": "down", "down": "up", "left": "right", "right": "left"}
MIRRORED = {"up": "up", "down": "down", "left": "right", "right": "left"}

Truth = dict[str, Any]


class CopyError(Exception):
    """A copy could not be made."""


def _frames(truth: Truth, to: Callable[[int], int]) -> None:
    for key in ("crossings", "uncertain", "present"):
        for row in truth.get(key, []):
            row["frame"] = to(row["frame"])
        truth.get(key, []).sort(key=lambda row: row["frame"])


def _points(truth: Truth, to: Callable[[float, float], list[float]], words: Mapping[str, str]) -> None:
    for lane in truth["lanes"]:
        lane["line"] = [to(x, y) for x, y in lane["line"]]
        if "zone" in lane:
            lane["zone"] = [to(x, y) for x, y in lane["zone"]]
        lane["direction"] = words[lane["direction"]]


def _slower(truth: Truth, times: int) -> None:
    _frames(truth, lambda frame: round(frame / times))
    truth["count_from"] = math.ceil(truth["count_from"] / times)
    truth["count_to"] //= times
    truth["frame_tolerance"] = math.ceil(truth["frame_tolerance"] / times)


def _reversed(truth: Truth) -> None:
    last = truth["frames"] - 1
    _frames(truth, lambda frame: last - frame)
    truth["count_from"], truth["count_to"] = last - truth["count_to"], last - truth["count_from"]
    _points(truth, lambda x, y: [x, y], BACKWARDS)


def _stopped(truth: Truth) -> None:
    at = stop_frame(truth)
    _frames(truth, lambda frame: frame + (STOPPED_FRAMES if frame > at else 0))
    truth["count_to"] += STOPPED_FRAMES


def _against(truth: Truth) -> None:
    """The clip backwards with the lanes as they are: nobody crosses in their direction."""
    for key in ("crossings", "uncertain", "present"):
        truth[key] = []
    truth["total"], truth["totals"] = 0, {}
    truth["count_from"], truth["count_to"] = 0, truth["frames"] - 1


def stop_frame(truth: Mapping[str, Any]) -> int:
    """Where a clip is stopped: with the vehicle on the line that is in the middle of its list."""
    crossings = truth["crossings"]
    return int(crossings[len(crossings) // 2]["frame"]) if crossings else int(truth["frames"]) // 2


def changed_truth(truth: Mapping[str, Any], kind: str) -> Truth:
    """The truth of a clip's copy."""
    new = copy.deepcopy(dict(truth))
    if kind in ("half", "third"):
        _slower(new, 2 if kind == "half" else 3)
    elif kind == "mirrored":
        _points(new, lambda x, y: [truth["width"] - 1 - x, y], MIRRORED)
    elif kind == "turned":
        new["width"], new["height"] = truth["height"], truth["width"]
        _points(new, lambda x, y: [y, x], TURNED)
    elif kind == "small":
        new["width"], new["height"] = truth["width"] // 4 * 2, truth["height"] // 4 * 2  # even, as a video has it
        _points(new, lambda x, y: [x / 2, y / 2], {word: word for word in TURNED})
    elif kind == "reversed":
        _reversed(new)
    elif kind == "stopped":
        _stopped(new)
    elif kind == "against":
        _against(new)
    return new


def program() -> Path:
    """copy_clip, as it was built or as ELMOPP_COPY_CLIP names it."""
    root = Path(__file__).resolve().parents[2]
    places = [Path(os.environ.get("ELMOPP_COPY_CLIP", ""))]
    places += [root / "build" / preset / "bin" / "tests" / "copy_clip" for preset in ("release", "host")]
    for place in places:
        if place.is_file():
            return place
    raise CopyError("copy_clip is not built; run: cmake --preset host && cmake --build build/host --target copy_clip")


def copy_clip(video: Path, truth: Mapping[str, Any], kind: str, folder: Path, name: str) -> None:
    """Writes NAME.avi and NAME.json, a copy of a clip, into a folder."""
    out = folder / f"{name}.avi"
    pictures = "reversed" if kind == "against" else kind
    command = [str(program()), str(video), str(out), pictures, str(stop_frame(truth))]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise CopyError(f"{video}: cannot be copied as {kind}: {done.stderr.strip()}")
    new = changed_truth(truth, kind)
    new["video"] = out.name
    (folder / f"{name}.json").write_text(json.dumps(new), encoding="utf-8")
