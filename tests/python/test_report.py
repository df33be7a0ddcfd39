# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""tools/report: what the page says, that it needs nothing beside it, and what it refuses."""

from __future__ import annotations

import csv
import json
from html.parser import HTMLParser
from pathlib import Path

import pytest
from elmopp_tools.plot_data import COLUMNS, METRIC_COLUMNS, WAIT_COLUMN
from elmopp_tools.report import main
from elmopp_tools.sumo_compare import compare
from elmopp_tools.sumo_report import COLUMNS as RUN_COLUMNS

# Mean 12 with one trial at 10, 12 and 14; t(0.975, 2) = 4.3027, so half = 4.3027 * 2 / sqrt(3) = 4.97.
DELAY_S = {"naive": (20.0, 22.0, 24.0), "cumulative:none": (10.0, 12.0, 14.0), "cumulative:ewma": (9.0, 11.5, 12.5)}


class Page(HTMLParser):
    """The text of each cell by caption, and what the page would fetch."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tables: dict[str, list[list[str]]] = {}
        self.best: list[str] = []
        self.addresses: list[str] = []
        self.tags: list[str] = []
        self.open: list[str] = []
        self.caption = ""
        self.is_best = False
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        attributes = dict(attrs)
        self.tags.append(tag)
        if tag not in ("meta", "img"):
            self.open.append(tag)
        self.addresses += [value or "" for name, value in attrs if name in ("src", "href")]
        if tag == "img":
            assert attributes["alt"], "a picture without words for it"
        if tag == "tr":
            self.tables[self.caption].append([])
        if tag in ("td", "th"):
            self.tables[self.caption][-1].append("")
            self.is_best = attributes.get("class") == "best"

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag, "tags are not nested"

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] == "caption":
            self.caption = data
            assert data not in self.tables or data.startswith(("Mean", "Longest", "Over")), f"two tables {data}"
            self.tables[data] = []
        elif self.open and self.open[-1] in ("td", "th"):
            self.tables[self.caption][-1][-1] += data
            if self.is_best:
                self.best.append(data)

    def row(self, caption: str, name: str) -> list[str]:
        table = next(rows for key, rows in self.tables.items() if key.startswith(caption))
        return next(row for row in table if row[0] == name)


@pytest.fixture
def experiment(tmp_path: Path) -> Path:
    folder = tmp_path / "experiment"
    folder.mkdir()
    rows = []
    for name, delays in DELAY_S.items():
        chooser, _, forecast = name.partition(":")
        for trial, delay_s in enumerate(delays):
            values: dict[str, object] = {**dict.fromkeys(METRIC_COLUMNS, 1.0), "mean_delay_s": delay_s}
            cells = {"profile": "saturation", "chooser": chooser, "forecast": forecast or "none"}
            rows.append(cells | {"vehicles": 300, "trial": trial, "seed": 1} | values)
    write_csv(folder / "trials.csv", list(COLUMNS), rows)
    return folder


@pytest.fixture
def sumo(tmp_path: Path) -> Path:
    folder = tmp_path / "sumo"
    folder.mkdir()
    delay_s = {"fixed": (30.0, 34.0), "rollout:none": (24.0, 27.0), "rollout:lstm": (22.0, 25.5)}
    rows = []
    for name, delays in delay_s.items():
        chooser, _, forecast = name.partition(":")
        for seed, delay in enumerate(delays, start=1):
            cells: dict[str, object] = dict.fromkeys(RUN_COLUMNS, 0) | {"scenario": "tee", "chooser": chooser}
            cells |= {"forecast": forecast or "none", "seed": seed, "delay_s": delay, "longest_wait_s": delay * 3}
            cells["longest_red_s"] = delay * 4
            rows.append(cells)
    write_csv(folder / "runs.csv", list(RUN_COLUMNS), rows)
    compare(folder / "runs.csv", folder, ("rollout",))
    return folder


@pytest.fixture
def log(tmp_path: Path) -> Path:
    file = tmp_path / "log.jsonl"
    seconds = [
        {
            "t_s": t,
            "stage": int(t >= 40),
            "aspects": "31" if t < 30 else ("41" if t < 33 else ("11" if t < 40 else "13")),
            "present": [t % 5, 2.5],
            "arrived": [0.2, 0.3],
            "urgency": [0.0, 0.0],
            "forecast": [12.0, 18.0],
            "fault": 0,
        }
        for t in range(100)
    ]
    file.write_text("".join(json.dumps(second) + "\n" for second in seconds), encoding="utf-8")
    return file


@pytest.fixture
def paths(tmp_path: Path) -> Path:
    rows: list[dict[str, object]] = [
        {"t_s": t, "approach": "north", "vehicle": f"v{v}", "distance_m": 90 - 9 * t}
        for v in range(2)
        for t in range(9)
    ]
    write_csv(tmp_path / "paths.csv", ["t_s", "approach", "vehicle", "distance_m"], rows)
    return tmp_path / "paths.csv"


def write_csv(file: Path, columns: list[str], rows: list[dict[str, object]]) -> None:
    with file.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def page_of(out: Path, *arguments: str | Path) -> Page:
    assert main([*map(str, arguments), "--out", str(out)]) == 0
    return Page(out.read_text(encoding="utf-8"))


def refused(capsys: pytest.CaptureFixture[str], out: Path, *arguments: str | Path) -> str:
    """The one line with which this is refused; the page that is there stays."""
    out.write_text("before", encoding="utf-8")
    assert main([*map(str, arguments), "--out", str(out)]) == 2
    assert out.read_text(encoding="utf-8") == "before"
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.count("\n") == 1
    assert "right would be" in said.err
    return said.err


def test_page_needs_nothing_beside_it(experiment: Path, sumo: Path, log: Path, paths: Path, tmp_path: Path) -> None:
    out = tmp_path / "page.html"
    page = page_of(out, "--experiment", experiment, "--sumo", sumo, "--run", log, "--paths", paths)
    assert page.open == []
    assert not {"script", "link", "iframe"} & set(page.tags)
    assert all(address.startswith(("data:image/svg+xml;base64,", "#")) for address in page.addresses)
    assert sum(address.startswith("data:") for address in page.addresses) == 4
    first = out.read_bytes()
    page_of(out, "--experiment", experiment, "--sumo", sumo, "--run", log, "--paths", paths)
    assert out.read_bytes() == first


def test_section_without_files_is_left_out(log: Path, tmp_path: Path) -> None:
    text = "".join(page_of(tmp_path / "page.html", "--run", log).addresses)
    assert "#run" in text
    assert "#sumo" not in text


def test_means_have_intervals_and_the_best_is_marked(experiment: Path, tmp_path: Path) -> None:
    page = page_of(tmp_path / "page.html", "--experiment", experiment)
    assert page.row("Mean delay", "cumulative") == ["cumulative", "12.0 ± 5.0"]
    assert page.best == ["11.0 ± 4.5"]  # 9, 11.5, 12.5


def test_longest_wait_is_shown_where_single_vehicles_drive(experiment: Path, tmp_path: Path) -> None:
    names = {"profile": "saturation", "chooser": "cumulative", "forecast": "none", "vehicles": 300, "seed": 1}
    rows: list[dict[str, object]] = [{**names, "trial": trial, WAIT_COLUMN: 90 - trial} for trial in (0, 1)]
    write_csv(experiment / "waits.csv", [*names, "trial", WAIT_COLUMN], rows)
    page = page_of(tmp_path / "page.html", "--experiment", experiment)
    assert page.row("Over all", "chooser")[:3] == ["chooser", "longest wait, s", "longest red, s"]
    assert page.row("Over all", "cumulative")[:2] == ["cumulative", "90"]
    assert page.row("Over all", "cumulative:ewma")[:2] == ["cumulative:ewma", "\N{EN DASH}"]


def test_a_wait_that_is_no_number(experiment: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    names = "profile,chooser,forecast,vehicles,trial,seed"
    (experiment / "waits.csv").write_text(f"{names},longest_wait_s\nsaturation,cumulative,none,300,0,1,long\n")
    said = refused(capsys, tmp_path / "page.html", "--experiment", experiment)
    assert 'waits.csv:2, column longest_wait_s: "long"; right would be a number' in said
    (experiment / "waits.csv").write_text(f"{names}\n")
    said = refused(capsys, tmp_path / "page.html", "--experiment", experiment)
    assert f"waits.csv:1: no column longest_wait_s; right would be {names},longest_wait_s" in said


def test_forecast_is_paired_by_trial(experiment: Path, tmp_path: Path) -> None:
    """Differences -1, -0.5 and -1.5: mean -1, sd 0.5, half 4.3027 * 0.5 / sqrt(3) = 1.24."""
    page = page_of(tmp_path / "page.html", "--experiment", experiment)
    assert page.row("cumulative: mean delay", "ewma") == ["ewma", "-1.00 ± 1.24"]


def test_sumo_tables_are_those_of_the_comparison(sumo: Path, tmp_path: Path) -> None:
    page = page_of(tmp_path / "page.html", "--sumo", sumo)
    assert page.row("The best rival", "tee")[:3] == ["tee", "fixed", "32.00"]
    # Differences -6 and -7: half = 12.706 * 0.7071 / sqrt(2) = 6.35.
    ours = next(rows for key, rows in page.tables.items() if key.startswith("Ours against"))
    assert [row for row in ours if row[1] == "rollout"] == [
        ["tee", "rollout", "fixed", "2", "25.50 (32.00)", "0.7969", "-6.50 ± 6.35", "0 (0)", "0 (0)", "81 (102)"]
    ]
    assert len(ours[0]) == len(ours[1])
    assert page.row("Longest wait", "rollout:lstm") == ["rollout:lstm", "76"]
    assert page.row("Longest red", "rollout:lstm") == ["rollout:lstm", "102"]


def test_sumo_forecast_is_held_against_none(sumo: Path, tmp_path: Path) -> None:
    """Differences -2 and -1.5: half = 12.706 * 0.25 = 3.18, undecided; ratio 47.5 / 51."""
    page = page_of(tmp_path / "page.html", "--sumo", sumo)
    assert page.row("What a forecast", "rollout:lstm") == ["rollout:lstm", "1", "0.931", "0", "0", "1"]


def test_words_say_whether_the_network_beats_what_has_none(experiment: Path, sumo: Path, tmp_path: Path) -> None:
    """Less ewma -2, -3, -1.5: surely better; less ar8 +1, +1.5, +2: surely worse."""
    trials = experiment / "trials.csv"
    lines = trials.read_text(encoding="utf-8").splitlines()
    ewma = [line for line in lines if ",cumulative,ewma," in line]
    for name, delays in (("lstm", (7.0, 8.5, 11.0)), ("ar8", (6.0, 7.0, 9.0))):
        for line, delay_s in zip(ewma, delays, strict=True):
            cells = line.replace(",ewma,", f",{name},").split(",")
            cells[COLUMNS.index("mean_delay_s")] = str(delay_s)
            lines.append(",".join(cells))
    trials.write_text("\n".join(lines) + "\n", encoding="utf-8")
    page_of(tmp_path / "page.html", "--experiment", experiment, "--sumo", sumo)
    text = (tmp_path / "page.html").read_text(encoding="utf-8")
    told = "the interval excludes 0 in"
    assert f"lstm less ewma: {told} 1 of 1 numbers of vehicles: for lstm in 1, against it in 0." in text
    assert f"lstm less ar8: {told} 1 of 1 numbers of vehicles: for lstm in 0, against it in 1." in text
    assert f"rollout. lstm less none: {told} 0 of 1 scenarios: for lstm in 0, against it in 0.</p>" in text


def test_nothing_is_said_of_a_network_that_was_not_run(experiment: Path, tmp_path: Path) -> None:
    page_of(tmp_path / "page.html", "--experiment", experiment)
    assert "lstm less" not in (tmp_path / "page.html").read_text(encoding="utf-8")


def test_run_says_changes_and_longest_red(log: Path, tmp_path: Path) -> None:
    page_of(tmp_path / "page.html", "--run", log)
    text = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert "Stage changes: 1. Longest time a group showed no green: 70 s." in text


def test_names_are_escaped(experiment: Path, tmp_path: Path) -> None:
    trials = experiment / "trials.csv"
    trials.write_text(trials.read_text(encoding="utf-8").replace("naive", "<b>&"), encoding="utf-8")
    page = page_of(tmp_path / "page.html", "--experiment", experiment)
    assert page.row("Mean delay", "<b>&")[0] == "<b>&"
    assert "b" not in page.tags


def test_nothing_to_report_on(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        main(["--out", str(tmp_path / "page.html")])
    assert stop.value.code == 2
    assert "nothing to report on" in capsys.readouterr().err


@pytest.mark.parametrize("option", ["--experiment", "--sumo", "--run", "--paths"])
def test_missing_file(tmp_path: Path, capsys: pytest.CaptureFixture[str], option: str) -> None:
    assert "none_there" in refused(capsys, tmp_path / "page.html", option, tmp_path / "none_there")


@pytest.mark.parametrize(
    ("line", "says"),
    [("{}", "no key t_s"), ("[]", "no object"), ("{", "Expecting"), ('{"t_s": "x"}', "no key stage")],
)
def test_broken_log(log: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], line: str, says: str) -> None:
    lines = log.read_text(encoding="utf-8").splitlines()
    lines[4] = line
    log.write_text("\n".join(lines), encoding="utf-8")
    said = refused(capsys, tmp_path / "page.html", "--run", log)
    assert "log.jsonl:5:" in said
    assert says in said


def test_log_of_two_sites(log: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    lines = log.read_text(encoding="utf-8").splitlines()
    lines[4] = lines[4].replace('"arrived": [0.2, 0.3]', '"arrived": [0.2]')
    log.write_text("\n".join(lines), encoding="utf-8")
    assert "log.jsonl:5: arrived has 1 values; right would be 2" in refused(
        capsys, tmp_path / "page.html", "--run", log
    )


def test_empty_log(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "log.jsonl").touch()
    assert "is empty" in refused(capsys, tmp_path / "page.html", "--run", tmp_path / "log.jsonl")


def test_path_that_is_no_number(paths: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    paths.write_text(paths.read_text(encoding="utf-8").replace(",81\n", ",inf\n", 1), encoding="utf-8")
    assert "paths.csv:3: t_s and distance_m" in refused(capsys, tmp_path / "page.html", "--paths", paths)


def test_missing_column(sumo: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = sumo / "comparison.csv"
    file.write_text(file.read_text(encoding="utf-8").replace("ci_low_s", "low"), encoding="utf-8")
    assert "no column ci_low_s" in refused(capsys, tmp_path / "page.html", "--sumo", sumo)


def test_out_in_no_folder(log: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--run", str(log), "--out", str(tmp_path / "no" / "page.html")]) == 2
    assert "right would be a folder that exists" in capsys.readouterr().err
