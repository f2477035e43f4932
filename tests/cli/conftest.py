"""Run of the program in this process, for the tests of commands."""

import json
import pickle
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import wraps
from hashlib import sha256
from pathlib import Path
from typing import Any

import pytest
from pytest import CaptureFixture, MonkeyPatch, raises

from sonolube.cli import main
from sonolube.cli.console import delivery, options as progress
from sonolube.cli.console.options import OutputFolder
from sonolube.execution.compilation import Kernel
from sonolube.models.fem import electromechanical_model, tuning
from sonolube.models.fem.results import part_modes as mode_files
from sonolube.models.fem.solver import modes as convergence
from sonolube.models.fem.solver.model import Model
from sonolube.storage.user_files import expect_target

ROOT = Path(__file__).parents[2]


@dataclass(frozen=True)
class Run:
    """Exit code and output of a command."""

    code: int
    out: str
    err: str

    @property
    def answer(self) -> dict[str, Any]:
        """JSON object on standard output of a command that succeeded, possibly with some files refused."""
        assert self.code in (0, 1), self.err
        content: dict[str, Any] = json.loads(self.out)
        return content

    @property
    def refusal(self) -> str:
        """The one line of a command that refused its input."""
        assert (self.code, self.out) == (2, ""), self.err
        assert self.err.count("\n") == 1, self.err
        return self.err


Program = Callable[..., Run]


@pytest.fixture
def compiled_kernels(monkeypatch: MonkeyPatch) -> None:
    """Few points are computed as many are: the same statements, faster once they are compiled."""
    monkeypatch.setattr(Kernel, "_runs_plain", lambda *_: False)


@pytest.fixture
def sonolube(capfd: CaptureFixture[str]) -> Program:
    """Program as a function of its arguments; what C libraries print is captured too."""

    def run(*arguments: object) -> Run:
        with raises(SystemExit) as end:
            main([str(argument) for argument in arguments])
        out, err = capfd.readouterr()
        return Run(code=int(end.value.code or 0), out=out, err=err)

    return run


def _solved_once(solve: Callable[..., Any]) -> Callable[..., Any]:
    """Solver of finite-element models that solves equal ones, of equal options, once."""
    known: dict[bytes, Any] = {}

    @wraps(solve)
    def solution(model: Model, **options: Any) -> Any:
        as_meshed = replace(model, mesh=replace(model.mesh, curved_nodes=None))
        key = sha256(pickle.dumps((as_meshed, options))).digest()
        if key not in known:
            known[key] = solve(model, **options)
        return known[key]

    return solution


@pytest.fixture(autouse=True, scope="session")
def equal_models_are_solved_once() -> Iterator[None]:
    """Solve equal finite-element models once for all commands: many differ only in what is made of the modes."""
    solvers = (
        (convergence, "natural_modes"),
        (tuning, "natural_modes"),
        (electromechanical_model, "krylov_reduction"),
        (mode_files, "reduce_model"),
    )
    with pytest.MonkeyPatch.context() as patch:
        for module, name in solvers:
            patch.setattr(module, name, _solved_once(getattr(module, name)))
        yield


@pytest.fixture(autouse=True)
def no_progress_on_a_slow_machine(monkeypatch: MonkeyPatch) -> None:
    """Tell no progress of work that takes less than an hour, so that what is on standard error is a refusal."""
    monkeypatch.setattr(progress, "SHORT", 3600.0)


@pytest.fixture(autouse=True)
def only_foreseen_files(monkeypatch: MonkeyPatch) -> None:
    """Hold every command to the names of files that its option declares, which are checked before it computes."""
    foreseen: list[tuple[Path, str]] = []
    expect_names = OutputFolder.expect

    def names(mark: OutputFolder, path: Path, stems: Mapping[str, str]) -> None:
        foreseen.extend((path, name.format_map(stems)) for name in mark.names.split())
        expect_names(mark, path, stems)

    def one(path: Path) -> Path:
        inside = [(folder, name) for folder, name in foreseen if folder in path.parents]
        assert not inside or any(path.relative_to(folder).match(name) for folder, name in inside), path
        return expect_target(path)

    monkeypatch.setattr(OutputFolder, "expect", names)
    monkeypatch.setattr(delivery, "expect_target", one)


@pytest.fixture(scope="session")
def rigs() -> Path:
    """Folder of the example rigs."""
    return ROOT / "examples" / "rigs"
