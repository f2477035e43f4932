"""Tiers of the tests, by their measured times: ``--tier daily`` for `make test`, ``--tier rest`` for all others.

A test that costs little is daily, as far as the cases of a function together do; so is the quickest case of each
function and of each file that takes no more than some seconds. A time is that of the test and its share of the
fixtures that a file, or a run, makes once. Times are kept in times.json, which ``make times`` renews; a test that is
not listed there is quick. Tests of properties run in both tiers: with few examples daily, with many in the rest.
"""

import json
import time
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, settings

TIMES = Path(__file__).with_name("times.json")
MAX = 0.3  # s, of a daily test
MAX_OF_A_FUNCTION = 3.0  # s, of the daily cases of a function together
MAX_OF_THE_QUICKEST = 1.0  # s, of the quickest case of a function, which is daily even beyond MAX
MAX_OF_A_FILE = 10.0  # s, of the quickest test of a file that has no other daily one
_LISTED = 0.1  # s, below which a test or a fixture is not listed
_SHARED = ("class", "module", "package", "session")  # scopes of fixtures

SELECTED = pytest.StashKey[list[pytest.Item]]()
COLLECTED = pytest.StashKey[list[pytest.Item]]()
_MEASURED = pytest.StashKey["Measured"]()

for _name, _examples in (("daily", 20), ("wide", 100)):
    settings.register_profile(
        _name, deadline=None, suppress_health_check=[HealthCheck.too_slow], max_examples=_examples
    )


def examples(number: int, **other: Any) -> settings:
    """Settings of a test of a property that needs another number of examples than most; daily at most 20."""
    daily = settings.get_profile("daily").max_examples
    wide = settings.get_current_profile_name() == "wide"
    return settings(max_examples=number if wide else min(number, daily), **other)


# -- selection


def pytest_addoption(parser: pytest.Parser) -> None:
    """Take the tier to run, and whether to keep the times."""
    parser.addoption("--tier", choices=("daily", "rest"), help="tests by their measured times; without it all")
    parser.addoption("--renew-times", action="store_true", help=f"write the times of this run to {TIMES.name}")


