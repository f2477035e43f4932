"""Parts of requests and answers: arguments, files, rigs, refusals and blocks as objects, routes of the workbench."""

import base64
import json
from contextlib import ExitStack
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from pytest import MonkeyPatch, approx, raises
from tests.browser.asgi import Client
from tests.names import names_of

from sonolube import __version__
from sonolube.browser import answers, mode_view, recording_view as recordings, routes, scan_view
from sonolube.browser.access import Access, Guard
from sonolube.browser.answer_files import _about, _bytes_of, _file as saved
from sonolube.browser.jobs import Job, Jobs
from sonolube.browser.measured_use import measured_table, measured_use
from sonolube.browser.requests import Places
from sonolube.browser.routes import Workbench
from sonolube.browser.take_away import _page_of_blocks, _scalars
from sonolube.browser.uploads import Uploads
from sonolube.browser.worker import Pool
from sonolube.errors import InvalidInput, SeveralFaults, UnknownName
from sonolube.example_files import example_file
from sonolube.report.blocks import Rows, Table, Verbatim
from sonolube.tasks.answer import Listing
from sonolube.tasks.table import task_named

NOWHERE = Places(rigs={})


def given(task: str, arguments: dict[str, Any], places: Places = NOWHERE) -> dict[str, Any]:
    with answers.given_arguments(task_named(task), arguments, places) as found:
        return dict(found)


def test_arguments_are_known_whole_and_without_those_of_doors() -> None:
    known = "rig, model, interval, evidence"
    with raises(InvalidInput, match=f"^nonsense: friction has no such argument; it has {known}$") as one:
        given("friction", {"rig": {"name": "tribometer"}, "nonsense": 1})
    assert one.value.key == "nonsense"
    with raises(InvalidInput, match=r"^rig: friction needs it$") as two:
        given("friction", {})
    assert two.value.key == "rig"
    with raises(InvalidInput, match=r"^progress: simulate has no such argument"):
        given("simulate", {"rig": {"name": "tribometer"}, "progress": 1})
    assert given("compare", {}) == {}
    assert given("compare", {"rig": None, "model": ["kinematic"]}) == {"rig": None, "model": ["kinematic"]}
    assert answers.positional(task_named("measure stiffness")) == ["free", "pressed", "again"]


def test_files_of_a_request_are_contents_uploads_or_none(tmp_path: Path) -> None:
    (tmp_path / "00ff").write_bytes(b"up")
    places = Places(rigs={}, uploads=str(tmp_path))
    content = {"name": "C:\\d\\a.csv", "content": base64.b64encode(b"in").decode()}
    found = given("measure friction", {"files": [content, {"name": "b.csv", "upload": "00ff"}]}, places)["files"]
    assert [(each.name, each.content) for each in found] == [("a.csv", b"in"), ("b.csv", b"up")]
    assert given("predict", {"rig": {"name": "tribometer"}, "runs": None})["runs"] is None
    for file, words in (
        ({"name": 3}, "give an object with the name"), ("a.csv", "give an object with the name"),
        ({"name": "a.csv", "content": 3}, "the content of 'a.csv' is not base64"),
        ({"name": "a.csv", "upload": "none"}, "'a.csv' is no longer here; drop the file again"),
        ({"name": "a.csv"}, "'a.csv' is no longer here"),
        ({"name": ".hidden", "content": "YQ=="}, "'.hidden' is no name of a file"),
        ({"name": ".hidden", "upload": "00ff"}, "'.hidden' is no name of a file"),
    ):  # fmt: skip
        with raises(InvalidInput, match=words):
            given("measure friction", {"files": [file]}, places)
    with raises(InvalidInput, match="is no longer here"):
        given("measure friction", {"files": [{"name": "b.csv", "upload": "00ff"}]})


def test_a_text_that_is_a_file_of_this_computer_is_refused_wherever_it_is(tmp_path: Path) -> None:
    path = tmp_path / "secret"
    path.write_text("")
    for value in (str(path), [str(path)], {str(path): 1}, {"a": [str(path)]}):
        with raises(InvalidInput, match=r"^pin: 'secret' is a file of this computer; upload it$"):
            given("predict", {"rig": {"name": "tribometer"}, "pin": value})
    assert list(answers._texts({"a": ["b", {"c": 1}], "d": "e"})) == ["a", "b", "c", "d", "e"]


