"""Initial guess of an exponential contact against Bessel functions."""

import numpy as np
import pytest
from scipy.special import ive

from sonolube.models.dynamics import ExponentialGap, Structure
from sonolube.models.dynamics.harmonic_balance.batch import BatchProblem
from sonolube.models.dynamics.harmonic_balance.equations import CONTACT_PER_FORCE, pole_residue_model, receptance
from sonolube.models.dynamics.harmonic_balance.initial_guess import initial_guess

LENGTH = 2e-6


@pytest.mark.parametrize("held", [1e-6, 1e-2, 1.0, 1e3])
def test_mean_and_amplitude_on_a_grounded_structure_satisfy_the_equations_of_a_single_harmonic(held: float) -> None:
    load = np.array([0.1, 1.0, 10.0, 100.0])
    stiffness = held * load[0] / LENGTH  # of the spring to the ground, from far below the contact's to far above
    structure = Structure(
        mass_matrix=np.diag([0.11, 2.5]),
        damping_matrix=np.diag([30.0, 30.0]),
        stiffness_matrix=2e9 * np.array([[1.0, -1.0], [-1.0, 1.0]]) + np.diag([stiffness, 0.0]),
        drive_vector=17 * np.array([-1.0, 1.0]),
        contact_vector=np.array([1.0, 0.0]),
        clamped_capacitance=2e-7,
    )
    model = pole_residue_model(structure)
    omega, static_displacement = np.full(4, 2 * np.pi * 15e3), np.array([0.0, 3e-7, -4e-7, 0.0])
    free = np.array([[0.1e-6], [1e-6], [4e-6], [12e-6]], dtype=complex)
    problem = BatchProblem(
        model=model,
        gap_law=ExponentialGap(decay_length=LENGTH),
        omega=omega,
        load=load,
        voltage=np.ones((4, 1), dtype=complex),
        static_displacement=static_displacement,
        minimum_harmonics=1,
        upper_branch=False,
        stability=False,
        tolerance=1e-6,
    )
    guess = initial_guess(problem, free, upper_branch=False)
    amplitude, mean = np.abs(guess.harmonic), guess.mean
    beta = amplitude / LENGTH
    force = load + model.static_stiffness * (mean - static_displacement)
    assert force == pytest.approx(load * np.exp(beta - mean / LENGTH) * ive(0, beta), rel=1e-4)
    opposing = 2 * force * ive(1, beta) / ive(0, beta)
    swing = np.abs(amplitude + receptance(model, CONTACT_PER_FORCE, omega) * opposing)
    assert swing == pytest.approx(np.abs(free[:, 0]), rel=1e-3)
