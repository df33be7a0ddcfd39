# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""tools/sumo-run with the real SUMO: what it reports, what it shows, what it counts, what it refuses."""

import csv
import json
import shutil
import subprocess
from itertools import groupby, pairwise
from pathlib import Path
from xml.etree import ElementTree

import pytest
from sumo_nets import CROSS, cross, traffic

ROOT = Path(__file__).resolve().parents[2]
SUMO_BIN = ROOT / "build" / "venv" / "sumo" / "bin"
PYTHON = SUMO_BIN / "python"


def sumo_run(*words: object, expect: int = 0) -> list[dict[str, str]]:
    done = run(*words)
    assert done.returncode == expect, done.stderr
    return list(csv.DictReader(done.stdout.splitlines()))


def run(*words: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [ROOT / "tools" / "sumo-run", *map(str, words)],
        capture_output=True,
        text=True,
        check=False,
        timeout=100,
        cwd=ROOT,
    )


def refused(*words: object) -> str:
    done = run(*words)
    assert done.returncode == 2, (done.returncode, done.stderr)
    assert done.stderr.startswith("sumo-run: ")
    assert done.stderr.count("\n") == 1, done.stderr
    assert not done.stdout
    return done.stderr


def root_of(file: Path) -> ElementTree.Element:
    return ElementTree.parse(file).getroot()  # noqa: S314  SUMO has just written it


