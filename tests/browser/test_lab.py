"""Page Lab: runs in processes of their own that outlive pages and servers, who may steer them, and their stop page."""

import http.client
import json
import os
import signal
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.browser.laboratory import HEAD, HOLDER, LONG, OTHER, RIG, SHORT, Asked, laboratory, stop_page, until
from tests.browser.workbench import served
from tests.laboratory.test_added_drivers import MAP, PROTOCOL, packages as packages_of_acme, written
from tests.same import same

import sonolube as sl
from sonolube.browser.lab import routes
from sonolube.browser.lab.runner_records import laboratory_folder
from sonolube.cli import main
from sonolube.example_files import example_file
from sonolube.laboratory.catalogue import catalogued_runs
from sonolube.laboratory.records import Run, read_run
from sonolube.operating_system import process_start
from sonolube.tasks.files import NamedBytes
from sonolube.tasks.lab.protocol_run import RunAnswer

packages = packages_of_acme


@pytest.fixture
def lab(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Asked]:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    with laboratory(tmp_path) as found:
        yield found
        run = found.state()["run"]
        if run is not None and process_start(run["process"]):
            found.post("/api/lab/stop")
            until(lambda: not process_start(run["process"]) or found.state()["run"]["is_ended"])


def record_of(folder: Path, run: dict[str, Any]) -> Run:
    return read_run(folder / "runs" / run["folder"])


def notes_of(run: Run) -> list[str]:
    return [note.kind for note in run.notes]


def test_a_run_outlives_its_killed_server_and_equals_one_that_nobody_disturbed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    with served(tmp_path) as workbench:
        first = Asked(workbench.port, workbench.token)
        started = first.start(SHORT)
        first.run_when(lambda run: run["time"] > 0)
        workbench.process.kill()
        workbench.process.wait()
    with laboratory(tmp_path) as second:
        found = second.state(HOLDER)
        assert (found["run"]["id"], found["holder"]["is_me"]) == (started["id"], True)
        ended = second.run_when(lambda run: run["is_ended"])
        assert second.state()["lost"] is None
        assert (ended["state"], ended["outcome"], ended["seed"]) == ("safe", "completed", 3)
        record = record_of(tmp_path, ended)
        protocol, rig = NamedBytes("short.toml", SHORT.encode()), example_file("tribometer").source
        answer = sl.lab.run(protocol, rig=rig, seed=3, out=tmp_path / "runs")
        assert isinstance(answer, RunAnswer)
        undisturbed = answer.run
        runs_are_compared(second, [record, undisturbed])
    assert notes_of(record) == notes_of(undisturbed)
    for name, values in undisturbed.dataset().items():
        same(record.dataset()[name].to_numpy(), values.to_numpy())
    assert {"tags": "tried", "operator": "Ann", "seed": 3}.items() <= record.facts.items()


def runs_are_compared(lab: Asked, runs: list[Run]) -> None:
    """Runs of one seed have the same levels, as in the table for `fit`, which is that of the catalogue."""
    names = [run.folder.name for run in runs]
    status, found = lab.post("/api/lab/compare", {"runs": names})
    assert status == 200, found
    levels = found["answer"]["levels"]
    numbers = [{key: level[key] for key in level.keys() - {"run", "source"}} for level in levels]
    assert [level["voltage_peak_to_peak"] for level in levels] == [0.0, 20.0] * 2
    same(numbers[:2], numbers[2:])
    assert any("no measurement" in each for each in found["caveats"])
    table = catalogued_runs(f"catalogue:in={runs[0].folder.parent}")
    same(levels[1]["friction_force"], table["friction_force"].to_numpy()[0])
    given = {"name": found["name"], "upload": found["upload"]}
    status, fitted = lab.post("/api/tasks/fit", {"runs": given, "rig": RIG})
    assert (status, "2 runs under one condition" in fitted["text"]) == (422, True)  # read, and too few to rank models


