# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Runs elmopp-camera over clips with counted truth and scores it.

One set of defaults for all clips; the lane files come from the truth files.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple, NoReturn

from elmopp_tools import clip_copies
from elmopp_tools.count_scores import Counted, Event, pooled, presence_error, score_crossings, wrong_events
from elmopp_tools.outputs import why_not_writable
from elmopp_tools.truth_file import RequestError, read_truth

EXIT_DONE = 0
EXIT_FAILED = 1
EXIT_REFUSED = 2

ROOT = Path(__file__).resolve().parents[2]
NO_FLAGS = frozenset({"ok", "learning"})
LEARNT_S = 3.9  # every clip learns for 3 s, and roads are made of that in 0.7 s; records come once a second

DESCRIPTION = """\
Scores the camera counter on clips whose vehicles were counted by eye (truth files lane-count-truth/1, one beside each
video): count error, lane error and F1 of the crossings, error of the vehicles present, flags, speed and memory."""

EPILOG = """\
Exit codes: 0 done; 1 the counter failed on a clip; 2 the request cannot be run.

Examples:
  tools/score-counter --clips clips --json scores.json        every clip of a folder
  tools/score-counter --write-lanes clips/a.json a.lanes.json the lane file of one"""


class ScoreFailedError(Exception):
    """The counter ended badly."""


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        self.exit(EXIT_REFUSED, f"score-counter: {message} (score-counter --help)\n")


def lanes_of(truth: Mapping[str, Any]) -> dict[str, Any]:
    """The lane file of a clip: geometry and nothing else."""
    keys = ("name", "line", "direction", "zone", "mask")
    lanes = [{key: lane[key] for key in keys if key in lane} for lane in truth["lanes"]]
    return {"width": truth["width"], "height": truth["height"], "lanes": lanes}


def camera_program(given: str | None) -> Path:
    """The program to score: the one that was asked for, or the best that was built."""
    if given:
        if not os.access(given, os.X_OK):
            raise RequestError(f"--camera {given}: is no program; right would be a built elmopp-camera")
        return Path(given)
    places = [ROOT / "build" / preset / "bin" / "elmopp-camera" for preset in ("release", "host")]
    for place in places:
        if os.access(place, os.X_OK):
            return place
    raise RequestError("elmopp-camera is not built; run: cmake --preset release && cmake --build --preset release")


def json_lines(file: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]


def run_camera(
    program: Path, video: Path, truth: Mapping[str, Any], folder: Path, tries: Sequence[str] = ()
) -> dict[str, Any]:
    """What the program says of a video: crossings, records, timing."""
    lanes = folder / "lanes.json"
    lanes.write_text(json.dumps(lanes_of(truth)), encoding="utf-8")
    files = {name: folder / f"{name}.jsonl" for name in ("crossings", "jsonl", "timing")}
    command = [str(program), "--source", str(video), "--lanes", str(lanes)]
    for name, file in files.items():
        command += [f"--{name}", str(file)]
    for one in tries:
        command += ["--try", one]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError as error:
        raise ScoreFailedError(f"{program}: cannot be run: {error.strerror}") from None
    if done.returncode != 0:
        raise ScoreFailedError(f"{video}: elmopp-camera ended with {done.returncode}: {done.stderr.strip()}")
    return {name: json_lines(file) for name, file in files.items()}


def flags_of(said: Mapping[str, Any]) -> list[str]:
    """What a camera of which all is well never says."""
    return sorted({lane["reason"] for r in said["jsonl"] for lane in r["lanes"].values()} - NO_FLAGS)


def learns_long(said: Mapping[str, Any]) -> bool:
    """True if a lane is `learning` in a record after the seconds in which every clip is."""
    begun_s = said["jsonl"][0]["t_s"]
    later = [record for record in said["jsonl"] if record["t_s"] >= begun_s + LEARNT_S]
    return any(lane["reason"] == "learning" for record in later for lane in record["lanes"].values())


def score_clip(truth: Mapping[str, Any], said: Mapping[str, Any]) -> tuple[dict[str, Any], Any]:
    """One clip's entry of the report, and its sums for the pool."""
    events = [Event(c["frame"], c["lane"]) for c in said["crossings"]]
    counted = score_crossings(truth, events)
    present = [(r["frame"], {name: lane["present"] for name, lane in r["lanes"].items()}) for r in said["jsonl"]]
    timing = said["timing"][0]
    entry = {
        "truth": counted.truth,
        "counted": counted.counted,
        "count_error": counted.count_error,
        "lane_error": counted.lane_error,
        "f1": counted.f1,
        "wrong_events": counted.wrong_events,
        "presence_error": presence_error(truth, present),
        "learning": learns_long(said),
        "flags": flags_of(said),
        "fps": round(timing["frames"] / timing["cpu_s"], 1) if timing["cpu_s"] > 0 else None,
        "p99_ms": round(timing["p99_ms"], 3),
        "rss_mb": round(timing["rss_mb"], 1),
    }
    return entry, counted