@pytest.fixture(scope="module")
def simple(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A cross with traffic that it can carry."""
    folder = tmp_path_factory.mktemp("simple")
    return cross(folder), traffic(folder)


def configuration(folder: Path, net: Path, routes: str, *, more: str = "", additional: str = "") -> Path:
    file = folder / "scenario.sumocfg"
    file.write_text(
        f'<configuration><input><net-file value="{net}"/><route-files value="{routes}"/>{additional}</input>'
        f'<time><begin value="0"/><end value="300"/></time>{more}</configuration>'
    )
    return file


# --- what it reports ---


def test_static_is_what_plain_sumo_says(simple: tuple[Path, Path], tmp_path: Path) -> None:
    net, routes = simple
    (row,) = sumo_run(
        "--net", net, "--routes", routes, "--end", 600, "--chooser", "static", "--seeds", 7, "--all-red", 0
    )
    trips, statistics = tmp_path / "trips.xml", tmp_path / "statistics.xml"
    words = ["-n", net, "-r", routes, "--end", "600", "--seed", "7", "--no-step-log", "--tripinfo-output", trips]
    words += ["--tripinfo-output.write-unfinished", "--statistic-output", statistics]
    subprocess.run(list(map(str, [SUMO_BIN / "sumo", *words])), check=True, timeout=60, capture_output=True)
    found = [t for t in root_of(trips) if float(t.get("depart", "-1")) >= 0]
    assert len(found) > 100
    delay = sum(float(t.get("timeLoss", "")) + float(t.get("departDelay", "")) for t in found) / len(found)
    assert float(row["delay_s"]) == pytest.approx(delay, abs=0.001)
    assert float(row["waiting_time_s"]) == pytest.approx(
        sum(float(t.get("waitingTime", "")) for t in found) / len(found), abs=0.001
    )
    assert int(row["arrived"]) == sum(float(t.get("arrival", "-1")) >= 0 for t in found)
    assert int(row["stops"]) == sum(int(t.get("waitingCount", "0")) for t in found)
    assert row["signals"] == "1"
    vehicles = root_of(statistics).find("vehicles")
    assert vehicles is not None
    assert row["not_inserted"] == vehicles.get("waiting")
    assert row["teleports"] == "0"
    assert int(row["switches"]) in range(18, 21), "62 s a cycle of two stages"


def test_paths_are_where_plain_sumo_has_the_vehicles(tmp_path: Path) -> None:
    """Within 100 m of the stop line, the last 60 of them on an edge of their own."""
    net, routes = cross(tmp_path, pieces=2), traffic(tmp_path, pieces=2)
    scenario = ["--net", net, "--routes", routes, "--end", 200, "--chooser", "static", "--seeds", 7, "--all-red", 0]
    sumo_run(*scenario, "--paths", tmp_path / "paths.csv")
    with (tmp_path / "paths.csv").open(encoding="utf-8", newline="") as stream:
        seen = {(float(r["t_s"]), r["approach"], r["vehicle"]): float(r["distance_m"]) for r in csv.DictReader(stream)}
    words = ["-n", net, "-r", routes, "--end", "200", "--seed", "7", "--no-step-log", "--fcd-output", "fcd.xml"]
    subprocess.run(
        list(map(str, [SUMO_BIN / "sumo", *words])), check=True, timeout=60, capture_output=True, cwd=tmp_path
    )
    lengths = {lane.get("id"): float(lane.get("length", "")) for lane in root_of(net).iter("lane")}
    last = {f"{arm}2_C_0" for arm in "NESW"}
    there = {
        (float(step.get("time", "")) + 1.0, f"{str(v.get('lane'))[:-2]}", str(v.get("id"))): (
            lengths[v.get("lane")] - float(v.get("pos", ""))
        )
        for step in root_of(tmp_path / "fcd.xml")
        for v in step
        if v.get("lane") in last
    }
    assert len(there) > 1000
    assert {key: seen.get(key) for key in there} == pytest.approx(there, abs=0.006)
    further = sorted(distance for key, distance in seen.items() if key not in there)
    assert len(further) > 200
    assert further[0] > min(lengths[lane] for lane in last) - 0.01
    assert further[-1] <= 100.0


@pytest.mark.parametrize("chooser", ["naive", "cumulative:ewma", "pressure", "sumo-actuated", "sumo-delay-based"])
def test_a_controller_that_looks_beats_fixed_times(simple: tuple[Path, Path], chooser: str) -> None:
    net, routes = simple
    (fixed,) = sumo_run("--net", net, "--routes", routes, "--end", 600, "--chooser", "static", "--seeds", 1)
    (row,) = sumo_run("--net", net, "--routes", routes, "--end", 600, "--chooser", chooser, "--seeds", 1)
    assert float(row["delay_s"]) < float(fixed["delay_s"])
    name, _, forecast = chooser.partition(":")
    assert (row["scenario"], row["chooser"], row["forecast"], row["seed"]) == ("cross", name, forecast or "none", "1")
    assert float(row["co2_kg"]) > float(row["fuel_kg"]) > 0
    assert int(row["longest_red_s"]) < 120


def test_seeds_are_rows_in_order_whoever_runs_them(simple: tuple[Path, Path], tmp_path: Path) -> None:
    net, routes = simple
    words = ("--net", net, "--routes", routes, "--end", 200, "--chooser", "naive")
    rows = sumo_run(*words, "--seeds", "3,1-2", "--jobs", 2)
    assert [row["seed"] for row in rows] == ["3", "1", "2"]
    assert rows == [sumo_run(*words, "--seeds", seed)[0] for seed in (3, 1, 2)]
    assert len({row["delay_s"] for row in rows}) == 3
    table = tmp_path / "rows.csv"
    assert sumo_run(*words, "--seeds", "3,1-2", "--csv", table) == []
    assert list(csv.DictReader(table.read_text().splitlines())) == rows


# --- what it shows ---


def test_lamps_keep_the_times_whatever_is_chosen(simple: tuple[Path, Path], tmp_path: Path) -> None:
    net, routes = simple
    states = tmp_path / "states.xml"
    saver = tmp_path / "save.add.xml"
    saver.write_text(f'<additional><timedEvent type="SaveTLSStates" source="C" dest="{states}"/></additional>')
    scenario = configuration(
        tmp_path, net, str(routes), additional=f'<additional-files value="{saver.name}"/>', more=""
    )
    sumo_run(
        "--sumocfg", scenario, "--chooser", "random", "--seeds", 5, "--end", 900, "--yellow", 4, "--all-red", 3,
        "--min-green", 7, "--max-green", 20,
    )  # fmt: skip
    seen = [s.get("state", "") for s in root_of(states) if s.tag.endswith("tlsState")]
    assert len(seen) > 890
    assert len(set(seen)) > 4
    for link in range(12):
        runs = [(letter, len(list(group))) for letter, group in groupby(state[link].lower() for state in seen)]
        for (letter, length), (following, _) in pairwise(runs[1:]):
            if letter == "g":
                assert length >= 7
                assert following == "y"
            if letter == "y":
                assert length == 4
                assert following == "r"
    ns = [state[1].lower() == "g" for state in seen]
    ew = [state[4].lower() == "g" for state in seen]
    for second in range(7, len(seen)):
        assert not (ew[second] and any(ns[second - 7 : second + 1]))
        assert not (ns[second] and any(ew[second - 7 : second + 1]))


def blocked_traffic(folder: Path) -> Path:
    """A vehicle breaks down behind the junction for a minute, the next one stands inside; then others want to cross."""
    file = folder / "blocked.rou.xml"
    file.write_text(
        '<routes><vType id="pushy" jmIgnoreKeepClearTime="0" sigma="0"/>'
        '<vehicle id="broken" type="pushy" depart="0" departPos="200"><route edges="N_C C_S"/>'
        '<stop lane="C_S_0" startPos="5" endPos="8" duration="60"/></vehicle>'
        '<vehicle id="inside" type="pushy" depart="3" departPos="200"><route edges="N_C C_S"/></vehicle>'
        '<vehicle id="east" type="pushy" depart="25" departPos="200"><route edges="E_C C_W"/></vehicle>'
        '<vehicle id="later" type="pushy" depart="120" departPos="200"><route edges="S_C C_N"/></vehicle></routes>'
    )
    return file


@pytest.mark.parametrize("chooser", ["naive", "max-pressure"])
def test_a_change_waits_while_a_vehicle_stands_in_the_junction(
    simple: tuple[Path, Path], tmp_path: Path, chooser: str
) -> None:
    net, routes = simple[0], blocked_traffic(tmp_path)
    states = tmp_path / "states.xml"
    saver = tmp_path / "save.add.xml"
    saver.write_text(f'<additional><timedEvent type="SaveTLSStates" source="C" dest="{states}"/></additional>')
    scenario = configuration(tmp_path, net, str(routes), additional=f'<additional-files value="{saver.name}"/>')
    found = {}
    for wait_s in (0, 4):
        words = ("--sumocfg", scenario, "--chooser", chooser, "--seeds", 1, "--end", 180, "--junction-wait", wait_s)
        (row,) = sumo_run(*words)
        assert row["teleports"] == "0"
        seen = [s.get("state", "") for s in root_of(states) if s.tag.endswith("tlsState")]
        runs = [(red, len(list(group))) for red, group in groupby(set(state) == {"r"} for state in seen)]
        found[wait_s] = [length for red, length in runs if red][1:]  # the first is the start's
    assert set(found[0]) == {2}, "the clearance that was asked for"
    assert found[4][0] == 2 + 4, "the first change finds somebody who does not move"
    assert found[4][-1] == 2, "the last change finds nobody"


# --- what it counts ---


@pytest.mark.parametrize("pieces", [1, 3])
def test_cameras_see_to_their_reach_across_cut_edges(tmp_path: Path, pieces: int) -> None:
    net, routes = cross(tmp_path, pieces=pieces), traffic(tmp_path, pieces=pieces)
    probe = ROOT / "tests" / "python" / "sumo_probe.py"
    words = [str(word) for word in (PYTHON, probe, net, routes, 100, 300)]
    done = subprocess.run(words, capture_output=True, text=True, check=True, timeout=60)
    rows = json.loads(done.stdout.splitlines()[-1])
    differs = [row for row in rows if abs(row[0] - row[1]) > 1e-6]
    assert max(row[1] for row in rows) > 15
    assert len(differs) <= len(rows) * 0.02, differs
    assert all(abs(row[0] - row[1]) <= 1.0 for row in rows)
    entered = sum(row[2] for row in rows)
    assert entered == pytest.approx(sum(row[1] for row in rows[-1:]) + entered - rows[-1][0], abs=1.0)


def test_people_who_walk_are_counted_and_served(tmp_path: Path) -> None:
    net, routes = cross(tmp_path, walked=True), traffic(tmp_path, end_s=300, per_s=0.06)
    walks = "".join(
        f'<personFlow id="{a}{b}" begin="0" end="300" period="exp(0.03)"><walk from="{a}_C" to="C_{b}"/></personFlow>'
        for a, b in ("NE", "SW", "EW", "WN")
    )
    routes.write_text(routes.read_text().replace("</routes>", f"{walks}</routes>"))
    own = '<output><vehroute-output value="walks.xml"/></output>'
    scenario = configuration(tmp_path, net, str(routes), more=own)
    (row,) = sumo_run("--sumocfg", scenario, "--chooser", "naive", "--seeds", 1, "--end", 600)
    people = [float(person.get("arrival", "-1")) for person in root_of(tmp_path / "walks.xml").iter("person")]
    assert len(people) > 20, "a configuration's own outputs are kept"
    assert min(people) > 0.0
    assert int(row["longest_red_s"]) < 90, "they are a movement"
    bad = tmp_path / "bad.rou.xml"
    bad.write_text('<routes><person id="lost" depart="5"><walk from="N_C" to="C_N nowhere"/></person></routes>')
    done = run("--net", net, "--routes", bad, "--end", 20, "--chooser", "naive")
    assert done.returncode in (1, 2)
    assert "SUMO says: " in done.stderr
    assert done.stderr.count("\n") == 1, done.stderr


# --- what it refuses ---


def test_unknown_names_and_numbers(simple: tuple[Path, Path]) -> None:
    net, routes = simple
    scenario = ("--net", net, "--routes", routes, "--end", 20)
    text = refused(*scenario, "--chooser", "nave")
    assert 'unknown chooser "nave"' in text
    assert "naive" in text
    assert "static" in text
    assert "reads no forecast" in refused(*scenario, "--chooser", "pressure:oracle")
    assert "--foretold with --chooser naive" in refused(*scenario, "--chooser", "naive", "--foretold", "x.csv")
    oracle = (*scenario, "--chooser", "cumulative:oracle")
    assert "no/folder" in refused(*oracle, "--foretold", "no/folder/x.csv")
    assert "static:lstm: SUMO's own take no option and no forecast; right would be static" in refused(
        *scenario, "--chooser", "static:lstm"
    )
    assert "'0'" in refused(*scenario, "--chooser", "naive", "--min-green", 0)
    assert "--max-green 4 is below --min-green 5" in refused(*scenario, "--chooser", "naive", "--max-green", 4)
    assert "'5-1'" in refused(*scenario, "--chooser", "naive", "--seeds", "5-1")
    assert "'1,1'" in refused(*scenario, "--chooser", "naive", "--seeds", "1,1")
    assert "'0.5'" in refused(*scenario, "--chooser", "naive", "--reach", 0.5)
    assert "'11'" in refused(*scenario, "--chooser", "naive", "--junction-wait", 11)
    assert "'phases'" in refused(*scenario, "--chooser", "naive", "--stages", "phases")
    assert "--stages all with --chooser static" in refused(*scenario, "--chooser", "static", "--stages", "all")
    assert "--chooser" in refused(*scenario)
    assert "no/folder" in refused(*scenario, "--chooser", "naive", "--csv", "no/folder/x.csv")
    assert "no/folder" in refused(*scenario, "--chooser", "naive", "--paths", "no/folder/x.csv")
    assert "--paths - " in refused(*scenario, "--chooser", "naive", "--paths", "-")
    assert "with 2 seeds" in refused(*scenario, "--chooser", "naive", "--paths", "x.csv", "--seeds", "1-2")
    assert "'nan'" in refused(*scenario, "--chooser", "naive", "--begin", "nan")
    assert "not after" in refused(*scenario, "--begin", 30, "--chooser", "naive")
    assert "either --sumocfg" in refused("--net", net, "--chooser", "naive")
    assert "either --sumocfg" in refused("--sumocfg", "x", *scenario, "--chooser", "naive")


def test_files_that_are_not_there_or_are_not_sumos(simple: tuple[Path, Path], tmp_path: Path) -> None:
    net, routes = simple
    assert "no.net.xml is missing" in refused("--net", "no.net.xml", "--routes", routes, "--chooser", "naive")
    assert "no.rou.xml is missing" in refused("--net", net, "--routes", "no.rou.xml", "--chooser", "naive")
    assert "no.sumocfg is missing; right would be a SUMO configuration" in refused(
        "--sumocfg", "no.sumocfg", "--chooser", "naive"
    )
    lost = configuration(tmp_path, net, "lost.rou.xml")
    assert "lost.rou.xml is missing" in refused("--sumocfg", lost, "--chooser", "naive")
    wrong = tmp_path / "wrong.sumocfg"
    wrong.write_text("<configuration>")
    assert "no XML" in refused("--sumocfg", wrong, "--chooser", "naive")
    wrong.write_text(
        lost.read_text().replace('end value="300"', 'end value="soon"').replace("lost.rou.xml", str(routes))
    )
    assert "has end soon ; seconds" in refused("--sumocfg", wrong, "--chooser", "naive")
    wrong.write_text("<routes/>")
    assert "names no net-file" in refused("--sumocfg", wrong, "--chooser", "naive")
    assert "no network" in refused("--net", routes, "--routes", routes, "--chooser", "naive")
    bad = tmp_path / "bad.rou.xml"
    bad.write_text('<routes><flow id="x" from="nowhere" to="C_N" begin="0" end="9" period="1"/></routes>')
    done = run("--net", net, "--routes", bad, "--end", 20, "--chooser", "naive")
    assert done.returncode == 2
    assert "nowhere" in done.stderr
    assert done.stderr.count("\n") == 1


def test_networks_that_cannot_be_controlled(tmp_path: Path) -> None:
    for name in ("none", "green", "amber"):
        (tmp_path / name).mkdir()
    net = cross(tmp_path / "none", signal="priority")
    routes = traffic(tmp_path / "none", end_s=10)
    assert "has no signal" in refused("--net", net, "--routes", routes, "--end", 20, "--chooser", "naive")
    logic = '<tlLogic id="C" type="static" programID="0" offset="0"><phase duration="9" state="{}"/></tlLogic>'
    crossing = f"<additional>{logic}</additional>"
    net = cross(tmp_path / "green", tls=crossing.format("G" * 12))
    text = refused("--net", net, "--routes", routes, "--end", 20, "--chooser", "naive")
    assert "signal C has conflicting greens in phase GGGGGGGGGGGG" in text
    text = refused("--net", net, "--routes", routes, "--end", 20, "--chooser", "naive", "--allow-partial")
    assert "conflicting greens" in text, "nothing is left to control"
    net = cross(tmp_path / "amber", tls=crossing.format("y" * 12))
    assert "signal C has no green phase" in refused(
        "--net", net, "--routes", routes, "--end", 20, "--chooser", "static"
    )


def test_a_signal_that_cannot_be_controlled_may_be_left_out(tmp_path: Path) -> None:
    dark = '<tlLogic id="N1" type="static" programID="0" offset="0"><phase duration="9" state="O"/></tlLogic>'
    net = cross(tmp_path, pieces=2, tls=CROSS.replace("</additional>", f"{dark}</additional>"))
    words = ("--net", net, "--routes", traffic(tmp_path, pieces=2, end_s=60), "--end", 60, "--chooser")
    for chooser in ("naive", "static"):
        assert "signal N1 has no green phase (O)" in refused(*words, chooser)
        (row,) = sumo_run(*words, chooser, "--allow-partial")
        assert row["signals"] == "1"


def test_signals_tell_each_other_who_has_left_them(tmp_path: Path) -> None:
    """Two signals 120 m apart: N1 lets in who comes from the north."""
    second = (
        '<tlLogic id="N1" type="static" programID="0" offset="0"><phase duration="9" state="Gr"/>'
        '<phase duration="3" state="yr"/><phase duration="9" state="rG"/></tlLogic>'
    )
    net = cross(tmp_path, pieces=2, tls=CROSS.replace("</additional>", f"{second}</additional>"))
    routes = traffic(tmp_path, pieces=2, end_s=300)
    words = ("--net", net, "--routes", routes, "--end", 300, "--reach", 20, "--chooser", "rollout@weight=0.5:mean")
    (alone,), (told,) = sumo_run(*words), sumo_run(*words, "--neighbours")
    assert (alone["signals"], alone["forecast"], told["forecast"]) == ("2", "mean", "mean+neighbours")
    assert told["delay_s"] != alone["delay_s"]


def test_neighbours_where_nobody_has_one_are_refused(simple: tuple[Path, Path]) -> None:
    words = ("--net", simple[0], "--routes", simple[1], "--end", 60, "--neighbours", "--chooser")
    assert "no road leads from one signal to the reach of another" in refused(*words, "naive")
    assert "--neighbours with --chooser static" in refused(*words, "static")


# --- an oracle ---


def steady_traffic(folder: Path) -> Path:
    """Nobody dawdles, and too few come for a queue of 100 m: who comes when does not hang on the signals."""
    file = traffic(folder, end_s=300, per_s=0.03)
    steady = '<vType id="DEFAULT_VEHTYPE" sigma="0" speedDev="0"/>'
    file.write_text(file.read_text().replace("<routes>", f"<routes>{steady}"))
    return file


def test_an_oracle_is_told_who_comes(tmp_path: Path) -> None:
    net, routes = cross(tmp_path), steady_traffic(tmp_path)
    probe = ROOT / "tests" / "python" / "sumo_oracle_probe.py"
    words = [str(word) for word in (PYTHON, probe, net, routes, 300)]
    done = subprocess.run(words, capture_output=True, text=True, check=True, timeout=60)
    found = json.loads(done.stdout.splitlines()[-1])
    told, came, comes = found["told"], found["came"], found["comes"]
    assert (len(told), len(came), len(comes)) == (301, 300, 300)
    assert sum(map(sum, came)) > 20
    pairs = [pair for now, then in zip(came, comes, strict=True) for pair in zip(now, then, strict=True)]
    moved = sum(abs(one - two) for one, two in pairs) / 2
    assert moved <= 0.25 * sum(map(sum, came)), "most come in the same second, whatever the signals show"
    for second, rows in enumerate(told):
        later = came[second : second + 150]
        nobody = [0.0] * (150 - len(later))
        assert rows == [[counts[arm] for counts in later] + nobody for arm in range(4)]


def test_it_says_how_well_an_oracle_was_told(simple: tuple[Path, Path], tmp_path: Path) -> None:
    file = tmp_path / "foretold.csv"
    words = ("--end", 300, "--chooser", "rollout:oracle", "--seeds", "1-2", "--foretold", file)
    rows = sumo_run("--net", simple[0], "--routes", simple[1], *words)
    assert [row["forecast"] for row in rows] == ["oracle", "oracle"]
    with file.open(encoding="utf-8", newline="") as stream:
        told = list(csv.DictReader(stream))
    assert [(row["scenario"], row["chooser"], row["seed"]) for row in told] == [
        ("cross", "rollout", "1"),
        ("cross", "rollout", "2"),
    ]
    for row in told:
        assert int(row["vehicles"]) > 80
        assert 0.5 < float(row["within_0_s"]) < float(row["within_1_s"]) <= float(row["within_3_s"]) <= 1.0
        assert 0.0 < float(row["skill"]) < 1.0, "drivers dawdle as chance has it"


def test_who_foresees_beats_who_sees_only_the_last_20_metres(simple: tuple[Path, Path]) -> None:
    words = ("--net", simple[0], "--routes", simple[1], "--end", 600, "--reach", 20, "--seeds", "1-4", "--chooser")
    alone, told = (
        sum(float(row["delay_s"]) for row in sumo_run(*words, chooser))
        for chooser in ("rollout", "rollout@rows=10@weight=1:oracle")
    )
    assert told < alone


def test_without_sumo_it_says_what_to_do(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "tools", tmp_path / "tools", ignore=shutil.ignore_patterns("__pycache__"))
    done = subprocess.run(
        ["/usr/bin/python3", tmp_path / "tools" / "sumo-run", "--chooser", "naive"],
        capture_output=True, text=True, check=False, timeout=20,
    )  # fmt: skip
    assert done.returncode == 2
    assert done.stderr == "sumo-run: this Python has no libsumo, sumolib; run ./tools/setup sumo\n"


def test_a_sumo_that_cannot_be_loaded_is_one_line(tmp_path: Path) -> None:
    for module, text in (("libsumo", 'raise ImportError("libX11.so.6: no such file", name="libX11")'), ("sumolib", "")):
        (tmp_path / f"{module}.py").write_text(text)
    shutil.copytree(ROOT / "tools", tmp_path / "tools", ignore=shutil.ignore_patterns("__pycache__"))
    done = subprocess.run(
        ["/usr/bin/python3", tmp_path / "tools" / "sumo-run", "--chooser", "naive"],
        capture_output=True, text=True, check=False, timeout=20, env={"PYTHONPATH": str(tmp_path)},
    )  # fmt: skip
    assert done.returncode == 2
    assert done.stderr == "sumo-run: cannot load libX11: libX11.so.6: no such file; run ./tools/setup sumo\n"
