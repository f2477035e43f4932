"""Range of conditions over which the published tests were made, beyond which a prediction extrapolates."""

from typing import Final

import numpy as np

from sonolube.prediction.evidence import published_rigs
from sonolube.prediction.inputs import RigInputs
from sonolube.rig import Rig
from sonolube.units import format_si
from sonolube.validation.published_tests import friction_tests

_MARGIN: Final = 1.05  # beyond the ends of a range


def extrapolation_caveats(rig: Rig, inputs: RigInputs) -> tuple[str, ...]:
    """Sentence that names the conditions of a rig that lie outside the published tests.

    Parameters
    ----------
    rig : Rig
    inputs : RigInputs

    Returns
    -------
    tuple of str
        Empty where all conditions lie within.
    """
    outside = [
        f"{label} {format_si(value, unit)} ({format_si(low, unit)} to {format_si(high, unit)})"
        for label, value, unit, tested in _conditions(rig, inputs)
        for low, high in [(float(np.min(tested)), float(np.max(tested)))]
        if not low / _MARGIN <= value <= high * _MARGIN
    ]
    if not outside:
        return ()
    return (f"outside the range of the published tests, so that the prediction extrapolates: {'; '.join(outside)}",)


def _conditions(rig: Rig, inputs: RigInputs) -> list[tuple[str, float, str, np.ndarray]]:
    """Label, value, unit and tested values of each condition."""
    tested = [each.at.conditions for each in published_rigs()]
    moduli = [test.contact.pair.effective_modulus for test in friction_tests()]
    return [
        (
            "vibration amplitude",
            inputs.amplitude.value,
            "m",
            np.concatenate([each.vibration_amplitude for each in tested]),
        ),
        ("sliding speed", inputs.sliding_speed, "m/s", np.concatenate([each.sliding_speed for each in tested])),
        ("effective modulus", rig.contact.pair.effective_modulus, "Pa", np.array(moduli)),
    ]
