from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.models.actuator import dissipated_power
from sonolube.models.dynamics.structure import (
    Structure,
    contact_receptance,
    drive_receptance,
    electrical_admittance,
    with_contact_spring,
)

ONE_MASS = Structure(
    mass_matrix=np.array([[0.1]]),
    damping_matrix=np.array([[20.0]]),
    stiffness_matrix=np.array([[2e8]]),
    drive_vector=np.array([1.5]),
    contact_vector=np.array([1.0]),
    clamped_capacitance=200e-9,
)


@st.composite
def structures(draw: st.DrawFn) -> Structure:
    """Return any passive structure with up to four coordinates, some of them floating."""
    n = draw(st.integers(1, 4))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    springs, dampers = rng.normal(size=(2, draw(st.integers(1, 4)), n))
    roots = rng.normal(size=(n, n))
    return Structure(
        mass_matrix=roots @ roots.T + 0.1 * np.eye(n),
        damping_matrix=10 * dampers.T @ dampers,
        stiffness_matrix=1e8 * springs.T @ springs,
        drive_vector=rng.normal(size=n),
        contact_vector=rng.normal(size=n),
        clamped_capacitance=1e-7 * rng.random(),
    )


frequencies = st.floats(10, 1e5)


def test_one_mass_on_a_spring_has_the_textbook_responses() -> None:
    f = np.array([1e3, 7.117e3, 50e3])
    omega = 2 * np.pi * f
    compliance = 1 / (2e8 - 0.1 * omega**2 + 20j * omega)
    assert contact_receptance(ONE_MASS, frequency=f) == approx(compliance)
    assert drive_receptance(ONE_MASS, frequency=f) == approx(1.5 * compliance)
    assert electrical_admittance(ONE_MASS, frequency=f) == approx(1j * omega * (200e-9 + 1.5**2 * compliance))


@given(structure=structures(), frequency=frequencies)
def test_displacement_per_volt_is_charge_per_force(structure: Structure, frequency: float) -> None:
    swapped = replace(
        structure, drive_vector=structure.contact_vector, contact_vector=structure.drive_vector
    )  # now the contact pushes, and what moves at the drive is its charge
    forth = complex(drive_receptance(structure, frequency=frequency))
    back = complex(drive_receptance(swapped, frequency=frequency))
    assert abs(forth - back) <= 1e-6 * abs(forth) + 1e-18


@given(structure=structures(), frequency=frequencies)
def test_the_electrical_power_is_dissipated_by_the_dampers(structure: Structure, frequency: float) -> None:
    omega = 2 * np.pi * frequency
    dynamic = structure.stiffness_matrix - omega**2 * structure.mass_matrix + 1j * omega * structure.damping_matrix
    velocity = 1j * omega * np.linalg.solve(dynamic, 3.0 * structure.drive_vector)
    heat = 0.5 * (velocity.conj() @ structure.damping_matrix @ velocity).real
    y = electrical_admittance(structure, frequency=frequency)
    scale = float(1e-9 * (heat + abs(complex(y))))
    assert float(dissipated_power(admittance=y, voltage_amplitude=3.0)) == approx(heat, rel=1e-5, abs=scale)


@given(structure=structures(), frequency=frequencies)
def test_every_structure_is_passive_at_both_ports(structure: Structure, frequency: float) -> None:
    y = complex(electrical_admittance(structure, frequency=frequency))
    mobility = 2j * np.pi * frequency * complex(contact_receptance(structure, frequency=frequency))
    assert y.real >= -1e-9 * abs(y)
    assert mobility.real >= -1e-9 * abs(mobility)


@given(structure=structures(), stiffness=st.floats(0, 1e9), damping=st.floats(0, 100), frequency=frequencies)
def test_a_spring_at_the_contact_adds_to_the_inverse_receptance(
    structure: Structure, stiffness: float, damping: float, frequency: float
) -> None:
    sprung = with_contact_spring(structure, normal_stiffness=stiffness, contact_damping=damping)
    free = complex(contact_receptance(structure, frequency=frequency))
    held = complex(contact_receptance(sprung, frequency=frequency))
    added = stiffness + 2j * np.pi * frequency * damping
    assert held * (1 + free * added) == approx(free, rel=1e-5, abs=1e-5 * abs(held) * (1 + abs(free * added)))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"mass_matrix": np.array([[-0.1]])}, r"mass_matrix must be positive definite, got an eigenvalue of -0\.1"),
        ({"stiffness_matrix": np.array([[-1.0]])}, r"stiffness_matrix must be positive semidefinite"),
        ({"damping_matrix": np.eye(2)}, r"damping_matrix must be symmetric of shape \(1, 1\), got shape \(2, 2\)"),
        ({"drive_vector": np.ones(2)}, r"drive_vector must have shape \(1,\), got \(2,\)"),
        ({"contact_vector": np.array([np.nan])}, r"contact_vector must be finite, got nan"),
        ({"clamped_capacitance": -1e-9}, r"clamped_capacitance must not be negative, got -1e-09 F"),
    ],
)
def test_an_inconsistent_structure_is_refused(changes: dict[str, Any], message: str) -> None:
    with raises(InvalidInput, match=message):
        replace(ONE_MASS, **changes)


def test_a_matrix_that_is_not_symmetric_is_refused() -> None:
    with raises(InvalidInput, match=r"stiffness_matrix must be symmetric"):
        Structure(
            mass_matrix=np.eye(2),
            damping_matrix=np.zeros((2, 2)),
            stiffness_matrix=np.array([[2.0, 1.0], [0.0, 2.0]]),
            drive_vector=np.zeros(2),
            contact_vector=np.ones(2),
            clamped_capacitance=0.0,
        )


def test_frequency_zero_is_refused() -> None:
    with raises(InvalidInput, match=r"frequency must be positive, got 0\.0 Hz"):
        electrical_admittance(ONE_MASS, frequency=[1e3, 0.0])


def test_structures_are_equal_where_all_their_numbers_are() -> None:
    again = replace(ONE_MASS, mass_matrix=np.array([[0.1]]))
    assert (again, hash(again)) == (ONE_MASS, hash(ONE_MASS))
    for name in ("mass_matrix", "damping_matrix", "stiffness_matrix", "drive_vector", "contact_vector"):
        assert replace(ONE_MASS, **{name: 1.001 * getattr(ONE_MASS, name)}) != ONE_MASS
    assert replace(ONE_MASS, clamped_capacitance=201e-9) != ONE_MASS
    assert replace(ONE_MASS, load_vector=np.array([1.0])) != ONE_MASS
