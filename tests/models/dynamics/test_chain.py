from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st
from pytest import approx, raises
from scipy.linalg import eigvalsh

from sonolube.errors import InvalidInput, SonolubeError, UnknownName
from sonolube.models.actuator import PiezoStack
from sonolube.models.dynamics.chain import (
    GROUND,
    Damper,
    LumpedChain,
    Spring,
    chain_structure,
    modal_structure,
    pin_on_disc_chain,
)
from sonolube.models.dynamics.linear import modes
from sonolube.models.dynamics.structure import (
    contact_receptance,
    drive_receptance,
    electrical_admittance,
    with_contact_spring,
)

STACK = PiezoStack(
    free_capacitance=360e-9, free_stroke_per_volt=62 * 140e-12, stack_stiffness=2e9, stack_damping=30.0, stack_mass=0.07
)
CHAIN = pin_on_disc_chain(
    STACK, tip_mass=0.15, reaction_mass=0.28, arm_mass=0.5, arm_stiffness=2e5, arm_damping=20.0, tip_damping=3.0
)
RIG = chain_structure(CHAIN)

masses, stiffnesses, dampings = st.floats(0.01, 5), st.floats(1e3, 1e8), st.floats(0, 200)


def test_the_matrices_of_the_rig_are_those_of_figure_3_8_with_all_heights_upwards() -> None:
    assert RIG.mass_matrix == approx(np.diag([0.15, 0.35, 0.5]))
    k_p, k_2 = 2e9, 2e5
    assert RIG.stiffness_matrix == approx(np.array([[k_p, -k_p, 0], [-k_p, k_p + k_2, -k_2], [0, -k_2, k_2]]))
    assert RIG.damping_matrix == approx(np.array([[33.0, -30, 0], [-30, 50, -20], [0, -20, 20]]))
    assert RIG.drive_vector == approx(62 * 140e-12 * 2e9 * np.array([-1, 1, 0]))
    assert RIG.contact_vector == approx(np.array([1, 0, 0]))


@given(m1=masses, m2=masses, m3=masses, k2=stiffnesses, k1=st.floats(0, 1e9))
def test_the_dissertations_matrices_have_the_same_natural_frequencies(
    m1: float, m2: float, m3: float, k2: float, k1: float
) -> None:
    chain = pin_on_disc_chain(STACK, tip_mass=m1, reaction_mass=m2, arm_mass=m3, arm_stiffness=k2, arm_damping=20.0)
    ours = modes(with_contact_spring(chain_structure(chain), normal_stiffness=k1)).natural_frequency
    k_p = 2e9
    printed = np.array([[k_p + k1, k_p, 0], [k_p, k_p + k2, -k2], [0, -k2, k2]])  # D 3.31: x1 points downwards
    theirs = np.sqrt(np.maximum(eigvalsh(printed, np.diag([m1, m2 + 0.07, m3])), 0)) / (2 * np.pi)
    # there x2 and x3 are heights and x1 a depth, which reverses the sign of the coupling k_p alone
    assert ours == approx(theirs, rel=1e-6, abs=1e-5 * theirs[-1])


@given(
    m1=masses,
    m2=masses,
    m3=masses,
    k2=stiffnesses,
    c2=dampings,
    c1=dampings,
    k1=st.floats(0, 1e9),
    frequency=st.floats(10, 1e5),
)
def test_the_corrected_impedances_of_the_dissertation_give_the_admittance_of_the_structure(
    m1: float, m2: float, m3: float, k2: float, c2: float, c1: float, k1: float, frequency: float
) -> None:
    # D 3.34 to 3.41 with open-circuit stiffness in 3.37, the stack once in 3.39, m0 with m2, no F_N in 3.40
    s = 2j * np.pi * frequency
    clamped = STACK.clamped_capacitance
    z_stack = 2e9 / (1 - STACK.derived_coupling_factor**2) / s + 30.0
    z_arm = 1 / (1 / (m3 * s) + 1 / (c2 + k2 / s))
    z_load = 1 / (1 / (m1 * s + c1 + k1 / s) + 1 / ((m2 + 0.07) * s + z_arm))
    transduction = 62 * 140e-12 * 2e9 / (clamped * s)
    impedance = 1 / (clamped * s) - transduction**2 / (z_stack + z_load)

    chain = pin_on_disc_chain(
        STACK, tip_mass=m1, reaction_mass=m2, arm_mass=m3, arm_stiffness=k2, arm_damping=c2, tip_damping=c1
    )
    structure = with_contact_spring(chain_structure(chain), normal_stiffness=k1)
    assert complex(electrical_admittance(structure, frequency=frequency)) == approx(1 / impedance, rel=1e-5)


def test_a_spring_to_the_ground_adds_its_stiffness() -> None:
    chain = LumpedChain(
        masses={"pin": 0.2},
        springs=(Spring(between=("pin", GROUND), spring_stiffness=3e6),),
        dampers=(Damper(between=(GROUND, "pin"), viscous_damping=5.0),),
        stack=STACK,
        stack_between=(GROUND, "pin"),
        contact="pin",
    )
    structure = chain_structure(chain)
    assert structure.stiffness_matrix == approx(2e9 + 3e6)
    assert structure.damping_matrix == approx(35.0)
    assert structure.mass_matrix == approx(0.27)
    assert structure.drive_vector == approx(62 * 140e-12 * 2e9)