def all_truths(clips: Path) -> dict[str, dict[str, Any]]:
    """The clips of a folder, all of them read before the first one runs."""
    if not clips.is_dir():
        raise RequestError(f"--clips {clips}: is no folder; right would be one with videos and truth files")
    truths = {}
    for file in sorted(clips.glob("*.json")):
        truth = read_truth(file)
        video = clips / truth["video"]
        if not video.is_file():
            raise RequestError(f"{file}: its video {video} is not there")
        truths[file.stem] = truth
    if not truths:
        raise RequestError(f"--clips {clips}: holds no truth file (*.json)")
    return truths


def score_folder(program: Path, clips: Path, verbose: bool) -> dict[str, Any]:
    report: dict[str, Any] = {"clips": {}}
    sums = []
    for name, truth in all_truths(clips).items():
        with tempfile.TemporaryDirectory() as folder:
            said = run_camera(program, clips / truth["video"], truth, Path(folder))
        report["clips"][name], counted = score_clip(truth, said)
        sums.append(counted)
        if verbose:
            missed, false = wrong_events(truth, [Event(c["frame"], c["lane"]) for c in said["crossings"]])
            for word, wrong in (("missed", missed), ("false", false)):
                print(f"{name}: {word} {' '.join(f'{e.frame}:{e.lane}' for e in wrong) or 'none'}")
    report["pooled"] = pooled(sums)
    return report


# Steps to both sides of the defaults (perception/settings.hpp), one at a time.
GRID = (
    (), ("texture=0.05",), ("texture=0.09",), ("density=0.15",), ("density=0.25",), ("covered=0.4",), ("covered=0.6",),
    ("neck=0.68",), ("neck=0.8",), ("joined=1.4",), ("joined=1.8",), ("fragment=0.4",), ("fragment=0.6",),
)  # fmt: skip


def truths_of(clips: Path) -> dict[str, dict[str, Any]]:
    """The clips with crossings of a folder; RequestError if there are not two."""
    truths = {name: truth for name, truth in all_truths(clips).items() if truth["total"]}
    if len(truths) < 2:
        raise RequestError(f"--clips {clips}: holds {len(truths)} clips with crossings; right would be two or more")
    return truths


class Scored(NamedTuple):
    """What a clip was counted as, and what the camera said was wrong."""

    counted: Counted
    flags: list[str]


def counted_with(
    program: Path, clips: Path, truths: Mapping[str, Mapping[str, Any]], tries: Sequence[str]
) -> dict[str, Scored]:
    """What becomes of each clip with these settings in place of the defaults."""
    counted = {}
    for name, truth in truths.items():
        with tempfile.TemporaryDirectory() as folder:
            said = run_camera(program, clips / truth["video"], truth, Path(folder), tries)
        crossings = score_crossings(truth, [Event(c["frame"], c["lane"]) for c in said["crossings"]])
        counted[name] = Scored(crossings, flags_of(said))
    return counted


def leave_one_out(program: Path, clips: Path) -> dict[str, Any]:
    """Each clip with the settings that are best on the others: the F1 first, then the lane error, then the defaults."""
    truths = truths_of(clips)
    found = {
        " ".join(tries) or "defaults": {
            name: scored.counted for name, scored in counted_with(program, clips, truths, tries).items()
        }
        for tries in GRID
    }
    report: dict[str, Any] = {"clips": {}}
    left_out = []
    for name in truths:

        def worth(settings: str, without: str = name) -> tuple[float, float]:
            rest = pooled([one for clip, one in found[settings].items() if clip != without])
            return (rest["f1"] or 0.0, -(rest["lane_error"] or 0.0))

        best = max(found, key=worth)
        one = found[best][name]
        left_out.append(one)
        report["clips"][name] = {
            "chosen": best, "truth": one.truth, "counted": one.counted, "lane_error": one.lane_error, "f1": one.f1,
        }  # fmt: skip
    report["pooled"] = pooled(left_out)
    report["grid"] = {settings: pooled(list(of.values())) for settings, of in found.items()}
    return report


def score_copies(program: Path, clips: Path, kinds: Sequence[str]) -> dict[str, Any]:
    """The clips with crossings, changed by program: the pool of each kind of change, and the clips with flags; of
    `against` how many of the vehicles were counted, none of which should be.
    """
    truths = truths_of(clips)
    report: dict[str, Any] = {"copies": {}}
    for kind in kinds:
        with tempfile.TemporaryDirectory() as folder:
            copies = Path(folder)
            try:
                for name, truth in truths.items():
                    clip_copies.copy_clip(clips / truth["video"], truth, kind, copies, name)
            except clip_copies.CopyError as error:
                raise RequestError(str(error)) from None
            changed = {name: truth for name, truth in all_truths(copies).items() if name in truths}
            scored = counted_with(program, copies, changed, ())
        flags = {name: one.flags for name, one in scored.items() if one.flags}
        counted = [one.counted for one in scored.values()]
        if kind == "against":
            wrong = {"counted": sum(one.counted for one in counted), "of": sum(t["total"] for t in truths.values())}
            report["copies"][kind] = {**wrong, "flags": flags}
            line = f"{kind:<16} counted {wrong['counted']} of {wrong['of']}"
        else:
            report["copies"][kind] = {**pooled(counted), "flags": flags}
            line = pool_line(kind, report["copies"][kind])
        print(f"{line}, flags {flags_line(flags)}", flush=True)
    return report


