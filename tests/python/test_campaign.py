# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""tools/campaign: a job file that runs in any order, goes on where it was broken off, and merges to the same table."""

import csv
import random
import subprocess
from pathlib import Path

import pytest
from scipy import stats
from sumo_nets import cross, traffic

ROOT = Path(__file__).resolve().parents[2]
COLUMNS = (
    "scenario,chooser,forecast,seed,signals,delay_s,time_loss_s,waiting_time_s,arrived,not_inserted,teleports,"
    "longest_wait_s,longest_red_s,stops,switches,co2_kg,fuel_kg"
)


def campaign(*words: object, expect: int = 0) -> str:
    done = subprocess.run(
        [ROOT / "tools" / "campaign", *map(str, words)], capture_output=True, text=True, check=False, timeout=120
    )
    assert done.returncode == expect, done.stderr
    if expect:
        # Lines that failed have said so before.
        assert [line.startswith("campaign") for line in done.stderr.splitlines()].count(True) == 1, done.stderr
    return done.stderr if expect else done.stdout


@pytest.fixture
def made(tmp_path: Path) -> Path:
    """A campaign of eight short runs."""
    net, routes = cross(tmp_path), traffic(tmp_path, end_s=30)
    for name in ("early", "late"):
        (tmp_path / f"{name}.hour.sumocfg").write_text(
            f'<configuration><input><net-file value="{net}"/><route-files value="{routes}"/></input>'
            f'<time><end value="{30 if name == "early" else 40}"/></time></configuration>'
        )
    folder = tmp_path / "campaign"
    words = (
        "--scenarios",
        tmp_path,
        "--choosers",
        "cumulative:ewma,static",
        "--seeds",
        "4,2",
        "--options",
        "--reach 80",
    )
    assert "8 lines" in campaign("make", folder, *words)
    return folder


def test_lines_in_any_order_make_one_table(made: Path) -> None:
    lines = (made / "jobs.txt").read_text().splitlines()
    assert len(lines) == 8
    assert lines[0].startswith("tools/sumo-run --sumocfg ")
    result = made / "results" / "early.cumulative+ewma.4.csv"
    assert lines[0].endswith(f"--chooser cumulative:ewma --seeds 4 --jobs 1 --reach 80 --csv {result}")
    assert "8 of 8 results are missing, first: results/early.cumulative+ewma.4.csv" in campaign("merge", made, expect=1)
    some = random.Random(1).sample(lines, 3)
    for line in some:
        subprocess.run(["bash", "-c", line], check=True, cwd=ROOT, timeout=60)
    assert "5 lines run, 3 were there" in campaign("run", made)
    assert "8 runs" in campaign("merge", made)
    table = (made / "runs.csv").read_text()
    assert table.splitlines()[0] == COLUMNS
    rows = list(csv.DictReader(table.splitlines()))
    assert [(r["scenario"], r["chooser"], r["seed"]) for r in rows] == [
        (s, c, n) for s in ("early", "late") for c in ("cumulative", "static") for n in ("4", "2")
    ]
    assert "0 lines run, 8 were there" in campaign("run", made)
    (made / "results" / "late.static.2.csv").unlink()
    assert "1 of 8" in campaign("merge", made, expect=1)
    assert "7 runs" in campaign("merge", made, "--partial")
    campaign("run", made)
    campaign("merge", made)
    assert (made / "runs.csv").read_text() == table


def test_one_command_does_it_all(tmp_path: Path) -> None:
    net, routes = cross(tmp_path), traffic(tmp_path, end_s=30)
    (tmp_path / "one.sumocfg").write_text(
        f'<configuration><input><net-file value="{net}"/><route-files value="{routes}"/></input>'
        f'<time><end value="60"/></time></configuration>'
    )

    def compare(*words: object) -> subprocess.CompletedProcess[str]:
        command = [str(word) for word in (ROOT / "tools" / "sumo-compare", *words)]
        return subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)

    out = tmp_path / "out"
    choice = ("--scenarios", tmp_path / "one.sumocfg", "--choosers", "naive,static", "--seeds", "1-2")
    for expected in ("4 lines run, 0 were there", "0 lines run, 4 were there"):
        done = compare("--out", out, *choice)
        assert done.returncode == 0, done.stderr
        assert expected in done.stdout
    assert (out / "best_rivals.csv").read_text().splitlines()[1].startswith("one,static,")
    assert (out / "comparison.csv").read_text().splitlines()[1].startswith("one,naive,static,2,")
    for words, right in (((), "--out is missing"), (("--jobs", "x"), "--jobs 'x'"), (("--sites",), "unknown argument")):
        done = compare(*(("--out", out) if "--jobs" in words else ()), *words)
        assert done.returncode == 2
        assert right in done.stderr
        assert done.stderr.count("\n") == 1


def test_a_line_that_fails_is_named(made: Path) -> None:
    jobs, plan = made / "jobs.txt", made / "campaign.json"
    for file in (jobs, plan):
        file.write_text(file.read_text().replace("--chooser static", "--chooser sttic"))
    text = campaign("run", made, expect=1)
    assert "4 of 8 lines have no result" in text
    assert "sttic" in text


