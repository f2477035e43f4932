"""Jobs by stand-ins of their processes: states, the queue, ends that nobody recorded, and what is too old."""

import json
import os
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from pytest import MonkeyPatch, raises
from tests.names import names_of

from sonolube.browser import job as process_of_job, jobs as module
from sonolube.browser.jobs import Jobs
from sonolube.errors import InvalidInput
from sonolube.operating_system import process_start

NOWHERE: dict[str, Any] = {"rigs": {}, "uploads": ""}
NOW = 1e9


class Process:
    """Stands in for the process of a job."""

    made: list["Process"]
    stays = False

    def __init__(self, command: list[str], **more: Any) -> None:
        self.command, self.more, self.returncode = command, more, 0
        self.code: int | None = None
        self.calls: list[str] = []
        self.made.append(self)

    def poll(self) -> int | None:
        return self.code

    def terminate(self) -> None:
        self.calls.append("terminate")

    def kill(self) -> None:
        self.calls.append("kill")

    def wait(self, longest: float | None = None) -> int:
        self.calls.append("wait" if longest is None else f"wait {longest}")
        if self.stays and longest is not None:
            raise subprocess.TimeoutExpired(self.command, longest)
        return 0


@pytest.fixture
def jobs(tmp_path: Path, monkeypatch: MonkeyPatch) -> Jobs:
    Process.made, Process.stays = [], False
    monkeypatch.setattr(names_of(module).subprocess, "Popen", Process)
    monkeypatch.setattr(names_of(module).time, "time", lambda: NOW)
    return Jobs(tmp_path / "jobs", most=2)


def started(jobs: Jobs, label: str = "") -> str:
    return jobs.start("sweep", {"rig": 1}, label=label, places=NOWHERE).id


def write(jobs: Jobs, name: str, **state: Any) -> None:
    (jobs.folder / name / "state.json").write_text(json.dumps(state))


def test_as_many_jobs_run_as_there_are_processors_and_others_wait_for_an_end(jobs: Jobs) -> None:
    names = [started(jobs) for _ in range(3)]
    assert [jobs.job(name).state for name in names] == ["running", "running", "waiting"]
    assert Process.made[0].command[1:] == ["-m", "sonolube.browser.job", str(jobs.folder / names[0])]
    write(jobs, names[0], state="done")
    Process.made[0].code = 0
    jobs.tend()
    assert [jobs.job(name).state for name in names] == ["done", "running", "running"]
    assert len(Process.made) == 3


def test_a_record_has_what_its_page_and_its_process_said(jobs: Jobs) -> None:
    name = started(jobs, "my sweep")
    write(jobs, name, state="running", stage="sweeping", done=3, total=7, seconds=1.5, of="command", other=1)
    job = jobs.job(name)
    assert (job.task, job.label, job.stage, job.done, job.total, job.seconds, job.of) == (
        "sweep", "my sweep", "sweeping", 3, 7, 1.5, "command",
    )  # fmt: skip
    assert job.created == NOW
    assert jobs.request(name) == {"task": "sweep", "arguments": {"rig": 1}, "label": "my sweep"}
    if os.name == "posix":
        assert (jobs.folder / name).stat().st_mode & 0o777 == 0o700


def test_a_process_that_ended_without_a_word_has_failed_with_its_code(jobs: Jobs) -> None:
    name = started(jobs)
    write(jobs, name, state="running", stage="sweeping")
    Process.made[0].code = Process.made[0].returncode = -9
    jobs.tend()
    job = jobs.job(name)
    assert (job.state, job.stage) == ("failed", "sweeping")
    assert job.reason.startswith("its process ended (code -9); a job may use 2 GiB of memory")


@pytest.mark.parametrize("stays", [False, True])
def test_a_cancelled_job_is_ended_by_force_where_it_stays(stays: bool, jobs: Jobs) -> None:
    Process.stays = stays
    name = started(jobs)
    assert jobs.cancel(name).state == "cancelled"
    more = ["kill", "wait"] if stays else []
    assert Process.made[0].calls == ["terminate", "wait 0.5", *more]
    names = [started(jobs) for _ in range(3)]
    assert jobs.cancel(names[2]).state == "cancelled"  # which had not begun
    assert len(Process.made) == 3
    jobs.delete(names[0])
    assert sorted(job.id for job in jobs.list()) == sorted([name, *names[1:]])


def test_jobs_come_latest_first(jobs: Jobs) -> None:
    for name in ("20260101-000000-aa", "20260301-000000-aa", "20260201-000000-aa", "no-request"):
        (jobs.folder / name).mkdir()
        if name != "no-request":
            request = {"task": "map", "label": "", "created": 1.0}
            (jobs.folder / name / "request.json").write_text(json.dumps(request))
    assert [job.id[4:6] for job in jobs.list()] == ["03", "02", "01"]


def test_the_end_of_the_server_ends_every_process_and_leaves_its_jobs_interrupted(jobs: Jobs) -> None:
    names = [started(jobs) for _ in range(2)]
    jobs.end()
    assert [each.calls[0] for each in Process.made] == ["terminate"] * 2
    assert [Jobs(jobs.folder, most=1).job(name).state for name in names] == ["interrupted"] * 2


