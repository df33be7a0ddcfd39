# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""The rollout in double precision, from the pseudo-code of its specification and without a look at the C.

Every loop is written out as the specification has it: queues are stepped second by second, arrivals kept one by one,
sums taken anew. Where the firmware's header departs from the pseudo-code, so does this: the clock on red restarts on a
departure, and who is overdue gets the next change, not one at once; a stage serves a movement if all its groups are in
it; nobody is hidden without a reach; a second teaches one vehicle a lane at most; the reactive rule is pressure's,
asked in every modelled second after the hold, which sees who drives in the reach of a green by then and is more than
the mean; rows correct the mean as far as they have been better than it, the later the less; without a reach nobody
goes in the second in which he comes; what is left at the horizon costs what it takes to clear it; who has waited long
makes his stage worth more; and of the other stages the heaviest are tried, each rule held against the same rule after
keeping, the mean gain less a part of what the worst one is behind it. A lane that gives way waits for the queue of
those it gives way to, and then for gaps between them (gaps_reference); seconds in which one of them was there teach
nothing. Where vehicles are seen to drive, each of a queue that gets green costs a stop.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from statistics import fmean

import gaps_reference

NEVER = -1
PROBES = (10, 30)  # so far ahead rows are held against what comes
LEFT = 0.01  # less may be rounding


@dataclass
class Site:
    """A junction of one signal group a movement."""

    saturation: list[float]
    startup: list[float]
    capacity: list[float]
    lanes: list[int]
    approach: list[int]
    stages: list[int]
    change: list[list[int]]
    free_flow: float = 0.0
    law: int = 0
    gives_way: list[set[int]] = field(default_factory=list)  # of a lane: those that go first
    gives_way_share: list[float] = field(default_factory=list)

    def foes(self, stage: int, lane: int) -> list[int]:
        """Those that go first in a stage, if the lane goes in it at all."""
        if not self.gives_way or not self.serves(stage, lane):
            return []
        return sorted(foe for foe in self.gives_way[lane] if self.serves(stage, foe))

    def serves(self, stage: int, lane: int) -> bool:
        return bool(self.stages[stage] >> lane & 1)

    def by_law(self, lane: int, queue: float) -> float:
        load = queue / self.capacity[lane]
        if self.law == 2:
            load = min(load, 0.5)
        return min(max(load * self.free_flow * (1.0 - load), 0.0), queue)


@dataclass
class Setting:
    """What the specification calls fixed."""

    travel: int = 0
    horizon: int = 120
    holds: tuple[int, ...] = (1, 2, 3, 5, 10)
    ratios: tuple[float, ...] = (2.5, 4.0, 6.0)
    others: int = 4
    caution: float = 0.5
    g_min: int = 5
    g_max: int = 60
    yuse: float = 0.5
    stop: float = 1.5  # lost by who starts from a queue, where one is seen to drive
    r_trig: int = 180
    f_rows: float = 0.5
    f_mean: float = 0.5
    patience: int = 40
    urge: float = 60.0  # vehicle-seconds, at most
    rows: int = 30
    fade: int = 60
    by_skill: bool = True


