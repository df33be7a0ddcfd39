# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""tools/campaign-slurm: what it submits, leaves out and refuses, on a pretended cluster and on a Slurm of one node."""

import os
import shlex
import shutil
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
LINES = 12

# Runs the tasks of an array here, one after the other in the order that FAKE_ORDER makes of theirs.
SBATCH = """\
#!/bin/bash
printf '%s\\n' "$@" >"$FAKE/arguments"
[ -z "${FAKE_REFUSAL-}" ] || { printf '%s\\n' "$FAKE_REFUSAL" "sbatch: more words" >&2; exit 1; }
wait=${SBATCH_WAIT+yes}
while [[ $1 == -* ]]; do
    case $1 in
    --array=1-*) last=${1#--array=1-} ;;
    --output=*) output=${1#--output=} ;;
    --partition) shift ;;
    -W | --wait) wait=yes ;;
    esac
    shift
done
echo "Submitted batch job 7"
mkdir -p "$FAKE/spool" && cp "$1" "$FAKE/spool/slurm_script" && shift
cd /
worst=0
for task in $(seq "$last" | $FAKE_ORDER); do
    log=${output//%a/$task} status=0
    SLURM_JOB_ID=7 SLURM_ARRAY_TASK_ID=$task bash "$FAKE/spool/slurm_script" "$@" >>"${log//%%/%}" 2>&1 || status=$?
    [ $status -le $worst ] || worst=$status
done
[ -z "$wait" ] || exit $worst
"""

SCONTROL = """\
#!/bin/bash
[ "$*" = "show config" ] && printf 'MaxArraySize            = %s\\nMaxJobCount             = 10000\\n' "$FAKE_SIZE"
"""

# A line's program: SEED --csv FILE. Says that it ran; fails with the exit code in the file fail.SEED; else writes.
TOY = """\
#!/bin/bash
set -e
here=${0%/*}
echo "$1" >>"$here/ran"
[ ! -e "$here/fail.$1" ] || exit "$(cat "$here/fail.$1")"
echo "$1,$PWD" >"$3.part"
mv "$3.part" "$3"
"""


@dataclass
class Cluster:
    """A campaign of 12 lines and what it takes to run it."""

    folder: Path
    environment: dict[str, str] = field(default_factory=dict)

    @property
    def campaign(self) -> Path:
        return self.folder / "50 % of 'all'"

    @property
    def results(self) -> dict[str, str]:
        return {file.name: file.read_text() for file in (self.campaign / "results").iterdir()}

    def log(self, task: int) -> str:
        return (self.campaign / "slurm" / f"{task}.log").read_text()

    def ran(self) -> list[int]:
        """The seeds that ran since the last question."""
        file = self.folder / "ran"
        seeds = [int(word) for word in file.read_text().split()] if file.exists() else []
        file.unlink(missing_ok=True)
        return seeds

    def submit(self, *words: object, expect: int = 0, **environment: str) -> subprocess.CompletedProcess[str]:
        """Submits the campaign."""
        return self.command(self.campaign, *words, expect=expect, **environment)

    def command(self, *words: object, expect: int = 0, **environment: str) -> subprocess.CompletedProcess[str]:
        done = subprocess.run(
            [ROOT / "tools" / "campaign-slurm", *map(str, words)],
            env=os.environ | self.environment | environment,
            capture_output=True,
            text=True,
            check=False,
            timeout=60,
            cwd=self.folder,
        )
        assert done.returncode == expect, (done.stdout, done.stderr)
        return done

    def submitted(self) -> list[str]:
        """The arguments of the last sbatch."""
        return (self.folder / "arguments").read_text().splitlines()


def program(file: Path, text: str) -> None:
    file.parent.mkdir(exist_ok=True)
    file.write_text(text)
    file.chmod(0o755)


