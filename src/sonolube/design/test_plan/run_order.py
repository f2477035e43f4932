"""Order of runs: randomised complete blocks, every point once in each, and of the states within a run.

Running-in shifts friction over a run. A run on one pair of bodies is without vibration, with it, and without again, so
that both states have the same mean time: the difference of their means holds nothing of a drift that is linear in time
or distance. Runs on pairs of their own begin with and without vibration in turn.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

import numpy as np


@dataclass(frozen=True, kw_only=True, slots=True)
class Blocking:
    """Conditions that the runs of a block share.

    Parameters
    ----------
    name : str
        As typed.
    title : str
        In the sheet.
    shares_specimens : bool
        Whether the runs of a block are made on the same bodies.
    """

    name: str
    title: str
    shares_specimens: bool


BLOCKINGS: Final[Mapping[str, Blocking]] = MappingProxyType(
    {
        each.name: each
        for each in (
            Blocking(name="day", title="one day, every run on new specimens", shares_specimens=False),
            Blocking(name="pair", title="one pair of pin and disc, cleaned between runs", shares_specimens=True),
        )
    }
)
"""Kinds of blocks, by name."""


INTERLEAVED: Final = (False, True, False)
"""States of the vibration in a run on one pair of bodies, True for on; the middle one lasts twice as long."""


@dataclass(frozen=True, kw_only=True, slots=True)
class RunState:
    """Part of a run without or with vibration.

    Parameters
    ----------
    vibrated : bool
    settling : float
        Time until friction is steady, in s.
    measuring : float
        Time in which friction is measured, in s.
    """

    vibrated: bool
    settling: float
    measuring: float

    @property
    def duration(self) -> float:
        """Duration of the part, in s."""
        return self.settling + self.measuring


@dataclass(frozen=True, kw_only=True, slots=True)
class RunPart:
    """Part of a run on one pair of bodies.

    Parameters
    ----------
    specimen : str
        Pair of bodies.
    vibrated : tuple of bool
        Whether the vibration is on, in each of its states.
    """

    specimen: str
    vibrated: tuple[bool, ...]


@dataclass(frozen=True, kw_only=True, slots=True)
class PlannedRun:
    """Run of a plan.

    Parameters
    ----------
    run : int
        Place in the order, from 1.
    block : int
        From 1.
    point : int
        Index of the point of the plan.
    parts : tuple of RunPart
        The one on one pair of bodies, or those without and with vibration in their order.
    """

    run: int
    block: int
    point: int
    parts: tuple[RunPart, ...]

    @property
    def specimens(self) -> tuple[str, ...]:
        """Pairs of bodies, in the order in which they are used."""
        return tuple(part.specimen for part in self.parts)


def randomised_runs(
    points: int, replicates: int, *, blocking: Blocking, specimens: int, seed: int
) -> tuple[PlannedRun, ...]:
    """Runs of a plan in their order: the first point first, then each block has every point once, in random order.

    Source: D. C. Montgomery, Design and Analysis of Experiments, 8th ed., Wiley 2013, chapter 4.
    """
    rng = np.random.default_rng(seed)
    runs: list[PlannedRun] = []
    for block in range(1, replicates + 1):
        order = [int(point) for point in rng.permutation(points)]
        if block == 1:
            order.sort(key=lambda point: point != 0)
        for point in order:
            number = len(runs) + 1
            first = block if blocking.shares_specimens else number
            parts = _separate(first, reverse=block % 2 == 0) if specimens > 1 else _together(first)
            runs.append(PlannedRun(run=number, block=block, point=point, parts=parts))
    return tuple(runs)


def _together(number: int) -> tuple[RunPart, ...]:
    """Both states on one pair of bodies."""
    return (RunPart(specimen=f"{number}", vibrated=INTERLEAVED),)


def _separate(number: int, *, reverse: bool) -> tuple[RunPart, ...]:
    """Each state on a pair of bodies of its own."""
    parts = tuple(
        RunPart(specimen=f"{number}{letter}", vibrated=(vibrated,)) for letter, vibrated in (("a", False), ("b", True))
    )
    return parts[::-1] if reverse else parts
