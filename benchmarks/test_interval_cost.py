"""Processor time of friction, maps and optima by the friction model alone, and with the prediction beside it.

Bars, in one run: `friction` at most 0.1 s more, `map` at most twice, `optimise` at most three times. All within one
process; what starting one costs more, `command_times.py` measures.
"""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from pytest import MonkeyPatch
from pytest_benchmark.fixture import BenchmarkFixture

import sonolube as sl
from sonolube.errors import SonolubeError
from sonolube.rig import Rig, read_rig

RIGS = Path(__file__).parents[1] / "examples" / "rigs"
RIG, MAPPED = RIGS / "tribometer.toml", RIGS / "power_map.toml"


@contextmanager
def model_alone() -> Iterator[None]:
    """Let maps and optima find no prediction inside a `with` block."""

    def nothing(*_: object, **__: object) -> None:
        raise SonolubeError("left out")

    with MonkeyPatch.context() as patch:
        patch.setattr("sonolube.tasks.design.map.reduction_chances", nothing)
        patch.setattr("sonolube.design.optimisation.confident_optimum.computed_chances", nothing)
        yield


def friction(rig: Rig) -> object:
    return sl.friction(rig).object()


def friction_of_the_model(rig: Rig) -> object:
    return sl.friction(rig, interval=False).object()


def mapped(rig: Rig, **given: Any) -> object:
    return sl.map(rig, **given).object()


def optimum(rig: Rig, **given: Any) -> object:
    return sl.optimise(rig, target_reduction="50%", **given).object()


def alone(of: Callable[[Rig], object]) -> Callable[[Rig], object]:
    def without(rig: Rig) -> object:
        with model_alone():
            return of(rig)

    return without


WAYS: dict[str, dict[str, Callable[[Rig], object]]] = {
    "friction": {"model alone": friction_of_the_model, "with the interval": friction},
    "map": {
        "model alone": alone(mapped),
        "with the interval": mapped,
        "with the chance of a target": lambda rig: mapped(rig, target_reduction="60%", confidence="90%"),
    },
    "optimise": {
        "model alone": alone(optimum),
        "with the interval": optimum,
        "with 6 chances in 10": lambda rig: optimum(rig, confidence="60%"),
    },
}
CASES = [
    pytest.param(name, way, id=f"{name} {way}", marks=pytest.mark.benchmark(group=name, timer=time.process_time))
    for name, ways in WAYS.items()
    for way in ways
]


@pytest.mark.parametrize(("name", "way"), CASES)
def test_a_command_by_the_model_alone_and_with_its_prediction(benchmark: BenchmarkFixture, name: str, way: str) -> None:
    file, run = (MAPPED if name == "map" else RIG), WAYS[name][way]
    run(read_rig(file))  # compiled, and the posterior read, outside the measurement

    def fresh() -> tuple[tuple[Rig], dict[str, object]]:
        return (read_rig(file),), {}

    benchmark.pedantic(run, setup=fresh, rounds=3 if name == "optimise" else 10)  # type: ignore[no-untyped-call]
