"""Arguments of `optimise` in SI as they reach the problem, and its answer by stand-ins of what was found."""

from types import SimpleNamespace
from typing import Any

import pytest
from pytest import MonkeyPatch, approx, raises
from tests.names import names_of

from sonolube.design.optimisation import OWN_ACTUATOR
from sonolube.errors import InvalidInput
from sonolube.example_files import example_file
from sonolube.rig import Rig, read_rig
from sonolube.tasks.design import optimise as module
from sonolube.tasks.design.optimise import OptimisationAnswer, optimise

NAMES = names_of(module)
Asked = dict[str, Any]


@pytest.fixture(scope="module")
def rig() -> Rig:
    """The reference rig: 22 kHz, 3 N, coefficient 0.341."""
    return read_rig(example_file("tribometer").source)


@pytest.fixture
def asked(monkeypatch: MonkeyPatch) -> Asked:
    """Problem, aims and resistance that the search was called with."""
    seen: Asked = {}

    def search(problem: Any, rig: Any, **named: Any) -> Any:
        seen.update(named, problem=problem, rig=rig)
        named["advance"](3, 7)
        return SimpleNamespace(best="best"), "chance"

    def electronics(problem: Any, best: Any, *, source_resistance: Any) -> str:
        seen.update(best=best, source=source_resistance)
        return "electronics"

    monkeypatch.setattr(module, "optimum_with_chance", search)
    monkeypatch.setattr(NAMES.optimisation, "required_electronics", electronics)
    return seen


def test_a_target_alone_is_sought_for_least_power_within_a_fifth_of_the_frequency(rig: Rig, asked: Asked) -> None:
    stages: list[tuple[Any, ...]] = []
    answer: Any = optimise(rig, target_reduction="60 %", progress=lambda *told: stages.append(told))
    problem = asked["problem"]
    assert problem.friction_ratio == approx(0.4)
    assert problem.space.frequencies == approx((17.6e3, 26.4e3))
    assert problem.space.actuators == (OWN_ACTUATOR,)
    assert (problem.tolerance, problem.limits.horn, problem.space.bolt) == (None, None, None)
    assert (problem.limits.voltage_maximum, problem.limits.temperature_rise) == (None, None)
    assert (asked["minimise"], asked["second_objective"], asked["samples"]) == ("power", None, 16)
    assert (asked["best"], asked["source"]) == ("best", None)
    assert (answer.electric, answer.chance) == ("electronics", "chance")
    assert (asked["rig"], asked["confidence"], asked["runs"]) == (rig, None, None)
    assert any(told[-2:] == (3, 7) for told in stages)
    optimise(rig, target_friction="0.5115N")
    assert asked["problem"].friction_ratio == approx(0.5)


def test_limits_tolerance_and_parts_reach_the_problem_in_si(rig: Rig, asked: Asked) -> None:
    optimise(
        rig,
        target_friction=0.1705,
        over={"structure.tip_mass": "90g:130g", "drive.frequency": "20kHz:24kHz", "drive.waveform": "square,sine"},
        minimise="heat",
        pareto="voltage",
        robust=0.05,
        quantile=0.9,
        samples=32,
        voltage_limit="100V",
        current_limit="500mA",
        slew_limit="3V/us",
        stress_limit="20MPa",
        temperature_limit="40K",
        conductance="0.5W/K",
        horn="titanium",
        horn_limit="200MPa",
        bolt="M6x40mm",
        preload="1kN",
        bolt_strength="900MPa",
        source_resistance="50ohm",
    )
    problem = asked["problem"]
    limits = problem.limits
    assert problem.friction_ratio == approx(0.5)
    assert problem.space.ranges == {"tip_mass": approx((0.09, 0.13))}
    assert problem.space.frequencies == approx((20e3, 24e3))
    assert problem.space.waveforms == ("square", "sine")
    assert (limits.voltage_maximum, limits.current_maximum, limits.slew_rate_maximum) == approx((100.0, 0.5, 3e6))
    assert (limits.nominal_pressure, limits.temperature_rise, limits.thermal_conductance) == approx((20e6, 40.0, 0.5))
    assert limits.horn is not None
    assert limits.horn.stress_limit == approx(200e6)
    assert problem.space.bolt is not None
    assert (problem.space.bolt.preload, problem.space.bolt.yield_strength) == approx((1e3, 900e6))
    assert problem.tolerance is not None
    assert (problem.tolerance.manufacturing_tolerance, problem.tolerance.quantile) == approx((0.05, 0.9))
    assert (asked["minimise"], asked["second_objective"], asked["samples"]) == ("heat", "voltage", 32)
    assert asked["source"] == approx(50.0)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"samples": 4}, "samples has no meaning unless over gives an entry of structure"),
        ({"quantile": 0.9}, "quantile needs robust, the tolerance"),
        ({"temperature_limit": "40K"}, "temperature_limit needs conductance, the heat that the actuator loses"),
        ({"bolt_strength": "900MPa"}, "bolt_strength has no meaning without bolt"),
        ({"pareto": "power"}, "pareto has no meaning for the quantity that is minimised; name another"),
        ({"quality": 70.0}, "quality has no meaning for the rig's own actuator"),
        ({"source_resistance": "0ohm"}, "source_resistance must be positive"),
        ({"horn": "titanium"}, "horn and horn_limit belong together"),
        ({"preload": "1kN"}, "bolt and preload belong together"),
    ],
)
def test_an_argument_without_the_one_that_it_belongs_to_is_refused(
    rig: Rig, asked: Asked, given: dict[str, Any], message: str
) -> None:
    with raises(InvalidInput, match=message):
        optimise(rig, target_friction=0.17, **given)
    assert "problem" not in asked