@pytest.mark.parametrize(
    ("owner", "state"),
    [
        ({"process": os.getppid(), "begun": process_start(os.getppid())}, "running elsewhere"),
        ({"process": os.getppid(), "begun": "before"}, "interrupted"),
        ({"process": os.getppid(), "begun": ""}, "interrupted"),
        ({"process": "1", "begun": "a"}, "interrupted"),
        (None, "interrupted"),
    ],
)
def test_a_job_runs_elsewhere_while_the_very_process_of_its_owner_lives(owner: Any, state: str, jobs: Jobs) -> None:
    (jobs.folder / "a-1").mkdir()
    request = {"task": "map", "label": "", "created": 1.0, "owner": owner}
    (jobs.folder / "a-1" / "request.json").write_text(json.dumps(request))
    assert jobs.job("a-1").state == state
    write(jobs, "a-1", state="done")
    assert jobs.job("a-1").state == "done"


def test_results_and_files_are_those_of_a_job_that_is_done(jobs: Jobs) -> None:
    name = started(jobs)
    with raises(InvalidInput, match=r"^the job is running; it has no result$"):
        jobs.result(name)
    write(jobs, name, state="done")
    Process.made[0].code = 0
    jobs.tend()
    with raises(InvalidInput, match="the job is done; it has no result"):
        jobs.result(name)
    (jobs.folder / name / "result.json").write_bytes(b"{}")
    (jobs.folder / name / "files" / "inner").mkdir(parents=True)
    (jobs.folder / name / "files" / "inner" / "a.csv").write_text("1")
    assert jobs.result(name) == b"{}"
    assert jobs.file(name, "inner/a.csv").read_text() == "1"
    for file in ("../request.json", "inner", "b.csv"):
        with raises(InvalidInput, match="the job has no file"):
            jobs.file(name, file)


def test_jobs_are_kept_for_thirty_days(tmp_path: Path, monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(names_of(module).time, "time", lambda: NOW)
    for name, days in (("young", 29.9), ("old", 30.1)):
        (tmp_path / name).mkdir()
        then = NOW - 86400 * days
        os.utime(tmp_path / name, (then, then))
    Jobs(tmp_path, most=1)
    assert [path.name for path in tmp_path.iterdir()] == ["young"]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: MonkeyPatch) -> Iterator[Path]:
    """Folder of a job, whose process is this one and is not limited."""
    limits: list[Any] = []
    monkeypatch.setattr(process_of_job, "limit_process", lambda **named: limits.append(named))
    request = {"task": "materials", "arguments": {"name": "aluminium_2024"}, "places": NOWHERE}
    (tmp_path / "request.json").write_text(json.dumps(request))
    yield tmp_path
    assert limits == [{"cpu_time": 600}]


def state(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "state.json").read_text())
    return found


def test_the_process_of_a_job_writes_its_result_and_what_made_it(folder: Path) -> None:
    process_of_job.main(folder)
    found = state(folder)
    assert found["state"] == "done"
    assert found["of"].startswith("sonolube ")
    assert "sonolube materials" in found["of"]
    assert found["seconds"] >= 0
    result = json.loads((folder / "result.json").read_text())
    assert result["answer"]["title"]
    assert (result["files"], result["made_by"]) == ([], f"Made by {found['of']}")


@pytest.mark.parametrize(
    ("arguments", "state_of_job", "words"),
    [({"name": "aluminum_2025"}, "refused", "unknown"), ({"nonsense": 1}, "refused", "no such argument")],
)
def test_a_job_that_is_refused_says_why(arguments: dict[str, Any], state_of_job: str, words: str, folder: Path) -> None:
    request = {"task": "materials", "arguments": arguments, "places": NOWHERE}
    (folder / "request.json").write_text(json.dumps(request))
    process_of_job.main(folder)
    assert (state(folder)["state"], words in state(folder)["reason"]) == (state_of_job, True)


def test_a_job_without_memory_has_failed(folder: Path, monkeypatch: MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise MemoryError

    monkeypatch.setattr(process_of_job, "called", fail)
    process_of_job.main(folder)
    assert state(folder)["state"] == "failed"
    assert state(folder)["reason"] == "does not fit into the 2 GiB of memory of a job; ask for fewer points"


def test_progress_is_written_not_more_often_than_people_read(tmp_path: Path, monkeypatch: MonkeyPatch) -> None:
    now = [100.0]
    monkeypatch.setattr(names_of(process_of_job).time, "monotonic", lambda: now[0])
    record = process_of_job._Record(tmp_path)
    record.progress("sweeping", 1, 9)
    assert {name: state(tmp_path)[name] for name in ("state", "stage", "done", "total", "seconds")} == {
        "state": "running", "stage": "sweeping", "done": 1, "total": 9, "seconds": 0.0,
    }  # fmt: skip
    now[0] += 0.19
    record.progress("sweeping", 2, 9)
    assert state(tmp_path)["done"] == 1
    now[0] += 0.02
    record.progress("sweeping", 3, 9)
    assert (state(tmp_path)["done"], round(state(tmp_path)["seconds"], 6)) == (3, 0.21)
