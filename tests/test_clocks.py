"""No test depends on the speed of the machine: none reads a clock, and what ends a hung test leaves it a minute."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

TESTS = Path(__file__).parent
CLOCKS = {"monotonic", "monotonic_ns", "perf_counter", "perf_counter_ns", "process_time", "time_ns", "thread_time"}
HUNG = {"cli/terminal.py", "cli/predict/test_new.py"}  # where a clock ends a hung test
STAND_INS = {  # of clocks, which are named alike, and of instruments, which have one
    "cli/console/test_progress.py",
    "laboratory/records/clock.py",
    "laboratory/test_added_drivers.py",
    "laboratory/test_own_clocks.py",
}
TIMED = {"tiers.py"}  # which measures the tests
LEAST = 60.0  # s


def faults(source: str) -> Iterator[str]:
    """Clocks that a source reads, and short times after which it gives up."""
    for node in ast.walk(ast.parse(source)):
        match node:
            case ast.Attribute(attr=name) | ast.Name(id=name) | ast.alias(name=name) if name in CLOCKS:
                yield f"line {node.lineno}: {name}"
            case ast.keyword(arg="timeout", value=ast.Constant(value=int() | float() as limit)) if limit < LEAST:
                yield f"line {node.value.lineno}: timeout={limit}"


@pytest.mark.parametrize(
    ("source", "count"),
    [
        ("import time\nbegun = time.perf_counter()\nassert time.monotonic() - begun < 5", 2),
        ("from time import process_time", 1),
        ("run.wait(timeout=30)\nrun.wait(timeout=60)\nrun.wait(timeout=None)", 1),
    ],
)
def test_a_clock_and_a_short_time_are_found(source: str, count: int) -> None:
    assert len(list(faults(source))) == count


def test_no_test_reads_a_clock_or_gives_up_within_a_minute() -> None:
    sources = {path.relative_to(TESTS).as_posix(): path for path in TESTS.rglob("*.py")}
    assert sources.keys() > HUNG | STAND_INS | TIMED
    found = [
        f"{name}: {fault}"
        for name, path in sources.items()
        if name not in HUNG | STAND_INS | TIMED
        for fault in faults(path.read_text(encoding="utf-8"))
    ]
    assert not found
