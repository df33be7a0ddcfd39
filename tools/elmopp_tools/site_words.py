# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The words of a site file: names become indices and masks, seconds become tenths, or SiteError says why not."""

import re
from collections.abc import Sequence
from typing import Any

from elmopp_tools.site_model import NAME_SIZE, SiteError

Document = dict[str, Any]


def tenths(path: str, time_s: float) -> int:
    """Seconds as a whole number of tenths; a finer time is refused, not rounded."""
    time_ds = round(time_s * 10)
    if time_ds / 10 != time_s:
        raise SiteError(f"{path} is finer than a tenth of a second", time_s, f"for example {time_ds / 10}")
    return time_ds


def percent(path: str, share: float) -> int:
    """A share as a whole number of hundredths; a finer one is refused, not rounded."""
    hundredths = round(share * 100)
    if abs(hundredths - share * 100) > 1e-9:
        raise SiteError(f"{path} is finer than a hundredth", share, f"for example {hundredths / 100}")
    return hundredths


def check_count(items: Sequence[object], what: str, bound_name: str, bound: int) -> None:
    """Refuses a list that the struct has no room for."""
    if len(items) > bound:
        raise SiteError(f"has too many {what}", len(items), f"{bound_name} is {bound}")


def list_names(items: Sequence[Document], what: str, bound_name: str, bound: int) -> tuple[str, ...]:
    """The names of a list of tables: not too many, well-formed, each once."""
    check_count(items, what, bound_name, bound)
    names = tuple(checked_name(f"{what}[{index}].name", item["name"], NAME_SIZE) for index, item in enumerate(items))
    for index, name in enumerate(names):
        if name in names[:index]:
            raise SiteError(f"{what}[{index}].name is taken", name, "every name once in its list")
    return names


def checked_name(path: str, name: str, size: int) -> str:
    """A name that fits into `size` bytes with its zero, and that no message or comment can be broken by."""
    if re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.+-]*", name) is None:
        raise SiteError(f"{path} is not a name", name, "ASCII letters, digits and _ . + -, a letter or digit first")
    if len(name) >= size:
        raise SiteError(f"{path} has {len(name)} bytes", name, f"at most {size - 1}")
    return name


def index_of(names: Sequence[str], name: str, path: str) -> int:
    """The place of a name in its list."""
    if name not in names:
        raise SiteError(f"{path} is not known", name, f"one of {', '.join(names)}")
    return names.index(name)


def mask_of(names: Sequence[str], chosen: Sequence[str], path: str) -> int:
    """The mask of the places of the chosen names."""
    return sum(1 << index_of(names, name, path) for name in chosen)
