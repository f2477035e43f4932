"""Resolved rig: each part of an operating condition is evaluated once a command, and as the rig alone gives it."""

import sys
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from pytest import MonkeyPatch, approx, fixture, mark, raises
from tests.same import same

import sonolube
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.models.contact import decay_length
from sonolube.models.friction.models import FRICTION_MODELS
from sonolube.rig import Rig, available_sources, friction_point, operating_points, read_rig, simulate
from sonolube.rig.driven_rig import voltage_harmonics, waveform_of
from sonolube.rig.resolved_rig import ResolvedRig, gap_law_of, resolved_rig, resolved_vibration, rest_separation

RIGS = Path("examples/rigs")
PREDICTIONS: dict[str, Callable[[Rig], Any]] = {
    "simulate": sonolube.simulate,
    "friction": sonolube.friction,
    "friction by another model": lambda rig: sonolube.friction(rig, model="dong_2015_full_period"),
    "wear": sonolube.wear,
    "predict": lambda rig: sonolube.predict(rig, draws=200),
    "contact": sonolube.contact,
    "thermal": lambda rig: sonolube.thermal(rig, pin="stainless_steel_316", disc="aluminium_2024"),
    "response": sonolube.response,
}
RESOLVING = (waveform_of, voltage_harmonics, available_sources, resolved_vibration, gap_law_of, rest_separation)
"""Functions that evaluate a part of the operating condition."""

REFERENCE = read_rig(RIGS / "tribometer.toml")
COMPUTED = read_rig(RIGS / "tribometer.toml", changes=["vibration.amplitude_source=computed"])
MEASURED_UNDER_ANOTHER_VOLTAGE = read_rig(
    RIGS / "tribometer.toml",
    changes=["drive.waveform=square", "vibration.vibration_amplitude=2um", "vibration.voltage_peak_to_peak=25V"],
)
STATED = read_rig(RIGS / "flextensional.toml")


@fixture
def calls(monkeypatch: MonkeyPatch) -> Counter[str]:
    """Calls of the functions that resolve a rig, by name, in every module of the program that knows them."""
    counts: Counter[str] = Counter()

    def counting(function: Callable[..., Any]) -> Callable[..., Any]:
        def counted(*args: Any, **options: Any) -> Any:
            counts[function.__name__] += 1
            return function(*args, **options)

        return counted

    modules = [module for name, module in sys.modules.items() if name.startswith("sonolube.")]
    for function in RESOLVING:
        for module in modules:
            if vars(module).get(function.__name__) is function:
                monkeypatch.setattr(module, function.__name__, counting(function))
    return counts


@mark.parametrize("rig", [REFERENCE, COMPUTED, MEASURED_UNDER_ANOTHER_VOLTAGE, STATED])
@mark.parametrize("command", PREDICTIONS)
def test_a_command_resolves_each_part_of_its_rig_at_most_twice(command: str, rig: Rig, calls: Counter[str]) -> None:
    if command == "response" and rig.structure is None:
        return
    PREDICTIONS[command](rig).object()
    assert calls["rest_separation"] >= 1
    assert max(calls.values()) <= 2, calls


def test_parts_are_evaluated_when_first_needed_and_kept(calls: Counter[str]) -> None:
    resolved = resolved_rig(REFERENCE)
    assert not calls
    assert resolved.separation == resolved.separation
    assert resolved.gap_law is resolved.gap_law
    assert resolved.vibration is resolved.vibration
    assert set(calls.values()) == {1}
    assert resolved_rig(resolved) is resolved


def test_a_resolved_rig_answers_as_its_rig() -> None:
    resolved = resolved_rig(REFERENCE)
    same(friction_point(resolved), friction_point(REFERENCE))
    same(simulate(resolved).wear, simulate(REFERENCE).wear)
    same(operating_points(resolved).friction_ratio, operating_points(REFERENCE).friction_ratio)


def test_another_friction_model_keeps_all_else_that_was_resolved(calls: Counter[str]) -> None:
    resolved = resolved_rig(REFERENCE)
    kept = resolved.vibration, resolved.gap_law, resolved.separation
    model = FRICTION_MODELS["dong_2015_full_period"]()
    other = resolved.with_friction_model(model)
    assert resolved.rig.friction_model is REFERENCE.friction_model
    assert other.rig.friction_model is model
    found = friction_point(other)
    assert (other.vibration, other.gap_law, other.separation) == kept
    assert calls["resolved_vibration"] == calls["gap_law_of"] == calls["rest_separation"] == 1
    same(found, friction_point(replace(REFERENCE, friction_model=model)))


def test_the_decay_length_at_rest_is_force_over_stiffness() -> None:
    # exponential heights: the decay length of the force is that of the heights, at any separation
    assert resolved_rig(STATED).decay_length == approx(float(decay_length(STATED.contact)))


def test_what_a_rig_lacks_is_refused_where_it_is_needed_and_not_before() -> None:
    bare = replace(STATED, vibration_amplitude=None, amplitude_per_volt=None, waveguide_amplitude=None)
    resolved = resolved_rig(bare)
    assert isinstance(resolved, ResolvedRig)
    assert resolved.separation > 0
    with raises(InvalidInput, match=r"no amplitude; give vibration\.vibration_amplitude"):
        assert resolved.vibration
    crushed = resolved_rig(replace(bare, normal_load=1e9))
    with raises(OutsideRange, match="leaves no separation"):
        simulate(crushed)  # before its amplitude is