def toy_campaign(folder: Path) -> Cluster:
    cluster = Cluster(folder)
    (cluster.campaign / "results").mkdir(parents=True)
    program(folder / "toy", TOY)
    write_lines(cluster, [toy_line(cluster, seed) for seed in range(1, LINES + 1)])
    return cluster


def toy_line(cluster: Cluster, seed: int) -> str:
    return shlex.join([str(cluster.folder / "toy"), str(seed), "--csv", str(cluster.campaign / f"results/{seed}.csv")])


def write_lines(cluster: Cluster, lines: list[str]) -> None:
    (cluster.campaign / "jobs.txt").write_text("".join(f"{line}\n" for line in lines))


@pytest.fixture
def cluster(tmp_path: Path) -> Cluster:
    """A pretended cluster."""
    cluster = toy_campaign(tmp_path)
    program(tmp_path / "bin" / "sbatch", SBATCH)
    program(tmp_path / "bin" / "scontrol", SCONTROL)
    cluster.environment = {
        "PATH": f"{tmp_path / 'bin'}:{os.environ['PATH']}",
        "FAKE": str(tmp_path),
        "FAKE_ORDER": "cat",
        "FAKE_SIZE": "1001",
    }
    return cluster


@pytest.mark.parametrize("order", ["cat", "tac", "sort"])
def test_a_line_is_a_task_and_their_order_is_nobodys_business(cluster: Cluster, order: str) -> None:
    jobs = (cluster.campaign / "jobs.txt").read_bytes()
    done = cluster.submit("--wait", FAKE_ORDER=order)
    assert f"--array=1-{LINES}" in cluster.submitted()
    assert sorted(cluster.ran()) == list(range(1, LINES + 1))
    assert cluster.results == {f"{seed}.csv": f"{seed},{ROOT}\n" for seed in range(1, LINES + 1)}  # run from the root
    assert done.stdout.splitlines()[1:] == ["Submitted batch job 7", "12 lines are done"]
    assert not done.stderr
    assert "line 5: exit code 0" in cluster.log(5)
    assert (cluster.campaign / "jobs.txt").read_bytes() == jobs


def test_done_lines_are_left_out(cluster: Cluster) -> None:
    cluster.submit()
    assert len(cluster.ran()) == LINES
    for seed in (3, 12):
        (cluster.campaign / f"results/{seed}.csv").unlink()
    cluster.submit("--wait")
    assert sorted(cluster.ran()) == [3, 12]
    assert "4.csv is there" in cluster.log(4)
    assert "line 4: exit code 0" in cluster.log(4)  # the log of the first run is kept


def test_failures_are_seen_when_one_waits(cluster: Cluster) -> None:
    (cluster.folder / "fail.4").write_text("2")
    (cluster.folder / "fail.9").write_text("1")
    done = cluster.submit("--wait", expect=1)
    log = cluster.campaign / "slurm" / "4.log"
    assert done.stderr == f"campaign-slurm: 2 of 12 lines have no result, first: line 4, see {log}\n"
    assert "line 4: exit code 2" in log.read_text()
    assert len(cluster.results) == LINES - 2
    assert cluster.submit(SBATCH_WAIT="1", expect=1).stderr == done.stderr
    assert not cluster.submit().stderr  # who does not wait does not know
    cluster.ran()
    for seed in (4, 9):
        (cluster.folder / f"fail.{seed}").unlink()
    cluster.submit("-W")
    assert sorted(cluster.ran()) == [4, 9]


def test_more_lines_than_the_cluster_allows_tasks(cluster: Cluster) -> None:
    (cluster.folder / "fail.2").write_text("1")
    cluster.submit("--wait", FAKE_SIZE="6", expect=1)
    assert "--array=1-5" in cluster.submitted()  # the greatest index is one less than the size
    assert cluster.ran() == [1, 6, 11, 2, 7, 12, 3, 8, 4, 9, 5, 10]
    assert [f"line {line}: exit code" in cluster.log(2) for line in (2, 7, 12)] == [True] * 3  # it went on
    cluster.submit(FAKE_SIZE="12")
    assert "--array=1-11" in cluster.submitted()
    cluster.submit(FAKE_SIZE="13")
    assert "--array=1-12" in cluster.submitted()
    for words in (("--array-tasks", "3"), ("--array-tasks=3",)):
        cluster.submit(*words)
        assert "--array=1-3" in cluster.submitted()
    cluster.submit("--array-tasks=30")
    assert "--array=1-12" in cluster.submitted()


