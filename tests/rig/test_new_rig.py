"""New rigs from what is known: roughness, contact area, softer body, distributions and the inputs known least."""

import tomllib
from dataclasses import replace
from math import exp, hypot, log, pi, sqrt
from pathlib import Path

import numpy as np
import pytest
from pytest import approx, raises
from tests.same import same

from sonolube.errors import InvalidInput
from sonolube.facts.materials import material
from sonolube.models.actuator import catalogue_actuator
from sonolube.models.surfaces import typical_summits
from sonolube.rig import PUBLISHED_DECAY_LENGTH, Rig, friction_point, rig_from
from sonolube.rig.new_rig.pin_and_vibration import (
    DrivenActuator,
    FlatPin,
    RoundPin,
    StatedAmplitude,
    finished_surface,
    scanned_surface,
    surfaces_in_contact,
)
from sonolube.rig.new_rig.rig_text import KnownBody, KnownRig, least_known, new_rig_text
from sonolube.rig.new_rig.stated_text import pin_shape, speed_of, surface_of
from sonolube.rig.resolved_rig import resolved_rig
from sonolube.rig.vibration_direction import VibrationDirection
from sonolube.text.units import to_si

GROUND = finished_surface("ground N6")
KNOWN = KnownRig(
    pin="aluminium_2024",
    disc="stainless_steel_316",
    shape=FlatPin(diameter=2e-3),
    normal_load=5.0,
    sliding_speed=0.2,
    frequency=20e3,
    vibration=StatedAmplitude(vibration_amplitude=3e-6),
    pin_surface=GROUND,
    disc_surface=GROUND,
    friction_coefficient=0.4,
)


def rig_of(known: KnownRig) -> Rig:
    return rig_from(tomllib.loads(new_rig_text(known)))


def test_a_new_rig_has_load_speed_and_vibration_as_known_and_gives_friction() -> None:
    rig = rig_of(KNOWN)
    assert (rig.normal_load, rig.sliding_speed, rig.vibration_amplitude) == approx((5.0, 0.2, 3e-6))
    assert rig.drive is not None
    assert rig.drive.frequency == 20e3
    assert friction_point(rig).vibration_amplitude == approx(3e-6)


def test_a_ball_touches_on_the_hertzian_circle_of_its_load() -> None:
    # a^3 = 3 F R/(4 E*), with 1/E* = (1 - 0.33^2)/73 GPa + (1 - 0.29^2)/200 GPa
    modulus = 1 / ((1 - 0.33**2) / 73e9 + (1 - 0.29**2) / 200e9)
    radius = (3 * 5.0 * 5e-3 / (4 * modulus)) ** (1 / 3)
    rig = rig_of(replace(KNOWN, shape=RoundPin(tip_radius=5e-3)))
    assert rig.contact.nominal_area == approx(pi * radius**2, rel=1e-3)
    assert rig_of(KNOWN).contact.nominal_area == approx(pi * 1e-6, rel=1e-3)


def test_the_softer_body_is_the_one_of_less_hardness_whichever_is_the_pin() -> None:
    strength = material("aluminium_2024").value("hardness") / 3
    for pin, disc in (("aluminium_2024", "stainless_steel_316"), ("stainless_steel_316", "aluminium_2024")):
        rig = rig_of(replace(KNOWN, pin=pin, disc=disc))
        assert rig.contact.pair.yield_strength == approx(strength, rel=1e-3)
        assert (rig.pin_material, rig.disc_material) == (pin, disc)


def test_heights_of_both_surfaces_add_as_variances() -> None:
    smooth, rough = finished_surface("N4"), finished_surface("N8")
    both = surfaces_in_contact(smooth, rough)
    heights = smooth.roughness.rms_height, rough.roughness.rms_height
    assert both.roughness.rms_height == approx(hypot(*heights))
    same(surfaces_in_contact(rough, smooth).roughness.rms_height, both.roughness.rms_height)
    assert both.height_deviation == approx(rough.height_deviation, rel=0.01)  # the rougher one decides


def test_two_equal_finishes_are_known_better_together_by_the_root_of_two() -> None:
    assert surfaces_in_contact(GROUND, GROUND).height_deviation == approx(GROUND.height_deviation / np.sqrt(2))


def test_a_grade_spans_its_range_of_roughness() -> None:
    # N6: Ra 0.4 um to 0.8 um; Gaussian heights have Rq = sqrt(pi/2) Ra
    height, factor = GROUND.roughness.rms_height, exp(GROUND.height_deviation)
    assert height == approx(np.sqrt(pi / 2) * np.sqrt(0.4e-6 * 0.8e-6))
    assert factor >= 2**0.25  # the range of the grade holds 95 of 100; the relation adds to it


