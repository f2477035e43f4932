"""Order of runs: randomised complete blocks, every point once in each."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

import numpy as np


@dataclass(frozen=True, kw_only=True, slots=True)
class Blocking:
    """What the runs of a block share.

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
    specimens : tuple of str
        Pairs of bodies: the one run on, or those without and with vibration.
    """

    run: int
    block: int
    point: int
    specimens: tuple[str, ...]


def randomised_runs(
    points: int, replicates: int, *, blocking: Blocking, specimens: int, seed: int
) -> tuple[PlannedRun, ...]:
    """Runs of a plan in their order: each block has every point once, in random order.

    Parameters
    ----------
    points : int
        Number of points.
    replicates : int
        Number of blocks.
    blocking : Blocking
    specimens : int
        Pairs of bodies for one run.
    seed : int

    Returns
    -------
    tuple of PlannedRun

    References
    ----------
    .. [1] D. C. Montgomery, Design and Analysis of Experiments, 8th ed., Wiley 2013, chapter 4.
    """
    rng = np.random.default_rng(seed)
    runs: list[PlannedRun] = []
    for block in range(1, replicates + 1):
        for point in rng.permutation(points):
            number = len(runs) + 1
            first = block if blocking.shares_specimens else number
            names = tuple(f"{first}{letter}" for letter in ("", "ab")[specimens > 1]) or (f"{first}",)
            runs.append(PlannedRun(run=number, block=block, point=int(point), specimens=names))
    return tuple(runs)
