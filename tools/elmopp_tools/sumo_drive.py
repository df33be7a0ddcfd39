# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""One second of a signal in a running SUMO simulation: its cameras, its controller, and who watches it.

Data flow one way: Camera (counts) -> Driver (a junction of libelmopp.so; none for SUMO's own controllers) -> lamps;
Watch sees counts and lamps of both kinds alike. None of them knows what a vehicle will do: a camera sees who is there.
"""

from collections.abc import Sequence

import libsumo

from elmopp_tools.library import NO_STAGE, Announced, CoreJunction
from elmopp_tools.site_image import image_bytes
from elmopp_tools.sumo_neighbours import Gateway
from elmopp_tools.sumo_network import Sight
from elmopp_tools.sumo_oracle import Record
from elmopp_tools.sumo_report import number
from elmopp_tools.sumo_signal import GREEN, Signal, Times, junction_of, letters

TICKS_PER_S = 10

# Slower than this inside a junction is in the way of whoever starts. SUMO's own halting is 0.1 m/s, but who has only
# just begun to move on needs seconds to be gone; everybody who drives on is faster, also from a standing start at the
# stop line.
STANDING_M_PER_S = 1.0


class Camera:
    """Counts, a value a movement: who is inside the reach now, and who of them was not a second ago (`came`)."""

    def __init__(self, signal: Signal, sight: Sight) -> None:
        self._sight = sight
        self._known: set[str] = set()
        self.came: set[str] = set()
        self.present_veh = [0.0] * len(signal.movements)
        self.arrived_veh = [0.0] * len(signal.movements)

    def count(self) -> None:
        """Looks once, after a step of the simulation."""
        present = [0.0] * len(self.present_veh)
        arrived = [0.0] * len(self.arrived_veh)
        now: set[str] = set()
        for view in self._sight.views:
            for vehicle in libsumo.lane.getLastStepVehicleIDs(view.lane):
                if view.from_m <= 0.0 or libsumo.vehicle.getLanePosition(vehicle) >= view.from_m:
                    now.add(vehicle)
                    for movement, part in view.parts:
                        present[movement] += part
                        arrived[movement] += part if vehicle not in self._known else 0.0
        for crossing in self._sight.crossings:
            for person in libsumo.edge.getLastStepPersonIDs(crossing.waiting_edge):
                if libsumo.person.getNextEdge(person) == crossing.crossing_edge:
                    now.add(person)
                    present[crossing.movement] += 1.0
                    arrived[crossing.movement] += 1.0 if person not in self._known else 0.0
        self.came = now - self._known
        self._known, self.present_veh, self.arrived_veh = now, present, arrived


class PathLog:
    """Where every vehicle in sight was in every second, for a time-space figure: `columns` name what `rows` hold."""

    columns = ("t_s", "approach", "vehicle", "distance_m")

    def __init__(self, signals: Sequence[Signal], sights: Sequence[Sight]) -> None:
        self._views = [
            (view, signal.movements[view.parts[0][0]].edge)
            for signal, sight in zip(signals, sights, strict=True)
            for view in sight.views
        ]
        self.rows: list[dict[str, str]] = []

    def look(self) -> None:
        """After a step of the simulation."""
        t_s = number(libsumo.simulation.getTime())
        for view, edge in self._views:
            for vehicle in libsumo.lane.getLastStepVehicleIDs(view.lane):
                position_m = libsumo.vehicle.getLanePosition(vehicle)
                if position_m >= view.from_m:
                    cells = (t_s, edge, vehicle, number(view.line_m - position_m))
                    self.rows.append(dict(zip(self.columns, cells, strict=True)))


class JunctionCamera:
    """Looks at the lanes across a junction, and at who has not left them whole."""

    def __init__(self, sight: Sight) -> None:
        self._inside = sight.inside
        self._behind = sorted({lane for lanes in sight.downstream for lane in lanes})

    def is_occupied(self) -> bool:
        """Whether a vehicle stands there now."""
        inside = (v for lane in self._inside for v in libsumo.lane.getLastStepVehicleIDs(lane))
        tails = (v for lane in self._behind for v in libsumo.lane.getLastStepVehicleIDs(lane) if _sticks_out(v))
        return any(libsumo.vehicle.getSpeed(vehicle) < STANDING_M_PER_S for vehicle in (*inside, *tails))


def _sticks_out(vehicle: str) -> bool:
    """SUMO has a vehicle where its front is: the rest may still be on the lane before."""
    shorter: bool = libsumo.vehicle.getLanePosition(vehicle) < libsumo.vehicle.getLength(vehicle)
    return shorter


class Driver:
    """A signal that libelmopp.so controls. An oracle is told of the first seconds, too."""

    def __init__(
        self,
        signal: Signal,
        times: Times,
        reach_m: float,
        chooser: str,
        seed: int,
        foreseen_veh: Sequence[Sequence[float]] = (),
    ) -> None:
        self._signal = signal
        self.waits = times.junction_wait_s > 0
        site = image_bytes(junction_of(signal, times, reach_m))
        self._core = CoreJunction(site, chooser, seed=seed)
        self._shown = NO_STAGE
        self._state = ""
        nobody = [0.0] * len(signal.movements)
        self.drive(nobody, nobody, None, foreseen_veh=foreseen_veh)

    def drive(
        self,
        present_veh: Sequence[float],
        arrived_veh: Sequence[float],
        downstream_veh: Sequence[float] | None,
        *,
        occupied: bool = False,
        announced: Sequence[Announced] = (),
        foreseen_veh: Sequence[Sequence[float]] = (),
    ) -> None:
        """Decides for the coming second and shows it. Lamps change at its beginning: all times are whole seconds."""
        self._core.count(
            present_veh,
            arrived_veh,
            downstream_veh,
            occupied=occupied,
            announced=announced,
            foreseen_veh=foreseen_veh,
        )
        aspects = self._core.tick()
        if self._core.stage != NO_STAGE:
            self._shown = self._core.stage
        state = self._letters(aspects)
        for _ in range(TICKS_PER_S - 1):
            self._core.tick()
        if state != self._state:
            libsumo.trafficlight.setRedYellowGreenState(self._signal.name, state)
            self._state = state

    def _letters(self, aspects: str) -> str:
        target = self._core.target
        if target == NO_STAGE:
            return "r" * len(self._signal.states[0])
        return letters(self._signal, target if self._shown == NO_STAGE else self._shown, target, aspects)

    def close(self) -> None:
        """Frees the junction."""
        self._core.close()


class Watch:
    """What a person at the roadside would write down, of any controller.

    Longest red: the longest time in which somebody was counted on a movement in every second and it did not go.
    Switches: how often a stage was shown that was not the one shown before.
    """

    def __init__(self, signal: Signal) -> None:
        self._signal = signal
        self._red_s = [0] * len(signal.movements)
        self._stage = NO_STAGE
        self.longest_red_s = 0
        self.switches = 0

    def look(self, present_veh: Sequence[float]) -> None:
        """The second that has just passed."""
        state = libsumo.trafficlight.getRedYellowGreenState(self._signal.name)
        green = sum(
            all(state[link] in GREEN for link in links) << group for group, links in enumerate(self._signal.group_links)
        )
        for index, movement in enumerate(self._signal.movements):
            waits = present_veh[index] >= 1.0 and green & movement.groups != movement.groups
            self._red_s[index] = self._red_s[index] + 1 if waits else 0
        self.longest_red_s = max(self.longest_red_s, *self._red_s)
        if green in self._signal.stages:
            stage = self._signal.stages.index(green)
            self.switches += stage != self._stage != NO_STAGE
            self._stage = stage


class Street:
    """All signals of a network, second by second.

    With gateways, one a signal, neighbours speak. With `foresight`, an earlier run's record, drivers foresee. `record`
    is what this one has seen.
    """

    def __init__(
        self,
        signals: Sequence[Signal],
        sights: Sequence[Sight],
        drivers: Sequence[Driver],
        gateways: Sequence[Gateway] = (),
        foresight: Record | None = None,
    ) -> None:
        self.record = Record(signals)
        self._foresight = foresight
        self._cameras = [Camera(signal, sight) for signal, sight in zip(signals, sights, strict=True)]
        self._watches = [Watch(signal) for signal in signals]
        self._junction_cameras = [JunctionCamera(sight) for sight in sights]
        self._drivers = drivers
        self._gateways = gateways
        seen = {
            view.lane: (camera, view.parts)
            for camera, sight in zip(self._cameras, sights, strict=True)
            for view in sight.views
        }
        self._downstream = [
            [[seen[lane] for lane in lanes if lane in seen] for lanes in sight.downstream] for sight in sights
        ]

    def second(self) -> None:
        """After each step of the simulation: count everywhere, then decide everywhere."""
        for camera, watch in zip(self._cameras, self._watches, strict=True):
            camera.count()
            watch.look(camera.present_veh)
        self.record.note([camera.arrived_veh for camera in self._cameras], [camera.came for camera in self._cameras])
        for index, driver in enumerate(self._drivers):
            camera = self._cameras[index]
            occupied = driver.waits and self._junction_cameras[index].is_occupied()
            announced = self._gateways[index].listen() if self._gateways else ()
            driver.drive(
                camera.present_veh,
                camera.arrived_veh,
                self._downstream_veh(index),
                occupied=occupied,
                announced=announced,
                foreseen_veh=self._foresight.rows(index, self.record.seconds) if self._foresight else (),
            )

    def _downstream_veh(self, index: int) -> list[float]:
        """For each movement the vehicles that wait at the next signal on its ways on, their mean; 0 behind the last."""
        return [
            sum(part * camera.present_veh[movement] for camera, parts in ways for movement, part in parts)
            / max(1, len(ways))
            for ways in self._downstream[index]
        ]

    @property
    def longest_red_s(self) -> int:
        """Of all movements of all signals."""
        return max(watch.longest_red_s for watch in self._watches)

    @property
    def switches(self) -> int:
        """Of all signals together."""
        return sum(watch.switches for watch in self._watches)
