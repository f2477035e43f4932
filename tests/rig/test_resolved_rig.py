"""Resolved rig: each part of an operating condition is evaluated once a command, and as the rig alone gives it."""

import sys
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from pytest import MonkeyPatch, approx, fixture, mark, raises
from tests.same import same

import sonolube
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.models.actuator.drive import Drive
from sonolube.models.contact import decay_length, normal_force
from sonolube.models.dynamics import Sine
from sonolube.models.friction.models import FRICTION_MODELS
from sonolube.models.wear.cube import DEFAULT_WEAR_MODEL
from sonolube.rig import Rig, available_sources, friction_point, operating_points, read_rig, simulate
from sonolube.rig.amplitude_source import AMPLITUDE_ERROR
from sonolube.rig.driven_rig import DriveVoltage, voltage_harmonics, waveform_of
from sonolube.rig.resolved_rig import (
    ResolvedRig,
    amplitude_labels,
    drive_and_load,
    gap_law_of,
    held_back_caveats,
    resolved_rig,
    resolved_vibration,
    rest_separation,
    source_caveats,
)
from sonolube.text.units import format_si
from sonolube.validation.published_wear_tests import wear_model_errors

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
    wear_model_errors(DEFAULT_WEAR_MODEL)  # on the published tests, computed once a process
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


def within_the_plane(source: str = "computed") -> ResolvedRig:
    """Tribometer whose tip moves along the sliding."""
    along = ["vibration.direction=along", "friction.model=coulomb", f"vibration.amplitude_source={source}"]
    return resolved_rig(read_rig(RIGS / "tribometer.toml", changes=along))


def test_friction_on_a_free_tip_may_change_its_amplitude_by_the_fundamental_of_a_square_wave() -> None:
    # a friction force of mu F that turns with the velocity has the first harmonic 4/pi mu F, here of 0.341 times 3 N;
    # the tip moves by the receptance of the chain, a free 3 x 3 system
    omega = 2 * np.pi * 22e3
    m1, m2, m3 = 0.1093, 2.41 + 0.07, 0.602
    stack, arm = 2e9 + 30j * omega, 4.56e5 + 90j * omega
    dynamic = np.array(
        [
            [stack + 702j * omega - m1 * omega**2, -stack, 0],
            [-stack, stack + arm - m2 * omega**2, -arm],
            [0, -arm, arm - m3 * omega**2],
        ]
    )
    moved = abs(np.linalg.inv(dynamic)[0, 0])
    change = 4 / np.pi * 0.341 * 3 * moved
    rig = within_the_plane()
    (line,) = held_back_caveats(rig, vibration_amplitude=0.99 * change / AMPLITUDE_ERROR)
    assert line.startswith(
        f"the friction force, up to 1.02 N, is left out of the motion of the tip and could change its"
        f" amplitude by up to {format_si(change, 'm')}; measure it"
    )
    assert held_back_caveats(rig, vibration_amplitude=1.01 * change / AMPLITUDE_ERROR) == ()


def test_friction_holds_back_only_a_computed_motion_within_the_plane() -> None:
    tiny = 1e-12
    assert held_back_caveats(within_the_plane(), vibration_amplitude=tiny)
    assert held_back_caveats(within_the_plane("measured"), vibration_amplitude=tiny) == ()
    assert held_back_caveats(resolved_rig(COMPUTED), vibration_amplitude=tiny) == ()


def test_sources_are_said_to_differ_beyond_five_percent_of_the_larger() -> None:
    # 89.3 nm/V at 28 V peak to peak are 2.5004 um; computed and measured ones are 2.5 um
    resolved = resolved_rig(REFERENCE)
    assert source_caveats(resolved, vibration_amplitude=2.5e-6) == ()
    assert source_caveats(resolved, vibration_amplitude=2.4e-6) == ()  # 0.1 of 2.5
    (line,) = source_caveats(resolved, vibration_amplitude=2.3e-6)  # 0.2 of 2.5
    assert line.startswith("the amplitudes differ by more than their error of 5 %: measured 2.3 um, taken here, and")
    assert line.endswith("computed 2.5 um, per-volt 2.5 um")
    computed = resolved.amplitude_by("computed")
    assert source_caveats(resolved, vibration_amplitude=1.0513 * computed) == ()  # 0.0513 of it, below 0.0526
    assert len(source_caveats(resolved, vibration_amplitude=1.0540 * computed)) == 1  # 0.0540, above 0.0527
    assert source_caveats(resolved_rig(STATED), vibration_amplitude=1.0) == ()  # of one source


def test_each_source_has_its_amplitude_at_the_drive_of_the_rig() -> None:
    resolved = resolved_rig(read_rig(RIGS / "tribometer.toml", changes=["drive.voltage_peak_to_peak=14V"]))
    assert resolved.amplitude_by("per-volt") == approx(0.0893e-6 * 14)
    assert resolved.amplitude_by("measured") == approx(1.25e-6, rel=2e-3)  # 2.5 um at 28 V, a tip almost linear
    assert resolved.amplitude_by("computed") == approx(1.25e-6, rel=0.01)
    assert resolved.sources == ("measured", "computed", "per-volt")