def test_a_scan_gives_the_height_of_its_levelled_map(tmp_path: Path) -> None:
    pytest.importorskip("SurfaceTopography", exc_type=ImportError)
    rough = 0.5 * np.random.default_rng(1).standard_normal((48, 48))
    tilted = rough + 0.2 * np.arange(48)  # um
    header = "Channel: Height\nWidth: 48 um\nHeight: 48 um\nValue units: um"
    np.savetxt(tmp_path / "disc.asc", tilted, header=header, fmt="%.6f")
    found = scanned_surface(tmp_path / "disc.asc")
    assert found.roughness.rms_height == approx(rough.std() * 1e-6, rel=0.01)
    assert "disc.asc" in found.height_reason


def test_a_ratio_that_the_catalogue_lacks_is_assumed_and_said() -> None:
    rig = rig_of(replace(KNOWN, pin="brass_c38500"))
    assert "0.33 assumed" in rig.assumptions["contact.softer.poisson_ratio"]


def test_what_is_no_metal_has_the_strength_of_its_data_sheet() -> None:
    rig = rig_of(replace(KNOWN, pin="pet"))  # it has both; Tabor's relation is of metals
    assert rig.contact.pair.yield_strength == approx(material("pet").value("yield_strength"), rel=1e-3)


def test_an_actuator_vibrates_with_half_its_stroke_at_its_voltage() -> None:
    shown = catalogue_actuator("sa050510")
    rig = rig_of(replace(KNOWN, vibration=DrivenActuator(actuator=shown, voltage_peak_to_peak=40.0)))
    expected = shown.stroke / shown.stroke_voltage * 40.0 / 2
    assert friction_point(rig).vibration_amplitude == approx(expected, rel=1e-3)
    assert rig.capacitance == approx(shown.free_capacitance, rel=1e-3)


def test_an_actuator_beyond_its_voltage_or_its_resonance_is_refused() -> None:
    shown = catalogue_actuator("sa050510")
    with raises(InvalidInput, match="voltage_peak_to_peak 4000 V exceeds"):
        DrivenActuator(actuator=shown, voltage_peak_to_peak=4000.0)
    driven = DrivenActuator(actuator=shown, voltage_peak_to_peak=40.0)
    with raises(InvalidInput, match="frequency must lie below 150 kHz, the resonance of sa050510"):
        new_rig_text(replace(KNOWN, vibration=driven, frequency=200e3))


def test_an_amplitude_of_metres_is_refused() -> None:
    with raises(InvalidInput, match="vibration_amplitude 3 m is beyond any ultrasonic vibration"):
        StatedAmplitude(vibration_amplitude=3.0)


def test_what_nobody_measured_has_a_distribution_and_a_reason() -> None:
    rig = rig_of(KNOWN)
    assert set(rig.uncertainty) == {
        "contact.decay_length",
        "contact.roughness.rms_height",
        "contact.roughness.summit_radius",
        "contact.roughness.summit_density",
        "contact.softer.yield_strength",
        "friction.friction_coefficient",
        "vibration.vibration_amplitude",
    }
    assert set(rig.uncertainty) <= set(rig.assumptions)


def test_the_decay_length_of_a_new_rig_is_that_of_worn_contacts_whatever_its_finish() -> None:
    for finish in ("N4", "N8"):
        rig = rig_of(replace(KNOWN, disc_surface=finished_surface(finish)))
        assert rig.contact.decay_length == approx(PUBLISHED_DECAY_LENGTH.median, rel=1e-3)
        assert rig.decay_length_origin == "published_tests"
        low, high = rig.uncertainty["contact.decay_length"].quantile((0.1, 0.9))
        assert (low, high) == approx(PUBLISHED_DECAY_LENGTH.central_range(share=0.8), rel=2e-3)
        assert "roughness before wear does not tell it" in rig.assumptions["contact.decay_length"]
        assert rig.contact.roughness.rms_height != approx(3 * PUBLISHED_DECAY_LENGTH.median, rel=0.1)


