# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Run by SUMO's Python: what the signals of networks let go, as SUMO's own library reads it.

usage: sumo_greens_probe.py NET...; prints JSON, by file a list of signals:

- `links`: how many; `states`: the phases without amber,
- `never`: links that get green in none,
- `crossing`: phases in which two links that cross have G,
- `unheeded`: phases without amber in which a link gives way though nobody whom it crosses has green.

With --shown NET STATES..., files of SUMO's SaveTLSStates: by signal the states of all seconds, each once, and of them
those in which a link with G crosses one with G or amber (`crossing`).
"""

import json
import sys
from typing import Any
from xml.etree import ElementTree

import sumolib


def ways_of(signal: Any) -> dict[int, Any]:
    return {
        index: next(way for way in start.getOutgoing() if way.getToLane() == end)
        for start, end, index in signal.getConnections()
    }


def meets(ways: dict[int, Any], index: int, state: str, letters: str) -> bool:
    way = ways[index]
    return any(
        state[other] in letters and way.getJunction().areFoes(way.getJunctionIndex(), ways[other].getJunctionIndex())
        for other in ways
        if other != index
    )


def read(signal: Any) -> dict[str, object]:
    ways = ways_of(signal)
    states = [phase.state for programme in signal.getPrograms().values() for phase in programme.getPhases()]
    greens = [state for state in states if "y" not in state]
    return {
        "links": len(ways),
        "states": greens,
        "never": [i for i in ways if all(state[i] not in "Gg" for state in greens)],
        "crossing": [s for s in states if any(s[i] == "G" and meets(ways, i, s, "G") for i in ways)],
        "unheeded": [s for s in greens if any(s[i] == "g" and not meets(ways, i, s, "Gg") for i in ways)],
    }


def shown(net: str, files: list[str]) -> dict[str, dict[str, list[str]]]:
    ways = {signal.getID(): ways_of(signal) for signal in sumolib.net.readNet(net).getTrafficLights()}
    seen: dict[str, set[str]] = {}
    for file in files:
        for second in ElementTree.parse(file).getroot().iter("tlsState"):  # noqa: S314  SUMO has just written it
            seen.setdefault(second.attrib["id"], set()).add(second.attrib["state"])
    return {
        name: {
            "states": sorted(states),
            "crossing": [s for s in states if any(s[i] == "G" and meets(ways[name], i, s, "Gy") for i in ways[name])],
        }
        for name, states in seen.items()
    }


def main(files: list[str]) -> None:
    if files[0] == "--shown":
        print(json.dumps(shown(files[1], files[2:])))
        return
    nets = {file: sumolib.net.readNet(file, withPrograms=True) for file in files}
    print(json.dumps({file: [read(signal) for signal in net.getTrafficLights()] for file, net in nets.items()}))


if __name__ == "__main__":
    main(sys.argv[1:])
