"""Resonances of a structure pressed against a spring, and the spring from one of them."""

from pathlib import Path

import numpy as np
import scipy.linalg
from pytest import approx, mark, raises

from sonolube.checks import Floats
from sonolube.errors import OutsideRange
from sonolube.models.dynamics import Structure, contact_resonances, stiffness_at_resonance
from sonolube.rig import read_rig

RIG = read_rig(Path(__file__).parents[3] / "examples" / "rigs" / "tribometer.toml")


def structure() -> Structure:
    assert RIG.structure is not None
    return RIG.structure


def by_scipy(parts: Structure, spring: float) -> Floats:
    """Moduli of the roots of the quadratic eigenvalue problem, linearised and solved as a generalised one by QZ."""
    n, zero = parts.coordinates, np.zeros_like(parts.mass_matrix)
    stiffness = parts.stiffness_matrix + spring * np.multiply.outer(parts.contact_vector, parts.contact_vector)
    left = np.block([[zero, np.eye(n)], [-stiffness, -parts.damping_matrix]])
    right = scipy.linalg.block_diag(np.eye(n), parts.mass_matrix)
    roots = scipy.linalg.eigvals(left, right)
    return np.sort(np.abs(roots[roots.imag > 1e-6])) / (2 * np.pi)


@mark.parametrize("spring", [3 / 2e-6, 3 / 0.7e-6, 1e8])
def test_frequencies_in_contact_are_those_of_the_quadratic_eigenvalue_problem(spring: float) -> None:
    assert contact_resonances(structure(), normal_stiffness=spring) == approx(by_scipy(structure(), spring), rel=1e-6)


@mark.parametrize(("mode", "spring"), [(0, 1.5e6), (0, 4e6), (1, 2e5), (1, 1.5e6), (1, 1e8), (2, 1.5e6), (2, 1e9)])
def test_the_stiffness_is_found_from_a_frequency_of_the_eigenvalue_problem(mode: int, spring: float) -> None:
    frequency = float(by_scipy(structure(), spring)[mode])
    assert stiffness_at_resonance(structure(), mode=mode, frequency=frequency) == approx(spring, rel=2e-4)


def test_a_small_shift_is_that_of_the_first_order() -> None:
    # one mass on a spring: exactly f^2 = f_0^2 + k/(4 pi^2 m), and k/(8 pi^2 m f_0) to first order
    mass, f_0, k = 0.105, 22e3, 1e4
    one = Structure(
        mass_matrix=np.array([[mass]]),
        damping_matrix=np.zeros((1, 1)),
        stiffness_matrix=np.array([[mass * (2 * np.pi * f_0) ** 2]]),
        drive_vector=np.zeros(1),
        contact_vector=np.ones(1),
        clamped_capacitance=0.0,
    )
    shift = float(contact_resonances(one, normal_stiffness=k)[0]) - f_0
    assert shift == approx(k / (8 * np.pi**2 * mass * f_0), rel=1e-4)
    exact = float(np.hypot(f_0, np.sqrt(k / mass) / (2 * np.pi)))
    assert stiffness_at_resonance(one, mode=0, frequency=exact) == approx(k, rel=1e-5)


def test_a_frequency_below_that_of_the_free_mode_is_refused() -> None:
    with raises(OutsideRange, match=r"150 Hz is not above the 152\.84\d+ Hz of mode 1 without contact"):
        stiffness_at_resonance(structure(), mode=1, frequency=150.0)


def test_a_frequency_that_not_even_a_rigid_contact_gives_is_refused() -> None:
    with raises(OutsideRange, match="reaches on a rigid contact"):
        stiffness_at_resonance(structure(), mode=0, frequency=150.0)