def test_a_chain_without_links_to_the_ground_conserves_momentum() -> None:
    # forces within the chain cannot move its centre of mass, whatever the voltage
    floating = chain_structure(replace(CHAIN, dampers=CHAIN.dampers[:1]))
    assert floating.stiffness_matrix.sum(axis=0) == approx(np.zeros(3), abs=1e-3)
    assert floating.damping_matrix.sum(axis=0) == approx(np.zeros(3), abs=1e-9)
    assert floating.drive_vector.sum() == approx(0, abs=1e-9)


@given(order=st.permutations(["tip", "reaction", "arm"]), frequency=st.floats(10, 1e5))
def test_the_order_of_the_masses_does_not_change_the_responses(order: list[str], frequency: float) -> None:
    shuffled = chain_structure(replace(CHAIN, masses={name: CHAIN.masses[name] for name in order}))
    for response in (electrical_admittance, drive_receptance, contact_receptance):
        same = complex(response(RIG, frequency=frequency))
        assert complex(response(shuffled, frequency=frequency)) == approx(same, rel=1e-6)


def test_the_modal_structure_has_the_responses_of_the_original_one() -> None:
    undamped = chain_structure(
        pin_on_disc_chain(
            replace(STACK, stack_damping=0.0),
            tip_mass=0.15,
            reaction_mass=0.28,
            arm_mass=0.5,
            arm_stiffness=2e5,
            arm_damping=0.0,
        )
    )
    found = modes(undamped)
    handed = modal_structure(
        frequencies=found.natural_frequency,
        damping_ratios=0.0,
        drive_participation=undamped.drive_vector @ found.shapes,
        contact_participation=undamped.contact_vector @ found.shapes,
        clamped_capacitance=undamped.clamped_capacitance,
    )
    f = np.array([50.0, 300.0, 10e3, 21e3, 60e3])
    for response in (electrical_admittance, drive_receptance, contact_receptance):
        assert response(handed, frequency=f) == approx(response(undamped, frequency=f), rel=1e-6)


def test_the_resonant_amplification_is_half_the_inverse_damping_ratio() -> None:
    one = modal_structure(
        frequencies=[1e3],
        damping_ratios=[0.01],
        drive_participation=[1.0],
        contact_participation=[1.0],
        clamped_capacitance=1e-9,
    )
    static = 1 / (2 * np.pi * 1e3) ** 2
    assert abs(complex(contact_receptance(one, frequency=1e3))) == approx(50 * static)


@pytest.mark.parametrize(
    ("changes", "error", "message"),
    [
        (
            {"masses": {"tip": -0.1, "reaction": 1.0, "arm": 1.0}},
            InvalidInput,
            r"mass of tip must be positive, got -0\.1",
        ),
        ({"contact": "tipp"}, UnknownName, r"unknown body 'tipp'; did you mean tip\?"),
        ({"stack_between": ("tip", "tip")}, InvalidInput, r"a stack needs two different ends, got 'tip', 'tip'"),
        ({"stack_between": ("tip", "recation")}, UnknownName, r"unknown body 'recation'; did you mean reaction\?"),
        ({"masses": {"ground": 1.0}}, InvalidInput, r'"ground" has no mass'),
        ({"contact": "ground"}, UnknownName, r"unknown body 'ground'"),
    ],
)
def test_an_inconsistent_chain_is_refused(changes: dict[str, object], error: type[SonolubeError], message: str) -> None:
    with raises(error, match=message):
        replace(CHAIN, **changes)  # type: ignore[arg-type]


def test_invalid_springs_and_dampers_are_refused() -> None:
    with raises(InvalidInput, match=r"spring_stiffness must be positive, got 0\.0 N/m"):
        Spring(between=("a", "b"), spring_stiffness=0)
    with raises(InvalidInput, match=r"viscous_damping must not be negative, got -1\.0 N s/m"):
        Damper(between=("a", "b"), viscous_damping=-1)
    with raises(InvalidInput, match=r"a spring needs two different ends, got 'a', 'a'"):
        Spring(between=("a", "a"), spring_stiffness=1)


def test_invalid_masses_of_the_rig_are_refused_by_name() -> None:
    with raises(InvalidInput, match=r"arm_mass must be positive, got -0\.5 kg"):
        pin_on_disc_chain(STACK, tip_mass=0.15, reaction_mass=0.28, arm_mass=-0.5, arm_stiffness=2e5, arm_damping=20.0)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"frequencies": [-1.0, 2.0]}, r"frequencies must not be negative"),
        ({"frequencies": 3.0}, r"frequencies must have one axis"),
        ({"damping_ratios": [0.1]}, r"damping_ratios must have shape \(2,\) or \(\), got \(1,\)"),
        ({"drive_participation": [1.0]}, r"drive_vector must have shape \(2,\), got \(1,\)"),
    ],
)
def test_inconsistent_modal_data_are_refused(changes: dict[str, object], message: str) -> None:
    two = {
        "frequencies": [0.0, 1e3],
        "damping_ratios": 0.01,
        "drive_participation": [0.0, 1.0],
        "contact_participation": [1.0, 1.0],
        "clamped_capacitance": 1e-9,
    }
    with raises(InvalidInput, match=message):
        modal_structure(**(two | changes))  # type: ignore[arg-type]
