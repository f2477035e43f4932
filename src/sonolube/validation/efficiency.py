"""Efficiency of friction reduction by vibration: the line fitted in the dissertation to its own tests."""

from sonolube.facts.metrics import EfficiencyLine
from sonolube.facts.published import si_value


def efficiency_line() -> EfficiencyLine:
    r"""Efficiency coefficient as a linear function of the sliding speed, fitted in D to its tests.

    .. math:: \eta = -2.93\,v_r + 0.672

    with the sliding speed in m/s and the efficiency coefficient in mW mm2/(N W), D 4.2.
    """
    return EfficiencyLine(slope=si_value("4.1.2-efficiency-slope"), intercept=si_value("4.1.2-efficiency-intercept"))