def test_a_measured_stiffness_or_a_stated_length_takes_the_place_of_that_of_published_tests() -> None:
    stiff = rig_of(replace(KNOWN, normal_stiffness=2.5e6))  # 5 N over 2.5 MN/m
    assert stiff.contact.decay_length == approx(2e-6)
    assert stiff.decay_length_origin == "normal_stiffness"
    stated = rig_of(replace(KNOWN, decay_length=0.7e-6))
    assert stated.contact.decay_length == approx(0.7e-6)
    assert stated.decay_length_origin == "stated"
    for rig, key in ((stiff, "contact.normal_stiffness"), (stated, "contact.decay_length")):
        assert key in rig.uncertainty
        assert key in rig.assumptions
    with raises(InvalidInput, match="give either decay_length or normal_stiffness, got both"):
        rig_of(replace(KNOWN, normal_stiffness=2.5e6, decay_length=0.7e-6))


def test_roughness_is_not_called_least_known_where_nothing_follows_from_it() -> None:
    listed = least_known(rig_of(KNOWN), count=10)
    assert "contact.roughness.rms_height" not in [one.key for one in listed]
    assert "contact.decay_length" in [one.key for one in listed]


def test_the_inputs_known_least_come_first_and_each_measurement_once() -> None:
    rig = rig_of(KNOWN)
    listed = least_known(rig)
    assert [one.deviation for one in listed] == sorted((one.deviation for one in listed), reverse=True)
    # friction hangs on the decay length, the amplitude and the coefficient without vibration, and on no more
    names = [one.key.rpartition(".")[2] for one in listed]
    assert set(names) == {"friction_coefficient", "vibration_amplitude", "decay_length"}
    assert len({one.remedy for one in listed}) == 3


@pytest.mark.parametrize(("pin", "disc"), [("brass", "ceramic"), ("polymer", "brass")])
def test_of_two_entries_that_one_measurement_gives_the_one_known_less_is_told(pin: str, disc: str) -> None:
    # of the stiffness of both bodies, on which friction about the gap at rest depends
    rig = rig_of(replace(KNOWN, pin=pin, disc=disc)).replace("friction.model", "dong_2015_half_period")
    spreads = {}
    for place in ("softer", "harder"):
        low, high = rig.uncertainty[key := f"contact.{place}.youngs_modulus"].quantile((0.1587, 0.8413))
        spreads[key] = log(high / low) / 2
    told = [one for one in least_known(rig, count=20) if one.key in spreads]
    assert [one.key for one in told] == [max(spreads, key=lambda key: spreads[key])]
    assert told[0].deviation == approx(max(spreads.values()))


def test_entries_that_change_no_friction_are_not_said_to_be_known_least() -> None:
    # the least known of all is the radius of the summits, which an exponential contact does not feel
    rig = rig_of(KNOWN)
    factor = typical_summits(rms_height=GROUND.roughness.rms_height).radius_factor  # holds 95 of 100
    low, high = rig.uncertainty["contact.roughness.summit_radius"].quantile((0.1587, 0.8413))
    assert log(high / low) / 2 == approx(log(factor) / 2, rel=0.01)
    sharp = rig.replace("contact.roughness.summit_radius", f"{low} m")
    assert friction_point(sharp).friction_force == approx(friction_point(rig).friction_force, rel=1e-9)
    assert "contact.roughness.summit_radius" not in {one.key for one in least_known(rig, count=9)}
    assert len(rig.uncertainty) > len(least_known(rig, count=9)) == 3


@pytest.mark.parametrize(
    ("text", "radius"),
    [
        ("ball 3mm", 3e-3),
        ("ball radius 3mm", 3e-3),
        ("ball r 3mm", 3e-3),
        ("ball diameter 6mm", 3e-3),
        ("Ball d6mm", 3e-3),
        ("sphere diameter: 6 mm", 3e-3),
        ("ball ø6mm", 3e-3),
        ("ball d 0.25 in", 3.175e-3),
    ],
)
def test_a_ball_is_known_by_its_radius_or_its_diameter(text: str, radius: float) -> None:
    shape = pin_shape(text)
    assert isinstance(shape, RoundPin)
    assert shape.tip_radius == approx(radius)


@pytest.mark.parametrize("text", ["flat 6mm", "pin 6mm", "flat diameter 6mm", "pin d6mm", "flat radius 3mm"])
def test_a_flat_pin_is_known_by_its_diameter_or_its_radius(text: str) -> None:
    assert pin_shape(text) == FlatPin(diameter=6e-3)


