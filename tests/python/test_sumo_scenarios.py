# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""tools/sumo-scenarios: what it writes, and that a seed means the same vehicles whatever the signals do."""

import json
import shutil
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

ROOT = Path(__file__).resolve().parents[2]
SUMO_BIN = ROOT / "build" / "venv" / "sumo" / "bin"


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


def listed() -> dict[str, list[str]]:
    """The columns after the name."""
    head, *lines = scenarios("--list").splitlines()
    assert head.split()[:6] == ["name", "signals", "arms", "lanes", "stages", "veh/h"]
    return {line.split()[0]: line.split()[1:] for line in lines}


def test_every_scenario_is_a_network_of_the_signals_that_the_list_says(written: Path) -> None:
    table = listed()
    assert len(table) == 15
    for name, (signals, _, _, stages, demand, *_) in table.items():
        net = root_of(written / name / f"{name}.net.xml")
        logics = net.findall("tlLogic")
        assert len(logics) == int(signals)
        assert all(logic.get("type") == "static" for logic in logics)
        greens = {sum("y" not in phase.get("state", "") for phase in logic.iter("phase")) for logic in logics}
        assert "-".join(str(count) for count in sorted(greens)[:: max(1, len(greens) - 1)]) == stages
        assert {phase.get("duration") for phase in net.iter("phase") if "y" in phase.get("state", "")} == {"3"}
        flows = root_of(written / name / f"{name}.rou.xml").findall("flow")
        vehicles = sum(
            float(flow.get("period", "")[4:-1]) * (float(flow.get("end", "")) - float(flow.get("begin", "")))
            for flow in flows
        )
        assert vehicles * 2 == pytest.approx(int(demand), rel=0.01)
        files = [f"{name}.{end}" for end in ("net.xml", "rou.xml", "sumocfg")]
        assert sorted(f.name for f in (written / name).iterdir()) == files
    assert {columns[0] for columns in table.values()} == {"1", "4", "16"}


def test_every_link_gets_green_and_only_those_that_cross_nobody_need_not_give_way(written: Path) -> None:
    nets = sorted(map(str, written.glob("*/*.net.xml")))
    command = [str(SUMO_BIN / "python"), str(ROOT / "tests" / "python" / "sumo_greens_probe.py"), *nets]
    done = subprocess.run(command, check=True, capture_output=True, timeout=60)
    read = json.loads(done.stdout)
    assert len(read) == 15
    for file, signals in read.items():
        assert signals, file
        for signal in signals:
            assert signal["crossing"] == signal["unheeded"] == signal["never"] == [], file
            assert signal["links"] <= 16
            assert len(set(signal["states"])) == len(signal["states"]) <= 8


@pytest.mark.parametrize(
    ("name", "signals", "programme", "least"),
    [("protected-low", ["C"], 4, 12), ("eight", ["C"], 8, 12), ("split", ["C"], 4, 6), ("paper", ["a", "c"], 8, 12)],
)
def test_stages_that_are_added_let_nobody_cross(
    written: Path, tmp_path: Path, name: str, signals: list[str], programme: int, least: int
) -> None:
    """Of a chooser that takes any stage, in every second, by SUMO's own right-of-way."""
    folder = written / name
    net = folder / f"{name}.net.xml"
    saver = "".join(f'<timedEvent type="SaveTLSStates" source="{s}" dest="{tmp_path}/{s}.xml"/>' for s in signals)
    (tmp_path / "save.add.xml").write_text(f"<additional>{saver}</additional>")
    scenario = tmp_path / "scenario.sumocfg"
    scenario.write_text(
        f'<configuration><input><net-file value="{net}"/><route-files value="{folder / name}.rou.xml"/>'
        f'<additional-files value="save.add.xml"/></input></configuration>'
    )
    for stages, fewest, most in (("all", least, 99), ("programme", 1, programme)):
        subprocess.run(
            [
                ROOT / "tools" / "sumo-run", "--sumocfg", scenario, "--chooser", "random", "--end", "1200",
                "--stages", stages, "--csv", tmp_path / "rows.csv",
            ],
            check=True, timeout=120,
        )  # fmt: skip
        probe = [str(SUMO_BIN / "python"), str(ROOT / "tests" / "python" / "sumo_greens_probe.py"), "--shown", str(net)]
        files = [str(tmp_path / f"{signal}.xml") for signal in signals]
        done = subprocess.run([*probe, *files], check=True, capture_output=True, timeout=60)
        for signal, read in json.loads(done.stdout).items():
            assert read["crossing"] == [], signal
            greens = [state for state in read["states"] if "y" not in state and set(state) != {"r"}]
            assert fewest <= len(greens), (signal, greens)
            if stages == "programme":
                full = [g for g in greens if not any(_is_part(g, other) for other in greens)]
                assert len(full) <= most, (signal, full)