def pytest_configure(config: pytest.Config) -> None:
    """Choose how many examples a test of a property takes, and measure."""
    settings.load_profile("wide" if config.getoption("--tier") == "rest" else "daily")
    config.stash[_MEASURED] = Measured()
    config.pluginmanager.register(config.stash[_MEASURED])


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave the tests of the tier."""
    config.stash[COLLECTED] = list(items)
    tier = config.getoption("--tier")
    if tier:
        daily = daily_tests(costs(items, read_times()))
        chosen = [item for item in items if (item.nodeid in daily) == (tier == "daily") or (_is_wide(item, tier))]
        config.hook.pytest_deselected(items=[item for item in items if item not in set(chosen)])
        items[:] = chosen
    config.stash[SELECTED] = list(items)


def _is_wide(item: pytest.Item, tier: str) -> bool:
    """Whether a test of the rest is one of a property, which runs there with more examples."""
    return tier == "rest" and getattr(getattr(item, "obj", None), "is_hypothesis_test", False)


def read_times() -> Mapping[str, Mapping[str, float]]:
    """Times of tests and of shared fixtures. [s]"""
    if not TIMES.exists():
        return {"tests": {}, "fixtures": {}}
    found: dict[str, dict[str, float]] = json.loads(TIMES.read_text(encoding="utf-8"))
    return found


def costs(items: Sequence[pytest.Item], times: Mapping[str, Mapping[str, float]]) -> dict[str, float]:
    """Time of each test with its share of the fixtures that it has in common with others. [s]"""
    fixtures = {item.nodeid: [*_shared(item, times["fixtures"])] for item in items}
    users = Counter(each for found in fixtures.values() for each in found)
    return {
        name: times["tests"].get(name, 0.0) + sum(times["fixtures"][each[0]] / users[each] for each in found)
        for name, found in fixtures.items()
    }


def _shared(item: pytest.Item, listed: Iterable[str]) -> Iterator[tuple[str, str]]:
    """Listed fixtures of a test, each with the file that has its own, or none where a run makes it once."""
    definitions: Mapping[str, Sequence[Any]] = getattr(item, "_fixtureinfo").name2fixturedefs  # noqa: B009
    for name, found in definitions.items():
        key = f"{found[-1].baseid}::{name}"
        if key in listed and found[-1].scope in _SHARED:
            yield key, "" if found[-1].scope == "session" else item.nodeid.partition("::")[0]


def daily_tests(costs: Mapping[str, float]) -> set[str]:
    """Names of the daily tests among all."""
    daily: set[str] = set()
    for cases in _grouped(costs, _function).values():
        total = 0.0
        for name in cases:
            total += costs[name]
            if total <= MAX_OF_A_FUNCTION and costs[name] <= MAX:
                daily.add(name)
        if costs[cases[0]] <= MAX_OF_THE_QUICKEST:
            daily.add(cases[0])
    for tests in _grouped(costs, _file).values():
        if daily.isdisjoint(tests) and costs[tests[0]] <= MAX_OF_A_FILE:
            daily.add(tests[0])
    return daily


def _grouped(costs: Mapping[str, float], group: Callable[[str], str]) -> dict[str, list[str]]:
    """Names of tests by what they have in common, the quickest first."""
    found: dict[str, list[str]] = defaultdict(list)
    for name in sorted(costs, key=lambda name: costs[name]):
        found[group(name)].append(name)
    return found


def _function(name: str) -> str:
    return name.partition("[")[0]


def _file(name: str) -> str:
    return name.partition("::")[0]


# -- measurement


class Measured:
    """Times of the tests of a run, and of the fixtures that tests share: a plugin of the run. [s]"""

    def __init__(self) -> None:
        self.tests: dict[str, float] = defaultdict(float)
        self.fixtures: dict[str, list[float]] = defaultdict(list)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Add a phase of a test; what it waited for a shared fixture is the fixture's."""
        found: list[Any] = report.user_properties if report.when == "setup" else []
        shared: list[tuple[str, float]] = [each for name, each in found if name == "fixture"]
        for name, seconds in shared:
            self.fixtures[name].append(seconds)
        self.tests[report.nodeid] += report.duration - sum(seconds for _, seconds in shared)

    def by_room(self) -> dict[str, float]:
        """Time of each folder of tests with that of its fixtures, the longest first."""
        rooms: dict[str, float] = defaultdict(float)
        for name, seconds in (*self.tests.items(), *((name, sum(each)) for name, each in self.fixtures.items())):
            place = _file(name)
            rooms[place if place.count("/") < 2 else place.split("/")[1]] += seconds
        return dict(sorted(rooms.items(), key=lambda room: -room[1]))

    def listed(self) -> dict[str, dict[str, float]]:
        """Times worth keeping."""
        fixtures = {name: sum(each) / len(each) for name, each in self.fixtures.items()}
        return {
            kind: {name: round(seconds, 1) for name, seconds in sorted(found.items()) if seconds > _LISTED}
            for kind, found in (("fixtures", fixtures), ("tests", self.tests))
        }


@pytest.hookimpl(wrapper=True)
def pytest_fixture_setup(fixturedef: Any, request: Any) -> Iterator[Any]:
    """Note how long a fixture took that several tests share."""
    begun = time.perf_counter()
    try:
        return (yield)
    finally:
        if fixturedef.scope in _SHARED:
            place = f"{fixturedef.baseid}::{fixturedef.argname}"
            request._pyfuncitem.user_properties.append(("fixture", (place, time.perf_counter() - begun)))


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    """Tell the time of the tier and of its rooms; keep the times of all where that was asked for."""
    measured = config.stash[_MEASURED]
    rooms = measured.by_room()
    whole, tier = sum(rooms.values()), config.getoption("--tier") or "every"
    terminalreporter.section(f"{tier} tier: {len(measured.tests):,} tests, {whole:.0f} s of tests")
    for room, seconds in rooms.items():
        if seconds > 0.01 * whole:
            terminalreporter.line(f"{seconds:8.0f} s  {room}")
    if config.getoption("--renew-times"):
        text = json.dumps(measured.listed(), indent=0, ensure_ascii=False)
        TIMES.write_text(f"{text}\n", encoding="utf-8")
