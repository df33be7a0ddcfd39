# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Enumerates stages: the maximal sets of signal groups that may be green together; and the fewest that serve all.

Sets of groups are bit masks: bit g is group g. A stage is a maximal clique of the compatibility graph, found with
Bron-Kerbosch and a pivot.
"""

from collections.abc import Iterator, Sequence


def bits_of(mask: int) -> Iterator[int]:
    """Yields the indices of the set bits, lowest first."""
    while mask:
        lowest = mask & -mask
        yield lowest.bit_length() - 1
        mask ^= lowest


def compatible_masks(conflict: Sequence[int]) -> list[int]:
    """For each group, the mask of the other groups that may be green with it."""
    everybody = (1 << len(conflict)) - 1
    return [everybody & ~mask & ~(1 << group) for group, mask in enumerate(conflict)]


def enumerate_stages(conflict: Sequence[int]) -> list[int]:
    """All maximal compatible sets, ascending as numbers; `conflict[g]` is the mask of the groups in conflict with g."""
    if not conflict:
        return []
    compatible = compatible_masks(conflict)
    return sorted(_extend(compatible, 0, (1 << len(conflict)) - 1, 0))


def _extend(compatible: Sequence[int], chosen: int, open_groups: int, done: int) -> Iterator[int]:
    """Bron-Kerbosch: maximal sets that contain `chosen`, may take from `open_groups` and nothing of `done`."""
    if not open_groups:
        if not done:
            yield chosen
        return
    pivot = max(bits_of(open_groups | done), key=lambda group: (open_groups & compatible[group]).bit_count())
    for group in bits_of(open_groups & ~compatible[pivot]):
        near = compatible[group]
        yield from _extend(compatible, chosen | 1 << group, open_groups & near, done & near)
        open_groups &= ~(1 << group)
        done |= 1 << group


def conflict_pair(conflict: Sequence[int], stage: int) -> tuple[int, int] | None:
    """The first two groups of the set that conflict, or None."""
    for group in bits_of(stage):
        against = conflict[group] & stage
        if against:
            return group, next(bits_of(against))
    return None


def addable_group(conflict: Sequence[int], stage: int) -> int | None:
    """The lowest group that could still join the compatible set, or None if the set is maximal."""
    for group, against in enumerate(conflict):
        if not stage >> group & 1 and not against & stage:
            return group
    return None


def smallest_cover(sets: Sequence[int], needed: int) -> tuple[int, ...]:
    """Indices of the fewest sets that together hold all needed bits; of several such choices the first in order.

    Every needed bit must be in some set. Exact: the number is the smallest for which a cover exists, and a set is taken
    as soon as the ones after it can do the rest.
    """
    count = next(count for count in range(len(sets) + 1) if _can_cover(sets, needed, count))
    chosen: list[int] = []
    for index, held in enumerate(sets):
        rest = count - len(chosen) - 1
        if needed and _can_cover(sets[index + 1 :], needed & ~held, rest):
            chosen.append(index)
            needed &= ~held
    return tuple(chosen)


def _can_cover(sets: Sequence[int], needed: int, count: int) -> bool:
    """True if `count` of the sets hold all needed bits. Branches on the bit that the fewest sets hold."""
    if not needed:
        return True
    if count <= 0 or max((held & needed).bit_count() for held in (0, *sets)) * count < needed.bit_count():
        return False
    rarest = min(bits_of(needed), key=lambda bit: sum(held >> bit & 1 for held in sets))
    return any(_can_cover(sets, needed & ~held, count - 1) for held in sets if held >> rarest & 1)
