# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""What SUMO itself says about a run: its trip and statistic outputs, as one row.

delay_s        mean of timeLoss + departDelay over every vehicle that entered, arrived or not; read it with not_inserted
time_loss_s    mean of timeLoss: the time lost by driving below the speed that was wanted
waiting_time_s mean of waitingTime: the time below 0.1 m/s
longest_wait_s the largest waitingTime of a vehicle
stops          how often a vehicle fell below 0.1 m/s, of all vehicles together
not_inserted   vehicles whose time had come and that found no room to enter
teleports      vehicles that SUMO lifted out of a jam, at the time-to-teleport of the scenario
co2_kg fuel_kg of all vehicles that entered, by SUMO's emission model
"""

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

MG_PER_KG = 1e6

COLUMNS = (
    "scenario", "chooser", "forecast", "seed", "signals", "delay_s", "time_loss_s", "waiting_time_s", "arrived",
    "not_inserted", "teleports", "longest_wait_s", "longest_red_s", "stops", "switches", "co2_kg", "fuel_kg",
)  # fmt: skip


def scenario_name(file: Path) -> str:
    """What stands in the column `scenario`: the name of the configuration, or of the network, up to its first dot."""
    return file.name.split(".")[0]


@dataclass(frozen=True)
class Trips:
    """Sums over all vehicles that entered."""

    entered: int
    arrived: int
    delay_s: float
    time_loss_s: float
    waiting_time_s: float
    longest_wait_s: float
    stops: int
    co2_kg: float
    fuel_kg: float


@dataclass(frozen=True)
class Statistics:
    """Of the whole run."""

    not_inserted: int
    teleports: int


def read_trips(file: Path) -> Trips:
    """SUMO's tripinfo output with unfinished trips and emissions."""
    entered = arrived = stops = 0
    delay_s = time_loss_s = waiting_s = longest_s = co2_mg = fuel_mg = 0.0
    for _, trip in ElementTree.iterparse(file):  # noqa: S314  the file is SUMO's of this very run
        if trip.tag == "tripinfo" and float(trip.get("depart", "-1")) >= 0.0:
            entered += 1
            arrived += float(trip.get("arrival", "-1")) >= 0.0
            time_loss_s += float(trip.get("timeLoss", "0"))
            delay_s += float(trip.get("timeLoss", "0")) + float(trip.get("departDelay", "0"))
            waiting_s += float(trip.get("waitingTime", "0"))
            longest_s = max(longest_s, float(trip.get("waitingTime", "0")))
            stops += int(trip.get("waitingCount", "0"))
            emissions = trip.find("emissions")
            if emissions is not None:
                co2_mg += float(emissions.get("CO2_abs", "0"))
                fuel_mg += float(emissions.get("fuel_abs", "0"))
            trip.clear()
    return Trips(
        entered, arrived, delay_s, time_loss_s, waiting_s, longest_s, stops, co2_mg / MG_PER_KG, fuel_mg / MG_PER_KG
    )


def read_statistics(file: Path) -> Statistics:
    """SUMO's statistic output."""
    root = ElementTree.parse(file).getroot()  # noqa: S314  the file is SUMO's of this very run
    vehicles, teleports = root.find("vehicles"), root.find("teleports")
    return Statistics(
        not_inserted=int(vehicles.get("waiting", "0")) if vehicles is not None else 0,
        teleports=int(teleports.get("total", "0")) if teleports is not None else 0,
    )


def table(rows: Sequence[dict[str, str]], columns: Sequence[str]) -> bytes:
    """The rows as CSV, with a head."""
    text = io.StringIO()
    writer = csv.DictWriter(text, columns, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue().encode()


def number(value: float) -> str:
    """Three digits behind the point at most."""
    return f"{value:.3f}".rstrip("0").rstrip(".")


def row(
    names: tuple[str, str, str, int],
    signals: int,
    trips: Trips,
    statistics: Statistics,
    longest_red_s: int,
    switches: int,
) -> dict[str, str]:
    """One line of the table; `names` are scenario, chooser, forecast and seed."""
    mean = 1.0 / max(1, trips.entered)
    values = (
        *map(str, names),
        str(signals),
        number(trips.delay_s * mean),
        number(trips.time_loss_s * mean),
        number(trips.waiting_time_s * mean),
        str(trips.arrived),
        str(statistics.not_inserted),
        str(statistics.teleports),
        number(trips.longest_wait_s),
        str(longest_red_s),
        str(trips.stops),
        str(switches),
        number(trips.co2_kg),
        number(trips.fuel_kg),
    )
    return dict(zip(COLUMNS, values, strict=True))