def test_one_tab_steers_others_watch_and_anybody_stops(lab: Asked, tmp_path: Path) -> None:
    run = lab.start(LONG)
    its_record_is_its_owners_alone(laboratory_folder() / run["id"])
    assert lab.state(OTHER)["holder"] == {"is_me": False, "is_free": False}
    assert "another tab has the laboratory" in refused(lab, "hold", {"holder": OTHER})
    assert "a run is at work" in refused(lab, "start", {"holder": HOLDER, "protocol": {"name": "map_test"}, "rig": RIG})
    asked = lab.run_when(lambda run: run["prompt"])["prompt"]
    assert asked == {"number": 1, "task": "load", "text": "Bring the pin into contact."}
    assert "watches only" in refused(lab, "confirm", {"holder": OTHER, "number": 1, "is_done": True})
    assert "another prompt" in refused(lab, "confirm", {"holder": HOLDER, "number": 2, "is_done": True})
    assert "true or false" in refused(lab, "confirm", {"holder": HOLDER, "number": 1, "is_done": 1})
    assert "of the prompt" in refused(lab, "confirm", {"holder": HOLDER, "number": True, "is_done": True})
    assert lab.post("/api/lab/confirm", {"holder": HOLDER, "number": 1, "is_done": True})[0] == 200
    frames = first_frames(lab, 8)  # then the page is closed
    assert_slices_follow_one_another(frames)
    limits = {each["label"]: each for each in frames[-1]["limits"]}
    assert limits["friction force"]["share"] == pytest.approx(limits["friction force"]["value"] / 50)
    assert 0 <= limits["temperature"]["share"] < 0.1
    assert "watches only" in refused(lab, "pause", {"holder": OTHER})
    assert lab.post("/api/lab/pause", {"holder": HOLDER})[1]["is_paused"]
    paused = lab.run_when(lambda run: run["state"] == "paused")
    assert lab.post("/api/lab/resume", {"holder": HOLDER})[0] == 200
    lab.run_when(lambda run: run["state"] == "running" and run["time"] > paused["time"])
    strangers_are_refused(stop_page(run))
    assert lab.post("/api/lab/stop")[1]["outcome"] in ("stopped", "")
    ended = lab.run_when(lambda run: run["is_ended"])
    assert (ended["state"], ended["reason"], ended["stop_link"]) == ("safe", "stopped on a page", "")
    record = record_of(tmp_path, ended)
    assert notes_of(record)[-2:] == ["stop", "off"]
    assert len(record.recordings) == 2  # before and after the pause
    runs_are_shown(lab, record)


def its_record_is_its_owners_alone(folder: Path) -> None:
    modes = {path.name: path.stat().st_mode & 0o777 for path in folder.glob("*.json")}
    assert {"request.json", "runner.json"} <= modes.keys()
    assert set(modes.values()) == {0o600}
    assert folder.stat().st_mode & 0o777 == 0o700


def refused(lab: Asked, what: str, content: object) -> str:
    """Text of a refusal, which is one line."""
    status, found = lab.post(f"/api/lab/{what}", content)
    assert status == 422, found
    assert "\n" not in found["text"]
    return str(found["text"])


def first_frames(lab: Asked, count: int) -> list[dict[str, Any]]:
    """Frames of a reader that goes away after some."""
    with closing(http.client.HTTPConnection("127.0.0.1", lab.port, timeout=120)) as connection:
        connection.request("GET", "/api/lab/live", headers={"cookie": lab.cookie, "accept-encoding": "gzip"})
        answer = connection.getresponse()
        assert (answer.status, answer.headers["content-encoding"]) == (200, "identity")
        return [json.loads(answer.readline()) for _ in range(count)]


def assert_slices_follow_one_another(frames: list[dict[str, Any]]) -> None:
    """Slices of a channel are at most 40 ms apart, and the mean lies within the range of each."""
    slices = [each for frame in frames for each in frame["channels"].get("friction_force", ())]
    times = [each[0] for each in slices]
    assert len(times) > 4
    assert max(np.diff(times)) <= 0.04 + 1e-9
    assert min(np.diff(times)) > 0
    assert all(low <= mean <= high for _, low, high, mean in slices)
    assert all(frame["dropped"] == 0 for frame in frames)