@pytest.mark.parametrize(
    ("source", "words"),
    [("tribometer", "give an object with its name or text"), ({"name": 3}, "give the name of an example"),
     ({"name": "tribometer", "changes": {"a": 1}}, "give texts by dotted key"),
     ({"name": "tribometer", "changes": ["a"]}, "give texts by dotted key"),
     ({"name": "map_test"}, "there is no rig 'map_test' here"),
     ({"name": "nothing"}, "there is no rig 'nothing' here")],
)  # fmt: skip
def test_a_rig_is_an_example_or_a_text_with_changes(source: Any, words: str) -> None:
    with ExitStack() as stack, raises(InvalidInput, match=words) as refused:
        answers.given_rig(source, NOWHERE, stack)
    assert refused.value.key == "rig"


def test_a_rig_by_its_text_has_its_name_and_one_that_was_opened_its_file() -> None:
    text = example_file("tribometer").source.read_text(encoding="utf-8")
    with ExitStack() as stack:
        assert answers.rig_path({"text": text, "name": "own"}, NOWHERE, stack).name == "own.toml"
        assert answers.rig_path({"text": text}, NOWHERE, stack).name == "rig.toml"
        opened = Places(rigs={"tribometer": "mine.toml"})
        assert answers.rig_path({"name": "tribometer"}, opened, stack) == Path("mine.toml")
        own = answers.given_rig({"text": text, "changes": {"contact.normal_load": "4 N"}}, NOWHERE, stack)
    assert own.normal_load == approx(4.0)


def test_a_refusal_names_files_without_folders_also_where_there_are_several_faults() -> None:
    path = Path("folder", "own.toml")

    def refuse(failure: Exception) -> None:
        with answers.names_only(path):
            raise failure

    with raises(InvalidInput, match=r"^own\.toml: bad$") as one:
        refuse(InvalidInput(f"{path}: bad", key="a.b"))
    assert one.value.key == "a.b"
    with raises(SeveralFaults) as both:
        refuse(SeveralFaults([f"{path}: x", "y"], where=str(path), keys=["a", "b"]))
    assert next(iter(both.value.faults)).endswith("own.toml: x")
    assert "folder" not in str(both.value)
    found = answers.refusal_object(both.value)
    assert [each["key"] for each in found["faults"]] == ["a", "b"]
    assert found["text"] == both.value.heading
    bare = answers.refusal_object(SeveralFaults(["x", "y"]))
    assert [each["key"] for each in bare["faults"]] == ["", ""]
    assert answers.refusal_object(InvalidInput("x", key="k")) == {"text": "x", "faults": [{"key": "k", "text": "x"}]}


def test_every_kind_of_block_is_an_object() -> None:
    blocks: list[Any] = [Rows([("a", "1")]), Table(("h",), [("2",)]), Verbatim(" v "), "  line "]
    assert [answers._block_object(block) for block in blocks] == [
        {"kind": "rows", "rows": [["a", "1"]]}, {"kind": "table", "heads": ["h"], "rows": [["2"]]},
        {"kind": "verbatim", "text": " v "}, {"kind": "text", "text": "line"},
    ]  # fmt: skip


def test_a_task_that_is_not_offered_is_unknown() -> None:
    for name in ("lab run", "lab recover", "nothing"):
        with raises(UnknownName, match=f"unknown task '{name}'"):
            answers.offered_task(name)
    assert answers.offered_task("lab show").name == "lab show"


