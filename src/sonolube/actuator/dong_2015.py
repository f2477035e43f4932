"""The electrical impedance of the stack in its rig as the dissertation prints it, beside which the right one stands."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.actuator.stack import PiezoStack
from sonolube.checks import Complexes, require_non_negative, require_positive


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
    """Return voltage per current of the stack in the pin-on-disc rig as the dissertation prints it, complex. [ohm]

    Parameters
    ----------
    stack : PiezoStack
    tip_mass : float
        Mass m_1 of the tip. [kg]
    reaction_mass : float
        Mass m_2 behind the stack. [kg]
    arm_mass : float
        Effective mass m_3 of the loading arm. [kg]
    arm_stiffness : float
        Stiffness k_2 between the arm and the mass behind the stack. [N/m]
    arm_damping : float
        Damping c_2 beside it. [N s/m]
    tip_damping : float
        Damping c_1 between tip and disc. [N s/m]
    normal_stiffness : float
        Stiffness k_1 of the contact. [N/m]
    normal_load : float
        Load F_N, which the print takes for a stiffness. [N]
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
    For comparison only: `electrical_admittance` of the rig's structure is right. What is wrong in print:

    - 3.37 takes the short-circuit stiffness; with the current as input the stack is as stiff as open-circuited,
      k_p/(1 - k^2), and has its damping c_p.
    - 3.39 counts the stack once more, as m_0, c_p and k_p in a branch of their own; m_0 belongs to m_2.
    - 3.40 adds F_N/s to an impedance, a load where only a stiffness has the dimension.
    - 3.38 names one factor twice. It equals N d33 k_p/(C_S s), which is right, as is the form of 3.41.

    So as printed the capacitance far below resonance is C_S (1 - k^2)/(1 - 2 k^2) instead of C_T, and negative for
    a coupling factor above 0.71.

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
    z_own = stack.stack_mass * s + stack.stack_damping + stack.stack_stiffness / s
    z_load = _in_series(z_own, m1 * s + c1 + k1 / s, m2 * s + z_arm)  # D 3.39
    return np.asarray(z_blocked - transduction**2 / (z_stack + z_load))  # D 3.41


def _in_series(*impedances: NDArray[np.inexact]) -> Complexes:
    """Return the impedance of elements that share one force, none where one of them is missing."""
    product = np.prod(np.broadcast_arrays(*impedances), axis=0)
    others = [
        np.prod(np.broadcast_arrays(*impedances[:i], *impedances[i + 1 :]), axis=0) for i in range(len(impedances))
    ]
    return np.asarray(product / sum(others), dtype=np.complex128)
