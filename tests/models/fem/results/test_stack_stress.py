"""Stress of a stack and its rod: a bar in closed form, springs in parallel and in series, preload, refusals."""

from functools import cache
from typing import Any

import numpy as np
import pytest
from pytest import approx, raises

pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")

from tests.same import same

from sonolube.errors import InvalidInput
from sonolube.models.actuator import tightening_preload
from sonolube.models.fem.parts.transducers import Transducer, stack_transducer
from sonolube.models.fem.results.impedance_spectra import SupportedSpectrum, supported_spectra
from sonolube.models.fem.results.part_modes import longest_axis
from sonolube.models.fem.results.stack_stress import StackStress, stack_stress
from sonolube.models.fem.solver.model import Medium

MATERIALS = {"ceramic": "pic255", "metal": "stainless_steel_304"}
BAR = (("outer_radius", 6e-3), ("inner_radius", 3e-3), ("length", 60e-3))
OUTER, INNER, LENGTH, ROD = 15e-3, 6e-3, 20e-3, 4e-3
BOLTED = (
    *(("outer_radius", OUTER), ("inner_radius", INNER), ("length", LENGTH), ("rod_radius", ROD)),
    *(("back_length", 30e-3), ("front_length", 30e-3)),
)
STACK_AREA, ROD_AREA = np.pi * (OUTER**2 - INNER**2), np.pi * ROD**2


@cache
def solved(sizes: tuple[tuple[str, float], ...]) -> tuple[Transducer, SupportedSpectrum]:
    made: Any = stack_transducer
    transducer = made(**dict(sizes), **MATERIALS)
    spectra = supported_spectra(
        transducer,
        frequency=np.linspace(1e3, 30e3, 5),
        clamped_faces=(),
        axis_of=longest_axis,
        element_size=8e-3,
        relative_tolerance=0.02,
    )
    return transducer, spectra["free"]


def stress(sizes: tuple[tuple[str, float], ...], **arguments: Any) -> StackStress:
    transducer, spectrum = solved(sizes)
    shape = spectrum.port.shapes[0]
    return stack_stress(spectrum.port.model, shape, working_end=transducer.outputs["tip"], **arguments)


def axial_modulus(medium: Medium) -> float:
    return float(1 / np.linalg.inv(medium.elastic_stiffness)[2, 2])


def test_the_stress_of_a_half_wave_bar_is_that_of_its_closed_form() -> None:
    # u = a cos(pi x/L) has the stress E a pi/L in the middle; radial inertia and the field along x change it slightly
    _, spectrum = solved(BAR)
    medium = spectrum.port.model.media["ring1"]
    expected = axial_modulus(medium) * 1e-6 * np.pi / 60e-3
    found = stress(BAR, amplitude=1e-6)
    assert found.stack_amplitude == approx(expected, rel=0.025)
    assert stress(BAR, amplitude=3e-6).stack_amplitude == approx(3 * found.stack_amplitude)
    assert (found.rod_amplitude, found.rod_mean, found.stack_mean, found.rod_share) == (0, 0, 0, 0)


def test_the_share_of_the_rod_lies_between_springs_in_parallel_and_a_rod_with_soft_seats() -> None:
    # a rod bonded to half-spaces at both ends is longer by two flat punches, each of pi a (1 - nu^2)/2
    _, spectrum = solved(BOLTED)
    media = spectrum.port.model.media
    stack = axial_modulus(media["ring1"]) * STACK_AREA / LENGTH
    rod = axial_modulus(media["rod"]) * ROD_AREA
    seated = rod / (LENGTH + np.pi * ROD * (1 - 0.29**2))
    low, high = seated / (seated + stack), rod / LENGTH / (rod / LENGTH + stack)
    assert low < stress(BOLTED, amplitude=1e-6).rod_share < high


def test_the_preload_stands_in_both_bodies_with_opposite_forces() -> None:
    loaded, bare = stress(BOLTED, amplitude=1e-6, preload=20e3), stress(BOLTED, amplitude=1e-6)
    assert loaded.stack_mean == approx(-20e3 / STACK_AREA, rel=5e-3)
    assert loaded.rod_mean == approx(20e3 / ROD_AREA, rel=5e-3)
    same((loaded.stack_amplitude, loaded.rod_amplitude), (bare.stack_amplitude, bare.rod_amplitude))
    same(loaded.highest_stack_stress, loaded.stack_mean + loaded.stack_amplitude)
    same(loaded.highest_rod_stress, loaded.rod_mean + loaded.rod_amplitude)
    quarter = stress(BOLTED, amplitude=1e-6, preload=20e3, copies=4)
    assert 4 * quarter.rod_mean == approx(loaded.rod_mean)


def test_a_preload_without_a_rod_and_negative_values_are_refused() -> None:
    with raises(InvalidInput, match="no rod that could preload its stack; give rod_radius"):
        stress(BAR, amplitude=1e-6, preload=1.0)
    with raises(InvalidInput, match="amplitude must not be negative"):
        stress(BAR, amplitude=-1e-6)
    with raises(InvalidInput, match="preload must not be negative"):
        stress(BOLTED, amplitude=1e-6, preload=-1.0)


def test_a_torque_tensions_a_bolt_by_the_nut_factor() -> None:
    # 40 N m on M8 with K = 0.2: 25 kN
    assert tightening_preload(torque=40.0, thread_diameter=8e-3) == approx(25e3)
    assert tightening_preload(torque=40.0, thread_diameter=8e-3, nut_factor=0.4) == approx(12.5e3)
    with raises(InvalidInput, match="nut_factor"):
        tightening_preload(torque=1.0, thread_diameter=8e-3, nut_factor=0.0)
