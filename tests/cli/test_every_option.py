"""Every option of every command changes the answer, or is refused where it would not be used."""

import contextlib
import hashlib
import io
import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import typer
import xarray as xr
from matplotlib import pyplot as plt
from tests.cli.option_uses import EXECUTION, MODES, PLACES, TESTED_ELSEWHERE, write_inputs
from tests.same import same

from sonolube.cli import main
from sonolube.cli.app import COMMANDS
from sonolube.report import Drawing

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("compiled_kernels")]

_TIME_OF_RUN = re.compile(r"\d{8}T\d{6}Z")  # in the name of its folder
CASES = [
    pytest.param(name, option, id=f"{name}{option}")
    for name, mode in MODES.items()
    for option in (*mode.values, *mode.flags)
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the files that commands read and write here."""
    place = tmp_path_factory.mktemp("inputs")
    write_inputs(place)
    return place


def drawn(drawing: Drawing, *, forms: Sequence[str]) -> dict[str, bytes]:
    """Empty files of a figure whose parts are drawn, but not rendered; without the option it is rendered."""
    plt.close(drawing.figure())
    return dict.fromkeys(forms, b"")


@dataclass(frozen=True)
class Outcome:
    """What a command answered: its code and refusal, its numbers, and the names and tables among its files."""

    code: int
    line: str
    content: dict[str, Any]
    files: tuple[str, ...]


@cache
def outcome(command: str, arguments: tuple[str, ...], folder: Path, place: str) -> Outcome:
    """Outcome of a command, run once."""
    out = folder / place
    words = [word.replace("FOLDER", str(folder)).replace("OUT", str(out)) for word in (*command.split(), *arguments)]
    if "--out" in options_of(command):
        words += ["--out", str(out / "rig.toml" if command == "identify rig" else out)]
    answer, errors = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(answer), contextlib.redirect_stderr(errors), pytest.raises(SystemExit) as end:
        main([*words, "--json"])
    code = int(end.value.code or 0)
    assert "Traceback" not in errors.getvalue()
    if code not in (0, 1):
        assert errors.getvalue().count("\n") == 1, errors.getvalue()
        return Outcome(code, errors.getvalue(), {}, ())
    content = json.loads(_TIME_OF_RUN.sub("TIME", answer.getvalue().replace(str(out), "OUT")))
    for key in ("settings", "files", "version"):
        content.pop(key, None)
    written = sorted(path for path in out.rglob("*") if path.is_file()) if out.exists() else []
    names = tuple(f"{_TIME_OF_RUN.sub('TIME', path.name)} {_numbers(path)}" for path in written)
    return Outcome(0, errors.getvalue(), content, names)


def _numbers(path: Path) -> str:
    """Digest of the numbers in a table or dataset; empty for pages, figures and texts."""
    if path.suffix == ".csv":
        return hashlib.sha256(path.read_bytes()).hexdigest()
    if path.suffix != ".nc":
        return ""
    with xr.open_dataset(path) as data:
        return hashlib.sha256(b"".join(data[name].values.tobytes() for name in sorted(map(str, data)))).hexdigest()


@cache
def options_of(name: str) -> frozenset[str]:
    """Options of a command as typed; of a pair such as --track/--no-track the one that is not the default."""
    app = typer.Typer()
    app.command()(next(command for command in COMMANDS if command.name == name).function)
    parameters: list[Any] = typer.main.get_command(app).params
    return frozenset(
        (each.secondary_opts or each.opts)[0] for each in parameters if each.param_type_name == "option"
    ) - {"--install-completion", "--show-completion"}


def test_the_table_has_every_option_of_every_command() -> None:
    for command in COMMANDS:
        modes = [mode for mode in MODES.values() if mode.command == command.name]
        tried = {option for mode in modes for option in (*mode.values, *mode.flags)}
        elsewhere = {option for name, option in TESTED_ELSEWHERE if name == command.name}
        assert options_of(command.name) - PLACES == tried | elsewhere, command.name


@pytest.mark.parametrize(("name", "given"), CASES)
def test_an_option_changes_the_answer_or_is_refused_by_name(
    name: str, given: str, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mode = MODES[name]
    base = tuple(mode.base)
    value = mode.values.get(given)
    if isinstance(value, tuple):
        changed = tuple(value[1] if word == value[0] else word for word in base)
    else:
        changed = (*base, given) if value is None else (*base, given, value)
    with monkeypatch.context() as patch:
        patch.setattr("sonolube.report.page.drawn", drawn)
        after = outcome(mode.command, changed, folder, f"{name}{given}".replace(" ", ""))
    if after.code:
        assert after.code == 2, after.line
        assert given.removeprefix("--").replace("-", "_") in after.line.replace("-", "_"), after.line
        return
    before = outcome(mode.command, base, folder, name.replace(" ", ""))
    assert before.code == 0, before.line
    differs = before.content != after.content or before.files != after.files
    if given in EXECUTION:
        same(after.content, before.content)
    else:
        assert differs, f"{given} changes nothing"
