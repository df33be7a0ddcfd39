# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""What several runs of tools/closed-loop say together, as a table in Markdown: by scene, and by lane."""

import json
import statistics
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from elmopp_tools.outputs import EXIT_DONE, EXIT_REFUSED, OneLineParser, say, why
from elmopp_tools.paired import half_width, paired

Result = dict[str, Any]


def read(folder: Path) -> Result:
    """The closed_loop.json of a run."""
    result: Result = json.loads((folder / "closed_loop.json").read_text(encoding="utf-8"))
    return result


def lane_error(results: Sequence[Result]) -> float:
    """Vehicles too many or too few in each lane, as a share of all."""
    lanes = [lane for result in results for lane in result["lanes"]]
    true = sum(lane["true"] for lane in lanes)
    return sum(abs(lane["true"] - lane["counted"]) for lane in lanes) / true if true else 0.0


def scene_row(scene: str, results: Sequence[Result]) -> str:
    """One scene, over its seeds."""
    lanes = [lane for result in results for lane in result["lanes"]]
    true, counted = (sum(lane[key] for lane in lanes) for key in ("true", "counted"))
    present = [result["present_error_veh"] for result in results]
    camera, perfect = ([result[key] for result in results] for key in ("delay_camera_s", "delay_perfect_s"))
    cost = paired(camera, perfect)
    told = "-" if cost is None else f"{cost.mean:+.2f} [{cost.low:+.2f}, {cost.high:+.2f}]"
    return (
        f"| {scene} | {len(results)} | {true} | {counted} | {100 * lane_error(results):.1f} % "
        f"| {statistics.fmean(present):.2f} ± {half_width(present):.2f} "
        f"| {statistics.fmean(perfect):.1f} | {statistics.fmean(camera):.1f} | {told} |"
    )


def by_scene(results: Sequence[Result]) -> list[str]:
    """The table of scenes, in the order in which they come."""
    scenes: dict[str, list[Result]] = defaultdict(list)
    for result in results:
        scenes[result["scene"]].append(result)
    head = (
        "| scene | seeds | crossed | counted | lane error | present, error of a movement | delay, right counts, s "
        "| delay, cameras, s | what counting costs, s [95 %] |"
    )
    rule = "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"
    return [head, rule, *(scene_row(scene, those) for scene, those in scenes.items())]


def by_lane(results: Sequence[Result]) -> list[str]:
    """Counted of true, summed over all runs, lane by lane."""
    sums: dict[str, list[int]] = defaultdict(lambda: [0, 0])
    for result in results:
        for lane in result["lanes"]:
            sums[lane["lane"]][0] += lane["true"]
            sums[lane["lane"]][1] += lane["counted"]
    names = list(sums)
    return [
        "| lane | " + " | ".join(names) + " |",
        "| --- |" + " ---: |" * len(names),
        "| crossed | " + " | ".join(str(sums[name][0]) for name in names) + " |",
        "| counted | " + " | ".join(str(sums[name][1]) for name in names) + " |",
    ]


def main(words: Sequence[str] | None = None) -> int:
    parser = OneLineParser(
        prog="tools/closed-loop-table", description="Sums up runs of tools/closed-loop, as tables in Markdown."
    )
    parser.add_argument("folders", nargs="+", type=Path, metavar="DIR", help="what --out named")
    arguments = parser.parse_args(words)
    try:
        results = [read(folder) for folder in arguments.folders]
    except (OSError, ValueError) as error:
        file = getattr(error, "filename", None)
        where = f"{file}: " if file else ""
        say("closed-loop-table", f"{where}{why(error)}; right would be folders that tools/closed-loop wrote")
        return EXIT_REFUSED
    print("\n".join([*by_scene(results), "", *by_lane(results)]))
    return EXIT_DONE
