"""Start of the workbench in this process: its link, rigs, processes and end, and options that need no parser."""

import socket
import stat
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from pytest import CaptureFixture, MonkeyPatch, raises
from tests.names import names_of

from sonolube.browser import command, server
from sonolube.errors import InvalidInput
from sonolube.example_files import example_file

ENDED: list[str] = []


class Part:
    """Stands in for pool, jobs and uploads."""

    def __init__(self, *given: Any, **named: Any) -> None:
        self.given, self.named, self.folder = given, named, Path("uploads")

    def end(self) -> None:
        ENDED.append(f"{self.given} {self.named}")


@pytest.fixture
def parts(monkeypatch: MonkeyPatch) -> list[Any]:
    """Servers that were made, none of which serves."""
    ENDED.clear()
    made: list[Any] = []

    class Server:
        def __init__(self, config: Any, **named: Any) -> None:
            made.append(SimpleNamespace(config=config, **named))

        def run(self, *, sockets: list[socket.socket]) -> None:
            made[-1].port = sockets[0].getsockname()[1]
            sockets[0].close()

    for name in ("Pool", "Jobs", "Uploads"):
        monkeypatch.setattr(server, name, Part)
    monkeypatch.setattr(server, "_Server", Server)
    monkeypatch.setattr(names_of(server).signal, "signal", lambda number, act: made.append((number, act)))
    return made


def test_the_link_has_port_and_token_and_all_parts_end_with_the_server(
    parts: list[Any], capsys: CaptureFixture[str], monkeypatch: MonkeyPatch
) -> None:
    monkeypatch.setattr(names_of(server).os, "cpu_count", lambda: 8)
    server.run(port=0, token="t" * 40, hosts=("lab.example",), opens_browser=False)
    (number, act), found = parts
    assert (number, act) == (names_of(server).signal.SIGTERM, server._leave)
    assert found.link == f"http://127.0.0.1:{found.port}/?token={'t' * 40}"
    assert (found.opened, found.pool.given) == (None, (4,))
    guard = found.config.app
    assert guard._access.hosts == {"lab.example"}
    assert guard._access.port == found.port
    assert ENDED[0] == "(4,) {}"
    assert ENDED[1].endswith("{'most': 8}")
    assert len(ENDED) == 3
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize(("cores", "workers"), [(1, 2), (3, 3), (16, 4), (None, 2)])
def test_two_to_four_workers_start_by_the_number_of_processors(
    cores: int | None, workers: int, parts: list[Any], monkeypatch: MonkeyPatch
) -> None:
    monkeypatch.setattr(names_of(server).os, "cpu_count", lambda: cores)
    found = server._workbench(None, None, Path("runs"))
    pool, jobs = found.pool, found.jobs
    assert pool.given == (workers,)  # type: ignore[attr-defined]
    assert jobs.named == {"most": cores or 1}  # type: ignore[attr-defined]
    assert found.opened == "tribometer"
    assert found._places.device_map == ""
    assert found._places.runs == str(Path("runs").resolve())


def test_a_rig_that_is_opened_has_the_name_of_its_file(parts: list[Any], tmp_path: Path) -> None:
    found = server._workbench(tmp_path / "own.toml", tmp_path / "map.toml", tmp_path)
    assert (found.opened, found._places.rigs) == ("own", {"own": str((tmp_path / "own.toml").resolve())})
    assert found._places.device_map == str((tmp_path / "map.toml").resolve())


def test_a_random_token_is_long_and_a_run_that_goes_on_is_told(
    parts: list[Any], capsys: CaptureFixture[str], monkeypatch: MonkeyPatch
) -> None:
    monkeypatch.setattr("sonolube.browser.lab.routes.Laboratory.end", lambda self: "http://127.0.0.1:9/?token=x")
    server.run(port=0)
    assert len(parts[1].link.partition("token=")[2]) >= 43
    assert parts[1].opened.name == f"open-{parts[1].port}.html"
    assert not parts[1].opened.exists()  # once the server has ended
    assert capsys.readouterr().out == (
        "A run goes on without the workbench. It can be stopped at http://127.0.0.1:9/?token=x\n"
    )


def test_the_address_of_the_newer_internet_stands_in_brackets(parts: list[Any], monkeypatch: MonkeyPatch) -> None:
    made: list[tuple[str, int]] = []

    def listening(host: str, port: int) -> Any:
        made.append((host, port))
        return SimpleNamespace(getsockname=lambda: (host, 77), close=lambda: None)

    monkeypatch.setattr(server, "_listening", listening)
    server.run(port=5, host="::1", token="t")
    assert parts[1].link == "http://[::1]:77/?token=t"
    assert made == [("::1", 5)]


