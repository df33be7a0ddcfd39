# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The page of tools/report: which tables and figures it has, and their HTML."""

import base64
import math
import statistics
from collections.abc import Callable, Iterable, Sequence
from html import escape

from elmopp_tools import report_draw
from elmopp_tools.paired import Pair, paired
from elmopp_tools.plot_data import WAIT_COLUMN, Row, points_of
from elmopp_tools.plot_draw import draw_figure
from elmopp_tools.plot_figures import Kind, make_figure
from elmopp_tools.report_data import Comparison, Log, Table, Way
from elmopp_tools.sumo_compare import Cell

STYLE = """
:root { color-scheme: light; }
body { font: 15px/1.45 "DejaVu Sans", Verdana, sans-serif; color: #1a1a1a; background: #fff;
       max-width: 72rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.7rem; } h2 { font-size: 1.3rem; margin-top: 2.6rem; border-bottom: 2px solid #0072B2; }
h3 { font-size: 1.05rem; margin-top: 1.8rem; }
nav a { margin-right: 1.2em; } a { color: #0072B2; }
p { max-width: 46rem; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; margin: 0.6rem 0 1.2rem; font-size: 0.86rem; font-variant-numeric: tabular-nums; }
caption { text-align: left; color: #555; padding-bottom: 0.3rem; }
th, td { padding: 0.18rem 0.4rem; text-align: right; white-space: nowrap; }
thead th { white-space: normal; vertical-align: bottom; }
th:first-child, td:first-child { text-align: left; padding-left: 0; }
thead th { border-bottom: 1px solid #555; } tbody tr:nth-child(even) { background: #f4f6f8; }
td.best { font-weight: bold; } td.best::before { content: "▸ "; color: #0072B2; }
figure { margin: 1rem 0; } figure img { max-width: 100%; height: auto; }
figcaption { color: #555; font-size: 0.86rem; max-width: 46rem; }
"""

NOTHING = "\N{EN DASH}"
REFERENCES = ("none", "ewma")  # what a forecast is held against: the first of them that was run
JUDGED = "lstm"  # what it is said of in words whether it beats ...
SIMPLE = ("none", "ewma", "ar8")  # ... those without a network


def make_page(
    title: str, rows: Sequence[Row], comparison: Comparison | None, log: Log | None, ways: Sequence[Way]
) -> str:
    """The whole page."""
    sections = []
    if rows:
        sections.append(("experiment", "In our own simulator", _experiment(rows)))
    if comparison is not None:
        sections.append(("sumo", "In SUMO", _sumo(comparison)))
    if log is not None:
        sections.append(("run", "One run", _run(log)))
    if ways:
        figure = _figure(report_draw.ways(ways), "Vehicles before the stop line", WAYS_CAPTION)
        sections.append(("ways", "Time and space", figure))
    links = "".join(f'<a href="#{name}">{escape(text)}</a>' for name, text, _ in sections)
    body = "".join(f'<section id="{name}"><h2>{escape(text)}</h2>{inner}</section>' for name, text, inner in sections)
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{escape(title)}</title>\n'
        f'<meta name="viewport" content="width=device-width, initial-scale=1"><style>{STYLE}</style></head>\n'
        f"<body><header><h1>{escape(title)}</h1><nav>{links}</nav></header><main>{body}</main></body></html>\n"
    )


WAYS_CAPTION = (
    "One line a vehicle. Where lines run level, vehicles stand; where they end at 0, they cross the stop line."
)

# --- our own simulator ------------------------------------------------------------------------------------------------


def _experiment(rows: Sequence[Row]) -> str:
    parts = []
    for profile in dict.fromkeys(row.profile for row in rows):
        here = [row for row in rows if row.profile == profile]
        trials = len({(row.trial, row.seed) for row in here})
        parts.append(f"<h3>Profile {escape(profile)}</h3><p>{len(here)} runs, {trials} trials at most a point.</p>")
        parts += [_curve(here, profile), _by_vehicles(here, "mean_delay_s", "Mean delay of a vehicle, s", best=min)]
        parts.append(_by_vehicles(here, "longest_red_s", "Longest red that a waiting vehicle saw, s: mean", best=None))
        parts.append(_extremes(here))
        parts.append(_ablation(here))
    return "".join(parts)


