# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Run by SUMO's Python: what an oracle is told in each second of a real run, and who was counted in the recorded one.

usage: sumo_oracle_probe.py NET ROUTES SECONDS; prints JSON {"told": [[row of each approach] a second, the start's
first], "came": [[arrivals of each movement] a second of the recorded run], "comes": the same of the one that is told},
of the only signal.
"""

import json
import sys
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))

from elmopp_tools import sumo_run
from elmopp_tools.library import CoreJunction
from elmopp_tools.sumo_scenario import scenario_of
from elmopp_tools.sumo_signal import Times

TIMES = Times(yellow_s=3, all_red_s=2, min_green_s=5, max_green_s=60, red_bound_s=0)


def main(net: str, routes: str, seconds: int) -> None:
    told: list[Any] = []
    came: list[Any] = []
    comes: list[Any] = []
    count = CoreJunction.count

    def noting(core: CoreJunction, present_veh: Any, arrived_veh: Any, *others: Any, **words: Any) -> None:
        if words["foreseen_veh"]:  # the run that is recorded has none
            told.append(words["foreseen_veh"])
            comes.append(list(arrived_veh))
        else:
            came.append(list(arrived_veh))
        count(core, present_veh, arrived_veh, *others, **words)

    setattr(CoreJunction, "count", noting)  # noqa: B010  a method is not assigned to
    scenario = scenario_of(None, Path(net), routes, None, float(seconds))
    sumo_run.run(sumo_run.Job(scenario, "rollout:oracle", 1, TIMES, 100.0, allow_partial=False, paths=None))
    print(json.dumps({"told": told, "came": came[1:], "comes": comes[1:]}))


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], int(sys.argv[3]))