def test_a_cluster_that_does_not_tell_its_size_has_slurms_own(cluster: Cluster) -> None:
    (cluster.folder / "bin" / "scontrol").write_text("#!/bin/bash\nexit 1\n")
    write_lines(cluster, [""] * 1001)
    cluster.submit("--hold", FAKE_ORDER="head -n 1")
    assert "--array=1-1000" in cluster.submitted()


def test_a_line_that_ends_well_without_its_result_has_failed(cluster: Cluster) -> None:
    write_lines(cluster, ["true --csv no.csv"])
    assert "1 of 1 lines have no result" in cluster.submit("--wait", expect=1).stderr
    assert "no.csv was not written" in cluster.log(1)


def test_a_line_without_a_result_is_judged_by_its_exit_code(cluster: Cluster) -> None:
    ran = cluster.folder / "ran"
    for line in (f"echo 1 >>{ran}; exit 3", f"echo 1 >>{ran}; bash -c 'exit 3' bash --csv -"):
        write_lines(cluster, [line])
        for _ in range(2):
            assert "the job ended with exit code 3" in cluster.submit("--wait", expect=1).stderr
            assert cluster.ran() == [1]


def test_a_job_file_that_changed_after_it_was_submitted_is_not_run(cluster: Cluster) -> None:
    cluster.submit("--hold", FAKE_ORDER="head -n 0")
    words = cluster.submitted()[-5:]
    assert words[0] == "--task"
    write_lines(cluster, [toy_line(cluster, 3)])
    done = cluster.command(*words, SLURM_ARRAY_TASK_ID="1", expect=2)
    assert "has changed since it was submitted" in done.stderr
    assert cluster.ran() == []


def test_other_options_go_to_sbatch(cluster: Cluster) -> None:
    cluster.submit("--partition", "short", "--time=30", "-W")
    words = cluster.submitted()
    first = words.index("--partition")
    assert words[first : first + 4] == ["--partition", "short", "--time=30", "-W"]
    assert words[first + 4] == str(ROOT / "tools" / "campaign-slurm")


def test_the_folder_may_be_told_in_any_way(cluster: Cluster) -> None:
    cluster.command(cluster.campaign.name, "--wait")
    assert len(cluster.results) == LINES


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ([], "no campaign"),
        (["--wait"], "--wait stands where the campaign should"),
        (["nowhere"], "nowhere is not a folder"),
        (["bin"], "bin/jobs.txt is missing"),
        (["empty"], "empty/jobs.txt is empty"),
        (["GOOD", "--array=1-3"], "--array=1-3 is made from the job file"),
        (["GOOD", "-a", "1-3"], "-a is made from the job file"),
        (["GOOD", "--array-tasks", "0"], "--array-tasks 0"),
        (["GOOD", "--array-tasks=many"], "--array-tasks many"),
        (["GOOD", "--array-tasks"], "--array-tasks without a number"),
        (["GOOD", "--wrap=true"], "--wrap=true is not for campaigns"),
        (["GOOD", "--wait", "toy"], "toy belongs to no option"),
    ],
)
def test_what_cannot_be_run_is_refused_in_one_line(cluster: Cluster, words: list[str], told: str) -> None:
    (cluster.folder / "empty").mkdir()
    (cluster.folder / "empty" / "jobs.txt").touch()
    done = cluster.command(*[cluster.campaign if word == "GOOD" else word for word in words], expect=2)
    assert refusal(done).find(told) >= 0, done.stderr
    assert not (cluster.folder / "arguments").exists()


