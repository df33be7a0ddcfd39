# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Who may run the signals of a SUMO scenario: the library is asked, and SUMO's own controllers are known by name.

It needs no SUMO: a campaign asks before anything is written, tools/sumo-run before anything runs.
"""

from elmopp_tools.library import CoreJunction, LibraryError
from elmopp_tools.site_image import image_bytes
from elmopp_tools.sumo_own import TYPES
from elmopp_tools.sumo_signal import Phase, Programme, Times, junction_of, read_signal

REACH_M = 100.0


def check_chooser(option: str, chooser: str, times: Times) -> None:
    """Whether it can be made, on the smallest junction there is; LibraryError names it and what would be right."""
    if chooser in TYPES:
        return
    name = chooser.replace("@", ":").partition(":")[0]
    if name in TYPES:
        raise LibraryError(f"{option} {chooser}: SUMO's own take no option and no forecast; right would be {name}")
    programme = Programme(
        "check", (Phase("Gr", 30.0), Phase("rG", 30.0)), ((("a", "a_0"),), (("b", "b_0"),)), frozenset()
    )
    site = image_bytes(junction_of(read_signal(programme), times, REACH_M))
    try:
        CoreJunction(site, chooser).close()
    except LibraryError as error:
        own = f", or SUMO's own {', '.join(TYPES)}" if "unknown chooser" in str(error) else ""
        raise LibraryError(f"{option} {chooser}: {error}{own}") from None