def test_the_motion_of_the_structure_is_refused_where_there_is_none_along_the_normal() -> None:
    with raises(InvalidInput, match="the tables stack and structure are missing"):
        assert resolved_rig(STATED).moved
    with raises(InvalidInput, match="the vibration is along the sliding; use friction or simulate, or leave"):
        assert within_the_plane().moved
    per_volt = read_rig(RIGS / "tribometer.toml", changes=["vibration.amplitude_source=per-volt"])
    with raises(InvalidInput, match=r"not a sine of the amplitude per-volt; choose the amplitude computed or measured"):
        assert resolved_rig(per_volt).moved
    assert resolved_rig(COMPUTED).moved.calibration is None
    assert resolved_rig(REFERENCE).moved.calibration is not None


def test_the_gap_law_has_the_force_of_the_contact_by_exponent_or_by_table() -> None:
    exponential = gap_law_of(REFERENCE.contact)
    rise = np.array([0.0, 1e-6])
    assert exponential.force(rise, np.float64(3.0)) == approx([3.0, 3 * np.exp(-0.5)])  # 6 um over 3
    gaussian = read_rig(RIGS / "tribometer.toml", changes=["contact.height_distribution=gaussian"])
    rest = rest_separation(gaussian)
    expected = normal_force(gaussian.contact, separation=rest + rise)
    assert gap_law_of(gaussian.contact).force(rise, np.float64(3.0)) == approx(expected, rel=1e-8)


def test_a_soft_layer_may_be_pressed_flat_and_a_hard_contact_may_not() -> None:
    soft = read_rig(RIGS / "pom_on_steel.toml", changes=["contact.normal_load=1 MN"])
    assert rest_separation(soft) <= 0
    with raises(OutsideRange, match=r"contact\.normal_load 1e\+06 N leaves no separation .* \(d = -"):
        rest_separation(replace(REFERENCE, normal_load=1e6))


def test_a_vibration_says_its_direction_after_its_source_but_along_the_normal() -> None:
    assert resolved_rig(REFERENCE).vibration.text.startswith("measured, 2.5 um at 28 V, 22 kHz; it scales the drive")
    assert "normal" not in resolved_rig(REFERENCE).vibration.text
    along = resolved_rig(read_rig(RIGS / "vibrating_base.toml"))
    assert along.vibration.text.endswith("; along the sliding")
    assert amplitude_labels(along) == {
        "amplitude_source": along.vibration.source,
        "amplitude_origin": along.vibration.text,
    }
    assert amplitude_labels(replace(STATED, amplitude_per_volt=None)) == {}


def test_a_march_takes_drive_load_and_ramp_of_the_rig_by_name() -> None:
    changes = ["drive.ramp_duration=7ms", "drive.ramp_shape=cosine", "drive.voltage_offset=-3V"]
    taken = drive_and_load(resolved_rig(read_rig(RIGS / "tribometer.toml", changes=changes)))
    ramp = taken.pop("ramp")
    assert (ramp.duration, ramp.shape) == (7e-3, "cosine")
    assert isinstance(taken.pop("waveform"), Sine)
    assert taken == {"normal_load": 3.0, "frequency": 22e3, "voltage_peak_to_peak": 28.0, "voltage_offset": -3.0}


def test_the_power_of_the_amplifier_needs_a_voltage_and_a_capacitance() -> None:
    # D 1.9: C U_max U_pp f = 360 nF 28 V 28 V 22 kHz
    power = resolved_rig(REFERENCE).charging_power()
    assert power == approx(360e-9 * 28 * 28 * 22e3)
    assert resolved_rig(replace(STATED, capacitance=None)).charging_power() is None
    assert resolved_rig(read_rig(RIGS / "cutter_head.toml")).charging_power() is None
    assert resolved_rig(STATED).charging_power() == approx(1.53e-6 * 6 * 4 * 16e3)  # 4 V about 4 V: up to 6 V


@mark.parametrize(("offset", "highest"), [(0.0, 20.0), (-10.0, 30.0), (15.0, 35.0)])
def test_an_amplifier_feeds_a_capacitance_from_a_rail_at_the_highest_voltage_of_either_sign(
    offset: float, highest: float
) -> None:
    # D 1.9: C U_max U_pp f, of 360 nF at 40 V peak to peak and 22 kHz
    voltage = DriveVoltage(drive=Drive(frequency=22e3, voltage_peak_to_peak=40.0, voltage_offset=offset))
    assert float(voltage.charging_power(capacitance=360e-9)) == approx(360e-9 * highest * 40.0 * 22e3)
    low, high = voltage.range()
    assert (float(low), float(high)) == approx((offset - 20.0, offset + 20.0))
    low, high = voltage.range(voltage_peak_to_peak=10.0, voltage_offset=1.0)
    assert (float(low), float(high)) == approx((-4.0, 6.0))
    at_half = voltage.charging_power(capacitance=360e-9, voltage_peak_to_peak=20.0, voltage_offset=0.0, frequency=11e3)
    assert float(at_half) == approx(360e-9 * 10.0 * 20.0 * 11e3)