def pool_line(name: str, pool: Mapping[str, Any]) -> str:
    def share(key: str) -> str:
        value = pool[key]
        return "-" if value is None else f"{100 * value:.1f} %"

    f1 = pool["f1"]
    return (
        f"{name:<16} count {share('count_error')}, lane {share('lane_error')}, F1 {'-' if f1 is None else f'{f1:.3f}'}"
    )


def flags_line(flags: Mapping[str, Sequence[str]]) -> str:
    """The clips whose camera said that something is wrong, with what it said."""
    return ", ".join(f"{name} {'+'.join(said)}" for name, said in flags.items()) or "none"


def table_of(report: Mapping[str, Any]) -> str:
    """The report as lines for a person."""

    def share(value: float | None) -> str:
        return "    -" if value is None else f"{100 * value:4.1f}%"

    rows = [f"{'clip':<24} truth counted count  lane   F1    wrong present fps   flags"]
    for name, c in report["clips"].items():
        f1 = "  -  " if c["f1"] is None else f"{c['f1']:.3f}"
        present = "  -  " if c["presence_error"] is None else f"{c['presence_error']:5.2f}"
        flags = ",".join(c["flags"] + (["learning"] if c["learning"] else []))
        rows.append(
            f"{name:<24} {c['truth']:5d} {c['counted']:7d} {share(c['count_error'])} {share(c['lane_error'])} {f1} "
            f"{c['wrong_events']:5d} {present} {c['fps'] or 0:5.0f}  {flags}"
        )
    p = report["pooled"]
    f1 = "-" if p["f1"] is None else f"{p['f1']:.3f}"
    rows.append(f"pooled: count {share(p['count_error'])}, lane {share(p['lane_error'])}, F1 {f1}")
    return "\n".join(rows)


def write_json(file: Path, content: Mapping[str, Any]) -> None:
    """Whole or not at all."""
    draft = file.with_name(file.name + ".part")
    try:
        draft.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
        draft.replace(file)
    except OSError as error:
        raise RequestError(f"{file}: cannot be written: {error.strerror}") from None


def report_of(request: argparse.Namespace) -> dict[str, Any]:
    """Runs what was asked for and prints it for a person."""
    program = camera_program(request.camera)
    clips = Path(request.clips)
    if request.copies:
        kinds = clip_copies.KINDS if request.copies == "all" else request.copies.split(",")
        for kind in kinds:
            if kind not in clip_copies.KINDS:
                raise RequestError(f"--copies {kind}: right would be all, or some of {','.join(clip_copies.KINDS)}")
        return score_copies(program, clips, kinds)
    if request.leave_one_out:
        report = leave_one_out(program, clips)
        for name, clip in report["clips"].items():
            print(f"{name:<24} {clip['chosen']:<14} {clip['counted']}/{clip['truth']} F1 {clip['f1']:.3f}")
        print(pool_line("left out", report["pooled"]))
        for settings, pool in report["grid"].items():
            print(pool_line(settings, pool))
        return report
    report = score_folder(program, clips, request.events)
    print(table_of(report))
    return report


def main(arguments: Sequence[str] | None = None) -> int:
    parser = _Parser(
        prog="score-counter",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--clips", metavar="DIR", help="folder with videos and truth files")
    parser.add_argument("--json", metavar="FILE", help="the report, shares and not percent")
    parser.add_argument(
        "--write-lanes", nargs=2, metavar=("TRUTH", "FILE"), help="writes the lane file of a truth file"
    )
    parser.add_argument("--camera", metavar="PROGRAM", help="elmopp-camera to score; default: the one that was built")
    parser.add_argument(
        "--copies",
        metavar="LIST",
        help=f"score copies changed by program: all, or some of {','.join(clip_copies.KINDS)}",
    )
    parser.add_argument(
        "--leave-one-out", action="store_true", help="score each clip with the settings that are best on the others"
    )
    parser.add_argument("--events", action="store_true", help="also print the crossings that are missed or false")
    request = parser.parse_args(arguments)
    try:
        if request.write_lanes:
            write_json(Path(request.write_lanes[1]), lanes_of(read_truth(Path(request.write_lanes[0]))))
            return EXIT_DONE
        if not request.clips or not request.json:
            raise RequestError("--clips DIR and --json FILE are needed, or --write-lanes TRUTH FILE")
        if (why := why_not_writable(Path(request.json))) is not None:
            raise RequestError(f"--json {request.json}: {why[0]}; right would be {why[1]}")
        report = report_of(request)
        write_json(Path(request.json), report)
    except RequestError as error:
        print(f"score-counter: {error}", file=sys.stderr)
        return EXIT_REFUSED
    except ScoreFailedError as error:
        print(f"score-counter: {error}", file=sys.stderr)
        return EXIT_FAILED
    return EXIT_DONE