@pytest.mark.parametrize(
    ("text", "track", "speed"),
    [
        ("60 rpm", {"track_radius": "15mm"}, 2 * pi * 15e-3),
        ("60rpm", {"track_diameter": "30mm"}, 2 * pi * 15e-3),
        ("1 rev/s", {"track_radius": "15mm"}, 2 * pi * 15e-3),
        ("60 U/min", {"track_radius": "15mm"}, 2 * pi * 15e-3),
        ("60/min", {"track_radius": "15mm"}, 2 * pi * 15e-3),
        ("10 rad/s", {"track_radius": "15mm"}, 0.15),
        ("40.6 mm/s", {}, 40.6e-3),
        ("8 in/s", {}, 0.2032),
    ],
)
def test_a_rotational_speed_slides_as_two_pi_times_radius_times_turns(
    text: str, track: dict[str, str], speed: float
) -> None:
    assert speed_of(text, **track)[0] == approx(speed)


@pytest.mark.parametrize(
    ("text", "height"),
    [
        ("Ra 0.4", np.sqrt(pi / 2) * 0.4e-6),
        ("Ra 0.4um", np.sqrt(pi / 2) * 0.4e-6),
        ("ra=0,4 µm", np.sqrt(pi / 2) * 0.4e-6),
        ("0.4um", np.sqrt(pi / 2) * 0.4e-6),
        ("400nm", np.sqrt(pi / 2) * 0.4e-6),
        ("ground Ra 0.4", np.sqrt(pi / 2) * 0.4e-6),
        ("Ra 16 uin", np.sqrt(pi / 2) * 16 * 25.4e-9),
        ("Rz 3.2", 3.2e-6 / 4.5),
        ("Rz 3.2um", 3.2e-6 / 4.5),
        ("Rq 0.5um", 0.5e-6),
        ("N6", np.sqrt(pi / 2) * np.sqrt(0.4 * 0.8) * 1e-6),
    ],
)
def test_a_finish_by_a_number_has_the_height_of_gaussian_surfaces(text: str, height: float) -> None:
    assert surface_of(text).roughness.rms_height == approx(height)


def test_a_number_tells_more_of_the_height_than_a_grade_and_that_more_than_a_process() -> None:
    deviations = [surface_of(text).height_deviation for text in ("Ra 0.6um", "N6", "ground")]
    assert deviations == sorted(deviations)
    assert deviations[0] == approx(log(1.43 / 1.04) / 4)


def test_what_was_assumed_in_reading_a_finish_is_said() -> None:
    assert "um assumed" in surface_of("Ra 0.4").height_reason
    assert "read as Ra" in surface_of("0.4um").height_reason
    assert "assumed" not in surface_of("Rz 3.2um").height_reason


def test_a_stated_amplitude_is_not_called_measured_until_its_uncertainty_is_removed() -> None:
    rig = rig_of(KNOWN)
    assert resolved_rig(rig).vibration.source == "measured"
    assert resolved_rig(rig).vibration.text == "stated, 3 um at 20 kHz"
    assert "3 um stated" in dict(rig.table())["vibration amplitude"]
    content = rig.content()
    del content["uncertainty"]["vibration.vibration_amplitude"]
    assert resolved_rig(rig_from(content)).vibration.text == "measured, 3 um at 20 kHz"


def test_a_class_puts_its_spread_into_the_file_and_an_alloy_does_not() -> None:
    rig = rig_of(replace(KNOWN, pin="brass", disc="ceramic"))
    known = {key: law for key, law in rig.uncertainty.items() if key.endswith("youngs_modulus")}
    assert set(known) == {"contact.softer.youngs_modulus", "contact.harder.youngs_modulus"}
    low, high = known["contact.harder.youngs_modulus"].quantile((0.1587, 0.8413))
    assert log(high / low) / 2 == approx(material("ceramic").property("youngs_modulus").deviation, rel=1e-2)
    assert "the class, not the material" in rig.assumptions["contact.softer.yield_strength"]
    assert not any(key.endswith("youngs_modulus") for key in rig_of(KNOWN).uncertainty)


def test_the_strength_of_a_class_is_less_known_than_that_of_an_alloy_by_the_spread_of_its_hardness() -> None:
    key = "contact.softer.yield_strength"
    deviations = []
    for name in ("steel_1045", "steel"):
        low, high = rig_of(replace(KNOWN, pin=name, disc="silicon_carbide")).uncertainty[key].quantile((0.1587, 0.8413))
        deviations.append(log(high / low) / 2)
    spread = material("steel").property("hardness").deviation
    assert deviations[1] == approx(hypot(deviations[0], spread), rel=1e-3)


