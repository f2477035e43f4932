"""Tiers follow from measured times, and the daily one holds every folder and command that a run collects."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.tiers import COLLECTED, SELECTED, daily_tests, read_times

from sonolube.cli.app import COMMANDS

ROOT = Path(__file__).parents[1]
TESTS = """
import time
import pytest
from hypothesis import given, strategies as st
from tests.tiers import examples

drawn = {"usual": 0, "more": 0, "fewer": 0}

@pytest.fixture(scope="module")
def shared():
    time.sleep(0.6)

def test_first(shared): ...
def test_second(shared): ...

@pytest.mark.parametrize("seconds", [0.0, 0.5])
def test_waits(seconds):
    time.sleep(seconds)

@given(st.integers())
def test_usual(i):
    drawn["usual"] += 1

@examples(300)
@given(st.integers())
def test_more(i):
    drawn["more"] += 1

@examples(7)
@given(st.integers())
def test_fewer(i):
    drawn["fewer"] += 1

def test_drawn(request):
    print("drawn", *drawn.values())
"""


@pytest.fixture
def run(tmp_path: Path) -> Callable[..., str]:
    """Run of the small tests with the tiers of a folder of its own, as a function of its options: what it prints."""
    place = tmp_path / "tests"
    place.mkdir()
    (tmp_path / "test_it.py").write_text(TESTS)
    (tmp_path / "pytest.ini").write_text("[pytest]\n")
    (place / "tiers.py").write_text((ROOT / "tests" / "tiers.py").read_text())
    given = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST")}

    def runs(*options: str) -> str:
        command = [sys.executable, "-m", "pytest", "-s", "-p", "tests.tiers", "-p", "no:cacheprovider", "-rN", *options]
        done = subprocess.run(
            [*command, "test_it.py"], cwd=tmp_path, env=given, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    return runs


def test_a_test_is_daily_by_its_cost_its_function_and_its_file() -> None:
    costs = {
        "a.py::test_quick": 0.2, "a.py::test_slow[1]": 30.0, "a.py::test_slow[2]": 3.0, "a.py::test_slow[3]": 1.0,
        "a.py::test_slower[1]": 9.0, "a.py::test_slower[2]": 5.0, "b.py::test_slowest": 9.5, "b.py::test_whole": 9.9,
        "c.py::test_endless": 11.0, **{f"d.py::test_options[{i}]": 0.25 for i in range(100)},
    }  # fmt: skip
    daily = daily_tests(costs)
    options = {name for name in daily if name.startswith("d.py")}
    assert len(options) == 12  # 12 times 0.25 s are 3 s
    assert daily - options == {"a.py::test_quick", "a.py::test_slow[3]", "b.py::test_slowest"}


def test_times_are_kept_without_those_of_fixtures_and_choose_the_tier(run: Callable[..., str], tmp_path: Path) -> None:
    assert "8 passed" in run("--renew-times")
    kept = json.loads((tmp_path / "tests" / "times.json").read_text())
    assert kept["fixtures"].keys() == {"test_it.py::shared"}
    assert kept["tests"].keys() >= {"test_it.py::test_waits[0.5]"}
    assert "test_it.py::test_first" not in kept["tests"]
    (tmp_path / "tests" / "times.json").write_text(
        json.dumps({"fixtures": {"test_it.py::shared": 9.0}, "tests": {"test_it.py::test_waits[0.5]": 3.0}})
    )
    # the fixture's 9 s are 4.5 s of each of two tests: more than a function's quickest case may take
    assert "5 passed, 3 deselected" in run("--tier", "daily")
    # tests of properties run in both tiers
    assert "6 passed, 2 deselected" in run("--tier", "rest")


def test_a_property_takes_few_examples_daily_and_many_in_the_rest(run: Callable[..., str], tmp_path: Path) -> None:
    assert "drawn 20 20 7" in run("--tier", "daily")
    assert "drawn 20 20 7" in run()
    slow = {"test_it.py::test_drawn": 99.0}
    (tmp_path / "tests" / "times.json").write_text(json.dumps({"fixtures": {}, "tests": slow}))
    assert "drawn 100 300 7" in run("--tier", "rest")


def test_the_times_are_of_tests_that_are_there() -> None:
    gone = {name for name in read_times()["tests"] if not (ROOT / name.partition("::")[0]).exists()}
    assert gone == set()


def test_every_folder_of_tests_has_daily_ones(request: pytest.FixtureRequest) -> None:
    def folders(items: list[pytest.Item]) -> set[Path]:
        return {Path(item.nodeid.partition("::")[0]).parent for item in items}

    assert folders(request.config.stash[COLLECTED]) == folders(request.config.stash[SELECTED])


def test_every_command_is_run_daily(request: pytest.FixtureRequest) -> None:
    def called(items: list[pytest.Item]) -> set[str]:
        """Commands that a parameter of a test names."""
        found = [item.callspec.params.get("name") for item in items if hasattr(item, "callspec")]
        return {str(name) for name in found} & {command.name for command in COMMANDS}

    assert called(request.config.stash[COLLECTED]) == called(request.config.stash[SELECTED])
