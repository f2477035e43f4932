"""Vibration amplitudes of the published tests in decay lengths of the contact's force, and a rig's beside them."""

from functools import cache

import numpy as np

from sonolube.models.contact import RoughContact, decay_length, separation
from sonolube.rig import ResolvedRig
from sonolube.validation.published_tests import friction_tests

_MARGIN = 1.05  # of the largest tested one


@cache
def amplitude_ratios_of_tests() -> tuple[float, float]:
    """Smallest and the largest amplitude of the published tests over the decay length. []"""
    ratios = [_amplitude_ratio(one.contact, one.normal_load, one.vibration_amplitude) for one in friction_tests()]
    return float(np.min(ratios)), float(np.max(ratios))


def large_amplitude_caveats(resolved: ResolvedRig, *, vibration_amplitude: float) -> tuple[str, ...]:
    """Sentence where an amplitude is more decay lengths of a rig's contact than any published test had.

    Empty for amplitudes within the tests.
    """
    ratio = vibration_amplitude / resolved.decay_length
    low, high = amplitude_ratios_of_tests()
    if not ratio > _MARGIN * high:
        return ()
    return (
        f"the amplitude is {ratio:.3g} decay lengths of the contact's force, and the published tests have {low:.2g} to"
        f" {high:.2g}: beyond them the friction model is an extrapolation",
    )


def _amplitude_ratio(contact: RoughContact, normal_load: float, amplitude: float) -> float:
    """Amplitude over the decay length of a contact under its load. []"""
    at_rest = separation(contact, normal_load=normal_load)
    return amplitude / float(decay_length(contact, separation=at_rest))
