"""Faults that a virtual tribometer has at a given sample, to try what a runner does."""

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True, slots=True)
class Fault:
    """A fault of the virtual hardware.

    Parameters
    ----------
    sample : int
        Of the acquisition, from 0, at which it happens.
    kind : {"lost", "overrun", "saturated", "no number"}
        The devices answer no more; samples are lost; the force gauge is at the end of its range, or its wire is broken.
    """

    sample: int
    kind: Literal["lost", "overrun", "saturated", "no number"]
