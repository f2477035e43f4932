"""The state of an installation: what is there, how to install what is not, and checks that a fault fails."""

import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytest import MonkeyPatch

from sonolube.extras import EXTRAS
from sonolube.report.results import installation as command
from sonolube.report.results.self_checks import SELF_CHECKS

Program = Callable[..., Any]


@pytest.fixture
def quick(monkeypatch: MonkeyPatch) -> None:
    """Leave out the checks but the first, for tests of what stands around them."""
    monkeypatch.setattr(command, "SELF_CHECKS", SELF_CHECKS[:1])


def test_a_sound_installation_passes_every_check_with_exit_code_0(sonolube: Program) -> None:
    run = sonolube("doctor", "--json")
    found = run.answer
    assert (run.code, found["healthy"]) == (0, True)
    assert [each["title"] for each in found["checks"] if not each["passed"]] == []
    assert found["packages"]["numpy"] == np.__version__
    assert Path(found["compiled_code"]["folder"]).is_dir()
    assert found["compiled_code"]["writable"]


@pytest.mark.parametrize(
    ("wrong", "reason"),
    [
        (replace(SELF_CHECKS[0], expected=22001.0), "off by more than 1e-09"),
        (replace(SELF_CHECKS[0], compute=lambda: float("nan")), "off by more than 1e-09"),
        (replace(SELF_CHECKS[0], compute=lambda: [][0]), "IndexError: list index out of range"),
    ],
    ids=["another value", "no number", "an error"],
)
def test_a_check_that_fails_is_shown_with_its_reason_and_exit_code_1(
    wrong: Any, reason: str, sonolube: Program, monkeypatch: MonkeyPatch
) -> None:
    monkeypatch.setattr(command, "SELF_CHECKS", (SELF_CHECKS[0], wrong))
    run = sonolube("doctor")
    assert run.code == 1
    assert f"FAILED: {wrong.outcome()['computed']} instead of" in run.out
    assert reason in run.out
    assert run.out.splitlines()[-1].startswith("1 of 2 checks passed")


@pytest.mark.usefixtures("quick")
def test_a_missing_part_or_program_is_shown_with_how_to_install_it_and_is_no_fault(
    sonolube: Program, monkeypatch: MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "plotly", None)
    monkeypatch.setenv("PATH", "")
    run = sonolube("doctor")
    assert run.code == 0
    assert f"not installed: {EXTRAS['web'].command}" in run.out
    assert "not found: apt-get install calculix-ccx" in run.out


@pytest.mark.usefixtures("quick")
def test_compiled_code_that_cannot_be_kept_is_a_fault_with_its_remedy(
    sonolube: Program, monkeypatch: MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setattr(command, "compiled_code_folder", lambda: tmp_path / "file" / "below")
    monkeypatch.setattr(command, "is_compiled", lambda: False)
    run = sonolube("doctor")
    assert run.code == 1
    assert "not writable: set NUMBA_CACHE_DIR" in run.out
    assert "was cold" in run.out