def strangers_are_refused(page: Asked) -> None:
    """The server of a run lets nobody stop it without the link, by another name or from another page."""
    assert page.raw("GET", "/")[0] == 401
    assert page.raw("POST", "/stop")[0] == 401
    assert page.raw("GET", "/?token=wrong")[0] == 401
    assert page.get("/", host="evil.example")[0] == 421
    assert page.raw("POST", "/stop", cookie=page.cookie, origin="http://evil.example")[0] == 403
    assert page.raw("POST", "/stop", cookie=page.cookie, sec_fetch_site="cross-site")[0] == 403
    assert page.raw("POST", "/stop", cookie=page.cookie, origin="null")[0] == 403
    assert page.raw("POST", "/stop", cookie=page.cookie, origin="null", sec_fetch_site="same-site")[0] == 403
    assert page.raw("POST", "/pause", cookie=page.cookie)[0] == 403  # without the word that the workbench knows
    assert page.raw("POST", "/pause", cookie=page.cookie, x_sonolube_control="wrong")[0] == 403
    assert page.get("/static/app.css")[0] == 404
    status, body = page.get("/status")
    assert (status, json.loads(body)["is_ended"]) == (200, False)


def runs_are_shown(lab: Asked, record: Run) -> None:
    """The run is in the list, shown as `lab show` does, and each part of its recording becomes an upload."""
    name = record.folder.name
    (listed,) = json.loads(lab.get("/api/lab/runs")[1])["runs"]
    assert (listed["id"], listed["state"], listed["seed"], listed["tags"]) == (name, "stopped", 3, ["tried"])
    shown = json.loads(lab.get(f"/api/lab/runs/{name}")[1])
    same(shown["answer"], json.loads(sl.lab.show(record.folder).to_json()))
    for part in (1, 2):
        status, found = lab.post(f"/api/lab/runs/{name}/upload", {"part": part})
        assert (status, found["name"], found["parts"]) == (200, f"{name}-part-{part}.nc", 2)
        measured = lab.post(
            "/api/tasks/measure/friction", {"files": [{"name": found["name"], "upload": found["upload"]}]}
        )
        assert measured[0] == 200, measured


def test_the_page_of_a_run_stops_it_without_scripts_when_the_server_is_gone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    with laboratory(tmp_path) as lab:
        run = lab.start(LONG)
        lab.run_when(lambda run: run["prompt"])
    page = stop_page(run)
    status, headers, _ = page.raw("GET", f"/?token={page.token}")
    assert (status, headers["location"]) == (303, "./")
    cookie = str(headers["set-cookie"]).partition(";")[0]
    status, headers, body = page.raw("GET", "/", cookie=cookie)
    text = body.decode()
    assert status == 200
    assert "default-src 'self'" in headers["content-security-policy"]
    assert '<form method="post" action="stop">' in text
    assert '<meta name="referrer" content="same-origin">' in text  # so that browsers say whose form it is
    assert "emergency stop" in text
    assert "<script" not in text
    form = {"cookie": cookie, "content_type": "application/x-www-form-urlencoded"}
    status, _, body = page.raw("POST", "/stop", b"", **form, origin=f"http://127.0.0.1:{page.port}")
    assert status == 200
    assert "The run has ended; motor and drive: " in body.decode() or "Stopping: " in body.decode()
    until(lambda: not process_start(run["process"]))
    with laboratory(tmp_path) as lab:
        ended = lab.state()["run"]
    assert (ended["state"], ended["outcome"]) == ("safe", "stopped")
    assert "while asked: Bring the pin into contact." in ended["reason"]
    assert notes_of(record_of(tmp_path, ended))[-2:] == ["stop", "off"]