def test_a_signal_ends_the_program_with_its_number() -> None:
    with raises(SystemExit) as end:
        server._leave(15, None)
    assert end.value.code == 143


def test_a_socket_may_be_taken_again_and_a_taken_port_is_refused() -> None:
    with server._listening("127.0.0.1", 0) as found:
        assert found.getsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR) != 0
        assert found.family == socket.AF_INET
        found.listen()
        with raises(InvalidInput, match=r"^--port \d+: .+; name another, or 0 for any free one$"):
            server._listening("127.0.0.1", found.getsockname()[1])


@pytest.mark.parametrize("port", ["65535", "0"])
def test_ports_up_to_the_last_need_no_parser(port: str) -> None:
    assert server.plain_options(["--port", port]) == {"port": int(port)}
    assert server.plain_options(["--port", "65536"]) is None


@pytest.mark.parametrize(
    ("text", "is_token"),
    [("t" * 32, True), ("t" * 31, False), ("t" * 31 + "ä", False), ("t" * 31 + "\x07", False),
     ("t" * 16 + " " + "t" * 16, False),
     (f"  {'t' * 32}\n", True)],
)  # fmt: skip
def test_a_token_is_one_line_of_32_printable_characters(text: str, is_token: bool, tmp_path: Path) -> None:
    path = tmp_path / "token"
    path.write_text(text, encoding="utf-8")
    path.chmod(0o600)
    if is_token:
        assert server.token_of_file(path) == text.strip()
        path.chmod(0o640)
        with raises(InvalidInput, match="others can read it"):
            server.token_of_file(path)
    else:
        with raises(InvalidInput, match="32 or more printable characters"):
            server.token_of_file(path)
    assert path.stat().st_mode & stat.S_IRWXU


@pytest.fixture
def ran(monkeypatch: MonkeyPatch) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = []
    monkeypatch.setattr(server, "run", lambda **named: found.append(named))
    return found


def test_the_command_hands_its_options_on(ran: list[dict[str, Any]], capsys: CaptureFixture[str]) -> None:
    rig = example_file("tribometer").source
    command.app(rig=rig, port=1, browser=False, allow_host=["a", "b"], runs=Path("r"))
    assert ran == [
        {"rig": rig, "port": 1, "host": "127.0.0.1", "token": "", "hosts": ("a", "b"), "opens_browser": False,
         "device_map": None, "runs": Path("r")}
    ]  # fmt: skip
    for host in ("localhost", "::1"):
        command.app(host=host)
    assert (ran[1]["hosts"], ran[1]["rig"], ran[2]["host"]) == ((), None, "::1")
    assert capsys.readouterr().out == ""


def test_other_computers_need_a_token_and_are_told_of(
    ran: list[dict[str, Any]], tmp_path: Path, capsys: CaptureFixture[str]
) -> None:
    with raises(InvalidInput, match=r"^--host 0\.0\.0\.0: opens the workbench"):
        command.app(host="0.0.0.0")
    path = tmp_path / "token"
    path.write_text("t" * 32)
    path.chmod(0o600)
    command.app(host="0.0.0.0", token_file=path)
    assert (ran[0]["token"], ran[0]["host"]) == ("t" * 32, "0.0.0.0")
    assert "Other computers can reach it at 0.0.0.0" in capsys.readouterr().out


def test_faults_of_a_rig_and_parts_that_devices_lack_are_said_before(
    ran: list[dict[str, Any]], tmp_path: Path, monkeypatch: MonkeyPatch
) -> None:
    (tmp_path / "bad.toml").write_text("title = 3")
    with raises(InvalidInput):
        command.app(rig=tmp_path / "bad.toml")
    monkeypatch.setattr("sonolube.laboratory.drivers.read_device_map", lambda path: path)
    monkeypatch.setattr("sonolube.laboratory.drivers.missing_parts", lambda found: ["needs nidaqmx", "more"])
    with raises(InvalidInput, match=r"^--lab map\.toml: needs nidaqmx$"):
        command.app(lab=Path("map.toml"))
    assert ran == []
    monkeypatch.setattr("sonolube.laboratory.drivers.missing_parts", lambda found: [])
    command.app(lab=Path("map.toml"))
    assert ran[0]["device_map"] == Path("map.toml")