@pytest.mark.parametrize("name", ["ptfe", "polyacetal", "peek", "uhmwpe", "polymer", "rubber", "felt", "skin", "dlc"])
def test_soft_bodies_and_films_are_written_with_a_range_of_friction(name: str) -> None:
    rig = rig_of(replace(KNOWN, pin=name, disc="stainless_steel_304", friction_coefficient=None))
    assert rig.pin_material == name
    assert "friction.friction_coefficient" in rig.uncertainty


def test_a_property_that_the_catalogue_lacks_of_a_material_is_that_of_its_class() -> None:
    rig = rig_of(replace(KNOWN, pin="uncoated_steel", disc="silicon_carbide"))
    assert "unspecified steel" in rig.assumptions["contact.softer.youngs_modulus"]
    assert "contact.softer.youngs_modulus" in rig.uncertainty


def test_a_soft_body_is_a_layer_of_its_thickness_with_what_the_catalogue_knows_of_it() -> None:
    felt = KnownBody(material=material("felt")).layer(3e-3)
    table = felt.tables["friction"]
    assert table["model"] == '"soft_layer"'
    assert to_si(table["layer_thickness"].strip('"'), unit="m", name="layer") == approx(3e-3)
    assert set(table) == {"model", "layer_thickness", "dynamic_modulus_ratio", "layer_loss", "layer_density"}
    # 1 to 10, 0.05 to 1 and 170 to 340 kg/m3, of which the catalogue takes the geometric means
    assert float(table["dynamic_modulus_ratio"]) == approx(sqrt(10), rel=1e-3)
    assert float(table["layer_loss"]) == approx(sqrt(0.05), rel=1e-3)
    assert to_si(table["layer_density"].strip('"'), unit="kg/m3", name="density") == approx(sqrt(170 * 340), rel=1e-3)
    assert felt.assumptions["friction.layer_thickness"] == "as stated, on a rigid base"
    assert set(felt.assumptions) == {f"friction.{key}" for key in table if key != "model"}
    with raises(InvalidInput, match=r"layer_thickness is of a soft body, and .* is none"):
        KnownBody(material=material("stainless_steel_316")).layer(3e-3)


@pytest.mark.parametrize(
    ("change", "message"),
    [({"normal_load": 0.0}, "normal_load must be positive"),
     ({"sliding_speed": -1.0}, "sliding_speed must be positive"),
     ({"frequency": 0.0}, "frequency must be positive"),
     ({"friction_coefficient": 0.0}, "friction_coefficient must be positive"),
     ({"layer_thickness": 0.0}, "layer_thickness must be positive"),
     ({"layer_thickness": 1e-3, "direction": VibrationDirection(direction="along")}, "a soft layer has no law for")],
)  # fmt: skip
def test_a_number_that_no_rig_has_is_refused_by_its_name(change: dict[str, object], message: str) -> None:
    with raises(InvalidInput, match=message):
        replace(KNOWN, **change)  # type: ignore[arg-type]
    assert replace(KNOWN, friction_coefficient=None).friction_coefficient is None


def test_a_body_states_what_the_catalogue_lacks_of_it_and_the_spread_of_a_class() -> None:
    body = KnownBody(material=material("aluminium_2024"))
    entries = body.entries("contact.softer", role="pin")
    assert entries.tables == {"contact.softer": {"material": '"aluminium_2024"', "role": '"pin"'}}
    assert entries.uncertainty == {}
    softer = body.entries("contact.softer", role="disc", strength=body.strength)
    assert softer.tables["contact.softer"]["yield_strength"].endswith('Pa"')
    assert set(softer.uncertainty) == {"contact.softer.yield_strength"}
    steel = KnownBody(material=material("steel"))  # a class
    assert set(steel.entries("contact.harder", role="disc").uncertainty) == {"contact.harder.youngs_modulus"}
    assert "youngs_modulus" in steel.entries("contact.harder", role="disc").tables["contact.harder"]


@pytest.mark.parametrize(
    ("pin", "disc", "title"),
    [
        ("brass", "stainless_steel_304", "Brass pin on stainless steel AISI 304 disc"),
        ("steel", "titanium_6al4v", "Steel pin on titanium alloy Ti-6Al-4V disc"),
        ("copper", "diamond_like_carbon", "Copper pin on diamond-like carbon film disc"),
    ],
)
def test_the_title_of_a_rig_names_its_bodies_as_a_person_would(pin: str, disc: str, title: str) -> None:
    found = tomllib.loads(new_rig_text(replace(KNOWN, pin=pin, disc=disc)))
    assert found["title"] == title