def test_a_run_whose_process_hangs_is_told_and_stopped_by_a_signal(
    lab: Asked, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = lab.start(LONG)
    lab.run_when(lambda run: run["prompt"])
    monkeypatch.setattr(routes, "_LOOKING", 0.5)
    monkeypatch.setattr(routes, "_STOPPING", 0.5)
    os.kill(run["process"], signal.SIGSTOP)
    hung = lab.state()["run"]
    assert (hung["state"], hung["is_lost"], bool(hung["stop_link"])) == ("paused", False, True)
    assert "does not answer" in hung["reason"]
    assert lab.post("/api/lab/stop")[0] == 200
    os.kill(run["process"], signal.SIGCONT)
    ended = lab.run_when(lambda run: run["is_ended"])
    assert (ended["state"], ended["outcome"]) == ("safe", "stopped")
    assert notes_of(record_of(tmp_path, ended))[-2:] == ["stop", "off"]


def test_a_killed_run_is_told_and_its_record_recovered_before_the_next(lab: Asked, tmp_path: Path) -> None:
    run = lab.start(HEAD + LONG.partition('Bring the pin into contact."\n')[2])
    lab.run_when(lambda run: run["time"] > 0.3)
    os.kill(run["process"], signal.SIGKILL)
    until(lambda: lab.state()["run"]["is_lost"])
    lost = lab.state(HOLDER)["lost"]
    assert lost["id"] == run["id"]
    assert "motor or drive may be on. Cut the power of the rig" in lost["text"]
    again = {"holder": HOLDER, "protocol": {"name": "short", "text": SHORT}, "rig": RIG}
    assert "Cut the power" in refused(lab, "start", again)
    assert "no run is at work" in refused(lab, "stop", {})
    assert "say true when" in refused(lab, "recover", {"holder": HOLDER})
    assert "watches only" in refused(lab, "recover", {"holder": OTHER, "is_off": True})
    status, found = lab.post("/api/lab/recover", {"holder": HOLDER, "is_off": True})
    assert status == 200
    record = read_run(tmp_path / "runs" / found["run"])
    assert record.summary.outcome == "interrupted"
    assert record.summary.samples > 0
    state = lab.state(HOLDER)
    assert (state["lost"], state["run"]["state"], state["run"]["is_lost"]) == (None, "safe", False)
    assert state["run"]["outputs"] == "the operator has cut the power and seen that motor and drive are off"


def test_a_killed_run_of_a_map_is_switched_off_and_told_by_its_switch_off_process(
    tmp_path: Path, packages: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(packages), os.environ.get("PYTHONPATH", "")]))
    with laboratory(tmp_path, device_map=written(tmp_path, MAP)) as lab:
        assert lab.post("/api/lab/hold", {"holder": HOLDER})[0] == 200
        run = lab.start(PROTOCOL.replace('"0.3 s"', '"50 s"').replace('"2 s"', '"60 s"'))
        log = packages / "log.txt"
        until(lambda: log.exists() and "drive 20 V 22000 Hz" in log.read_text())
        os.kill(run["process"], signal.SIGKILL)
        ended = lab.run_when(lambda run: run["is_ended"])
        assert lab.state(HOLDER)["lost"] is None
    assert (ended["state"], ended["outcome"], ended["reason"]) == ("safe", "failed", "its program was killed")
    assert ended["outputs"].startswith("confirmed off")
    assert record_of(tmp_path, ended).summary.outcome == "interrupted"
    lines = (packages / "log.txt").read_text().splitlines()
    assert {"drive off", "motor off"} <= set(lines[lines.index("drive 20 V 22000 Hz") :])