def found(rig: Rig, **more: Any) -> OptimisationAnswer:
    """Answer of one design of the rig's own actuator by stand-ins."""
    space = SimpleNamespace(rig=rig, mechanical_quality_factor=75.0)
    design = SimpleNamespace(candidate=SimpleNamespace(actuator=OWN_ACTUATOR))
    made = {
        "problem": SimpleNamespace(space=space, limits=SimpleNamespace(loss_tangent=0.02), friction_ratio=0.4),
        "minimise": "power",
        "second_objective": "heat",
        "screening": SimpleNamespace(refused={"nac2023": "too stiff"}),
        "designs": (design,),
        "front": (),
        "best": design,
    }
    optimum: Any = SimpleNamespace(**made | more)
    electric: Any = "electronics"
    return OptimisationAnswer(rig=rig, optimum=optimum, electric=electric)


def test_figures_are_those_of_what_was_found(rig: Rig, monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(NAMES.results, "tightest_limit", lambda best: NAMES.results.NO_LIMIT)
    for name in ("frequency_chart", "front_chart", "limits_chart", "power_factor_chart"):
        monkeypatch.setattr(NAMES.figures, name, lambda *given, name=name: (name, given))
    plain = found(rig)
    assert list(plain.figures()) == ["tribometer-optimum-frequency", "tribometer-optimum-power-factor"]
    monkeypatch.setattr(NAMES.results, "tightest_limit", lambda best: "voltage")
    whole = found(rig, front=(1, 2))
    drawn: dict[str, Any] = {
        name: figure.chart() for name, figure in whole.figures().items() if figure.chart is not None
    }
    assert drawn == {
        "tribometer-optimum-frequency": ("frequency_chart", (whole.optimum,)),
        "tribometer-optimum-front": ("front_chart", (whole.optimum,)),
        "tribometer-optimum-limits": ("limits_chart", (whole.optimum.best,)),
        "tribometer-optimum-power-factor": ("power_factor_chart", (whole.optimum, "electronics")),
    }


def test_the_quality_factor_is_assumed_of_actuators_of_the_catalogue_only(rig: Rig) -> None:
    own = found(rig).assumptions()
    assert own["loss tangent"] == "0.02 for the ceramic, in its heat"
    assert "quality factor" not in own
    assert set(rig.assumptions) <= set(own)
    other = SimpleNamespace(candidate=SimpleNamespace(actuator="nac2023"))
    assert found(rig, designs=(other,)).assumptions()["quality factor"].startswith("75 for the catalogue's ceramics")


def test_the_file_of_the_best_design_keeps_the_words_of_an_unchanged_rig(rig: Rig, monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(module, "designs_dataset", lambda optimum: "designs")
    monkeypatch.setattr(module, "design_text", lambda source, content, problem, best: source)
    assert rig.file is not None
    text = rig.file.read_text(encoding="utf-8")
    files = found(rig).files()
    assert list(files) == ["tribometer-optimum.nc", "tribometer-optimum.toml"]
    assert list(files.values()) == ["designs", text]
    changed = read_rig(rig.file, changes=["drive.frequency=21kHz"])
    written = found(changed).files()["tribometer-optimum.toml"]
    assert written != text
    assert "#" not in str(written).splitlines()[0]