def test_files_to_save_have_the_kind_of_their_ending_and_any_content_as_bytes(tmp_path: Path) -> None:
    assert saved("a/b.csv", b"1") == {"name": "b.csv", "kind": "text/csv", "base64": "MQ=="}
    assert saved("b.bin", b"")["kind"] == "application/octet-stream"
    (tmp_path / "a").write_bytes(b"path")
    assert (_bytes_of("ä"), _bytes_of(b"x"), _bytes_of(tmp_path / "a")) == ("ä".encode(), b"x", b"path")
    answer = Listing(parts=["x"], content={})
    assert _about(answer, "sonolube x") == f"sonolube {__version__}\ncommand: sonolube x\n"
    rig: Any = SimpleNamespace(title="Own", changes=("a=1",), assumptions={})
    object.__setattr__(answer, "rig", rig)
    assert _about(answer, "c").splitlines() == [f"sonolube {__version__}", "rig: Own", "changed: a=1", "command: c"]


def test_a_page_of_an_answer_has_its_rows_lines_and_tables() -> None:
    parts = ["title", Rows([("a", "1")]), " line ", Verbatim(" v "), Table(("h",), [["2"]])]
    page = _page_of_blocks(Listing(parts=parts, content={}))  # type: ignore[arg-type]
    assert (page.title, list(page.facts)) == ("title", [("a", "1"), ("", "line"), ("", "v")])
    assert [(table.heads, table.rows) for table in page.tables] == [(("h",), (("2",),))]
    assert _scalars({"a": {"value": 1, "unit": "m"}, "b": {"value": 2}, "c": {"unit": "m"}, "d": 3}) == [
        ["a", 1, "m"], ["b", 2, ""],
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("payload", "key"),
    [({"conditions": [1]}, "conditions"), ({"results": 3}, "results"), ({"results": [1]}, "results"),
     ({"results": [{}] * 1001}, "results"), ({"conditions": {"normal_load": "3 m"}}, "normal_load")],
)  # fmt: skip
def test_what_is_no_measurement_is_refused_by_its_name(payload: dict[str, Any], key: str) -> None:
    with raises(InvalidInput) as refused:
        measured_use(payload, NOWHERE)
    assert refused.value.key == key
    nothing = measured_use({"results": [{}] * 1000}, NOWHERE)
    assert (nothing["entries"], nothing["csv"], nothing["added"], nothing["runs"]) == ([], "", 0, 0)
    with raises(InvalidInput, match="give a list of answers in JSON"):
        measured_table({"answers": [1]}, NOWHERE)


def test_a_table_of_numbers_names_each_task_once_and_leaves_out_what_has_no_results() -> None:
    answer = {"results": [{"values": {"friction_force": {"value": 1.5, "unit": "N", "uncertainty": 0.1}}}, 3]}
    found = measured_table(
        {"answers": [{"name": "a.csv", "task": "measure  friction", "answer": answer}, {"task": "measure friction"},
                     {"task": "x", "answer": {"results": 3}}]}, NOWHERE,
    )["csv"].splitlines()  # fmt: skip
    assert found[0] == f"# sonolube {__version__}: measure friction, measure friction, x"
    assert len(found) == 3
    assert found[2].startswith("a.csv,")
    assert "friction_force,1.5,0.1,N" in found[2]


def test_sizes_of_parts_are_in_millimetres_with_a_start_where_they_are_needed() -> None:
    def bar(length: float, radius: float = 0.0125, count: int = 3, end_radius: float | None = None) -> None: ...

    found = mode_view._sizes(bar)
    assert [(each["name"], each["default"], each["start"]) for each in found] == [
        ("length", "", "127 mm"), ("radius", "12.5 mm", ""), ("end_radius", "", ""),
    ]  # fmt: skip
    assert (mode_view._size_text(0.5, ""), mode_view._size_text(2.0, "kg")) == ("0.5", "2 kg")


def test_shapes_are_packed_with_stresses_in_megapascals_per_micrometre() -> None:
    motion = SimpleNamespace(end_ratio=2.5, nodal_planes=[0.06, 0.07])
    moving = SimpleNamespace(
        name="axial 1", frequency_text="20 kHz", reference="tip", shape=np.ones((1, 3)), stress=np.array([4e12]),
        stress_per_displacement=4e12, motion=motion,
    )  # fmt: skip
    still = SimpleNamespace(**(vars(moving) | {"stress": None, "stress_per_displacement": None, "motion": None}))
    surface: Any = SimpleNamespace(
        points=np.zeros((1, 3)), triangles=np.array([[0, 1, 2]]), axis="x", modes=(moving, still)
    )
    found = mode_view.shapes_object(surface)
    first, second = found["modes"]
    assert np.frombuffer(base64.b64decode(first["stress"]), "<f4") == approx([4.0])
    assert np.frombuffer(base64.b64decode(found["triangles"]), "<u4").tolist() == [0, 1, 2]
    assert (first["peak_stress"], first["end_ratio"], first["nodal_planes"]) == (approx(4.0), 2.5, approx([60, 70]))
    assert (second["stress"], second["peak_stress"], second["end_ratio"], second["nodal_planes"]) == (None,) * 4


