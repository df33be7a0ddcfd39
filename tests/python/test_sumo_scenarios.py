# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""tools/sumo-scenarios: what it writes, and that a seed means the same vehicles whatever the signals do."""

import subprocess
from pathlib import Path
from xml.etree import ElementTree

import pytest

ROOT = Path(__file__).resolve().parents[2]
SUMO = ROOT / "build" / "venv" / "sumo" / "bin" / "sumo"


def scenarios(*words: object, expect: int = 0) -> str:
    done = subprocess.run(
        [ROOT / "tools" / "sumo-scenarios", *map(str, words)], capture_output=True, text=True, check=False, timeout=120
    )
    assert done.returncode == expect, done.stderr
    if expect:
        assert done.stderr.count("\n") == 1, done.stderr
    return done.stderr if expect else done.stdout


def root_of(file: Path) -> ElementTree.Element:
    return ElementTree.parse(file).getroot()  # noqa: S314  SUMO has just written it


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """All of them."""
    folder = tmp_path_factory.mktemp("scenarios")
    scenarios("--out", folder)
    return folder


def test_every_scenario_is_a_network_of_the_signals_that_the_list_says(written: Path) -> None:
    listed = scenarios("--list").splitlines()
    assert len(listed) == 15
    for line in listed:
        name, signals, _, demand = line.split()[:4]
        net = root_of(written / name / f"{name}.net.xml")
        assert len(net.findall("tlLogic")) == int(signals)
        assert all(logic.get("type") == "static" for logic in net.findall("tlLogic"))
        flows = root_of(written / name / f"{name}.rou.xml").findall("flow")
        assert sum(float(f.get("period", "")[4:-1]) * 3600 for f in flows) > 0
        assert int(demand) >= 400
        files = [f"{name}.{end}" for end in ("net.xml", "rou.xml", "sumocfg")]
        assert sorted(f.name for f in (written / name).iterdir()) == files
    assert {line.split()[1] for line in listed} == {"1", "4", "16"}


def test_left_turns_give_way_where_they_should_and_nowhere_else(written: Path) -> None:
    def states(name: str) -> list[str]:
        phases = root_of(written / name / f"{name}.net.xml").iter("phase")
        return [p.get("state", "") for p in phases if "y" not in p.get("state", "")]

    assert all("g" in state for state in states("single"))
    assert not any("g" in state for state in states("protected-high"))
    assert len(states("eight")) == 8
    assert ["g" in state for state in states("shared")] == [True, False, True, False]
    assert len(states("split")) == 4


def test_the_same_scenario_is_the_same_bytes(written: Path, tmp_path: Path) -> None:
    scenarios("--out", tmp_path, "tee")
    for file in (tmp_path / "tee").iterdir():
        assert file.read_bytes() == (written / "tee" / file.name).read_bytes()


def test_a_seed_means_the_same_vehicles_under_any_signals(written: Path, tmp_path: Path) -> None:
    links = len(next(root_of(written / "tee" / "tee.net.xml").iter("phase")).get("state", ""))
    red = tmp_path / "red.add.xml"
    red.write_text(
        f'<additional><tlLogic id="C" type="static" programID="red" offset="0">'
        f'<phase duration="900" state="{"r" * links}"/></tlLogic></additional>'
    )

    def vehicles(seed: int, *words: str) -> dict[str, tuple[object, ...]]:
        trips = tmp_path / "trips.xml"
        command = [str(SUMO), "-c", str(written / "tee" / "tee.sumocfg"), "--end", "120", "--seed", str(seed)]
        command += ["--tripinfo-output", str(trips), "--tripinfo-output.write-unfinished", "--no-step-log", *words]
        subprocess.run(command, check=True, capture_output=True, timeout=60)
        return {
            trip.get("id", ""): (
                round(float(trip.get("depart", "")) - float(trip.get("departDelay", "")), 2),
                trip.get("vType"),
                trip.get("speedFactor"),
                trip.get("departLane"),
            )
            for trip in root_of(trips)
        }

    usual, stopped, other = vehicles(1), vehicles(1, "--additional-files", str(red)), vehicles(2)
    assert len(usual) > 30
    assert {name: values[:3] for name, values in usual.items()} == {
        name: values[:3] for name, values in stopped.items()
    }
    assert usual != other


def test_bad_requests() -> None:
    assert "unknown scenario nowhere" in scenarios("--out", "x", "nowhere", expect=2)
    assert "--out is missing" in scenarios(expect=2)