def test_a_result_of_another_line_is_refused(made: Path) -> None:
    for line in ("early.static.2", "early.static.4"):
        (made / "results" / f"{line}.csv").write_text(f"{COLUMNS}\nlate,static,none,2{',0' * 13}\n")
    assert "is not the result of its line" in campaign("merge", made, "--partial", expect=1)


def test_bad_requests(tmp_path: Path) -> None:
    words = ("--choosers", "naive", "--scenarios")
    assert "no/such is missing" in campaign("make", tmp_path / "c", *words, "no/such", expect=2)
    assert "'x'" in campaign("make", tmp_path, *words, "x", "--seeds", "x", expect=2)
    assert "campaign.json is missing" in campaign("run", tmp_path, expect=2)
    assert "runs.csv is missing" in campaign("compare", tmp_path, expect=2)
    (tmp_path / "runs.csv").write_text(f"{COLUMNS}\n")
    assert "has no run of naive, cumulative, pressure" in campaign("compare", tmp_path, expect=2)


@pytest.mark.parametrize(
    ("wrong", "right"),
    [
        ("foo", 'unknown chooser "foo"; right would be one of naive, '),
        ("rollout@caution=2", "caution of chooser rollout is 2; right would be above 0, at most 1"),
        ("naive:lstm", "right would be naive"),
        ("static:lstm", "SUMO's own take no option and no forecast; right would be static"),
    ],
)
def test_a_wrong_name_among_right_ones_is_refused_before_anything_is_written(
    tmp_path: Path, wrong: str, right: str
) -> None:
    out = tmp_path / "out"
    made = ("make", out, "--scenarios", tmp_path, "--choosers")
    (tmp_path / "one.sumocfg").write_text("<configuration/>")
    compare = [ROOT / "tools" / "sumo-compare", "--out", out, "--choosers", f"rollout,{wrong},static"]
    done = subprocess.run(list(map(str, compare)), capture_output=True, text=True, check=False, timeout=60)
    for code, said in ((done.returncode, done.stderr), (2, campaign(*made, f"rollout,{wrong}", expect=2))):
        assert code == 2
        assert said.count("\n") == 1, said
        assert f"--choosers {wrong}: " in said
        assert right in said
    assert not out.exists()
    for words in (("--seeds", "x"), ("--scenarios", "no/such")):
        done = subprocess.run([*map(str, compare[:3]), *words], capture_output=True, text=True, check=False, timeout=60)
        assert (done.returncode, done.stderr.count("\n"), out.exists()) == (2, 1, False), done.stderr
        assert words[1] in done.stderr


def test_the_comparison_is_students(tmp_path: Path) -> None:
    draw = random.Random(7)
    delays = {
        (scenario, chooser): [draw.gauss(20.0 + shift, 2.0) for _ in range(10)]
        for scenario in ("a", "b")
        for chooser, shift in (("pressure", -1.0), ("max-wave", 1.0), ("static", 5.0 if scenario == "a" else -3.0))
    }
    rows = [
        f"{scenario},{chooser},none,{seed + 1},1,{delay:.6f},0,0,100,{seed % 2},0,{40 + seed},9,9,9,1,1"
        for (scenario, chooser), values in delays.items()
        for seed, delay in enumerate(values)
    ]
    draw.shuffle(rows)
    (tmp_path / "runs.csv").write_text("\n".join([COLUMNS, *rows, ""]))
    said = campaign("compare", tmp_path)
    best = {r["scenario"]: r for r in csv.DictReader((tmp_path / "best_rivals.csv").read_text().splitlines())}
    assert {name: r["best_rival"] for name, r in best.items()} == {"a": "max-wave", "b": "static"}
    assert best["a"]["not_inserted"] == "5"
    assert best["a"]["longest_wait_s"] == "49"
    found = list(csv.DictReader((tmp_path / "comparison.csv").read_text().splitlines()))
    assert [(r["scenario"], r["chooser"]) for r in found] == [("a", "pressure"), ("b", "pressure")]
    for row in found:
        ours, rival = delays[row["scenario"], "pressure"], delays[row["scenario"], row["best_rival"]]
        test = stats.ttest_rel(ours, rival)
        interval = test.confidence_interval(0.95)
        assert float(row["ci_low_s"]) == pytest.approx(interval.low, abs=0.006)
        assert float(row["ci_high_s"]) == pytest.approx(interval.high, abs=0.006)
        assert float(row["ratio"]) == pytest.approx(sum(ours) / sum(rival), abs=1e-4)
        assert row["seeds"] == "10"
    standings = list(csv.DictReader((tmp_path / "standings.csv").read_text().splitlines()))
    assert standings[0]["chooser"] == "pressure"
    ratios = [sum(delays[s, "pressure"]) / sum(delays[s, best[s]["best_rival"]]) for s in ("a", "b")]
    assert float(standings[0]["mean_ratio"]) == pytest.approx((ratios[0] * ratios[1]) ** 0.5, abs=0.0006)
    assert float(standings[0]["worst_ratio"]) == pytest.approx(max(ratios), abs=0.0006)
    assert "mean_ratio" in said
