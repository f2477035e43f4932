from dataclasses import replace

import numpy as np
from hypothesis import assume, given, strategies as st
from pytest import approx, raises

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.models.actuator import PiezoStack, circuit_admittance, circuit_resonances
from sonolube.models.dynamics.chain import (
    GROUND,
    LumpedChain,
    Spring,
    chain_structure,
    modal_structure,
    pin_on_disc_chain,
)
from sonolube.models.dynamics.linear import equivalent_circuit, modes, poles, static_contact
from sonolube.models.dynamics.structure import (
    Structure,
    contact_receptance,
    drive_receptance,
    electrical_admittance,
    with_contact_spring,
)

STACK = PiezoStack(
    free_capacitance=360e-9, free_stroke_per_volt=62 * 140e-12, stack_stiffness=2e9, stack_damping=30.0, stack_mass=0.07
)
CHAIN = pin_on_disc_chain(STACK, tip_mass=0.15, reaction_mass=0.28, arm_mass=0.5, arm_stiffness=2e5, arm_damping=20.0)
RIG = chain_structure(CHAIN)
HELD = chain_structure(replace(CHAIN, springs=(*CHAIN.springs, Spring(between=("arm", GROUND), spring_stiffness=1e5))))


@st.composite
def proportional(draw: st.DrawFn) -> Structure:
    """Return any structure with Rayleigh damping, a combination of mass and stiffness matrix."""
    n = draw(st.integers(1, 4))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    roots, springs = rng.normal(size=(2, n, n))
    mass = roots @ roots.T + 0.1 * np.eye(n)
    stiffness = 1e8 * (springs @ springs.T + 0.01 * np.eye(n))
    return Structure(
        mass_matrix=mass,
        damping_matrix=draw(st.floats(0, 100)) * mass + draw(st.floats(0, 1e-5)) * stiffness,
        stiffness_matrix=stiffness,
        drive_vector=rng.normal(size=n),
        contact_vector=rng.normal(size=n),
        clamped_capacitance=1e-8 + 1e-7 * rng.random(),
    )


def test_two_free_masses_vibrate_at_the_frequency_of_their_reduced_mass() -> None:
    pair = chain_structure(
        LumpedChain(
            masses={"near": 0.15, "far": 0.28},
            springs=(),
            dampers=(),
            stack=STACK,
            stack_between=("near", "far"),
            contact="near",
        )
    )
    found = modes(pair)
    reduced = 0.15 * 0.35 / 0.5
    assert found.rigid.tolist() == [True, False]
    assert found.natural_frequency == approx(np.array([0, np.sqrt(2e9 / reduced) / (2 * np.pi)]))
    assert found.damping_ratio[1] == approx(30 / (2 * np.sqrt(2e9 * reduced)))


def test_the_rig_has_a_rigid_mode_one_near_a_hundred_hertz_and_one_at_22_kilohertz() -> None:
    found = modes(RIG)
    assert found.rigid.tolist() == [True, False, False]
    # the arm against all the rest on its spring
    sway = np.sqrt(2e5 * (1 / 0.5 + 1 / 0.5)) / (2 * np.pi)
    assert found.natural_frequency == approx(np.array([0.0, sway, 22e3]), rel=0.002)


@given(structure=proportional())
def test_shapes_are_orthogonal_in_masses_and_in_stiffness(structure: Structure) -> None:
    found = modes(structure)
    squares = (2 * np.pi * found.natural_frequency) ** 2
    n = structure.coordinates
    assert found.shapes.T @ structure.mass_matrix @ found.shapes == approx(np.eye(n), abs=1e-9)
    stiffness = found.shapes.T @ structure.stiffness_matrix @ found.shapes
    assert stiffness == approx(np.diag(squares), abs=1e-9 * squares[-1])


@given(structure=proportional(), seed=st.integers(0, 2**32 - 1))
def test_every_rayleigh_quotient_lies_between_the_extreme_natural_frequencies(structure: Structure, seed: int) -> None:
    x = np.random.default_rng(seed).normal(size=structure.coordinates)
    quotient = (x @ structure.stiffness_matrix @ x) / (x @ structure.mass_matrix @ x)
    lowest, highest = (2 * np.pi * modes(structure).natural_frequency[[0, -1]]) ** 2
    assert lowest * (1 - 1e-9) <= quotient <= highest * (1 + 1e-9)


@given(structure=proportional(), stiffness=st.floats(1, 1e9))
def test_a_spring_at_the_contact_raises_natural_frequencies_up_to_the_next_one(
    structure: Structure, stiffness: float
) -> None:
    free = modes(structure).natural_frequency
    sprung = modes(with_contact_spring(structure, normal_stiffness=stiffness)).natural_frequency
    assert np.all(sprung >= free * (1 - 1e-9))
    assert np.all(sprung[:-1] <= free[1:] * (1 + 1e-9))  # nor past the next one, with a single spring


@given(structure=proportional())
def test_with_proportional_damping_each_pair_of_poles_belongs_to_a_mode(structure: Structure) -> None:
    found = modes(structure)
    assume(np.all(found.damping_ratio < 0.99))
    omega = 2 * np.pi * found.natural_frequency
    upper = poles(structure)
    upper = upper[upper.imag > 0]
    expected = -found.damping_ratio * omega + 2j * np.pi * found.damped_frequency
    order = np.argsort(np.abs(upper))
    assert upper[order] == approx(expected, rel=1e-6, abs=1e-6 * omega[-1])


def test_every_pole_solves_the_equation_of_free_motion() -> None:
    stiff = with_contact_spring(RIG, normal_stiffness=1.5e6, contact_damping=50.0)
    for exponent in poles(stiff):
        matrix = exponent**2 * stiff.mass_matrix + exponent * stiff.damping_matrix + stiff.stiffness_matrix
        singular = np.linalg.svd(matrix, compute_uv=False)
        assert singular[-1] < 1e-9 * singular[0]


