# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Run by SUMO's Python: what our cameras count each second beside what SUMO says of every vehicle's next signal.

usage: sumo_probe.py NET ROUTES REACH_M SECONDS; prints a JSON list of [counted, true, arrived] a second.
"""

import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))

import libsumo
from elmopp_tools.sumo_drive import Camera
from elmopp_tools.sumo_network import Network
from elmopp_tools.sumo_signal import read_signal


def inside(reach_m: float) -> int:
    """Vehicles whose next signal is no further."""
    found = 0
    for vehicle in libsumo.vehicle.getIDList():
        signals = libsumo.vehicle.getNextTLS(vehicle)
        found += bool(signals) and signals[0][2] <= reach_m
    return found


def main(net: str, routes: str, reach_m: float, seconds: int) -> None:
    libsumo.start(["sumo", "-n", net, "-r", routes, "--no-step-log", "--no-warnings"])
    network = Network.read(Path(net))
    signal = read_signal(network.programme("C"))
    camera = Camera(signal, network.sight(signal, reach_m, frozenset(libsumo.trafficlight.getControlledLanes("C"))))
    rows = []
    for _ in range(seconds):
        libsumo.simulationStep()
        camera.count()
        rows.append([sum(camera.present_veh), inside(reach_m), sum(camera.arrived_veh)])
    libsumo.close()
    print(json.dumps(rows))


main(sys.argv[1], sys.argv[2], float(sys.argv[3]), int(sys.argv[4]))
