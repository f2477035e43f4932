"""Clock of a part of a recording that is not the clock of its run."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from sonolube.laboratory.records.run_folder import CLOCK_NAME


@dataclass(frozen=True, kw_only=True, slots=True)
class PartClock:
    """Clock of a part of the recording that is not the clock of the run.

    Parameters
    ----------
    name : str
        Of the acquisition, as the device map calls it.
    part : int
        Of the recording beside which this one was taken, from 1.
    offset : float
        Time of the first sample on the time axis of that part, in s.
    uncertainty : float
        Greatest error of the offset, which the times of two blocks tell, in s.
    first_sample : int
        By the counter of its hardware.
    """

    name: str
    part: int
    offset: float
    uncertainty: float
    first_sample: int = 0


def part_clock(content: Mapping[str, Any]) -> PartClock:
    """Clock of a part by what its file tells."""
    if not CLOCK_NAME.fullmatch(str(content["name"])):
        raise ValueError
    return PartClock(
        name=str(content["name"]),
        part=int(content["part"]),
        offset=float(content["offset"]),
        uncertainty=float(content["uncertainty"]),
        first_sample=int(content["first_sample"]),
    )
