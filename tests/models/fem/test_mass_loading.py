"""Mass loading against the roots of the frequency equation of a bar with an end mass."""

import numpy as np
import pytest
from pytest import approx
from scipy.optimize import brentq

from sonolube.models.fem import (
    Model,
    box_mesh,
    face_residual_compliance,
    isotropic_medium,
    mass_loaded_frequencies,
    mode_names,
    natural_modes,
)
from sonolube.models.fem.solver.modes import spectral_shift
from sonolube.models.fem.solver.system import assemble_system, shift_invert_solver

E, NU, RHO = 200e9, 0.3, 8000.0

SLIM = isotropic_medium(youngs_modulus=E, poisson_ratio=0.0, density=RHO)


def bar(length: float, cells: int) -> Model:
    mesh = box_mesh(length=length, width=0.004, thickness=0.006, divisions=(cells, 1, 1))
    return Model(mesh=mesh, media={"block": SLIM})


@pytest.mark.parametrize("mass", [0.0, 2e-3, 20e-3])
def test_a_bar_with_an_end_mass_has_the_root_of_its_frequency_equation(mass: float) -> None:
    # tan kL = -(m/m_bar) kL for a bar with one end free and a mass on the other; no Poisson ratio, so exactly so.
    model = bar(0.1, 12)
    modes = natural_modes(model, count=24)
    row = mode_names(model, modes, axis="x").index("axial 1")
    share = mass / (RHO * 0.1 * 0.004 * 0.006)
    root = brentq(lambda x: np.sin(x) + share * x * np.cos(x), np.pi / 2 + 1e-9, np.pi + 1e-9)
    expected = root * np.sqrt(E / RHO) / (2 * np.pi * 0.1)
    equations = assemble_system(model)
    inverse = shift_invert_solver(model, equations, shift=spectral_shift(model))
    compliance = face_residual_compliance(modes, model, equations, inverse=inverse, face="+x", along="x")
    found = mass_loaded_frequencies(modes, model, face="+x", along="x", tool_mass=mass, residual_compliance=compliance)
    assert found[row] == approx(expected, rel=1e-3)
