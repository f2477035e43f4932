"""Electrical impedance of the stack in the pin-on-disc rig by Dong (2015), D 3.34 to 3.41, misprints included."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Complexes, require_non_negative, require_positive
from sonolube.models.actuator.stack import PiezoStack


def dong_2015_impedance(
    stack: PiezoStack,
    *,
    tip_mass: float,
    reaction_mass: float,
    arm_mass: float,
    arm_stiffness: float,
    arm_damping: float,
    tip_damping: float,
    normal_stiffness: float,
    normal_load: float,
    frequency: ArrayLike,
) -> Complexes:
    r"""Complex impedance of the stack in the pin-on-disc rig by Dong (2015), as printed. [ohm]

    Parameters
    ----------
    stack : PiezoStack
    tip_mass : float
        Mass m_1 of the tip. [kg]
    reaction_mass : float
        Mass m_2 at the back of the stack. [kg]
    arm_mass : float
        Effective mass m_3 of the loading arm. [kg]
    arm_stiffness : float
        Stiffness k_2 between the arm and the reaction mass. [N/m]
    arm_damping : float
        Damping c_2 in parallel with it. [N s/m]
    tip_damping : float
        Damping c_1 between tip and disc. [N s/m]
    normal_stiffness : float
        Stiffness k_1 of the contact. [N/m]
    normal_load : float
        Load F_N, used as a stiffness in D 3.40. [N]
    frequency : array_like, any shape
        Frequency of the voltage. [Hz]

    Returns
    -------
    ndarray, shape of `frequency`

    Raises
    ------
    InvalidInput
        If a mass or frequency is not positive, or another value negative.

    Notes
    -----
    For comparison only; `sonolube.models.dynamics.electrical_admittance` of the rig's structure is correct. With the
    Laplace variable s, the elements :math:`Z_i` in series having :math:`Z_1 \| Z_2 = Z_1 Z_2/(Z_1 + Z_2)`,

    .. math::

        Z_b = \frac{1}{C_S s} \quad\text{(D 3.36)}, \qquad
        Z_p = \frac{k_p}{s} \quad\text{(D 3.37)}, \qquad
        \phi = \frac{N d_{33} k_p}{C_S s} \quad\text{(D 3.38)}

    .. math::

        Z_a = \left(m_3 s + \frac{F_N}{s}\right) \Big\| \left(c_2 + \frac{k_2}{s}\right) \quad\text{(D 3.40)}

    .. math::

        Z_l = \left(m_0 s + c_p + \frac{k_p}{s}\right) \Big\| \left(m_1 s + c_1 + \frac{k_1}{s}\right)
        \Big\| \left(m_2 s + Z_a\right) \quad\text{(D 3.39)}, \qquad
        Z = Z_b - \frac{\phi^2}{Z_p + Z_l} \quad\text{(D 3.41)}

    Errors in print:

    - D 3.37 has the short-circuit stiffness; with the current as input the stack has its open-circuit stiffness,
      k_p/(1 - k^2), and its damping c_p.
    - D 3.39 counts the stack twice, m_0, c_p and k_p forming a branch of their own; m_0 belongs to m_2.
    - D 3.40 adds F_N/s to an impedance: a load in place of a stiffness.
    - D 3.38 names one factor twice. As evaluated here it is correct, as is the form of D 3.41.

    As printed, the capacitance far below resonance is C_S (1 - k^2)/(1 - 2 k^2) instead of C_T, and negative for a
    coupling factor above 0.71.

    References
    ----------
    .. [1] D 3.34 to 3.41.
    """
    m1, m2 = require_positive(tip_mass=tip_mass), require_positive(reaction_mass=reaction_mass)
    m3 = require_positive(arm_mass=arm_mass)
    k2, c2 = require_non_negative(arm_stiffness=arm_stiffness), require_non_negative(arm_damping=arm_damping)
    k1, c1 = require_non_negative(normal_stiffness=normal_stiffness), require_non_negative(tip_damping=tip_damping)
    load = require_non_negative(normal_load=normal_load)
    s = 2j * np.pi * require_positive(frequency=frequency)
    z_blocked = 1 / (stack.clamped_capacitance * s)  # D 3.36
    z_stack = stack.stack_stiffness / s  # D 3.37
    transduction = stack.charge_per_elongation * z_blocked  # D 3.38
    z_arm = _in_series(m3 * s + load / s, c2 + k2 / s)  # D 3.40
    z_mass = stack.stack_mass * s + stack.stack_damping + stack.stack_stiffness / s
    z_load = _in_series(z_mass, m1 * s + c1 + k1 / s, m2 * s + z_arm)  # D 3.39
    return np.asarray(z_blocked - transduction**2 / (z_stack + z_load))  # D 3.41


def _in_series(*impedances: NDArray[np.inexact]) -> Complexes:
    """Mechanical impedance of elements in series, which share one force; zero where one of them is zero."""
    product = np.prod(np.broadcast_arrays(*impedances), axis=0)
    others = [
        np.prod(np.broadcast_arrays(*impedances[:i], *impedances[i + 1 :]), axis=0) for i in range(len(impedances))
    ]
    return np.asarray(product / sum(others), dtype=np.complex128)
