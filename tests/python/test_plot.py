# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""tools/plot: the figures it draws, what it refuses, and that it leaves nothing behind."""

from __future__ import annotations

import csv
import math
import os
import subprocess
import sys
import xml.etree.ElementTree as ET
import zlib
from collections.abc import Iterable
from pathlib import Path

import pytest
from elmopp_tools.plot import main
from elmopp_tools.plot_data import COLUMNS, METRIC_COLUMNS, read_results
from elmopp_tools.plot_figures import KINDS, PRINTED, PRINTED_N, Figure, make_figure
from elmopp_tools.plot_labels import _spread

ROOT = Path(__file__).resolve().parents[2]
NAMES = ("throughput", "delay", "longest_red")
FILES = {f"{name}.{suffix}" for name in NAMES for suffix in ("png", "svg")}
PAPER_N = (200, 400, 600, 800, 1000)
CHOOSERS = ("naive", "cumulative:none", "cumulative:mean", "cumulative:ar8", "cumulative:oracle", "pressure", "itlc")
SATURATION_DELAY_S = dict(zip(PAPER_N, (11.9, 14.8, 40.0, 198.0, 341.0), strict=True))

Cells = dict[str, str]


def made_up_row(profile: str, name: str, vehicles: int, trial: int) -> Cells:
    """A trial about as the experiment gives it."""
    chooser, _, forecast = name.partition(":")
    wobble = 1.0 + 0.01 * math.sin(7.0 * trial + len(name))
    values = dict.fromkeys(METRIC_COLUMNS, 1.0)
    values["throughput_veh_per_s"] = 0.4 * (vehicles / 100) ** 0.7 * wobble
    values["figure_throughput_veh_per_s"] = 2.4 * (1.0 + vehicles / 200) ** -0.12 * wobble
    delay_s = SATURATION_DELAY_S.get(vehicles, 50.0) if profile == "saturation" else 150.0
    values["mean_delay_s"] = delay_s * wobble
    values["longest_red_s"] = (300.0 if chooser == "itlc" else 70.0) * wobble
    texts = {"profile": profile, "chooser": chooser, "forecast": forecast or "none"}
    counts = {"vehicles": vehicles, "trial": trial, "seed": 1}
    return texts | {column: str(value) for column, value in (counts | values).items()}


def made_up_rows(
    profiles: Iterable[str], names: Iterable[str] = CHOOSERS, numbers: Iterable[int] = PAPER_N, trials: int = 3
) -> list[Cells]:
    return [
        made_up_row(profile, name, vehicles, trial)
        for profile in profiles
        for name in names
        for vehicles in numbers
        for trial in range(trials)
    ]


def write_rows(path: Path, rows: Iterable[Cells], columns: Iterable[str] = COLUMNS) -> None:
    with path.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, list(columns), extrasaction="ignore", lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def figure_of(name: str, folder: Path) -> Figure:
    return make_figure(next(kind for kind in KINDS if kind.name == name), read_results(folder))


def texts_of(svg: Path) -> list[str]:
    return [element.text or "" for element in ET.parse(svg).iter("{http://www.w3.org/2000/svg}text")]  # noqa: S314


def png_chunks(data: bytes) -> dict[bytes, bytes]:
    """The chunks of a PNG by type, each checked; of several of one type the last."""
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    chunks, at = {}, 8
    while at < len(data):
        length = int.from_bytes(data[at : at + 4], "big")
        kind, body = data[at + 4 : at + 8], data[at + 8 : at + 8 + length]
        assert zlib.crc32(kind + body) == int.from_bytes(data[at + 8 + length : at + 12 + length], "big")
        chunks[kind] = body
        at += 12 + length
    assert kind == b"IEND"
    return chunks


def write_results(folder: Path) -> None:
    """About what a whole experiment writes."""
    folder.mkdir()
    write_rows(folder / "trials.csv", made_up_rows(["paper", "saturation"]))
    beside = made_up_rows(["figure"], ["naive", "cumulative:ar8", "itlc", "oaf"])
    beside += made_up_rows(["paper", "saturation"], ["itlc@ready=60"]) + made_up_rows(["literal"], ["naive"])
    write_rows(folder / "beside.csv", beside)


