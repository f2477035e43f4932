"""Three-mass chain of the modified tribometer: tip, stack and body on its arm."""

import numpy as np

from sonolube.models.dynamics.structure import Structure

_STACK, _ARM = np.array([-1.0, 1.0, 0.0]), np.array([0.0, 1.0, -1.0])
TRIBOMETER = Structure(
    mass_matrix=np.diag([0.15, 0.35, 0.5]),
    damping_matrix=30.0 * np.outer(_STACK, _STACK) + 20.0 * np.outer(_ARM, _ARM),
    stiffness_matrix=2e9 * np.outer(_STACK, _STACK) + 2e5 * np.outer(_ARM, _ARM),
    drive_vector=17.36 * _STACK,
    contact_vector=np.array([1.0, 0.0, 0.0]),
    clamped_capacitance=2.093e-7,
)
