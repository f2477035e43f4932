"""State of an installation in words: each missing part with its remedy, self-checks counted, and a folder for code."""

import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from pytest import MonkeyPatch

from sonolube.extras import EXTRAS
from sonolube.report.blocks import Rows
from sonolube.report.results import installation as results

NAME = next(iter(EXTRAS))


def check(title: str, *, passed: bool = True) -> dict[str, Any]:
    return {"title": title, "passed": passed, "computed": 1.2345678, "expected": 1.5, "reason": "" if passed else "off"}


@pytest.fixture
def whole(tmp_path: Path) -> results.Installation:
    return results.Installation(
        packages={"numpy": "2.0", "scipy": "1.14"},
        extras=dict.fromkeys(EXTRAS, False),
        cache_folder=tmp_path / "cache" / "inner",
        cache_was_warm=True,
        programs={"C compiler": "/usr/bin/cc", "CalculiX": ""},
        drivers={"motor": ("one", "two")},
        checks=(check("first"), check("second")),
    )


def rows_after(blocks: Any, title: str) -> dict[str, str]:
    found = blocks[list(blocks).index(title) + 1]
    assert isinstance(found, Rows)
    return dict(found.rows)


def test_a_whole_installation_is_healthy_and_says_what_each_part_is(whole: results.Installation) -> None:
    assert whole.healthy
    blocks = whole.blocks()
    assert rows_after(blocks, "required packages") == {"numpy": "2.0", "scipy": "1.14"}
    assert rows_after(blocks, "compiled code") == {"folder": f"{whole.cache_folder}, warm"}
    assert rows_after(blocks, "other programs") == {
        "C compiler": "/usr/bin/cc (compiles what control exports)",
        "CalculiX": "not found: apt-get install calculix-ccx (compared with by tests and benchmarks only)",
    }
    assert rows_after(blocks, "drivers of devices") == {"motor": "one, two"}
    assert rows_after(blocks, "self-check") == {"first": "passed, 1.23457", "second": "passed, 1.23457"}
    assert rows_after(blocks, "optional parts")[NAME] == f"not installed: {EXTRAS[NAME].command}"
    assert blocks[-1] == "all 2 checks passed"


def test_what_is_missing_makes_an_installation_ill_and_has_its_remedy(
    whole: results.Installation, monkeypatch: MonkeyPatch
) -> None:
    failed = replace(whole, checks=(check("first"), check("second", passed=False)))
    assert not failed.healthy
    assert failed.blocks()[-1] == "1 of 2 checks passed; mend what is named above, or install anew"
    assert rows_after(failed.blocks(), "self-check")["second"] == "FAILED: 1.2345678 instead of 1.5, off"
    missing = replace(whole, packages={"numpy": "2.0", "scipy": ""})
    assert not missing.healthy
    assert rows_after(missing.blocks(), "required packages")["scipy"] == "missing: pip install scipy"
    monkeypatch.setattr(results, "_is_writable", lambda folder: False)
    assert not whole.healthy
    cold = replace(whole, cache_was_warm=False)
    assert rows_after(cold.blocks(), "compiled code") == {
        "folder": f"{whole.cache_folder}, was cold: the first computation compiled for some 20 s;"
        " not writable: set NUMBA_CACHE_DIR to a folder that is"
    }


def test_a_part_that_is_there_has_the_version_of_its_package(
    whole: results.Installation, monkeypatch: MonkeyPatch
) -> None:
    monkeypatch.setattr(results, "installed_version", lambda package: "9.9" if package == EXTRAS[NAME].package else "")
    there = replace(whole, extras=dict.fromkeys(EXTRAS, True))
    assert rows_after(there.blocks(), "optional parts")[NAME] == f"{EXTRAS[NAME].package} 9.9"


def test_an_installation_in_json_has_null_for_what_is_missing(whole: results.Installation) -> None:
    found = replace(whole, packages={"numpy": "2.0", "scipy": ""}).object()
    assert found["packages"] == {"numpy": "2.0", "scipy": None}
    assert found["programs"] == {"C compiler": "/usr/bin/cc", "CalculiX": None}
    assert found["compiled_code"] == {"folder": str(whole.cache_folder), "writable": True, "warm": True}
    assert found["extras"][NAME] == {
        "installed": False, "command": EXTRAS[NAME].command, "obstacle": EXTRAS[NAME].obstacle or None,
    }  # fmt: skip
    assert found["drivers"] == {"motor": ["one", "two"]}
    assert found["healthy"] is False
    assert [each["title"] for each in found["checks"]] == ["first", "second"]


def test_the_state_is_found_with_every_self_check_made_and_told(monkeypatch: MonkeyPatch, tmp_path: Path) -> None:
    class Check:
        title = "closed form"

        def outcome(self) -> dict[str, Any]:
            return check("closed form")

    monkeypatch.setattr(results, "SELF_CHECKS", (Check(), Check()))
    monkeypatch.setattr(results, "which", lambda name: f"/bin/{name}" if name in ("gcc", "clang") else None)
    monkeypatch.setattr(results, "is_compiled", lambda: True)
    for name in ("known_drivers", "required_packages"):
        monkeypatch.setattr(results, name, lambda *_: {})
    told: list[tuple[str, int, int]] = []
    found = results.installation(lambda *each: told.append(each))
    assert told == [("closed form", 0, 2), ("closed form", 1, 2)]
    assert len(found.checks) == 2
    assert found.programs["C compiler"] == "/bin/gcc"
    assert found.programs["CalculiX"] == ""
    assert found.cache_was_warm


def test_code_can_be_kept_below_the_nearest_folder_that_exists(tmp_path: Path, whole: results.Installation) -> None:
    assert whole.cache_is_writable
    (tmp_path / "file").write_text("")
    assert not replace(whole, cache_folder=tmp_path / "file" / "cache").cache_is_writable


def test_a_folder_without_permission_keeps_nothing(whole: results.Installation, monkeypatch: MonkeyPatch) -> None:
    asked: list[tuple[Path, int]] = []
    monkeypatch.setattr(os, "access", lambda path, mode: asked.append((path, mode)))  # None: not allowed
    assert not whole.cache_is_writable
    assert asked == [(whole.cache_folder.parents[1], os.W_OK)]