@dataclass
class Rollout:
    """State and the two functions of the specification."""

    site: Site
    setting: Setting
    lam_weight: int = 0
    last_stage: int = NEVER
    last_going: int = 0
    n: list[float] = field(default_factory=list)

    def __post_init__(self) -> None:
        count, stages = len(self.site.saturation), len(self.site.stages)
        law = self.site.law != 0
        self.s = [self.site.free_flow / 4 if law else value for value in self.site.saturation]
        self.n = [0.0] * count
        self.q = [0.0] * count
        self.lam = [0.0] * count
        self.hid = [0.0] * count
        self.red = [0] * count
        self.idle = [0] * count
        # what rows and mean said of so much later
        self.told: dict[int, list[tuple[list[float], list[float]] | None]] = {ahead: [] for ahead in PROBES}
        self.squares = dict.fromkeys(PROBES, (0.0, 0.0))
        self.judged = dict.fromkeys(PROBES, 0)
        self.ring = [[0.0] * self.setting.travel for _ in range(count)]  # oldest first
        self.num = [[0.0] * count for _ in range(stages)]
        self.den = [[0.0] * count for _ in range(stages)]
        self.sat = [[self.s[j] if self.site.serves(s, j) else 0.0 for j in range(count)] for s in range(stages)]

    # --- observe ---

    def observe(self, present: list[float], arrived: list[float], stage: int, elapsed: float, going: int) -> None:
        self.lam_weight = min(self.lam_weight + 1, 120)
        before = list(self.n)
        self.held = [
            stage != NEVER and any(before[f] > 0.0 for f in self.site.foes(stage, j)) for j in range(len(before))
        ]
        for lane in range(len(present)):
            self._observe(lane, present[lane], arrived[lane], stage, elapsed, going)
        self.last_stage, self.last_going = stage, going

    def _observe(self, lane: int, n_new: float, arr: float, stage: int, elapsed: float, going: int) -> None:
        site = self.site
        dep = self.n[lane] + arr - n_new
        q_old = self.q[lane]
        if self.setting.travel:
            ring = self.ring[lane] = [*self.ring[lane][1:], arr]
            while sum(ring) > n_new + 1e-12:
                oldest = next(k for k, value in enumerate(ring) if value > 0.0)
                ring[oldest] -= min(ring[oldest], sum(ring) - n_new)
        self.n[lane] = n_new
        self.q[lane] = max(n_new - sum(self.ring[lane]), 0.0)
        full = self.setting.travel > 0 and n_new >= 0.85 * site.capacity[lane]
        self.hid[lane] = min(max(self.hid[lane] + self.lam[lane] - arr, 0.0), site.capacity[lane]) if full else 0.0
        if not full or arr > self.lam[lane]:
            self.lam[lane] += (arr - self.lam[lane]) / self.lam_weight
        settled = stage != NEVER and stage == self.last_stage and elapsed > site.startup[lane] + 1.0
        if settled and site.serves(stage, lane) and site.law == 0:
            if self.held[lane]:
                self.idle[lane] = 0 if dep >= LEFT else self.idle[lane]
            else:
                if q_old >= 2.0 * site.lanes[lane]:
                    self._learn(stage, lane, dep)
                self.idle[lane] = self.idle[lane] + 1 if q_old >= 1.0 and dep < LEFT else 0
        else:
            self.idle[lane] = 0
        if (self.last_going & going) >> lane & 1 and (dep >= LEFT or n_new < 0.5):
            self.red[lane] = 0
        elif n_new > 0.0 or self.red[lane] > 0:
            self.red[lane] += 1

    def judge(self, arrived: list[float], rows: list[list[float]]) -> None:
        """What was said 30 s ago against what came; what is said now for later. After observe()."""
        approaches = range(max(self.site.approach) + 1 if not rows else len(rows))
        by_approach = [
            [sum(values[j] for j in range(len(arrived)) if self.site.approach[j] == i) for i in approaches]
            for values in (arrived, self.lam)
        ]
        for ahead in PROBES:
            before = self.told[ahead][-ahead] if len(self.told[ahead]) >= ahead else None
            if before is not None:
                self.judged[ahead] += 1
                errors = [sum((s - c) ** 2 for s, c in zip(said, by_approach[0], strict=True)) for said in before]
                weight = min(self.judged[ahead], 300)
                old, mean = self.squares[ahead]
                self.squares[ahead] = (old + (errors[0] - old) / weight, mean + (errors[1] - mean) / weight)
            said_now = ([max(row[ahead - 1], 0.0) for row in rows], by_approach[1]) if rows else None
            self.told[ahead].append(said_now)

    def row_weight(self, row: int = 59) -> float:
        """The skill that was measured nearer to a row."""
        ahead = PROBES[0] if row < sum(PROBES) / 2 else PROBES[1]
        said, mean = self.squares[ahead]
        if not self.setting.by_skill:
            return self.setting.f_rows
        return 1.0 - said / mean if self.judged[ahead] >= 60 and said < mean else 0.0

    def _learn(self, stage: int, lane: int, dep: float) -> None:
        prior = self.s[lane]
        most = max(2.0 * prior, float(self.site.lanes[lane]))
        self.num[stage][lane] = self.num[stage][lane] * (1.0 - 1.0 / 600.0) + min(max(dep, 0.0), most)
        self.den[stage][lane] = self.den[stage][lane] * (1.0 - 1.0 / 600.0) + 1.0
        value = (prior * 30.0 + self.num[stage][lane]) / (30.0 + self.den[stage][lane])
        self.sat[stage][lane] = min(max(value, 0.1 * prior), 1.4 * prior)

    # --- decide ---

    def serves_well(self, stage: int, lane: int) -> bool:
        return self.site.serves(stage, lane) and self.usual(stage, lane) >= self.s[lane] / 4

    def usual(self, stage: int, lane: int) -> float:
        """What a stage lets a lane go in the mean of those it gives way to."""
        foes = self.site.foes(stage, lane)
        flow = self.sat[stage][lane]
        return self.through(lane, flow, sum(self.first(stage, f) * self.lam[f] for f in foes)) if foes else flow

    def first(self, stage: int, lane: int) -> float:
        """The share of a lane for which others wait: those of it who give way themselves are none."""
        return 1.0 - self.site.gives_way_share[lane] if self.site.foes(stage, lane) else 1.0

    def through(self, lane: int, flow: float, opposing: float) -> float:
        gaps = self.site.lanes[lane] * gaps_reference.by_lines(opposing)
        return float(gaps_reference.shared(flow, gaps, self.site.gives_way_share[lane]))

    def decide(
        self, cur: int, elapsed: int, rows: list[list[float]], share: list[float]
    ) -> tuple[int, dict[int, float]]:
        """The stage, and V of each that was tried."""
        lanes = range(len(self.n))
        waiting = [j for j in lanes if self.n[j] > 0.0 and not self.serves_well(cur, j)]
        if elapsed < self.setting.g_min or not waiting:
            return cur, {}
        self._expect(rows, share)
        self.sx = [self.sat[cur][j] * (0.5 if self.idle[j] >= 8 else 1.0) for j in lanes]
        values, ratios = {}, self.setting.ratios
        kept = None
        if elapsed < self.setting.g_max:
            holds = self.setting.holds
            kept = [min(self.roll(cur, elapsed, cur, hold, ratio) for hold in holds) for ratio in ratios]
            values[cur] = fmean(kept)
        called = [
            s
            for s in range(len(self.site.stages))
            if s != cur and any(self.n[j] > 0.0 and self.serves_well(s, j) for j in lanes)
        ]
        for s in sorted(called, key=lambda s: (-self._weight(s), s))[: self.setting.others]:
            costs = [self.roll(cur, elapsed, s, 0, ratio) for ratio in ratios]
            values[s] = fmean(costs)
            if kept is not None:
                gains = [before - after for before, after in zip(kept, costs, strict=True)]
                values[s] += self.setting.caution * (fmean(gains) - min(gains))
            beyond = max([self.red[j] - self.setting.patience for j in waiting if self.serves_well(s, j)], default=0)
            if beyond > 0 and self.setting.urge > 0.0:
                values[s] -= min(beyond * (1.0 + beyond / self.setting.urge), self.setting.urge)
        best = min(values, key=lambda s: (values[s], s != cur, -self._weight(s), s)) if values else cur
        w = max(waiting, key=lambda j: (self.red[j], -j))
        able = [s for s in range(len(self.site.stages)) if self.serves_well(s, w)]
        if best != cur and able and self.setting.r_trig and self.red[w] >= self.setting.r_trig:
            best = max(able, key=lambda s: (self.usual(s, w), self._late(s, waiting), self._weight(s), -s))
        return best, values

    def _late(self, stage: int, waiting: list[int]) -> int:
        """How long the stage's own of those who wait have waited beyond half of the bound, together."""
        half = self.setting.r_trig // 2
        return sum(max(self.red[lane] - half, 0) for lane in waiting if self.serves_well(stage, lane))

    def _weight(self, stage: int) -> float:
        return sum(n * self.usual(stage, lane) for lane, n in enumerate(self.n))

    def _expect(self, rows: list[list[float]], share: list[float]) -> None:
        travel, self.a = self.setting.travel, []
        hid = list(self.hid)
        for k in range(self.setting.horizon):
            second = []
            for lane in range(len(self.n)):
                if k < travel:
                    second.append(self.ring[lane][k])
                    continue
                row = rows[self.site.approach[lane]] if rows else []
                come = self.setting.f_mean * self.lam[lane]
                if k - travel < min(len(row), self.setting.rows):
                    weight, said = self.row_weight(k - travel), share[lane] * row[k - travel]
                    if self.setting.by_skill:
                        weight *= max(1.0 - (k - travel) / self.setting.fade, 0.0)
                        come += weight * (said - come)
                    else:
                        come = weight * said
                rise = min(max(self.s[lane] - come, 0.0), hid[lane])
                hid[lane] -= rise
                second.append(come + rise)
            self.a.append(second)

    def _flow(self, flow: list[float], lane: int, queue: float) -> float:
        return self.site.by_law(lane, queue) if self.site.law else flow[lane]

    def _open(self, g: int, target: int, left: int, flow: list[float], lane: int, queue: float) -> float:
        """What a lane lets go in a second, in green, in amber or in red."""
        if not self.site.serves(g, lane):
            return 0.0
        c = self._flow(flow, lane, queue)
        if target == NEVER:
            return c
        if self.site.serves(target, lane):
            return min(c, self._flow(self.sat[target], lane, queue))
        return c * min(max(self.setting.yuse - (self.site.change[g][target] - left), 0.0), 1.0)

    def _ahead(self, before: int, stage: int, lane: int) -> float:
        """Who stands before the first one who gives way, in the mean of a lane where one in 1/share does."""
        if self.site.serves(before, lane) or not self.site.foes(stage, lane):
            return 0.0
        return self.site.lanes[lane] * (1.0 / self.site.gives_way_share[lane] - 1.0)

    def _in_gaps(self, g: int, lane: int, c: float, k: int, queues: list[float]) -> float:
        """A lane's flow, less where it gives way: `queues` stood before the second, arrivals of five count."""
        foes = self.site.foes(g, lane)
        if not foes or self.ahead[lane] > 0.0:
            return c
        ahead = self.a[k : k + 5]
        opposing = sum(self.first(g, f) * sum(second[f] for second in ahead) / len(ahead) for f in foes)
        standing = sum(max(queues[f], 0.0) for f in foes if not self.site.foes(g, f))
        return max(1.0 - standing, 0.0) * self.through(lane, c, opposing)

    def roll(self, cur: int, elapsed: int, first: int, hold: int, ratio: float) -> float:
        site, lanes, horizon = self.site, range(len(self.n)), self.setting.horizon
        x, g, e, su = list(self.q), cur, elapsed, [0.0] * len(self.n)
        self.ahead = [0.0] * len(self.n)  # of the first who gives way
        target, left, cost, flow = NEVER, 0, 0.0, self.sx
        nobody = [[0.0] * len(self.n)] * horizon
        passing, counted = (self.a, nobody) if self.setting.travel else (nobody, self.a)
        for k in range(horizon):
            queues = list(x)
            if target == NEVER:
                later = self.base(g, e, ratio, x, self._soon(k, x), flow) if k >= hold else g
                want = first if k == 0 else later
                if want != g:
                    target, left = want, site.change[g][want]
            for lane in lanes:
                x[lane] += passing[k][lane]
            if target != NEVER and left <= 0:
                su = [0.0 if site.serves(g, j) and site.serves(target, j) else site.startup[j] for j in lanes]
                self.ahead = [self._ahead(g, target, j) for j in lanes]
                if self.setting.travel:
                    stopped = sum(queues[j] for j in lanes if site.serves(target, j) and not site.serves(g, j))
                    cost += self.setting.stop * stopped
                g, target, e, flow = target, NEVER, 0, self.sat[target]
            for lane in lanes:
                c = self._in_gaps(g, lane, self._open(g, target, left, flow, lane, x[lane]), k, queues)
                if su[lane] >= 1.0:
                    su[lane] -= 1.0
                else:
                    gone = min(x[lane], c * (1.0 - su[lane]))
                    x[lane] -= gone
                    su[lane] = 0.0
                    self.ahead[lane] -= gone if site.foes(g, lane) else 0.0
                x[lane] += counted[k][lane]
                cost += x[lane]
            if target != NEVER:
                left -= 1
            else:
                e += 1
        return cost + sum(x[lane] ** 2 / (2.0 * self.s[lane]) for lane in lanes)

    def _soon(self, k: int, x: list[float]) -> list[float]:
        """The queues before second k with who comes within the reach then, over the mean that is planned with."""
        later = self.a[k : k + self.setting.travel]
        more = [sum(second[j] - self.setting.f_mean * self.lam[j] for second in later) for j in range(len(x))]
        return [queue + (more[j] if more[j] >= LEFT else 0.0) for j, queue in enumerate(x)]

    def _pressure(self, stage: int, x: list[float], flow: list[float]) -> float:
        seen = [queue if queue >= LEFT else 0.0 for queue in x]
        return sum(
            queue * min(self._flow(flow, j, queue), queue) for j, queue in enumerate(seen) if self.site.serves(stage, j)
        )

    def base(self, g: int, e: int, ratio: float, x: list[float], soon: list[float], flow: list[float]) -> int:
        site, setting = self.site, self.setting
        if e < setting.g_min:
            return g
        pressure = [
            self._pressure(s, soon, flow) if s == g else self._pressure(s, x, self.sat[s])
            for s in range(len(site.stages))
        ]
        best = max(range(len(pressure)), key=lambda s: (pressure[s], -s))
        if pressure[best] <= 0.0:
            return g
        return best if e >= setting.g_max or pressure[best] > ratio * pressure[g] else g