def test_poles_lie_in_the_left_half_plane_but_for_two_at_zero_of_a_floating_rig() -> None:
    exponents = poles(RIG)
    assert exponents.real.max() < 1e-6
    assert np.sum(np.abs(exponents) < 1e-6) == 2


def test_weak_damping_gives_poles_the_modes_damping_ratios_to_first_order() -> None:
    weak = np.abs(poles(RIG).real[-1]) / np.abs(poles(RIG)[-1])
    assert modes(RIG).damping_ratio[-1] == approx(weak, rel=1e-4)
    assert modes(RIG).damping_ratio[1] == approx(20 * 4 / (2 * 2 * np.pi * 142.35), rel=1e-3)


def test_an_overdamped_mode_has_two_real_poles() -> None:
    creeping = modal_structure(
        frequencies=[100.0],
        damping_ratios=2.0,
        drive_participation=[1.0],
        contact_participation=[1.0],
        clamped_capacitance=1e-9,
    )
    assert modes(creeping).damped_frequency == 0
    omega = 2 * np.pi * 100
    assert np.sort(poles(creeping).real) == approx(omega * np.array([-2 - np.sqrt(3), -2 + np.sqrt(3)]))


# -- static


def test_a_floating_rig_has_no_static_stiffness_and_no_static_displacement() -> None:
    found = static_contact(RIG)
    assert found.static_stiffness == 0
    assert found.displacement_per_volt is None


def test_the_static_stiffness_of_a_grounded_rig_is_that_of_its_springs_in_series() -> None:
    found = static_contact(HELD)
    assert found.static_stiffness == approx(1 / (1 / 2e9 + 1 / 2e5 + 1 / 1e5))
    assert found.displacement_per_volt == approx(-62 * 140e-12)


@given(structure=proportional())
def test_the_static_stiffness_is_the_low_frequency_limit_of_the_receptance(structure: Structure) -> None:
    found = static_contact(structure)
    slow = 1e-4 * float(modes(structure).natural_frequency[0])
    compliance = complex(contact_receptance(structure, frequency=slow)).real
    assert 1 / found.static_stiffness == approx(compliance, rel=1e-4)
    drive = complex(drive_receptance(structure, frequency=slow)).real
    assert found.displacement_per_volt == approx(drive, rel=1e-3, abs=1e-6 * abs(compliance))


# -- electrical


@given(structure=proportional(), frequencies=st.lists(st.floats(10, 1e5), min_size=1, max_size=5))
def test_with_proportional_damping_the_equivalent_circuit_has_the_admittance_of_the_structure(
    structure: Structure, frequencies: list[float]
) -> None:
    circuit = circuit_admittance(equivalent_circuit(structure), frequency=frequencies)
    exact = electrical_admittance(structure, frequency=frequencies)
    assert np.all(np.abs(circuit - exact) <= 1e-9 * np.abs(exact) + 1e-15)


def test_the_impedance_of_the_rig_has_its_minimum_at_22_kilohertz_and_its_maximum_above() -> None:
    # D figure 3.12 in kind
    f = np.linspace(15e3, 40e3, 25001)
    size = np.abs(1 / electrical_admittance(RIG, frequency=f))
    dip, peak = f[size.argmin()], f[size.argmax()]
    assert dip == approx(22e3, rel=0.002)
    assert peak == approx(dip / np.sqrt(1 - STACK.derived_coupling_factor**2), rel=0.002)
    found = circuit_resonances(equivalent_circuit(RIG))
    assert found.series_frequency[-1] == approx(dip, rel=1e-4)
    assert found.parallel_frequency[-1] == approx(peak, rel=1e-4)
    assert found.mechanical_quality_factor[-1] == approx(1 / (2 * modes(RIG).damping_ratio[-1]))


def test_parallel_resonances_are_those_of_the_open_circuited_stack() -> None:
    opened = chain_structure(
        replace(
            CHAIN,
            stack=replace(
                STACK, stack_stiffness=2e9 / (1 - STACK.derived_coupling_factor**2), free_stroke_per_volt=1e-12
            ),
        )
    )
    assert circuit_resonances(equivalent_circuit(RIG)).parallel_frequency == approx(
        modes(opened).natural_frequency[1:], rel=1e-6
    )


def shape_at(index: int) -> Floats:
    return modes(RIG).shapes[:, index]


def test_the_ultrasonic_mode_keeps_the_centre_of_mass_and_does_not_move_the_arm() -> None:
    ringing = shape_at(2)
    assert RIG.mass_matrix.diagonal() @ ringing == approx(0, abs=1e-9)
    assert abs(ringing[2]) < 1e-4 * abs(ringing[0])
    assert ringing[1] / ringing[0] == approx(-0.15 / 0.35, rel=1e-3)


def test_a_mode_with_a_node_at_the_stack_has_no_motional_branch() -> None:
    silent = modal_structure(
        frequencies=[1e3, 2e3],
        damping_ratios=0.01,
        drive_participation=[0.0, 0.1],
        contact_participation=[1.0, 1.0],
        clamped_capacitance=1e-9,
    )
    assert len(equivalent_circuit(silent).branches) == 1
    assert circuit_resonances(equivalent_circuit(silent)).series_frequency == approx(2e3)


def test_a_structure_without_capacitance_has_no_equivalent_circuit() -> None:
    with raises(InvalidInput, match=r"parallel_capacitance must be positive, got 0\.0 F"):
        equivalent_circuit(replace(RIG, clamped_capacitance=0.0))