def test_devices_of_a_map_are_run_and_end_off(tmp_path: Path, packages: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(packages), os.environ.get("PYTHONPATH", "")]))
    with laboratory(tmp_path, device_map=written(tmp_path, MAP)) as lab:
        devices = lab.state()["devices"]
        assert (devices["kind"], devices["title"]) == ("map", "Rig of Acme")
        assert [(each["name"], each["unit"]) for each in devices["channels"]] == [
            ("friction_force", "N"),
            ("emission", "V"),
        ]
        fast = PROTOCOL.replace('"1 Hz"', '"200 Hz"')
        assert lab.post("/api/lab/hold", {"holder": HOLDER})[0] == 200
        asked = {"holder": HOLDER, "protocol": {"name": "fast", "text": fast}, "rig": None}
        assert "turns at most at" in refused(lab, "start", asked)
        lab.start(PROTOCOL)
        ended = lab.run_when(lambda run: run["is_ended"])
    assert (ended["state"], ended["outcome"], ended["seed"], ended["rig"]) == ("safe", "completed", None, "Rig of Acme")
    assert record_of(tmp_path, ended).dataset()["friction_force"].to_numpy() == pytest.approx(0.5)
    lines = (packages / "log.txt").read_text().splitlines()
    assert lines[lines.index("drive 20 V 22000 Hz") + 1 :][:2] == ["drive off", "motor off"]
    assert {"drive close", "motor close", "inputs close"} <= set(lines)


@pytest.mark.parametrize(("text", "words"), [('title = "x"', "acquisition: missing"), ("[[", "not valid TOML")])
def test_faults_of_a_map_are_one_line_before_anything_is_served(
    text: str, words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as end:
        main(["app", "--no-browser", "--lab", str(written(tmp_path, text))])
    assert end.value.code == 2
    assert words in capsys.readouterr().err


BAD = (
    *(b"", b"[]", b"{", b"\xff", b'{"holder": 1}', b'{"holder": "tab-of-the-operator", "protocol": []}'),
    *(b'{"holder": "tab-of-the-operator", "protocol": {"name": "../x"}}', b'{"runs": ["../../etc"]}', b'{"runs": 3}'),
    b'{"holder": "tab-of-the-operator", "protocol": {"name": "map_test"}, "rig": 3}',
    b'{"holder": "tab-of-the-operator", "protocol": {"name": "map_test"}, "rig": {"name": "tribometer"}, "seed": -1}',
    b'{"holder": "tab-of-the-operator", "protocol": {"name": "map_test"}, "rig": {"name": "tribometer"}, "tags": "a"}',
    b'{"holder": "tab-of-the-operator", "protocol": {"name": "map_test"}, "rig": {"name": "tribometer"}, "facts": [1]}',
    b'{"holder": "tab-of-the-operator", "protocol": {"name": "x", "text": "steps = 3"}, "rig": {"name": "tribometer"}}',
    b'{"protocol": {"name": "map_test"}, "changes": {"steps.9.duration": "1 s", "insert": 3, "move": {}}}',
    b'{"protocol": {"name": "map_test"}, "changes": {"steps.4.duration": {"a": 1}}}',
    b'{"protocol": {"name": "map_test"}, "changes": {"remove": "0", "": ""}}',
)
PLACES = (
    *("lab/start", "lab/pause", "lab/confirm", "lab/stop", "lab/recover", "lab/compare", "lab/runs/none/upload"),
    *("protocol", "edit_protocol", "lab/hold"),
)


def test_what_makes_no_sense_is_one_line_and_starts_nothing(lab: Asked, tmp_path: Path) -> None:
    assert lab.post("/api/lab/hold", {"holder": HOLDER})[0] == 200
    for place in PLACES:
        for body in BAD:
            status, found = lab.post(f"/api/{place}", body)
            if (place, status) != ("lab/hold", 200) and (place, status) != ("protocol", 200):
                assert status == 422, (place, body, found)
                assert found["text"]
                assert "\n" not in found["text"]
    for path in ("/api/lab/live", "/api/lab/runs/..%2f..", "/api/lab/runs/none", "/api/lab/runs/.hidden"):
        assert lab.get(path)[0] in (404, 422)
    assert lab.state()["run"] is None
    assert not (tmp_path / "runs").exists()
