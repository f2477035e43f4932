"""Jobs: progress and result on disk, cancelled within a second, queued, found again, and limited."""

import json
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from sonolube.browser import job as job_process
from sonolube.browser.jobs import Job, Jobs
from sonolube.errors import InvalidInput

RIG = {"name": "tribometer"}
NOWHERE: dict[str, Any] = {"rigs": {}, "uploads": ""}
LONG = {"rig": RIG, "over": {"drive.voltage_peak_to_peak": "1V:200V:200", "sliding.sliding_speed": "1mm/s:1m/s:2000"}}


@pytest.fixture
def jobs(tmp_path: Path) -> Iterator[Jobs]:
    found = Jobs(tmp_path / "jobs", most=1)
    yield found
    found.end()


def ended(jobs: Jobs, name: str) -> Job:
    """Record of a job after its end; the test runner's own limit ends one that never comes."""
    while True:
        jobs.tend()
        job = jobs.job(name)
        if job.state not in ("waiting", "running"):
            return job
        time.sleep(0.02)


def test_a_job_leaves_its_result_and_files_and_is_found_by_another_server(jobs: Jobs) -> None:
    started = jobs.start("contact", {"rig": RIG}, label="contact of the tribometer", places=NOWHERE)
    assert ended(jobs, started.id).state == "done"
    others = Jobs(jobs.folder, most=1)
    (found,) = others.list()
    assert (found.task, found.label, found.state) == ("contact", "contact of the tribometer", "done")
    content = json.loads(others.result(found.id))
    assert content["answer"]["rig"].startswith("Modified pin-on-disc tribometer")
    others.delete(found.id)
    assert others.list() == []


def test_a_refused_job_says_why(jobs: Jobs) -> None:
    started = jobs.start("contact", {"rig": {"name": "nothing"}}, label="", places=NOWHERE)
    job = ended(jobs, started.id)
    assert job.state == "refused"
    assert "there is no rig 'nothing'" in job.reason
    with pytest.raises(InvalidInput, match="it has no result"):
        jobs.result(started.id)


def test_jobs_beyond_the_processors_wait_and_a_cancelled_one_ends(jobs: Jobs) -> None:
    first = jobs.start("sweep", LONG, label="", places=NOWHERE)
    second = jobs.start("contact", {"rig": RIG}, label="", places=NOWHERE)
    assert (jobs.job(first.id).state, jobs.job(second.id).state) == ("running", "waiting")
    assert jobs.cancel(first.id).state == "cancelled"
    assert ended(jobs, second.id).state == "done"
    assert jobs.job(first.id).state == "cancelled"


def test_a_job_whose_server_was_killed_counts_as_interrupted(jobs: Jobs) -> None:
    started = jobs.start("sweep", LONG, label="", places=NOWHERE)
    jobs.end()
    assert Jobs(jobs.folder, most=1).job(started.id).state == "interrupted"


OTHER = """
import json, sys
from pathlib import Path
from sonolube.browser.jobs import Jobs
jobs = Jobs(Path(sys.argv[1]), most=1)
for _ in range(2):
    print(jobs.start("sweep", json.loads(sys.argv[2]), label="", places={"rigs": {}, "uploads": ""}).id, flush=True)
sys.stdin.read()
jobs.end()
"""


def test_a_job_of_another_workbench_that_runs_is_neither_stopped_nor_deleted_here(jobs: Jobs) -> None:
    command = [sys.executable, "-c", OTHER, str(jobs.folder), json.dumps(LONG)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as other:
        assert other.stdout is not None
        names = [other.stdout.readline().strip() for _ in range(2)]  # one runs, one waits
        assert [jobs.job(name).state for name in names] == ["running elsewhere"] * 2
        for call in (jobs.cancel, jobs.delete):
            with pytest.raises(InvalidInput, match="another workbench of yours runs this job"):
                call(names[0])
        assert jobs.job(names[0]).state == "running elsewhere"
        other.communicate("")
    assert [jobs.job(name).state for name in names] == ["interrupted"] * 2
    jobs.delete(names[0])
    assert [job.id for job in jobs.list()] == names[1:]


@pytest.mark.parametrize("name", ["", "..", "../jobs", "no-such", "a/b", "x" * 300])
def test_names_that_are_no_job_are_refused(jobs: Jobs, name: str) -> None:
    for call in (jobs.job, jobs.result, jobs.cancel):
        with pytest.raises(InvalidInput, match="there is no job"):
            call(name)


def test_no_file_beside_those_of_a_job_is_read(jobs: Jobs) -> None:
    started = jobs.start("contact", {"rig": RIG}, label="", places=NOWHERE)
    ended(jobs, started.id)
    for name in ("../request.json", "/etc/passwd", "..", "nothing.txt"):
        with pytest.raises(InvalidInput, match="has no file"):
            jobs.file(started.id, name)


@pytest.mark.parametrize(
    "failure", [IndexError("list index out of range"), ZeroDivisionError("float division by zero"), RuntimeError("no")]
)
def test_a_job_that_raises_what_no_refusal_foresees_has_failed_by_a_fault_of_sonolube(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, failure: Exception
) -> None:
    def failing(*_: object) -> None:
        raise failure

    monkeypatch.setattr(job_process, "called", failing)
    monkeypatch.setattr(job_process, "limit_process", lambda **_: None)
    request = {"task": "contact", "arguments": {"rig": RIG}, "places": NOWHERE}
    (tmp_path / "request.json").write_text(json.dumps(request), encoding="utf-8")
    job_process.main(tmp_path)
    state = json.loads((tmp_path / "state.json").read_text(encoding="utf-8"))
    kind = f"{type(failure).__name__} ({failure})"
    assert state["state"] == "failed"
    assert state["reason"].startswith(
        f"a fault of sonolube itself, not of your input: {kind} in sonolube/browser/job.py"
    )
    assert "memory" not in state["reason"]
    file = Path(state["reason"].partition(", and attach ")[2].partition(",")[0])
    assert "Traceback" in file.read_text(encoding="utf-8")
    file.unlink()
