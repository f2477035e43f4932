"""Names of modes against the frequencies of slender bars in textbooks."""

import numpy as np
from pytest import approx

from sonolube.models.fem import Model, box_mesh, isotropic_medium, mode_names, natural_modes

STEEL = isotropic_medium(youngs_modulus=200e9, poisson_ratio=0.29, density=7900.0)


def test_named_modes_of_a_slender_bar_have_the_frequencies_of_the_textbook() -> None:
    mesh = box_mesh(length=0.1, width=0.012, thickness=0.008, divisions=(10, 3, 2))
    model = Model(mesh=mesh, media={"block": STEEL})
    modes = natural_modes(model, count=12)
    names = dict(zip(mode_names(model, modes, axis="x"), modes.natural_frequency, strict=True))
    assert [name for name in names if name.startswith("rigid")] == [f"rigid {k}" for k in range(1, 7)]
    assert names["axial 1"] == approx(np.sqrt(200e9 / 7900) / 0.2, rel=5e-3)
    # Bending 1 across the thin side after Euler and Bernoulli, which overestimates somewhat.
    bending = 4.730**2 / (2 * np.pi) * np.sqrt(200e9 / 7900 * 0.008**2 / 12) / 0.1**2
    assert names["bending 1"] == approx(bending, rel=0.05)
    # Torsion after Saint-Venant: J/(b t^3) = 0.196 and polar moment (b^2 + t^2)/12 at b/t = 1.5.
    shear = 200e9 / 2 / 1.29
    torsion = np.sqrt(shear * 0.196 * 0.008**2 * 12 / (7900 * (0.012**2 + 0.008**2))) / 0.2
    assert names["torsional 1"] == approx(torsion, rel=0.02)
