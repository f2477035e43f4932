"""Answer of a command for the tests of its task."""

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest
from pytest import CaptureFixture, raises

from sonolube.cli import main

EXAMPLES = Path(__file__).parents[3] / "examples"


@pytest.fixture(scope="session")
def examples() -> Path:
    """Folder of the examples."""
    return EXAMPLES


@pytest.fixture(scope="session")
def rigs() -> Path:
    """Folder of the example rigs."""
    return EXAMPLES / "rigs"


@pytest.fixture
def on_terminal(capfd: CaptureFixture[str], tmp_path: Path) -> Callable[..., Mapping[str, Any]]:
    """Program as a function of its arguments: its JSON object without the files."""

    def run(*arguments: object) -> Mapping[str, Any]:
        with raises(SystemExit) as end:
            main([*map(str, arguments), "--json", "--out", str(tmp_path / "terminal")])
        out, err = capfd.readouterr()
        assert not end.value.code, err
        content: dict[str, Any] = json.loads(out)
        return {key: value for key, value in content.items() if key != "files"}

    return run
