"""Mapping of columns: by questions under a pseudo-terminal, by options, refused without either; then used by tasks."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from tests.cli.terminal import rest
from tests.same import same

import sonolube as sl
from sonolube.cli import main
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.tasks.files import NamedBytes

RUNS = "Kraft MW;Reibkraft ohne Ultraschall [N];w [mm/s];Schmierstoff\n0,5;1,0;20;PAO\n0,8;1,0;40;PAO\n"
KNOWN = {"Kraft MW": "friction_force N", "w [mm/s]": "sliding_speed mm/s", "Schmierstoff": "-"}


@pytest.fixture
def runs(tmp_path: Path) -> Path:
    """Table with a column of known heading, two of unknown and one that must not be left out unasked."""
    path = tmp_path / "runs.csv"
    path.write_text(RUNS)
    return path


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no pseudo-terminals")
def test_questions_write_the_mapping_that_tasks_read(runs: Path) -> None:
    import pty

    terminal, follower = pty.openpty()
    os.write(terminal, b"friction_force mm\nfriction_force N\nsliding_speed mm/s\n\n")
    command = [sys.executable, "-m", "sonolube", "mapping", str(runs), "--out", str(runs.parent)]
    done = subprocess.run(command, stdin=follower, stdout=follower, stderr=follower, check=False)
    os.close(follower)
    screen = rest(terminal).decode()
    assert done.returncode == 0, screen
    assert "Column 'Kraft MW' (0,5; 0,8): quantity and unit" in screen
    assert "'friction_force mm' has no unit of friction_force; expected a force" in screen
    read = sl.read_runs(runs, mapping=runs.parent / "runs-mapping.toml")
    assert read["friction_force"].to_numpy().tolist() == [0.5, 0.8]
    assert read["sliding_speed"].to_numpy() == pytest.approx([0.02, 0.04])


def test_without_a_terminal_the_column_and_what_to_write_are_named(
    runs: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["mapping", str(runs), "--out", str(runs.parent / "out")])
    assert ended.value.code == 2
    line = capsys.readouterr().err
    assert "line 1: column 'Kraft MW' needs a quantity and its unit; state it by --column, such as 'Kraft MW=" in line
    assert line.count("\n") == 1
    assert not (runs.parent / "out").exists()


def test_stated_columns_are_those_of_the_mapping(runs: Path, capsys: pytest.CaptureFixture[str]) -> None:
    stated = [word for label, text in KNOWN.items() for word in ("--column", f"{label}={text}")]
    with pytest.raises(SystemExit):
        main(["mapping", str(runs), "--out", str(runs.parent), "--json", *stated])
    columns = json.loads(capsys.readouterr().out)["columns"]
    assert columns["Kraft MW"] == {"quantity": "friction_force", "unit": "N"}
    assert columns["Schmierstoff"] is None
    assert sl.mapping(runs, column=KNOWN).object()["columns"] == columns


def test_bytes_and_their_mapping_answer_as_files_do(runs: Path) -> None:
    text = sl.mapping(runs, column=KNOWN).files()["runs-mapping.toml"]
    assert isinstance(text, str)
    mapping = NamedBytes("lab.toml", text.encode())
    by_bytes = sl.fit(NamedBytes("runs.csv", runs.read_bytes()), mapping=mapping, model=["kinematic-fitted"])
    (runs.parent / "lab.toml").write_text(text)
    by_files = sl.fit(runs, mapping=runs.parent / "lab.toml", model=["kinematic-fitted"])
    same(by_bytes.object(), by_files.object())
    assert by_bytes.every_caveat() == by_files.every_caveat()
    assert "1 column is left out: 'Schmierstoff'" in by_files.caveats()


@pytest.mark.parametrize(
    ("column", "message"),
    [
        ({"Kraft": "friction_force N"}, "has no column 'Kraft'; did you mean Kraft MW"),
        ({"Kraft MW": "friktion N"}, "column 'Kraft MW': .* is no quantity; did you mean"),
        (KNOWN | {"w [mm/s]": "friction_force N"}, "are both friction_force; leave one out by column"),
    ],
)
def test_statements_that_do_not_fit_are_refused(runs: Path, column: dict[str, str], message: str) -> None:
    with pytest.raises(SonolubeError, match=message):
        sl.mapping(runs, column=column)


def test_a_mapping_without_a_table_is_refused() -> None:
    rig = Path(__file__).parents[3] / "examples" / "rigs" / "tribometer.toml"
    with pytest.raises(InvalidInput, match="mapping has no meaning without a table of runs"):
        sl.predict(rig, mapping="umt")