@pytest.fixture
def results(tmp_path: Path) -> Path:
    write_results(tmp_path / "results")
    return tmp_path / "results"


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The figures of such results beside them, for the tests that only look."""
    folder = tmp_path_factory.mktemp("drawn") / "results"
    write_results(folder)
    assert main(["--results", str(folder)]) == 0
    return folder


@pytest.fixture
def one_row(tmp_path: Path) -> Path:
    """A folder with a single, right row, for the tests that break it."""
    write_rows(tmp_path / "trials.csv", made_up_rows(["paper"], ["naive"], [200], 1))
    return tmp_path


def refused(capsys: pytest.CaptureFixture[str], folder: Path, *more: str) -> str:
    """The one line with which this is refused, having written nothing."""
    before = sorted(folder.rglob("*"))
    assert main(["--results", str(folder), *more]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.endswith("\n") and err.count("\n") == 1
    assert sorted(folder.rglob("*")) == before
    return err.removesuffix("\n")


# What is drawn


def test_three_figures_beside_the_rows(results: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--results", str(results)]) == 0
    assert {path.name for path in results.iterdir()} == FILES | {"trials.csv", "beside.csv"}
    assert capsys.readouterr() == ("", "")


def test_png_has_150_dpi_and_names_no_software(drawn: Path) -> None:
    for name in NAMES:
        chunks = png_chunks((drawn / f"{name}.png").read_bytes())
        assert chunks[b"pHYs"] == (5906).to_bytes(4, "big") * 2 + b"\x01"
        assert b"tEXt" not in chunks


def test_svg_is_xml_with_a_title_and_no_date(drawn: Path) -> None:
    for name in NAMES:
        text = (drawn / f"{name}.svg").read_text(encoding="utf-8")
        assert ET.fromstring(text).find("{http://www.w3.org/2000/svg}title") is not None  # noqa: S314
        assert "dc:date" not in text
        assert str(drawn) not in text


def test_second_run_gives_the_same_bytes(results: Path, tmp_path: Path) -> None:
    command = [sys.executable, str(ROOT / "tools" / "plot"), "--results", str(results), "--out"]
    for seed, out in enumerate(("a", "b")):
        environment = os.environ | {"PYTHONHASHSEED": str(seed), "TZ": f"UTC{seed}"}
        subprocess.run([*command, str(tmp_path / out)], check=True, env=environment)
    for name in FILES:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()


def test_settings_of_the_user_change_no_byte(results: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    main(["--results", str(results), "--out", str(tmp_path / "a")])
    with monkeypatch.context() as patch:
        import matplotlib as mpl

        patch.setitem(mpl.rcParams, "axes.linewidth", 9.0)
        patch.setitem(mpl.rcParams, "svg.fonttype", "path")
        main(["--results", str(results), "--out", str(tmp_path / "b")])
    for name in FILES:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()


def test_out_is_made_and_results_stay_as_they_are(results: Path, tmp_path: Path) -> None:
    out = tmp_path / "deep" / "figures"
    assert main(["--results", str(results), "--out", str(out)]) == 0
    assert {path.name for path in out.iterdir()} == FILES
    assert {path.name for path in results.iterdir()} == {"trials.csv", "beside.csv"}


def test_printed_curves_are_told_from_ours(drawn: Path) -> None:
    texts = texts_of(drawn / "throughput.svg")
    for name in ("ELMOPP", "ITLC", "OAF"):
        assert texts.count(f"{name}, printed") == 2  # panels paper and figure
    assert "printed in the paper" in texts
    assert "ours, mean of 3 trials" in texts
    assert "95 % interval of the mean" in texts
    for name in ("delay", "longest_red"):
        assert not any("printed" in text for text in texts_of(drawn / f"{name}.svg"))


def test_printed_curves_have_the_printed_values() -> None:
    assert PRINTED_N == PAPER_N
    assert list(PRINTED.values()) == [
        (2.31937, 2.17839, 2.06249, 1.97497, 1.92143),
        (1.692, 1.883, 1.8520, 1.8593, 1.8844),
        (1.2174, 1.05736, 1.1540, 1.1057, 1.07094),
    ]


def test_panels_and_units(drawn: Path) -> None:
    texts = texts_of(drawn / "throughput.svg")
    titles = [text for text in texts if text.startswith("Profile ")]
    assert [title.split(":")[0] for title in titles] == ["Profile paper", "Profile saturation", "Profile figure"]
    assert texts.count("vehicles per approach, N") == 2
    assert texts.count("vehicles on all approaches together, N") == 1
    assert any("figure_throughput" in text for text in texts)
    assert texts.count("throughput, vehicles/s") == 2
    assert texts_of(drawn / "delay.svg").count("mean delay, seconds per vehicle") == 2
    assert texts_of(drawn / "longest_red.svg").count("longest red, seconds") == 2


def test_figure_panel_shows_its_own_metric(results: Path) -> None:
    row = next(row for row in read_results(results) if row.profile == "figure" and row.vehicles == 200)
    panel = figure_of("throughput", results).panels[2]
    assert panel.lines[0].points[0].mean == pytest.approx(row.metrics["figure_throughput_veh_per_s"], rel=0.02)


def test_literal_is_left_out(drawn: Path) -> None:
    for name in NAMES:
        assert not any("literal" in text for text in texts_of(drawn / f"{name}.svg"))


@pytest.mark.parametrize(
    ("factor", "drawn", "hidden"), [(0.5, "itlc@ready=60", "itlc"), (2.0, "itlc", "itlc@ready=60")]
)
def test_the_best_of_a_sweep_stands_for_the_chooser(results: Path, factor: float, drawn: str, hidden: str) -> None:
    sweep = made_up_rows(["paper"], ["itlc@ready=60"])
    for row in sweep:
        row["mean_delay_s"] = str(float(row["mean_delay_s"]) * factor)
    write_rows(results / "beside.csv", sweep)
    names = [line.name for line in figure_of("delay", results).panels[0].ours]
    assert drawn in names
    assert hidden not in names


def test_choosers_with_options_in_the_table_are_all_drawn(tmp_path: Path) -> None:
    write_rows(tmp_path / "trials.csv", made_up_rows(["paper"], ["itlc@ready=60", "itlc@ready=20"]))
    names = {line.name for line in figure_of("delay", tmp_path).panels[0].ours}
    assert names == {"itlc@ready=60", "itlc@ready=20"}


def test_coinciding_forecasts_are_named_but_not_drawn(drawn: Path) -> None:
    texts = texts_of(drawn / "delay.svg")
    assert "Not drawn: cumulative:mean." in texts
    assert "cumulative:mean" not in texts
    assert {"naive", "cumulative", "cumulative:ar8", "cumulative:oracle", "pressure", "itlc"} <= set(texts)


def test_only_such_forecasts_are_drawn_all_the_same(tmp_path: Path) -> None:
    write_rows(tmp_path / "trials.csv", made_up_rows(["paper"], ["cumulative:mean", "cumulative:persistence"]))
    figure = figure_of("delay", tmp_path)
    assert [line.name for line in figure.panels[0].lines] == ["cumulative:mean", "cumulative:persistence"]
    assert figure.left_out == []


def test_trial_in_both_files_counts_once(tmp_path: Path) -> None:
    write_rows(tmp_path / "trials.csv", made_up_rows(["figure"], ["naive"]))
    write_rows(tmp_path / "beside.csv", made_up_rows(["figure"], ["naive", "itlc"]))
    assert len(read_results(tmp_path)) == 2 * 5 * 3


def test_beside_may_be_missing_or_without_rows(one_row: Path) -> None:
    assert main(["--results", str(one_row)]) == 0
    write_rows(one_row / "beside.csv", [])
    assert main(["--results", str(one_row)]) == 0


@pytest.mark.parametrize(
    ("names", "numbers", "trials"),
    [
        (["naive"], [800], 1),
        (CHOOSERS, [800], 2),
        (CHOOSERS, [0], 2),
        (CHOOSERS, [3, 999], 2),
        (CHOOSERS, range(200, 1100, 75), 2),  # 12 numbers: lines
        (CHOOSERS, range(200, 1100, 67), 2),  # more: points
        ([f"new-{index}" for index in range(40)], PAPER_N, 2),
        (["a$b", "c_$^d", "<&>"], PAPER_N, 2),
    ],
)
def test_any_numbers_and_any_choosers_can_be_drawn(
    tmp_path: Path, names: Iterable[str], numbers: Iterable[int], trials: int
) -> None:
    write_rows(tmp_path / "trials.csv", made_up_rows(["paper", "saturation", "figure"], names, numbers, trials))
    assert main(["--results", str(tmp_path)]) == 0
    assert {path.name for path in tmp_path.iterdir()} == FILES | {"trials.csv"}


@pytest.mark.parametrize("values", [("0", "0"), ("0", "1e12"), ("1e-300", "1e12"), ("-5", "5"), ("7", "7")])
def test_any_values_can_be_drawn(tmp_path: Path, values: tuple[str, str]) -> None:
    rows = made_up_rows(["paper", "saturation"], ["naive"], [200, 400], 2)
    for row in rows:
        row.update(dict.fromkeys(METRIC_COLUMNS, values[row["vehicles"] == "400"]))
    write_rows(tmp_path / "trials.csv", rows)
    assert main(["--results", str(tmp_path)]) == 0


def test_with_more_than_12_numbers_each_trial_is_a_point(tmp_path: Path) -> None:
    for count, scattered, points in ((12, False, 12), (13, True, 39)):
        write_rows(tmp_path / "trials.csv", made_up_rows(["saturation"], ["naive"], range(100, 100 + count)))
        panel = figure_of("delay", tmp_path).panels[0]
        assert panel.scattered is scattered
        assert len(panel.lines[0].points) == points


def test_figure_without_rows_is_named_and_not_drawn(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_rows(tmp_path / "trials.csv", made_up_rows(["figure"]))
    assert main(["--results", str(tmp_path)]) == 0
    assert {path.name for path in tmp_path.iterdir()} == {"trials.csv", "throughput.png", "throughput.svg"}
    lines = capsys.readouterr().out.splitlines()
    assert [line.split(":")[1] for line in lines] == [" delay is not drawn", " longest_red is not drawn"]


def test_nothing_to_draw_is_no_failure(tmp_path: Path) -> None:
    write_rows(tmp_path / "trials.csv", made_up_rows(["literal"]))
    assert main(["--results", str(tmp_path), "--out", str(tmp_path / "out")]) == 0
    assert {path.name for path in tmp_path.iterdir()} == {"trials.csv"}


# Numbers


def test_interval_of_the_mean(tmp_path: Path) -> None:
    rows = made_up_rows(["saturation"], ["naive"], [200], 3)
    for row, value in zip(rows, ("10", "12", "17"), strict=True):
        row["mean_delay_s"] = value
    write_rows(tmp_path / "trials.csv", rows)
    point = figure_of("delay", tmp_path).panels[0].lines[0].points[0]
    assert (point.vehicles, point.mean, point.trials) == (200, 13.0, 3)
    assert point.half_width == pytest.approx(4.3026527297 * math.sqrt(13.0 / 3.0))


def test_labels_keep_their_distance_and_order() -> None:
    places = _spread([100.0, 99.0, 98.5, 50.0, 1.0, 0.0], 10.0, 0.0, 100.0)
    assert places == pytest.approx([100.0, 90.0, 80.0, 50.0, 10.0, 0.0])
    assert _spread([60.0, 40.0], 10.0, 0.0, 100.0) == [60.0, 40.0]


# What is refused


def test_missing_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    line = refused(capsys, tmp_path)
    assert (
        line == f"plot: {tmp_path}/trials.csv: no such file; right would be the folder that host_sim experiment wrote"
    )


@pytest.mark.parametrize("column", COLUMNS)
def test_missing_column(one_row: Path, capsys: pytest.CaptureFixture[str], column: str) -> None:
    columns = [other for other in COLUMNS if other != column]
    write_rows(one_row / "trials.csv", made_up_rows(["paper"], ["naive"], [200], 1), columns)
    line = refused(capsys, one_row)
    assert line == f"plot: {one_row}/trials.csv:1: no column {column}; right would be {','.join(COLUMNS)}"


@pytest.mark.parametrize(
    "value", ["", "x", "nan", "inf", "1e400", "1e13", "1_0", " 1", "0x1", "1,5", "two\nlines", "é"]
)
@pytest.mark.parametrize("column", ["vehicles", "mean_delay_s", "vehicles_outside"])
@pytest.mark.parametrize("name", ["trials.csv", "beside.csv"])
def test_cell_that_is_no_number(
    one_row: Path, capsys: pytest.CaptureFixture[str], name: str, column: str, value: str
) -> None:
    rows = made_up_rows(["paper"], ["naive"], [200], 2)
    rows[1][column] = value
    write_rows(one_row / name, rows)
    line = refused(capsys, one_row)
    line_number = 4 if "\n" in value else 3
    assert line.startswith(f'plot: {one_row}/{name}:{line_number}, column {column}: "')
    assert "; right would be a" in line


def test_long_cell_is_shown_short(one_row: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_rows(one_row / "trials.csv", [made_up_row("paper", "naive", 200, 0) | {"served_share": "9" * 5000}])
    assert len(refused(capsys, one_row)) < 200 + len(str(one_row))


@pytest.mark.parametrize("column", ["profile", "chooser", "forecast"])
@pytest.mark.parametrize("value", ["", "a\nb", "\x1b[31m"])
def test_name_that_is_none(one_row: Path, capsys: pytest.CaptureFixture[str], column: str, value: str) -> None:
    write_rows(one_row / "trials.csv", [made_up_row("paper", "naive", 200, 0) | {column: value}])
    assert f", column {column}: " in refused(capsys, one_row)


@pytest.mark.parametrize("content", ["", ",".join(COLUMNS) + "\n"])
def test_no_rows(tmp_path: Path, capsys: pytest.CaptureFixture[str], content: str) -> None:
    (tmp_path / "trials.csv").write_text(content, encoding="utf-8")
    line = refused(capsys, tmp_path)
    assert line.startswith(f"plot: {tmp_path}/trials.csv:")
    assert ("no rows" if content else "no column profile") in line


@pytest.mark.parametrize(
    ("tail", "wrong"), [(b"paper,naive\n", ":3: 2 values"), (b'"paper\n', ":3: "), (b"\xff\n", ": is no UTF-8 text")]
)
def test_broken_line(one_row: Path, capsys: pytest.CaptureFixture[str], tail: bytes, wrong: str) -> None:
    with (one_row / "trials.csv").open("ab") as stream:
        stream.write(tail)
    assert f"trials.csv{wrong}" in refused(capsys, one_row)


def test_folder_in_place_of_a_file(one_row: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (one_row / "beside.csv").mkdir()
    assert f"{one_row}/beside.csv: " in refused(capsys, one_row)


def test_out_that_is_a_file(one_row: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = one_row / "file"
    out.touch()
    assert f"--out {out}: is no folder" in refused(capsys, one_row, "--out", str(out))
    assert f"{out}" in refused(capsys, one_row, "--out", str(out / "below"))


def test_figure_that_cannot_be_replaced_leaves_the_others(one_row: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (one_row / "longest_red.svg").mkdir()
    assert "longest_red.svg: is no regular file" in refused(capsys, one_row)


def test_failed_write_leaves_no_part(
    one_row: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(path: Path, data: bytes) -> int:
        with path.open("wb") as stream:
            stream.write(data[:10])
        raise OSError(28, "No space left on device", str(path))

    monkeypatch.setattr(Path, "write_bytes", fail)
    assert "No space left on device" in refused(capsys, one_row)


@pytest.mark.parametrize("arguments", [[], ["--results"], ["--results", "x", "y"], ["--result", "x"]])
def test_wrong_arguments(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(arguments)
    assert ended.value.code == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_help_names_files_and_exit_codes(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["--help"])
    assert ended.value.code == 0
    text = capsys.readouterr().out
    for word in ("trials.csv", "beside.csv", "throughput", "delay", "longest_red", "--out", "Exit codes"):
        assert word in text
