"""Electromechanical coupling factors of a piezoelectric ceramic from its constants."""

import numpy as np

from sonolube.facts.materials import PiezoCeramic


def coupling_factors(ceramic: PiezoCeramic) -> dict[str, float]:
    """Coupling factors of a ceramic by the names of the catalogue, as magnitudes; IEEE Std 176, section 5."""
    s, d, eps_t = ceramic.compliance_short_circuit, ceramic.charge_constants, ceramic.permittivity_free
    e33 = ceramic.stress_constants[2, 2]
    c33_eps_s33 = ceramic.stiffness_short_circuit[2, 2] * ceramic.permittivity_clamped[2]
    squares = {
        "coupling_factor_31": d[2, 0] ** 2 / (s[0, 0] * eps_t[2]),
        "coupling_factor_33": d[2, 2] ** 2 / (s[2, 2] * eps_t[2]),
        "coupling_factor_15": d[0, 4] ** 2 / (s[4, 4] * eps_t[0]),
        "coupling_factor_thickness": e33**2 / (c33_eps_s33 + e33**2),
        "coupling_factor_planar": 2 * d[2, 0] ** 2 / ((s[0, 0] + s[0, 1]) * eps_t[2]),
    }
    return {name: float(np.sqrt(square)) for name, square in squares.items()}
