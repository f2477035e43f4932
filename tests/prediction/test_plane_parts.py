"""Parts of predictions within the plane: conditions, distance, sentences and ranges, against values by hand."""

from dataclasses import replace
from math import cos, exp, hypot, log, pi, sin, sqrt
from typing import Any

import numpy as np
from pytest import approx, mark
from tests.prediction.linear_rigs import conditions

from sonolube.prediction import within_plane as plane
from sonolube.prediction.within_plane import (
    SPRINGS,
    compliant_ratio,
    coulomb_ratio,
    is_predicted,
    plane_caveats,
    plane_extrapolation,
    plane_posterior,
    plane_rigs,
)
from sonolube.rig.vibration_direction import VibrationDirection

ALONG = VibrationDirection(direction="along")
LOWEST = 0.05e-3 / (2 * pi * 26e3 * 0.35e-6)  # Luo et al., figure 5b: 0.05 mm/s against 26 kHz and 0.35 um


def at(zeta: float, direction: VibrationDirection, *, factor: float = 1.0) -> Any:
    """Conditions of a velocity ratio at 2 um and 20 kHz, whose amplitude is off by a factor."""
    speed = zeta * 2 * pi * 2e4 * 2e-6
    known = conditions([2e-6], [speed])
    return plane.within_plane(known.scaled(decay_length=np.array([1.5 * factor])), direction)


def test_the_velocity_ratio_is_sliding_over_vibration_velocity_with_the_error_of_the_amplitude() -> None:
    # decay length over its reference of 1.5 um carries the error: 1.2 times it is an amplitude 1.2 times smaller
    assert at(0.3, ALONG).velocity_ratio == approx([0.3])
    off = at(0.3, ALONG, factor=1.2)
    assert off.velocity_ratio == approx([0.36])
    assert off.amplitude_ratio(log(0.5e-6)) == approx([2.0 / 1.2 / 0.5])
    assert SPRINGS.ratio(log(1e-12), off) == approx([2 / pi * np.arcsin(0.36)], abs=5e-3)  # stiff as a rigid contact
    assert SPRINGS.ratio(log(1e-3), off) == approx([1.0], abs=2e-3)  # yields by the whole amplitude


def test_of_a_measured_velocity_the_amplitude_alone_has_an_error() -> None:
    measured = replace(at(0.3, ALONG, factor=1.2), vibration_velocity=np.array([2 * pi * 2e4 * 2e-6]))
    assert measured.velocity_ratio == approx([0.3])
    assert measured.amplitude_ratio(log(0.5e-6)) == approx([2.0 / 1.2 / 0.5])


@mark.parametrize("given", [{"direction": "along"}, {"direction": "across"}, {"vibration_direction": 0.5}])
def test_every_law_lies_between_the_rigid_contact_and_none_and_vanishes_with_the_amplitude(given: Any) -> None:
    direction = VibrationDirection(**given)
    zeta, stroke = np.meshgrid(np.geomspace(1e-3, 3.0, 20), np.geomspace(1e-4, 500.0, 20))
    found = compliant_ratio(direction, velocity_ratio=zeta, amplitude_ratio=stroke)
    assert np.all(found >= coulomb_ratio(direction, velocity_ratio=zeta) - 1e-12)
    assert np.all(found <= 1)
    assert found[0] == approx(np.ones(20), abs=1e-3)
    assert found[-1] == approx(coulomb_ratio(direction, velocity_ratio=zeta[-1]), abs=0.03)


def test_the_discrepancy_of_a_vibration_within_the_plane_vanishes_with_its_amplitude() -> None:
    assert SPRINGS.effect(log(1e-6), at(0.3, ALONG)) == approx([1.0])  # two slip lengths
    assert SPRINGS.effect(log(100e-6), at(0.3, ALONG)) == approx([0.1])  # 0.02 over a fifth
    low, high = SPRINGS.bounds(at(0.3, ALONG))
    assert low == approx([2 / pi * np.arcsin(0.3)])
    assert high == approx(1.0)


@mark.parametrize(
    ("zeta", "given", "expected"),
    [
        (0.2, {"direction": "along"}, 0.0),
        (LOWEST / 2, {"direction": "along"}, log(2)),
        (0.2, {"vibration_direction": 0.5}, sin(0.5)),
        (0.2, {"vibration_direction": -0.5}, sin(0.5)),
        (LOWEST / 3, {"vibration_direction": 0.5}, hypot(log(3), sin(0.5))),
        (4.0, {"vibration_direction": 0.5}, sin(0.5) / 4),  # towards no vibration it vanishes
        (0.5, {"direction": "torsional", "torsion_radius": 2e-3}, 1.0),
        # a circle: size sqrt(2), sine 1/sqrt(2), roundness 1
        (0.5, {"direction": "along", "second_direction": "across", "second_fraction": 1.0, "second_phase": pi / 2},
         sqrt(1.5)),
        # across 0.5 in quadrature: size sqrt(1.25), sine 0.5/size, roundness 2 0.5/1.25
        (0.5, {"direction": "along", "second_direction": "across", "second_fraction": 0.5, "second_phase": pi / 2},
         hypot(0.5 / sqrt(1.25), 0.8)),
        # in step: a line, at the angle of both
        (0.5, {"direction": "along", "second_direction": "across", "second_fraction": 0.5, "second_phase": 0.0},
         0.5 / sqrt(1.25)),
    ],
)  # fmt: skip
def test_the_distance_grows_below_the_tests_and_with_direction_and_roundness(
    zeta: float, given: dict[str, Any], expected: float
) -> None:
    assert at(zeta, VibrationDirection(**given)).distance() == approx([expected], abs=1e-9)