def upload(tmp_path: Path, content: str) -> tuple[dict[str, str], Places]:
    (tmp_path / "00ff").write_text(content)
    return {"name": "own.csv", "upload": "00ff"}, Places(rigs={}, uploads=str(tmp_path))


def test_a_recording_is_shown_whole_where_it_is_short_and_with_a_neighbour_at_each_end(tmp_path: Path) -> None:
    rows = "\n".join(f"{k / 10},{k * k}" for k in range(20))
    file, places = upload(tmp_path, f"time (s),friction_force (N)\n{rows}\n")
    view = recordings.file_view({"file": file}, places)
    assert (view["begin"], view["end"], view["samples"]) == (approx(0.0), approx(1.9), 20)
    assert view["axis"] == {"name": "time", "label": "Time", "unit": "s"}
    assert view["channels"][0]["unit"] == "N"
    assert (view["kind"], view["reason"], view["rows"]) == ("recording", "", {})
    assert view["bytes"] == (tmp_path / "00ff").stat().st_size
    assert next(each[:2] for each in view["quantities"] if each[0] == "friction_force") == ["friction_force", "N"]
    part = recordings.recording_view({"file": file, "from": 0.5, "to": 0.8}, places)
    assert part["x"] == approx([0.4, 0.5, 0.6, 0.7, 0.8, 0.9])
    assert part["channels"][0] == approx([16, 25, 36, 49, 64, 81])
    assert (part["samples"], part["is_reduced"]) == (6, False)
    whole = recordings.recording_view({"file": file}, places)
    assert (whole["samples"], len(whole["x"])) == (20, 20)
    less = recordings.recording_view({"file": file, "points": 3}, places)  # eight points at least
    assert (less["samples"], less["is_reduced"], len(less["x"])) == (20, True, 8)
    assert (min(less["channels"][0]), max(less["channels"][0])) == approx((0.0, 361.0))
    exact = recordings.recording_view({"file": file, "points": 20}, places)
    assert exact["is_reduced"] is False
    with raises(InvalidInput, match="it has not been read yet, or was dropped"):
        recordings.recording_view({"file": file, "mapping": "x"}, places)


def test_only_the_head_of_a_long_text_is_looked_at_up_to_a_whole_line(tmp_path: Path, monkeypatch: MonkeyPatch) -> None:
    path = tmp_path / "long.csv"
    path.write_text("ab\ncd\nef\n")
    assert recordings._head(path) == path
    monkeypatch.setattr(recordings, "_WHOLE", 9)
    assert recordings._head(path) == path
    monkeypatch.setattr(recordings, "_WHOLE", 8)
    monkeypatch.setattr(recordings, "_HEAD", 5)
    heads: list[bytes] = []
    monkeypatch.setattr(recordings, "file_path", lambda file: heads.append(file.content))
    recordings._head(path)
    path.write_text("abcdefghij")
    recordings._head(path)
    assert heads == [b"ab\n", b"abcde"]