def _curve(rows: Sequence[Row], profile: str) -> str:
    # The profile figure measures a throughput of its own and draws nothing else.
    title = "Throughput" if profile == "figure" else "Mean delay"
    figure = make_figure(Kind("delay", title, "mean_delay_s", "seconds per vehicle", (profile,), 20.0), rows)
    caption = "Mean over the trials, shaded with its 95 % interval; a logarithmic axis where delays differ much."
    return _figure(draw_figure(figure)["svg"], f"{title} by number of vehicles, profile {profile}", caption)


def _by_vehicles(
    rows: Sequence[Row], metric: str, caption: str, best: Callable[[Iterable[float]], float] | None
) -> str:
    counts = sorted({row.vehicles for row in rows})
    points = {
        name: {point.vehicles: point for point in points_of((row for row in rows if row.name == name), metric)}
        for name in dict.fromkeys(row.name for row in rows)
    }
    bests = {n: best(p[n].mean for p in points.values() if n in p) if best else math.nan for n in counts}
    lines = []
    for name, by_count in points.items():
        cells: list[str | tuple[str, bool]] = [name]
        for count in counts:
            point = by_count.get(count)
            text = f"{point.mean:.1f} ± {point.half_width:.1f}" if point else NOTHING
            cells.append((text, point is not None and point.mean == bests[count]))
        lines.append(cells)
    return _table(f"{caption} ± 95 % interval", ["chooser", *(f"N = {count}" for count in counts)], lines)


def _extremes(rows: Sequence[Row]) -> str:
    lines = []
    for name in dict.fromkeys(row.name for row in rows):
        metrics = [row.metrics for row in rows if row.name == name]
        waits = [m[WAIT_COLUMN] for m in metrics if WAIT_COLUMN in m]
        lines.append(
            [
                name,
                f"{max(waits):.0f}" if waits else NOTHING,
                f"{max(m['longest_red_s'] for m in metrics):.0f}",
                f"{statistics.fmean(m['switches'] for m in metrics):.0f}",
                f"{statistics.fmean(m['served_share'] for m in metrics):.3f}",
                f"{max(m['vehicles_outside'] for m in metrics):.0f}",
            ]
        )
    head = ["chooser", "longest wait, s", "longest red, s"]
    head += ["switches, mean", "served share, mean", "left outside, at most"]
    return _table("Over all numbers of vehicles and trials", head, lines)


def _ablation(rows: Sequence[Row]) -> str:
    counts = sorted({row.vehicles for row in rows})
    parts = []
    for chooser in dict.fromkeys(row.chooser for row in rows):
        forecasts = list(dict.fromkeys(row.forecast for row in rows if row.chooser == chooser))
        reference = next((name for name in REFERENCES if name in forecasts), None)
        if reference is None or len(forecasts) < 2:
            continue
        delay = {
            forecast: {
                (row.vehicles, row.trial, row.seed): row.metrics["mean_delay_s"]
                for row in rows
                if row.chooser == chooser and row.forecast == forecast
            }
            for forecast in forecasts
        }
        lines = [
            [forecast, *(_difference(_pair_at(delay[forecast], delay[reference], count)) for count in counts)]
            for forecast in forecasts
            if forecast != reference
        ]
        caption = f"{chooser}: mean delay with each forecast less that with {reference}, s, paired, 95 % interval"
        parts.append(_table(caption, ["forecast", *(f"N = {count}" for count in counts)], lines))
        parts.append(
            _in_words(
                chooser,
                "numbers of vehicles",
                {
                    name: [_pair_at(delay[JUDGED], delay[name], count) for count in counts]
                    for name in SIMPLE
                    if name in delay and JUDGED in delay
                },
            )
        )
    return "".join(parts)


def _in_words(chooser: str, cells: str, pairs: dict[str, list[Pair | None]]) -> str:
    """Whether the judged forecast beats those without a network, from the same pairs as the table; nothing of none."""
    said = []
    for name, all_of_them in pairs.items():
        known = [pair for pair in all_of_them if pair is not None]
        better, worse = sum(pair.high < 0.0 for pair in known), sum(pair.low > 0.0 for pair in known)
        if known:
            said.append(
                f"{JUDGED} less {name}: the interval excludes 0 in {better + worse} of {len(known)} {cells}: "
                f"for {JUDGED} in {better}, against it in {worse}."
            )
    return f"<p>{escape(' '.join([f'{chooser}.', *said]))}</p>" if said else ""