def test_vibrations_within_the_plane_alone_are_predicted() -> None:
    assert is_predicted(ALONG)
    assert is_predicted(VibrationDirection(direction="across", second_direction="along", second_fraction=0.3))
    assert not is_predicted(VibrationDirection(direction="along", second_direction="normal", second_fraction=0.3))
    assert not is_predicted(VibrationDirection(direction="normal"))


def test_the_published_points_are_those_of_littmann_of_gutowski_and_of_luo() -> None:
    littmann, gutowski, luo = plane_rigs()
    assert littmann.name == "L-1 of Littmann et al."
    assert gutowski.name == "L-2 of Gutowski and Leus"
    assert luo.name == "M of Luo et al."
    # the numbers printed above the bars of figure 5b
    assert luo.friction_ratio == approx([0.154, 0.146, 0.140, 0.113, 0.104], abs=6e-4)
    assert luo.at.conditions.vibration_amplitude == approx([0.35e-6] * 5)
    assert luo.at.conditions.sliding_speed == approx([0.05e-3, 0.1e-3, 0.2e-3, 0.5e-3, 1e-3])
    assert (littmann.friction_ratio[0], gutowski.friction_ratio[0]) == approx((1.0, 0.1))
    assert gutowski.at.conditions.sliding_speed == approx([0.62e-3])
    assert gutowski.uncertainty == approx([0.05])
    assert gutowski.at.amplitude_spread == approx(0.8)  # its frequency is an assumption, its velocity is printed
    assert gutowski.at.conditions.velocity_ratio == approx([0.62 / 6.64])
    assert littmann.at.conditions.vibration_amplitude == approx([0.26 / (2 * pi * 60e3)])
    low, high = plane.tested_velocity_ratios()
    assert low == approx(LOWEST)
    assert high > 0.9
    assert gutowski.at.conditions.distance() == approx([0.0], abs=1e-9)


@mark.parametrize(("angle", "zeta"), [(0.0, 0.4), (1e-12, 0.4), (0.7, 0.05), (0.7, 0.9), (1.2, 1.7), (2.5, 0.3)])
def test_an_oblique_vibration_has_the_mean_direction_of_the_velocity(angle: float, zeta: float) -> None:
    turn = (np.arange(400_000) + 0.5) / 400_000 * 2 * pi
    along, across = zeta - cos(angle) * np.sin(turn), sin(angle) * np.sin(turn)
    mean = float(np.mean(along / np.hypot(along, across)))
    direction = VibrationDirection(vibration_direction=angle)
    assert float(coulomb_ratio(direction, velocity_ratio=zeta)) == approx(mean, abs=3e-4)


@mark.parametrize(("share", "is_said"), [(0.96, False), (0.94, True)])
def test_sliding_slower_than_tested_is_said_from_a_twentieth_on(share: float, is_said: bool) -> None:
    # 1/1.05 = 0.952
    found = plane_extrapolation(at(share * LOWEST, ALONG))
    assert bool(found) is is_said
    if is_said:
        assert found[0].endswith("v_r/(omega a) 0.00082, tested down to 0.00087")
    # on a circle the size is sqrt(2) amplitudes
    circle = VibrationDirection(direction="along", second_direction="across", second_fraction=1.0, second_phase=pi / 2)
    assert bool(plane_extrapolation(at(share * LOWEST * sqrt(2), circle))) is is_said


def test_how_far_the_law_was_tested_is_said_by_direction() -> None:
    along, across = (VibrationDirection(direction=word) for word in ("along", "across"))
    assert plane.tested_words(along).endswith("by springs on exponential heights tested with 7 published points")
    assert plane.tested_words(across).endswith("(springs on exponential heights, compared with no experiment)")
    first, slip, rate = plane_caveats(along, plane_posterior())
    assert (
        "7 published points of 3 sources along the sliding, L-1 of Littmann et al. (1.00 where the law has 1.00)"
        in first
    )
    assert "M of Luo et al. (0.10 to 0.15 where the law has 0.1" in first
    assert "at v_r/(omega a) of 0.00087 to 1" in first
    assert first.endswith("and with no others")
    assert "untested" not in slip
    assert "nm within a factor of" in slip
    assert rate == "of M of Luo et al. the friction ratio falls with the sliding speed, against every law without rate"
    other, wider, _ = plane_caveats(across, plane_posterior())
    assert "theory alone" in other
    assert wider.endswith("for an untested direction the interval is wider, by an assumption")
    assert exp(log(LOWEST)) == approx(8.74e-4, rel=1e-3)
