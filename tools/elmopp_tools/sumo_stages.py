# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The stages that a SUMO programme leaves out: what else of a signal may safely be green together.

Pure, on letters and numbers of links. A *stream* is the links that share lanes, one after the other: its vehicles
cannot be told apart by a lamp. Only streams that never give way are taken up, and a stage that is added lets no two
links go that cross or merge, so it needs no judgement that the network does not state. Who gives way in some phase
(g), people on crossings, and signals of several junctions, between which there may be no room, stay as the programme
has them.
"""

from collections.abc import Collection, Iterable, Sequence

from elmopp_tools.stages import bits_of, enumerate_stages

# Of a link: the lanes behind it, each (edge, lane).
Lanes = Sequence[tuple[tuple[str, str], ...]]
Foes = frozenset[tuple[int, int]]


def more_stages(
    states: Sequence[str], links: Sequence[int], lanes: Lanes, foes: Foes, places: Sequence[str]
) -> list[str]:
    """States of the stages to add: maximal sets of streams that are not together in any phase; [] if there are none.

    `states` are the green phases, `links` those with a signal group, `places` the junction of each, "" if unknown.
    """
    if not _is_one_junction(links, places):
        return []
    streams = [stream for stream in streams_of(links, lanes) if _is_simple(stream, states, lanes, foes)]
    conflict = [
        sum(cross(stream, other, foes) << at for at, other in enumerate(streams) if other is not stream)
        for stream in streams
    ]
    added = []
    for stage in enumerate_stages(conflict):
        going = frozenset(link for at in bits_of(stage) for link in streams[at])
        if not any(all(state[link] == "G" for link in going) for state in states):
            added.append("".join(_letter(states, link, links, going) for link in range(len(states[0]))))
    return added


def streams_of(links: Sequence[int], lanes: Lanes) -> list[frozenset[int]]:
    """The links in streams, in the order of their lowest links."""
    streams: list[tuple[set[int], set[tuple[str, str]]]] = []
    for link in links:
        behind = set(lanes[link])
        joined = [stream for stream in streams if stream[1] & behind]
        streams = [stream for stream in streams if not stream[1] & behind]
        streams.append(({link}.union(*(s[0] for s in joined)), behind.union(*(s[1] for s in joined))))
    return sorted((frozenset(stream[0]) for stream in streams), key=min)


def cross(links: Iterable[int], others: Collection[int], foes: Foes) -> bool:
    """Whether a link of the one crosses or merges with one of the other."""
    return any((first, second) in foes or (second, first) in foes for first in links for second in others)


def _is_one_junction(links: Sequence[int], places: Sequence[str]) -> bool:
    """Whether it is known of all links that they are of one junction."""
    return all(link < len(places) and places[link] for link in links) and len({places[link] for link in links}) == 1


def _is_simple(stream: frozenset[int], states: Sequence[str], lanes: Lanes, foes: Foes) -> bool:
    walked = any(edge.startswith(":") for link in stream for edge, _ in lanes[link])
    gives_way = any(state[link] == "g" for state in states for link in stream)
    return not walked and not gives_way and not cross(stream, stream, foes)


def _letter(states: Sequence[str], link: int, links: Sequence[int], going: frozenset[int]) -> str:
    """A link with a group goes or waits; one without is as in all phases, and gives way if it does so in any."""
    if link in links:
        return "G" if link in going else "r"
    letters = {state[link] for state in states}
    return "g" if "g" in letters else states[0][link]