def _pair_at(
    one: dict[tuple[int, int, int], float], other: dict[tuple[int, int, int], float], vehicles: int
) -> Pair | None:
    keys = sorted(key for key in one.keys() & other.keys() if key[0] == vehicles)
    return paired([one[key] for key in keys], [other[key] for key in keys])


def _difference(pair: Pair | None) -> str:
    return NOTHING if pair is None else f"{pair.mean:+.2f} ± {pair.high - pair.mean:.2f}"


# --- SUMO -------------------------------------------------------------------------------------------------------------


SUMO_SAYS = (
    "Delay is time loss and wait to enter, over every vehicle that entered; read it with the vehicles that never "
    "could. The best rival of a scenario is the one with the lowest mean delay over the seeds, chosen before ours are "
    "looked at. The same seed has the same vehicles for all."
)


def _sumo(comparison: Comparison) -> str:
    return "".join(
        (
            f"<p>{SUMO_SAYS}</p>",
            _rows("Everybody, as a share of the best rival of each scenario", comparison.standings),
            _rows("The best rival of each scenario", comparison.best_rivals),
            _figure(
                report_draw.ratios(comparison.ours),
                "Ours beside the best rival, by scenario",
                "Left of the line is better than the best rival. What is off the axis is in the table.",
            ),
            _ours(comparison.ours),
            _longest("Longest wait of a vehicle over all seeds, s", comparison.cells, lambda cell: cell.longest_wait_s),
            _longest(
                "Longest red that a waiting vehicle saw, over all seeds, s",
                comparison.cells,
                lambda cell: cell.longest_red_s,
            ),
            _sumo_ablation(comparison.cells),
        )
    )


def _rows(caption: str, rows: Table) -> str:
    head = list(rows[0])
    return _table(caption, [name.replace("_", " ") for name in head], [list(row.values()) for row in rows])


def _ours(rows: Table) -> str:
    """comparison.csv, the rival's value in brackets beside ours."""
    head = [
        "scenario",
        "chooser",
        "best rival",
        "seeds",
        "delay, s (rival)",
        "ratio",
        "difference ± 95 % interval, s",
        "not inserted (rival)",
        "teleports (rival)",
        "longest wait, s (rival)",
    ]
    lines = []
    for row in rows:
        half_s = (float(row["ci_high_s"]) - float(row["ci_low_s"])) / 2.0
        beside = [f"{row[key]} ({row[f'rival_{key}']})" for key in ("not_inserted", "teleports", "longest_wait_s")]
        names = [row[key] for key in ("scenario", "chooser", "best_rival", "seeds")]
        delay = f"{row['delay_s']} ({row['rival_delay_s']})"
        difference = f"{float(row['difference_s']):+.2f} ± {half_s:.2f}"
        lines.append([*names, delay, row["ratio"], difference, *beside])
    return _table("Ours against the best rival, paired by seed", head, lines)


def _longest(caption: str, cells: Sequence[Cell], value_of: Callable[[Cell], float]) -> str:
    scenarios = sorted({cell.scenario for cell in cells})
    by_name: dict[str, dict[str, Cell]] = {}
    for cell in cells:
        by_name.setdefault(cell.name, {})[cell.scenario] = cell
    lines = [
        [name, *(f"{value_of(here[s]):.0f}" if s in here else NOTHING for s in scenarios)]
        for name, here in by_name.items()
    ]
    return _table(caption, ["chooser", *scenarios], lines)


def _sumo_ablation(cells: Sequence[Cell]) -> str:
    by_name = {(cell.name, cell.scenario): cell for cell in cells}
    parts = []
    for chooser in dict.fromkeys(cell.name.partition(":")[0] for cell in cells):
        names = list(dict.fromkeys(c.name for c in cells if c.name.partition(":")[0] == chooser))
        wanted = (chooser if name == "none" else f"{chooser}:{name}" for name in REFERENCES)
        reference = next((name for name in wanted if name in names), None)
        if reference is None or len(names) < 2:
            continue
        scenarios = sorted({cell.scenario for cell in cells if cell.name == reference})
        lines = [[name, *_against(name, reference, scenarios, by_name)] for name in names if name != reference]
        head = ["", "scenarios", "geometric mean of the ratio", "better in", "worse in", "undecided in"]
        parts.append(_table(f"What a forecast is worth: delay beside {reference}, paired by seed", head, lines))
        parts.append(_in_words(chooser, "scenarios", _sumo_pairs(chooser, names, scenarios, by_name)))
    return "".join(parts)


