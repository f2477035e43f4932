"""Answers of commands for the tests of their tasks."""

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest
from pytest import CaptureFixture, MonkeyPatch, raises

from sonolube.cli import main

EXAMPLES = Path(__file__).parents[3] / "examples"


@pytest.fixture(scope="session")
def examples() -> Path:
    """Folder of the examples."""
    return EXAMPLES


@pytest.fixture(scope="session")
def tribometer() -> Path:
    """File of the reference rig."""
    return EXAMPLES / "rigs" / "tribometer.toml"


@pytest.fixture
def on_terminal(
    capfd: CaptureFixture[str], tmp_path: Path, monkeypatch: MonkeyPatch
) -> Callable[..., Mapping[str, Any]]:
    """Program as a function of its arguments, which writes in an empty folder: its JSON object without the files."""

    def run(*arguments: object) -> Mapping[str, Any]:
        monkeypatch.chdir(tmp_path)
        with raises(SystemExit) as end:
            main([*map(str, arguments), "--json"])
        out, err = capfd.readouterr()
        assert not end.value.code, err
        content: dict[str, Any] = json.loads(out)
        return {key: value for key, value in content.items() if key != "files"}

    return run
