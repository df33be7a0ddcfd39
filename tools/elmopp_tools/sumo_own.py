# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""SUMO's own controllers with the times that hold for everybody: their programmes as an additional file.

The green phases of a signal in its own order, amber and all red between them by the same rule as everywhere else.
`static` keeps the network's green durations, the others choose between minimum and maximum green.
"""

from collections.abc import Iterator, Sequence
from xml.etree import ElementTree

from elmopp_tools.sumo_signal import Signal, Times, transition

# Our name: SUMO's type of tlLogic.
TYPES = {"static": "static", "sumo-actuated": "actuated", "sumo-delay-based": "delay_based"}
PROGRAM = "elmopp-own"


def own_programmes(signals: Sequence[Signal], times: Times, chooser: str) -> bytes:
    """The additional file."""
    root = ElementTree.Element("additional")
    for signal in signals:
        logic = ElementTree.SubElement(
            root, "tlLogic", id=signal.name, type=TYPES[chooser], programID=PROGRAM, offset="0"
        )
        for attributes in phases_of(signal, times, chooser):
            ElementTree.SubElement(logic, "phase", attributes)
    text: bytes = ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)
    return text


def phases_of(signal: Signal, times: Times, chooser: str) -> Iterator[dict[str, str]]:
    """The attributes of every phase: the greens, and between them amber and all red where there are any."""
    count = len(signal.states)
    for stage, state in enumerate(signal.states):
        green_s = max(times.min_green_s, round(signal.durations_s[stage]))
        bounds = {} if chooser == "static" else {"minDur": str(times.min_green_s), "maxDur": str(times.max_green_s)}
        yield {"duration": str(green_s), "state": state, **bounds}
        following = (stage + 1) % count
        if following == stage:
            continue
        amber, red = transition(signal, stage, following)
        if "y" in amber and times.yellow_s > 0:
            yield {"duration": str(times.yellow_s), "state": amber}
            if signal.stages[following] & ~signal.stages[stage] and times.all_red_s > 0:
                yield {"duration": str(times.all_red_s), "state": red}
