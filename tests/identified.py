"""Identification of the tribometer from the published facts, made once for all tests of a process."""

from functools import cache

from sonolube.identification import Identification
from sonolube.validation.tribometer import tribometer_identification


@cache
def identified_tribometer() -> Identification:
    """Return the identification, which takes some 13 s of processor time."""
    return tribometer_identification()