def _is_part(state: str, other: str) -> bool:
    return state != other and all(o.lower() == "g" for s, o in zip(state, other, strict=True) if s.lower() == "g")


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


@pytest.mark.parametrize(("name", "seconds"), [("tee", 120), ("paper", 300)])
def test_a_seed_means_the_same_vehicles_under_any_signals(
    written: Path, tmp_path: Path, name: str, seconds: int
) -> None:
    """One signal stays red. Where there are two ways SUMO would choose by how slow they are; the flows name theirs."""
    red = ElementTree.Element("additional")
    logic = next(root_of(written / name / f"{name}.net.xml").iter("tlLogic"))
    stopped_logic = ElementTree.SubElement(red, "tlLogic", logic.attrib | {"programID": "red"})
    ElementTree.SubElement(stopped_logic, "phase", duration="900", state="r" * len(logic[0].get("state", "")))
    (tmp_path / "red.add.xml").write_bytes(ElementTree.tostring(red))

    def vehicles(seed: int, *words: str) -> dict[str, tuple[object, ...]]:
        trips, routes = tmp_path / "trips.xml", tmp_path / "routes.xml"
        command = [str(SUMO_BIN / "sumo"), "-c", str(written / name / f"{name}.sumocfg"), "--end", str(seconds)]
        command += ["--seed", str(seed), "--no-step-log", "--tripinfo-output", str(trips)]
        command += ["--tripinfo-output.write-unfinished", "--vehroute-output", str(routes)]
        command += ["--vehroute-output.write-unfinished", *words]
        subprocess.run(command, check=True, capture_output=True, timeout=60)
        driven = {vehicle.get("id"): vehicle.find("route") for vehicle in root_of(routes).iter("vehicle")}
        return {
            trip.get("id", ""): (
                round(float(trip.get("depart", "")) - float(trip.get("departDelay", "")), 2),
                trip.get("vType"),
                trip.get("speedFactor"),
                route.get("edges"),
            )
            for trip in root_of(trips)
            if (route := driven[trip.get("id")]) is not None
        }

    usual, stopped = vehicles(1), vehicles(1, "--additional-files", str(tmp_path / "red.add.xml"))
    assert len(usual) > 30
    assert usual == stopped
    assert usual != vehicles(2)


def test_the_length_can_be_chosen(tmp_path: Path) -> None:
    scenarios("--out", tmp_path, "--hours", "0.05", "alternating", "platoons")
    for name in ("alternating", "platoons"):
        assert '<end value="180" />' in (tmp_path / name / f"{name}.sumocfg").read_text()
        flows = root_of(tmp_path / name / f"{name}.rou.xml").findall("flow")
        assert max(int(flow.get("end", "")) for flow in flows) == 180


def test_bad_requests() -> None:
    assert "unknown scenario nowhere" in scenarios("--out", "x", "nowhere", expect=2)
    assert "--out is missing" in scenarios(expect=2)
    for hours in ("0", "-1", "nan", "25", "long"):
        assert f"{hours} is no length" in scenarios("--list", f"--hours={hours}", expect=2)


def test_an_output_that_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    assert "a folder that can be written" in scenarios("--out", tmp_path / "file", "light", expect=2)


def test_without_sumo_one_line_says_what_to_do(tmp_path: Path) -> None:
    """A copy of the tools beside which there is no environment, under a Python without SUMO."""
    (tmp_path / "tools" / "elmopp_tools").mkdir(parents=True)
    for file in ("sumo-scenarios", "elmopp_tools/__init__.py", "elmopp_tools/venv.py"):
        shutil.copy(ROOT / "tools" / file, tmp_path / "tools" / file)
    command = [sys.executable, str(tmp_path / "tools" / "sumo-scenarios"), "--list"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 2
    assert done.stderr.startswith("sumo-scenarios: this Python has no libsumo, sumolib; ")
    assert done.stderr.count("\n") == 1