def test_what_slurm_refuses_is_refused(cluster: Cluster) -> None:
    done = cluster.submit("--wait", FAKE_REFUSAL="sbatch: error: invalid partition specified: no", expect=2)
    assert "sbatch says: sbatch: error: invalid partition specified: no ; " in refusal(done)


def test_no_slurm_is_refused(cluster: Cluster) -> None:
    (cluster.folder / "few").mkdir()
    for name in ("bash", "dirname", "env"):
        (cluster.folder / "few" / name).symlink_to(shutil.which(name) or "")
    assert "there is no sbatch" in refusal(cluster.submit(PATH=str(cluster.folder / "few"), expect=2))


def refusal(done: subprocess.CompletedProcess[str]) -> str:
    """Its one line."""
    assert done.stderr.startswith("campaign-slurm: ")
    assert done.stderr.count("\n") == 1, done.stderr
    assert "right would be" in done.stderr
    return done.stderr


def test_help(cluster: Cluster) -> None:
    for words in (["--help"], ["-h"], ["anything", "--help"]):
        assert cluster.command(*words).stdout.startswith("Usage: tools/campaign-slurm CAMPAIGN")


def one_node(*words: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [ROOT / "tests" / "slurm" / "one-node", *map(str, words)],
        capture_output=True,
        text=True,
        check=False,
        timeout=100,
        cwd=ROOT,
    )


def test_one_node(tmp_path: Path, request: pytest.FixtureRequest) -> None:
    """Twelve lines on a real Slurm: one fails, and only that one is run again, as the second of its task."""
    cluster = toy_campaign(tmp_path)
    submit = ["tools/campaign-slurm", cluster.campaign, "--wait"]
    (tmp_path / "fail.8").write_text("2")
    done = one_node("-c", LINES, *submit)
    if done.returncode == 77:
        if len(request.session.items) == 1:  # a test of CTest on its own, to which 77 says "skipped"
            pytest.exit(done.stderr.strip(), returncode=77)
        pytest.skip(done.stderr.strip())
    assert done.returncode == 1, (done.stdout, done.stderr)
    assert "campaign-slurm: 1 of 12 lines have no result, first: line 8, see " in done.stderr
    assert "line 8: exit code 2" in cluster.log(8)
    assert "--- slurmctld" in done.stderr  # its log
    assert sorted(cluster.ran()) == list(range(1, LINES + 1))
    (tmp_path / "fail.8").unlink()
    done = one_node("-c", LINES, "-o", "MaxArraySize=6", *submit, "--time=5", "--partition", "all")
    assert done.returncode == 0, (done.stdout, done.stderr)
    assert "12 lines as 5 tasks" in done.stdout
    assert "12 lines are done" in done.stdout
    assert cluster.ran() == [8]
    assert cluster.results == {f"{seed}.csv": f"{seed},{ROOT}\n" for seed in range(1, LINES + 1)}


@pytest.mark.parametrize(
    ("words", "told"), [([], "no command"), (["-c", "0", "true"], "-c 0"), (["-o", "x", "true"], "-o x")]
)
def test_the_single_node_refuses_in_one_line(words: list[str], told: str) -> None:
    done = one_node(*words)
    assert done.returncode == 2
    assert done.stderr.startswith(f"one-node: {told}")
    assert done.stderr.count("\n") == 1


def test_the_document_shows_the_configuration_that_is_tested() -> None:
    script = (ROOT / "tests" / "slurm" / "one-node").read_text(encoding="utf-8")
    configuration = script.partition("<<CONF\n")[2].partition("CONF\n")[0].splitlines()
    document = (ROOT / "docs" / "campaigns.md").read_text(encoding="utf-8")
    assert len(configuration) > 20
    assert "".join(f"    {line}\n" for line in configuration) in document
