"""Scales of sensors: voltages of an input as values of a quantity in SI."""

import csv
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sonolube.errors import InvalidInput
from sonolube.text.units import to_si
from sonolube.vocabulary import unit_of

Floats = NDArray[np.float64]

_MAX_POINTS = 10_000


class SensorScale(Protocol):
    """Relation of the voltage of an input to a quantity."""

    def values(self, voltages: Floats) -> Floats:
        """Values in SI of voltages in V."""

    def reach(self, voltage: float) -> tuple[float, float]:
        """Lowest and highest value within plus and minus a voltage."""


@dataclass(frozen=True, kw_only=True, slots=True)
class LinearScale:
    """Value as gain times voltage plus offset.

    Parameters
    ----------
    gain : float
        SI unit of the quantity per V.
    offset : float
        In SI.
    """

    gain: float
    offset: float = 0.0

    def values(self, voltages: Floats) -> Floats:
        """Values in SI of voltages in V."""
        return self.gain * voltages + self.offset

    def reach(self, voltage: float) -> tuple[float, float]:
        """Lowest and highest value within plus and minus a voltage."""
        ends = (self.gain * voltage + self.offset, -self.gain * voltage + self.offset)
        return min(ends), max(ends)


@dataclass(frozen=True, kw_only=True, slots=True)
class TabulatedScale:
    """Value between measured points, linear from one to the next; beyond them that of the last point, as saturated.

    Parameters
    ----------
    voltages : ndarray, shape (points,)
        Increasing, in V.
    readings : ndarray, shape (points,)
        In SI.
    """

    voltages: Floats
    readings: Floats

    def values(self, voltages: Floats) -> Floats:
        """Values in SI of voltages in V."""
        return np.interp(voltages, self.voltages, self.readings)

    def reach(self, voltage: float) -> tuple[float, float]:
        """Lowest and highest value of the points within plus and minus a voltage."""
        ends = self.values(np.clip(self.voltages, -voltage, voltage))
        return float(ends.min()), float(ends.max())


def tabulated_scale(text: str, *, quantity: str, unit: str | None = None) -> TabulatedScale:
    """Scale of the text of a calibration file."""
    rows = [[cell.strip() for cell in row] for row in csv.reader(text.splitlines()) if row]
    if not rows or rows[0] != ["voltage", quantity]:
        raise InvalidInput(f"line 1: expected voltage,{quantity}")
    if not 3 <= len(rows) <= _MAX_POINTS:
        raise InvalidInput(f"{len(rows) - 1} points; expected 2 to {_MAX_POINTS - 1}")
    si_unit = unit_of(quantity) if unit is None else unit
    points = np.array([_point(row, si_unit, line) for line, row in enumerate(rows[1:], start=2)])
    voltages, readings = points[:, 0], points[:, 1]
    if not (np.diff(voltages) > 0).all():
        raise InvalidInput("the voltages must increase from line to line")
    if abs(np.sign(np.diff(readings)).sum()) != len(readings) - 1:
        raise InvalidInput("the readings must rise or fall from line to line: one reading has one voltage")
    return TabulatedScale(voltages=voltages, readings=readings)


def _point(row: list[str], unit: str, line: int) -> tuple[float, float]:
    """Voltage and reading of a line."""
    if len(row) != 2:
        raise InvalidInput(f"line {line}: expected a voltage and a reading, got {len(row)} cells")
    place = f"line {line}:"
    return to_si(row[0], unit="V", name=place), to_si(row[1], unit=unit, name=place)