def test_a_text_is_long_beyond_a_mebibyte_and_half_of_one_is_its_head(tmp_path: Path, monkeypatch: MonkeyPatch) -> None:
    path, heads = tmp_path / "long.csv", list[int]()
    monkeypatch.setattr(recordings, "file_path", lambda file: heads.append(len(file.content)))
    path.write_bytes(b"0123456789abcde\n" * (2**20 // 16))
    assert recordings._head(path) == path
    with path.open("ab") as stream:
        stream.write(b"0")
    recordings._head(path)
    assert heads == [2**19]


@pytest.mark.parametrize(("degree", "is_taken"), [(0, True), (12, True), (13, False), (-1, False), (1.0, False)])
def test_the_form_of_a_scan_has_a_degree_up_to_twelve(degree: Any, is_taken: bool, tmp_path: Path) -> None:
    np.save(tmp_path / "a.npy", 1e-6 * np.random.default_rng(1).standard_normal((20, 20)))
    (tmp_path / "a.npy").rename(tmp_path / "00ff")
    payload = {"file": {"name": "a.npy", "upload": "00ff"}, "spacing": "1 um", "degree": degree}
    places = Places(rigs={}, uploads=str(tmp_path))
    scan_view._read.cache_clear()
    if is_taken:
        found = scan_view.scan_view(payload, places)
        assert (found["is_profile"], found["metres"]["across"]) == (False, approx(1e-6))
    else:
        with raises(InvalidInput, match="give a whole number from 0 to 12") as refused:
            scan_view.scan_view(payload, places)
        assert refused.value.key == "degree"


class FakePool:
    """Pool that says what it was asked."""

    is_warm = True

    async def ask(self, kind: str, payload: Any, places: Places, *, is_gone: Any = None) -> tuple[int, bytes]:
        return 200, json.dumps({"kind": kind, "payload": payload, "waits": is_gone is not None}).encode()


class FakeJobs:
    """Jobs that list what was done to them."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.done = folder, list[Any]()

    def _job(self, name: str) -> Job:
        return Job(id=name, task="map", label="", created=1.0, state="done")

    def start(self, task: str, arguments: Any, *, label: str, places: Any) -> Job:
        self.done.append((task, arguments, label, places))
        return self._job("new")

    def list(self) -> list[Job]:
        return [self._job("one")]

    def job(self, name: str) -> Job:
        return self._job(name)

    def request(self, name: str) -> dict[str, Any]:
        return {"task": "map"}

    def cancel(self, name: str) -> Job:
        self.done.append(f"cancel {name}")
        return self._job(name)

    def delete(self, name: str) -> None:
        self.done.append(f"delete {name}")

    def tend(self) -> None:
        self.done.append("tend")

    def result(self, name: str) -> bytes:
        return b'{"of": "x"}'

    def file(self, name: str, file: str) -> Path:
        return self.folder / file


@pytest.fixture
def bench(tmp_path: Path) -> Any:
    (tmp_path / "a.csv").write_text("1")
    jobs, uploads = FakeJobs(tmp_path), Uploads(largest=10)
    workbench = Workbench(
        pool=cast(Pool, FakePool()), jobs=cast(Jobs, jobs), uploads=uploads, rigs={"own": "own.toml"}, opened="own",
        runs=tmp_path,
    )  # fmt: skip
    yield SimpleNamespace(client=Client(workbench.application()), jobs=jobs, uploads=uploads)
    uploads.end()


def test_pages_and_answers_have_their_routes(bench: Any) -> None:
    client = bench.client
    page = client.get("/")
    assert (page.status_code, page.headers["cache-control"]) == (200, "no-cache")
    assert client.get("/api/start").json() == {
        "rig": "own",
        "is_folder": False,
        "version": __version__,
        "is_running": False,
    }
    assert client.get("/api/description").json() == {"kind": "description", "payload": {}, "waits": True}
    asked = client.post("/api/tasks/measure/friction", {"a": 1})
    assert asked.headers["cache-control"] == "no-store"
    assert asked.json()["payload"] == {"task": "measure friction", "arguments": {"a": 1}}
    less = client.ask("POST", "/api/tasks/map", b"{}", query="tables=no").json()["payload"]
    assert less == {"task": "map", "arguments": {}, "tables": False}
    assert client.post("/api/rig", {"b": 2}).json()["kind"] == "rig"
    unknown = client.post("/api/rgi", {})
    assert (unknown.status_code, "did you mean rig" in unknown.json()["text"]) == (422, True)


def test_jobs_have_their_routes(bench: Any) -> None:
    client, jobs = bench.client, bench.jobs
    listed = client.get("/api/jobs").json()
    assert (listed["jobs"][0]["id"], listed["days"]) == ("one", 30)
    started = client.post("/api/jobs", {"task": "map", "arguments": {"a": 1}, "label": "x" * 300})
    assert started.json()["id"] == "new"
    task, arguments, label, places = jobs.done[-1]
    assert (task, arguments, len(label), places["rigs"]) == ("map", {"a": 1}, 200, {"own": "own.toml"})
    refused = client.post("/api/jobs", {"task": "mapp"})
    assert (refused.status_code, refused.json()["faults"][0]["key"]) == (422, "task")
    jobs.done.clear()
    assert client.get("/api/jobs/one").json()["request"] == {"task": "map"}
    assert client.post("/api/jobs/one/cancel").json()["id"] == "one"
    assert client.ask("DELETE", "/api/jobs/one").json() == {"deleted": "one"}
    assert client.get("/api/jobs/one/result").json() == {"of": "x"}
    assert jobs.done == ["tend", "cancel one", "tend", "delete one", "tend"]
    file = client.get("/api/jobs/one/files/a.csv")
    assert (file.text, file.headers["content-disposition"]) == ("1", 'attachment; filename="a.csv"')


def test_an_upload_is_kept_within_its_announced_length(bench: Any) -> None:
    kept = bench.client.post("/api/uploads", b"abc").json()["upload"]
    assert (bench.uploads.folder / kept).read_bytes() == b"abc"
    for length in ("11", "many"):
        answer = bench.client.ask("POST", "/api/uploads", b"abc", content_length=length)
        assert answer.status_code == (422 if length == "11" else 200)
    assert names_of(routes).KEPT_DAYS == 30


def guarded(**headers: str) -> Client:
    async def application(scope: Any, receive: Any, send: Any) -> None:
        await send({"type": "http.response.start", "status": 200, "headers": [(b"x", b"y")]})
        await send({"type": "http.response.body", "body": b"inside"})

    return Client(Guard(application, Access(token="t" * 40, port=1, hosts=frozenset({"lab"}))), headers)


def test_the_token_is_asked_for_on_the_first_page_and_refused_in_one_line_elsewhere() -> None:
    bare = guarded()
    page, other = bare.get("/"), bare.get("/api/jobs")
    assert (page.status_code, page.headers["content-type"]) == (401, "text/html; charset=utf-8")
    assert (other.status_code, other.headers["content-type"]) == (401, "text/plain; charset=utf-8")
    assert int(page.headers["content-length"]) == len(page.content)
    assert other.text.startswith("This workbench asks for its link")
    assert guarded(host="lab:80").get("/api/jobs").status_code == 401
    assert guarded(host="lab").get("/api/jobs").status_code == 401
    assert guarded(host="lab:x").get("/").status_code == 421
    assert bare.get("/", params={"token": "t" * 40}).headers["set-cookie"].startswith("sonolube-1=")
    assert bare.get("/", params={"token": "x"}).headers["content-type"].startswith("text/html")
    for name in ("link.css", "icon.svg"):
        assert bare.ask("HEAD", f"/static/{name}").status_code == 200
    assert bare.get("/static/app.css").status_code == 401


def test_a_request_that_changes_something_comes_from_a_page_of_the_same_host() -> None:
    access = Access(token="t" * 40, port=1)
    cookie = f"a=b; {access.cookie}={access.secret}"
    inside = guarded(cookie=cookie)
    assert inside.get("/api/jobs").text == "inside"
    assert inside.ask("HEAD", "/api/jobs", origin="http://evil").status_code == 200
    for headers, status in (
        ({}, 200), ({"origin": "http://localhost"}, 200), ({"origin": "http://evil"}, 403),
        ({"origin": "null"}, 403), ({"origin": "null", "sec_fetch_site": "same-origin"}, 200),
        ({"sec_fetch_site": "none"}, 200), ({"sec_fetch_site": "same-site"}, 403),
    ):  # fmt: skip
        assert inside.post("/api/jobs", {}, **headers).status_code == status, headers
    stated = guarded(x_status="in-header").get("/api/jobs", x_status="in-header")
    assert (stated.status_code, stated.headers["x-status"]) == (200, "401")
