"""The server of the workbench as a process: uploads, foreign requests, slow clients, killed workers, ends."""

import asyncio
import gzip
import http.client
import json
import re
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import closing, suppress
from importlib.resources import files
from pathlib import Path
from typing import Any

import psutil  # type: ignore[import-untyped]
import pytest
import uvicorn
from tests.browser.workbench import Served, served
from uvicorn.server import ServerState

from sonolube.browser.connections import MAX_WAITING, BoundedProtocol
from sonolube.browser.server import _listening, _page_that_opens, plain_options
from sonolube.cli import main

RIG = {"name": "tribometer"}
LONG = {"drive.voltage_peak_to_peak": "1V:200V:200", "sliding.sliding_speed": "1mm/s:1m/s:2000"}


@pytest.fixture(scope="module")
def many_files() -> Iterator[None]:
    """Let this process, and those that it starts, hold as many files as a thousand connections need."""
    resource = pytest.importorskip("resource")
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (max(before[0], min(4096, before[1])), before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_NOFILE, before)


@pytest.fixture(scope="module")
def workbench(tmp_path_factory: pytest.TempPathFactory, many_files: None) -> Iterator[Served]:
    with served(tmp_path_factory.mktemp("server")) as found:
        yield found


def request(
    workbench: Served, method: str, path: str, body: bytes | None = None, **headers: str
) -> tuple[int, Any, bytes]:
    """Status, headers and body of a reply."""
    with closing(http.client.HTTPConnection("127.0.0.1", workbench.port, timeout=120)) as connection:
        connection.request(method, path, body=body, headers=headers)
        reply = connection.getresponse()
        return reply.status, reply.headers, reply.read()


def cookie(workbench: Served) -> str:
    _, headers, _ = request(workbench, "GET", f"/?token={workbench.token}")
    return str(headers["set-cookie"]).partition(";")[0]


def ask(workbench: Served, method: str, path: str, body: bytes | None = None, **headers: str) -> tuple[int, bytes]:
    status, _, content = request(workbench, method, path, body, **({"cookie": cookie(workbench)} | headers))
    return status, content


def asked(workbench: Served, path: str, content: object) -> tuple[int, Any]:
    status, body = ask(workbench, "POST", path, json.dumps(content).encode())
    return status, json.loads(body)


def test_a_task_is_answered_and_a_fault_is_refused_with_its_key(workbench: Served) -> None:
    status, content = asked(workbench, "/api/tasks/friction", {"rig": RIG})
    assert (status, content["answer"]["rig"][:8]) == (200, "Modified")
    changes = {"contact.normal_load": "3 kg"}
    status, content = asked(workbench, "/api/tasks/friction", {"rig": RIG | {"changes": changes}})
    assert (status, content["faults"][0]["key"]) == (422, "contact.normal_load")


@pytest.mark.parametrize("body", [b"", b"[]", b"{", b'{"rig": NaN}', b"[" * 100_000, b"\xff\xfe"])
def test_what_is_no_object_of_json_is_refused(workbench: Served, body: bytes) -> None:
    status, reply = ask(workbench, "POST", "/api/tasks/friction", body)
    assert status == 422
    assert "\n" not in json.loads(reply)["text"]


def test_a_large_request_and_a_large_upload_are_refused(workbench: Served) -> None:
    status, reply = ask(workbench, "POST", "/api/tasks/friction", b" " * (5 * 2**20))
    assert (status, "larger than 4 MiB" in json.loads(reply)["text"]) == (422, True)
    with closing(http.client.HTTPConnection("127.0.0.1", workbench.port, timeout=60)) as connection:
        connection.putrequest("POST", "/api/uploads")
        connection.putheader("cookie", cookie(workbench))
        connection.putheader("content-length", str(2**30))
        connection.endheaders()
        refused = connection.getresponse()
        assert refused.status == 422
        assert "1024 MiB are more than the 256 MiB" in json.loads(refused.read())["text"]


def test_an_uploaded_file_is_used_by_its_name_here(workbench: Served) -> None:
    table = (Path(__file__).parents[2] / "examples" / "tribometer-runs.csv").read_bytes()
    status, reply = ask(workbench, "POST", "/api/uploads?name=../../x", table)
    assert status == 200
    runs = {"name": "own.csv", "upload": json.loads(reply)["upload"]}
    status, content = asked(workbench, "/api/tasks/predict", {"rig": RIG, "runs": runs, "draws": 400})
    assert (status, content["answer"]["runs"]) == (200, 4)


OUTSIDE = (
    "/../pyproject.toml",
    "/static/../routes.py",
    "/static/%2e%2e/routes.py",
    "/etc/passwd",
    "/static//etc/passwd",
)


@pytest.mark.parametrize("path", OUTSIDE)
def test_no_file_outside_the_pages_is_served(workbench: Served, path: str) -> None:
    assert ask(workbench, "GET", path)[0] == 404


STATIC = files("sonolube.browser") / "static"


