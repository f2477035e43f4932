"""Arguments of `export fmu` in SI as they reach tables, controller and units, and those that have no meaning."""

from types import SimpleNamespace
from typing import Any

import pytest
from pytest import MonkeyPatch, approx, raises
from tests.names import names_of
from tests.tasks.running import RigStandIn

from sonolube.errors import InvalidInput
from sonolube.rig import AMPLITUDE, VOLTAGE
from sonolube.tasks.export import mock_up
from sonolube.tasks.export.mock_up import fmu

NAMES = names_of(mock_up)
RIG: Any = RigStandIn(
    name="own-rig", title="Own rig", structure=None, pin_material=None, disc_material=None, assumptions={}
)


class Asked(dict[str, Any]):
    """What each part was called with, by its name; the quantity and range of frequencies that the rig has."""

    quantity: Any = VOLTAGE
    frequency = (20e3, 24e3)


@pytest.fixture
def asked(monkeypatch: MonkeyPatch) -> Asked:
    seen = Asked()

    def see(name: str, result: Any) -> Any:
        def call(*given: Any, **named: Any) -> Any:
            seen[name] = (given, named)
            return result

        return call

    study = SimpleNamespace(controller="controller", tracker="tracker")
    tables = SimpleNamespace(quantity=None)
    monkeypatch.setattr(mock_up, "rig_of", lambda rig: rig)
    monkeypatch.setattr(mock_up, "refuse_replaced", lambda rig, over: None)
    monkeypatch.setattr(mock_up, "commanded_quantity", lambda rig: seen.quantity)
    monkeypatch.setattr(mock_up, "resolved_rig", lambda rig: "resolved")
    monkeypatch.setattr(mock_up, "resonance_without_structure", see("resonance", ("mode", {"quality": "assumed"})))

    def ranges(resolved: Any, *, over: Any) -> Any:
        seen["ranges"] = over
        return SimpleNamespace(frequency=seen.frequency, level=(0.0, 40.0))

    def tabulated(*given: Any, **named: Any) -> Any:
        seen["tables"] = (given, named)
        tables.quantity = seen.quantity
        return tables

    monkeypatch.setattr(mock_up, "plant_ranges", ranges)
    monkeypatch.setattr(mock_up, "plant_tables", tabulated)
    monkeypatch.setattr(NAMES.loops, "design_control", see("control", study))
    monkeypatch.setattr(mock_up, "c_compiler", lambda: "cc")
    monkeypatch.setattr(mock_up, "plant_unit", see("plant", "the plant"))
    monkeypatch.setattr(mock_up, "controller_unit", see("controller", "the controller"))
    return seen


def test_a_rig_with_a_voltage_has_an_amplifier_and_follows_its_resonance(asked: Asked) -> None:
    answer: Any = fmu(RIG, fmi="2", delay="2ms", rate="10kHz", closed_loop="20ms", quality=80.0, coupling=0.3)
    assert asked["resonance"][0][1:] == (80.0, 0.3)
    _, settings = asked["control"][0]
    assert settings.amplifier.voltage_maximum == approx(40.0)
    assert settings.amplitude_maximum is None
    assert (settings.dead_time, settings.sample_interval, settings.closed_loop_time) == approx((2e-3, 1e-4, 0.02))
    assert settings.duration == approx(0.1)  # a thousand samples
    assert settings.tracking
    assert asked["control"][1] == {"mode": "mode"}
    given, named = asked["plant"]
    assert named["identifier"] == "own_rig_plant"
    assert (named["version"], named["compiler"]) == ("2", "cc")
    given, named = asked["controller"]
    assert given == ("controller", "tracker")
    assert named["identifier"] == "own_rig_controller"
    assert (answer.plant, answer.controller) == ("the plant", "the controller")
    assert answer.assumed == {"quality": "assumed"}
    assert asked["ranges"] == {}
    assert asked["tables"][1]["heat"] is None


def test_defaults_are_a_millisecond_five_kilohertz_and_version_three(asked: Asked) -> None:
    fmu(RIG, over={"contact.normal_load": "2N:4N"})
    _, settings = asked["control"][0]
    assert (settings.dead_time, settings.sample_interval) == approx((1e-3, 2e-4))
    assert settings.closed_loop_time is None
    assert asked["plant"][1]["version"] == "3"
    assert asked["ranges"] == {"contact.normal_load": approx((2.0, 4.0))}
    fmu(RIG, track=False)
    assert not asked["control"][0][1].tracking


def test_a_commanded_amplitude_has_a_limit_of_its_own_and_no_resonance_to_track(asked: Asked) -> None:
    asked.quantity = AMPLITUDE
    fmu(RIG)
    settings = asked["control"][0][1]
    assert settings.amplitude_maximum == approx(40.0)
    assert settings.amplifier is None
    for argument in ({"coupling": 0.3}, {"track": True}):
        with raises(InvalidInput, match="has no meaning for an amplitude that is commanded"):
            fmu(RIG, **argument)


def test_an_amplitude_of_one_frequency_is_not_tracked(asked: Asked) -> None:
    asked.frequency = (22e3, 22e3)
    fmu(RIG)
    assert not asked["control"][0][1].tracking
    with raises(InvalidInput, match="track has no meaning for an amplitude that holds at one frequency"):
        fmu(RIG, track=True)


def test_a_structure_has_its_own_resonance_and_a_rate_is_positive(asked: Asked) -> None:
    whole: Any = RigStandIn(**{**vars(RIG), "structure": object()})
    fmu(whole)
    for argument in ({"quality": 80.0}, {"coupling": 0.3}):
        with raises(InvalidInput, match="has no meaning for a rig whose file has the table structure"):
            fmu(whole, **argument)  # type: ignore[arg-type]
    with raises(InvalidInput, match="rate 0 must be positive"):
        fmu(RIG, rate=0)
