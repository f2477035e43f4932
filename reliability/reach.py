"""Map from lines of the package to the tests that reach them: ``python -m reliability.reach [--add] [TESTS ...]``.

The tests run once under coverage, each with its name as context, also in the programs that they start; the map is
kept in out/reliability/reach.sqlite, from which the tests of a mutant are picked, the quickest first. With --add the
tests that run join those of the map, in place of what it had of them.
"""

import os
import shutil
import sqlite3
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import closing, suppress
from pathlib import Path

import coverage
import pytest

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src" / "sonolube"
MAP = ROOT / "out" / "reliability" / "reach.sqlite"
_PARTS = ROOT / "out" / "reliability" / "reach-parts"
_SETTINGS = """\
[run]
data_file = {parts}/coverage
source = {source}
parallel = true
patch = subprocess
sigterm = true
context = ${{SONOLUBE_TEST-}}
disable_warnings = no-data-collected,module-not-imported,couldnt-parse,no-ctracer,trace-changed
"""
_TIME_OF_TESTS = 60.0  # s, of the tests picked for a mutant
_REACHING = "select distinct name, seconds from reach join test on test.id = reach.test where file = ?"

_KEY = pytest.StashKey[coverage.Coverage]()


# -- as a plugin of the tests


def pytest_configure(config: pytest.Config) -> None:
    """Measure the lines of this process, in the worker that runs tests."""
    if hasattr(config, "workerinput") or not config.getoption("numprocesses", None):
        measured = coverage.Coverage(config_file=os.environ["SONOLUBE_REACH"])
        measured.start()
        config.stash[_KEY] = measured


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """Name the test in what is measured here, and in what its programs measure."""
    os.environ["SONOLUBE_TEST"] = item.nodeid
    if measured := item.config.stash.get(_KEY, None):
        measured.switch_context(item.nodeid)
    yield


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Keep the seconds of a test."""
    if report.when == "call" and "PYTEST_XDIST_WORKER" not in os.environ:
        with (_PARTS / "seconds").open("a", encoding="utf-8") as stream:
            stream.write(f"{report.duration:.3f} {report.nodeid}\n")


def pytest_unconfigure(config: pytest.Config) -> None:
    """Write what was measured."""
    if measured := config.stash.get(_KEY, None):
        measured.stop()
        measured.save()


# -- making and reading the map


def make(tests: Sequence[str], *, add: bool = False) -> None:
    """Run tests under coverage and keep which reach which line, beside the other tests of the map where added."""
    shutil.rmtree(_PARTS, ignore_errors=True)
    _PARTS.mkdir(parents=True)
    settings = _PARTS / "settings"
    settings.write_text(_SETTINGS.format(parts=_PARTS, source=SOURCE), encoding="utf-8")
    environment = {**os.environ, "SONOLUBE_REACH": str(settings), "OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "Agg"}
    command = [sys.executable, "-m", "pytest", "-q", "-p", "reliability.reach", "-n", "2", "--dist", "worksteal"]
    subprocess.run([*command, *tests], cwd=ROOT, env=environment, check=False)
    _combine(add=add)


def _combine(*, add: bool) -> None:
    """Write the map from what the processes of the tests have measured."""
    combined = coverage.CoverageData(basename=str(_PARTS / "combined"))
    for part in sorted(_PARTS.glob("coverage.*")):
        data = coverage.CoverageData(basename=str(part))
        with suppress(coverage.exceptions.DataError):  # of a program that a test has killed
            data.read()
            combined.update(data)
    timed = [line.split(" ", 1) for line in (_PARTS / "seconds").read_text("utf-8").splitlines()]
    _write(combined, {name: float(seconds) for seconds, name in timed}, add=add)


def _write(data: coverage.CoverageData, seconds: dict[str, float], *, add: bool = False) -> None:
    if not add:
        MAP.unlink(missing_ok=True)
    with closing(sqlite3.connect(MAP)) as base, base:
        base.execute("create table if not exists test (id integer primary key, name text unique, seconds real)")
        base.execute("create table if not exists reach (file text, line integer, test integer)")
        known = [(i,) for i, name in base.execute("select id, name from test") if name in seconds]
        base.execute("create temporary table former (test integer primary key)")
        base.executemany("insert into former values (?)", known)
        base.execute("delete from reach where test in (select test from former)")
        base.executemany("delete from test where id = ?", known)
        base.executemany("insert into test (name, seconds) values (?, ?)", seconds.items())
        number = {name: i for i, name in base.execute("select id, name from test") if name in seconds}
        for file in data.measured_files():
            below = Path(file).relative_to(SOURCE).as_posix()
            for line, contexts in data.contexts_by_lineno(file).items():
                tests = {number[name] for context in contexts for name in context.split("|") if name in number}
                base.executemany("insert into reach values (?, ?, ?)", [(below, line, test) for test in tests])
        base.execute("create index if not exists place on reach (file, line)")


def reaching(file: str, line: int) -> list[tuple[str, float]]:
    """Tests that reach a line, from 1, of a file below src/sonolube, and their seconds; the quickest first.

    Where a line runs at import, or compiled, no test is seen there: all that reach another line of the file.
    """
    with closing(sqlite3.connect(f"file:{MAP}?mode=ro", uri=True)) as base:
        found = base.execute(f"{_REACHING} and line = ? order by seconds", (file, line)).fetchall()
    return found or reaching_file(file)


def reaching_file(file: str) -> list[tuple[str, float]]:
    """Tests that reach any line of a file below src/sonolube, and their seconds; the quickest first."""
    with closing(sqlite3.connect(f"file:{MAP}?mode=ro", uri=True)) as base:
        return base.execute(f"{_REACHING} order by seconds", (file,)).fetchall()


def with_their_files(tests: Sequence[tuple[str, float]]) -> list[tuple[str, float]]:
    """Tests with their seconds, followed by the others of their files, the quickest first.

    What a fixture of a module or a cached function computes is seen in the first test that asks for it alone, and the
    others of the file, which look at the result too, do not reach its lines.
    """
    files = {name.partition("::")[0] for name, _ in tests}
    known = {name for name, _ in tests}
    with closing(sqlite3.connect(f"file:{MAP}?mode=ro", uri=True)) as base:
        every = base.execute("select name, seconds from test order by seconds").fetchall()
    return [*tests, *(each for each in every if each[0].partition("::")[0] in files and each[0] not in known)]


def picked(tests: Sequence[tuple[str, float]]) -> list[str]:
    """Names of the first tests, of a minute together."""
    names: list[str] = []
    total = 0.0
    for name, seconds in tests:
        total += seconds
        if total > _TIME_OF_TESTS and names:
            break
        names.append(name)
    return names


if __name__ == "__main__":
    make([each for each in sys.argv[1:] if each != "--add"], add="--add" in sys.argv[1:])