@pytest.mark.parametrize(("name", "kind"), [("app.css", "text/css"), ("scripts/main.js", "text/javascript")])
def test_a_file_of_the_pages_is_sent_compressed_and_not_again(workbench: Served, name: str, kind: str) -> None:
    known = cookie(workbench)
    packed: dict[str, Any] = {"accept-encoding": "gzip"}
    status, headers, body = request(workbench, "GET", f"/static/{name}", cookie=known, **packed)
    assert (status, headers["content-encoding"], headers["content-type"].split(";")[0]) == (200, "gzip", kind)
    assert gzip.decompress(body) == STATIC.joinpath(name).read_bytes()
    status, plain, content = request(workbench, "GET", f"/static/{name}", cookie=known)
    assert (status, plain["content-encoding"], content) == (200, None, STATIC.joinpath(name).read_bytes())
    again: dict[str, Any] = {"if-none-match": headers["etag"]}
    assert request(workbench, "GET", f"/static/{name}", cookie=known, **again)[0::2] == (304, b"")
    older: dict[str, Any] = {"if-none-match": '"0123456789abcdef"'}
    assert request(workbench, "GET", f"/static/{name}", cookie=known, **older)[0::2] == (200, content)


def test_answers_are_sent_without_waiting_for_an_acknowledgement() -> None:
    set_by_asyncio: list[int] = []

    async def served_once(listening: socket.socket) -> None:
        def accepted(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            own = writer.get_extra_info("socket")
            set_by_asyncio.append(own.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY))
            writer.close()

        async with await asyncio.start_server(accepted, sock=listening):
            reader, writer = await asyncio.open_connection(*listening.getsockname())
            await reader.read()
            writer.close()

    asyncio.run(served_once(_listening("127.0.0.1", 0)))
    assert set_by_asyncio == [1]


def test_a_foreign_host_and_no_cookie_are_refused_by_the_server_itself(workbench: Served) -> None:
    assert ask(workbench, "GET", "/api/jobs", host="evil.example")[0] == 421
    assert request(workbench, "GET", "/api/jobs")[0] == 401


SLOW = (
    b"",  # says nothing
    b"POST /api/tasks/friction HT",  # stops within the first line
    b"POST /api/tasks/friction HTTP/1.1\r\nHost: 127.0.0.1\r\nX: " + b"x" * 8000,  # within a header
    b"POST /api/tasks/friction HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 100\r\n\r\n{",  # within the body
)
CONNECTIONS, MAX_MEMORY = 1200, 16 * 2**20  # bytes by which the parent may grow


def test_twelve_hundred_slow_connections_leave_others_answered_with_bounded_files_and_memory(workbench: Served) -> None:
    parent = psutil.Process(workbench.process.pid)
    assert asked(workbench, "/api/tasks/contact", {"rig": RIG})[0] == 200
    before = parent.memory_info().rss
    slow: list[socket.socket] = []
    try:
        for place in range(CONNECTIONS):
            slow.append(socket.create_connection(("127.0.0.1", workbench.port)))
            with suppress(ConnectionError):
                slow[-1].sendall(SLOW[place % len(SLOW)])
        assert asked(workbench, "/api/tasks/contact", {"rig": RIG})[0] == 200
        assert len(parent.net_connections()) <= MAX_WAITING + 10  # with some of this test and of its workers
        assert parent.memory_info().rss - before < MAX_MEMORY
    finally:
        for each in slow:
            each.close()
    assert asked(workbench, "/api/tasks/contact", {"rig": RIG})[0] == 200


class Ended(asyncio.Transport):
    """Transport without a network that notes whether it was aborted."""

    def __init__(self) -> None:
        super().__init__({"peername": ("127.0.0.1", 1), "sockname": ("127.0.0.1", 2)})
        self.is_ended = False

    def abort(self) -> None:
        self.is_ended = True

    def is_closing(self) -> bool:
        return self.is_ended


