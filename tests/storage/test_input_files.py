"""Files of users: pipes are read once and up to a bound, and what is no file is refused, through every reader."""

import os
import select
import socket
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from sonolube.cli import main
from sonolube.errors import InvalidInput
from sonolube.measurement.contact_stiffness.resonance_spectrum import read_resonance_spectrum
from sonolube.measurement.impedance.spectrum import read_impedance
from sonolube.measurement.measured_runs import read_runs
from sonolube.measurement.recordings.reader import read_recording
from sonolube.measurement.surface_files.reader import read_surface_file
from sonolube.rig import read_rig
from sonolube.storage.user_files import input_bytes, input_text, open_input, require_file

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no pipes among its paths")

EXAMPLES = Path(__file__).parents[2] / "examples"
RIG = EXAMPLES / "rigs" / "tribometer.toml"
RUNS = EXAMPLES / "tribometer-runs.csv"
READERS: dict[str, Callable[[Path], object]] = {
    "rig": read_rig,
    "recording": read_recording,
    "runs": read_runs,
    "impedance": read_impedance,
    "spectrum": read_resonance_spectrum,
    "surface": read_surface_file,
}


@contextmanager
def pipe_with(content: bytes) -> Iterator[Path]:
    """Path of a pipe that gives some bytes, few enough for its buffer, and ends."""
    reading, writing = os.pipe()
    try:
        os.write(writing, content)
        os.close(writing)
        yield Path(f"/dev/fd/{reading}")
    finally:
        os.close(reading)


def test_a_pipe_is_read_once_and_gives_the_same_bytes_again() -> None:
    with pipe_with(b"a,b\n1,2\n") as path:
        assert input_bytes(path) == b"a,b\n1,2\n"
        assert input_text(path) == "a,b\n1,2\n"
        with open_input(path) as stream:
            assert stream.read(3) == b"a,b"


def test_a_pipe_beyond_its_bound_is_refused() -> None:
    with pipe_with(bytes(1001)) as path, pytest.raises(OSError, match="gives more than 1,000 bytes; save it to a file"):
        input_bytes(path, most=1000)


def test_a_pipe_that_gives_nothing_is_waited_for_aloud_and_given_up(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    os.mkfifo(tmp_path / "silent")
    waited: list[float] = []

    def nothing(*arguments: Any) -> tuple[list[int], ...]:
        waited.append(arguments[-1])
        return [], [], []

    monkeypatch.setattr(select, "select", nothing)
    with pytest.raises(OSError, match="gave nothing for 60 s"):
        input_bytes(tmp_path / "silent")
    assert sum(waited) == 60
    assert capsys.readouterr().err == f"waiting for data from {tmp_path / 'silent'}\n"


@pytest.mark.parametrize("reader", READERS)
@pytest.mark.parametrize("kind", ["device", "folder", "socket"])
def test_what_is_no_file_is_refused_in_one_line_by_every_reader(reader: str, kind: str, tmp_path: Path) -> None:
    place = {"device": Path("/dev/zero"), "folder": tmp_path, "socket": tmp_path / "socket"}[kind]
    with socket.socket(socket.AF_UNIX) as opened, pytest.MonkeyPatch.context() as patched:
        patched.chdir(tmp_path)  # names of sockets are short
        opened.bind("socket")
        with pytest.raises(InvalidInput, match=rf"is a {kind}, not a file") as refused:
            READERS[reader](place)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    "call",
    ["predict /dev/zero", "fit /dev/zero --rig RIG", "measure friction /dev/zero", "measure impedance /dev/zero",
     "measure surface /dev/zero", "identify decay-length /dev/zero --free-frequency 40Hz"],
)  # fmt: skip
def test_a_device_ends_a_command_at_once(call: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main([word.replace("RIG", str(RIG)) for word in call.split()])
    assert ended.value.code == 2
    assert "is a device, not a file" in capsys.readouterr().err


def test_rigs_and_runs_come_through_pipes() -> None:
    with pipe_with(RIG.read_bytes()) as path:
        assert read_rig(path).normal_load == read_rig(RIG).normal_load
    with pipe_with(RUNS.read_bytes()) as path:
        assert read_runs(path).sizes == read_runs(RUNS).sizes


def test_a_recording_of_text_comes_through_a_pipe_and_a_binary_one_is_refused() -> None:
    text = b"time [s],friction force [N]\n" + b"".join(b"%.2f,1.0\n" % (0.01 * k) for k in range(100))
    with pipe_with(text) as path:
        assert read_recording(path).sizes["time"] == 100
    with pipe_with(b"\x89HDF\r\n\x1a\n" + bytes(100)) as path, pytest.raises(InvalidInput, match="save it to a file"):
        read_recording(path)


def test_a_regular_file_is_required_where_a_reader_goes_back(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"1")
    require_file(tmp_path / "file")
    with pipe_with(b"1") as path, pytest.raises(OSError, match="is a pipe, which this format cannot be read from"):
        require_file(path)