def _sumo_pairs(
    chooser: str, names: Sequence[str], scenarios: Sequence[str], cells: dict[tuple[str, str], Cell]
) -> dict[str, list[Pair | None]]:
    """Of the judged forecast and each without a network that was run, by scenario."""
    judged = f"{chooser}:{JUDGED}"
    others = {name: chooser if name == "none" else f"{chooser}:{name}" for name in SIMPLE}
    return {
        name: [_sumo_pair(cells.get((judged, s)), cells.get((other, s))) for s in scenarios]
        for name, other in others.items()
        if judged in names and other in names
    }


def _sumo_pair(one: Cell | None, other: Cell | None) -> Pair | None:
    if one is None or other is None:
        return None
    seeds = sorted(one.delay_s.keys() & other.delay_s.keys())
    return paired([one.delay_s[seed] for seed in seeds], [other.delay_s[seed] for seed in seeds])


def _against(name: str, reference: str, scenarios: Sequence[str], cells: dict[tuple[str, str], Cell]) -> list[str]:
    logs: list[float] = []
    better = worse = 0
    for scenario in scenarios:
        one, other = cells.get((name, scenario)), cells[reference, scenario]
        pair = _sumo_pair(one, other)
        if one is not None and pair is not None:
            seeds = one.delay_s.keys() & other.delay_s.keys()
            logs.append(math.log(sum(one.delay_s[s] for s in seeds) / sum(other.delay_s[s] for s in seeds)))
            better += pair.high < 0.0
            worse += pair.low > 0.0
    mean = f"{math.exp(statistics.fmean(logs)):.3f}" if logs else NOTHING
    return [str(len(logs)), mean, str(better), str(worse), str(len(logs) - better - worse)]


# --- one run ----------------------------------------------------------------------------------------------------------


def _run(log: Log) -> str:
    caption = (
        f"{len(log.t_s)} seconds. Above: how many vehicles the controller saw in each movement. Middle: the lamps of "
        "each signal group. Below: how many it expected within 60 s, and how many then came."
    )
    longest = max(_longest_red_s(log), default=0)
    changes = sum(a != b for a, b in zip(log.stage, log.stage[1:], strict=False))
    facts = f"<p>Stage changes: {changes}. Longest time a group showed no green: {longest} s.</p>"
    return facts + _figure(report_draw.run(log), "Queues, lamps and forecast of one run", caption)


def _longest_red_s(log: Log) -> list[int]:
    """Of each group that is ever green, its longest time without green."""
    result = []
    for group in range(len(log.aspects[0])):
        shown = [aspects[group] for aspects in log.aspects]
        if "3" in shown:
            result.append(max(map(len, "".join("g" if a == "3" else "r" for a in shown).split("g"))))
    return result


# --- HTML -------------------------------------------------------------------------------------------------------------


def _figure(svg: bytes, alternative: str, caption: str) -> str:
    data = base64.b64encode(svg).decode()
    return (
        f'<figure><img src="data:image/svg+xml;base64,{data}" alt="{escape(alternative)}">'
        f"<figcaption>{escape(caption)}</figcaption></figure>"
    )


def _table(caption: str, head: Sequence[str], lines: Iterable[Sequence[str | tuple[str, bool]]]) -> str:
    heads = "".join(f'<th scope="col">{escape(text)}</th>' for text in head)
    body = "".join(f"<tr>{''.join(map(_cell, line))}</tr>" for line in lines)
    return (
        f'<div class="wide"><table><caption>{escape(caption)}</caption>'
        f"<thead><tr>{heads}</tr></thead><tbody>{body}</tbody></table></div>"
    )


def _cell(value: str | tuple[str, bool]) -> str:
    text, best = value if isinstance(value, tuple) else (value, False)
    return f'<td class="best">{escape(text)}</td>' if best else f"<td>{escape(text)}</td>"