@pytest.mark.parametrize(
    ("sent", "is_ended"),
    [(b"", True), (b"GET / HT", True), (b"POST / HTTP/1.1\r\nHost: a\r\nContent-Length: 9\r\n\r\n{", True)],
)
def test_a_request_that_does_not_become_whole_ends_its_connection(
    sent: bytes, is_ended: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("_TIME_OF_A_HEAD", "_TIME_OF_A_BODY"):
        monkeypatch.setattr(f"sonolube.browser.connections.{name}", 0.0)

    async def application(scope: Any, receive: Any, send: Any) -> None:
        await receive()

    async def connected() -> bool:
        transport = Ended()
        found = BoundedProtocol(uvicorn.Config(application, lifespan="off"), ServerState(), {})
        found.connection_made(transport)
        if sent:
            found.data_received(sent)
        await asyncio.sleep(0.05)
        return transport.is_ended

    assert asyncio.run(connected()) is is_ended


def test_a_long_study_ends_when_its_page_waits_no_more(workbench: Served) -> None:
    body = json.dumps({"rig": RIG, "over": LONG}).encode()
    workers = workers_of(workbench)
    with closing(socket.create_connection(("127.0.0.1", workbench.port))) as connection:
        head = f"POST /api/tasks/sweep HTTP/1.1\r\nHost: 127.0.0.1\r\nCookie: {cookie(workbench)}\r\n"
        connection.sendall(f"{head}Content-Length: {len(body)}\r\n\r\n".encode() + body)
        until(lambda: any(worker.cpu_percent(0.2) > 20 for worker in workers))
    until(lambda: not set(workers) <= set(workers_of(workbench)))
    for _ in workers:
        assert asked(workbench, "/api/tasks/contact", {"rig": RIG})[0] == 200


def workers_of(workbench: Served) -> list[psutil.Process]:
    """Processes that answer its requests, those that have ended left out."""
    found = []
    for child in psutil.Process(workbench.process.pid).children():
        with suppress(psutil.NoSuchProcess):  # or one that was not yet waited for
            if "spawn_main" in " ".join(child.cmdline()):
                found.append(child)
    return found


def until(is_so: Callable[[], bool]) -> None:
    """Wait for a state; the limit is for what never comes, on a slow machine too."""
    for _ in range(2400):
        if is_so():
            return
        time.sleep(0.05)
    raise AssertionError("the state did not come")


def test_a_killed_worker_is_one_sentence_and_is_replaced(workbench: Served) -> None:
    workers = workers_of(workbench)
    assert workers
    for worker in workers:
        worker.kill()
    replies = [asked(workbench, "/api/tasks/contact", {"rig": RIG}) for _ in range(len(workers) + 1)]
    assert replies[-1][0] == 200
    assert all(status in (200, 503) for status, _ in replies)


def test_a_server_that_is_terminated_ends_its_jobs(tmp_path: Path) -> None:
    with served(tmp_path) as workbench:
        status, _ = asked(workbench, "/api/jobs", {"task": "sweep", "arguments": {"rig": RIG, "over": LONG}})
        assert status == 200
        children = psutil.Process(workbench.process.pid).children()
    _, left = psutil.wait_procs(children, timeout=60)
    assert left == []


def test_a_restart_with_the_same_folder_finds_the_jobs(tmp_path: Path) -> None:
    with served(tmp_path) as first:
        status, job = asked(first, "/api/jobs", {"task": "contact", "arguments": {"rig": RIG}, "label": "contact"})
        assert status == 200
    with served(tmp_path) as second:
        jobs = json.loads(ask(second, "GET", "/api/jobs")[1])["jobs"]
    assert [(each["id"], each["label"]) for each in jobs] == [(job["id"], "contact")]
    assert jobs[0]["state"] in ("done", "interrupted")


def test_other_computers_need_a_token_file_that_only_its_owner_reads(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "token"
    path.write_text("short", encoding="utf-8")
    path.chmod(0o644)
    for arguments, words in (
        (("--host", "0.0.0.0"), "opens the workbench"),
        (("--token-file", str(path)), "others can read it"),
        (("--token-file", str(tmp_path / "none")), "No such file"),
        (("--port", "1", "--token-file", str(path)), "others can read it"),
    ):
        with pytest.raises(SystemExit) as end:
            main(["app", *arguments])
        assert end.value.code == 2
        (line,) = capsys.readouterr().err.splitlines()
        assert words in line
    path.chmod(0o600)
    with pytest.raises(SystemExit):
        main(["app", "--token-file", str(path)])
    assert "32 or more printable characters" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "options"),
    [
        ([], {}),
        (["--port", "0", "--no-browser"], {"port": 0, "opens_browser": False}),
        (["--no-browser", "--port=9000"], {"port": 9000, "opens_browser": False}),
    ],
)
def test_few_options_need_no_parser(words: list[str], options: dict[str, Any]) -> None:
    assert plain_options(words) == options


@pytest.mark.parametrize(
    "words",
    [["rig.toml"], ["--help"], ["--port"], ["--port", "70000"], ["--port", "x"], ["--host", "::1"], ["--port=1=2"]],
)
def test_all_else_is_left_to_the_parser(words: list[str]) -> None:
    assert plain_options(words) is None


def test_the_parser_of_the_terminal_is_not_imported_for_few_options() -> None:
    code = (
        "import sys, sonolube.cli, sonolube.browser.server as server\n"
        "server.run = lambda port: print(port, 'typer' in sys.modules, 'pydantic' in sys.modules)\n"
        "sys.argv = ['sonolube', 'app', '--port', '0']\n"
        "sonolube.cli.main()"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (0, "0 False False\n")


def test_a_taken_port_is_refused_in_one_line_with_few_options_too() -> None:
    with closing(socket.create_server(("127.0.0.1", 0))) as taken:
        words = ["app", "--no-browser", "--port", str(taken.getsockname()[1])]
        done = subprocess.run([sys.executable, "-m", "sonolube", *words], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert re.fullmatch(r"sonolube app: --port \d+: .*; name another, or 0 for any free one\n", done.stderr)


def test_the_browser_is_opened_by_a_file_that_others_cannot_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    page = _page_that_opens("http://127.0.0.1:8765/?key=abc", 8765)
    assert "url=http://127.0.0.1:8765/?key=abc" in page.read_text(encoding="utf-8")
    if sys.platform != "win32":
        assert page.stat().st_mode & 0o777 == 0o600
    assert "abc" not in page.as_uri()
