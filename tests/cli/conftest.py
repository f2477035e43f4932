"""Run of the program in this process, for the tests of commands."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from pytest import CaptureFixture, raises

from sonolube.cli import main

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
def sonolube(capfd: CaptureFixture[str]) -> Program:
    """Program as a function of its arguments; what C libraries print is captured too."""

    def run(*arguments: object) -> Run:
        with raises(SystemExit) as end:
            main([str(argument) for argument in arguments])
        out, err = capfd.readouterr()
        return Run(code=int(end.value.code or 0), out=out, err=err)

    return run


@pytest.fixture(scope="session")
def rigs() -> Path:
    """Folder of the example rigs."""
    return ROOT / "examples" / "rigs"
