"""Tables of a plant: made from operating points of a rig, and refined until other points agree."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sonolube.checks import Floats
from sonolube.design.control import VibrationMode, mode_at_drive
from sonolube.design.fmu.chebyshev import (
    ChebyshevTable,
    Ends,
    fitted,
    grown,
    nodes,
    of_one_variable,
    trimmed,
    unconverged,
)
from sonolube.design.fmu.plant import PinHeat, PlantRanges, PlantTables, reduced_speed, speed_over_scale
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.models import thermal
from sonolube.models.thermal.flash import FLASH_MODELS
from sonolube.rig import OperatingPoints, Rig, commanded_quantity, level_settings, operating_points
from sonolube.rig.resolved_rig import ResolvedRig, resolved_rig
from sonolube.text.units import format_si

LARGEST_ERROR = 1e-6
"""Largest relative error of tables that are exported. []"""

_AIM = 3e-7  # relative error at which tables are fine enough
_TOLERANCE = 3e-8  # relative, of the last coefficients of a function of one variable
_TRIM = 2e-9  # relative, below which coefficients are left out
_FIRST = (12, 6, 5, 14)  # nodes of level, frequency, load and speed
_MOST = 400_000  # points of a table
_HELD_OUT = 600  # points at which the error is measured
_SEED = 0
_FAST = 1e3  # speeds over the vibration velocity above every threshold
_FASTEST = 1e6  # the same, of the limit
_SAME = 1e-9  # difference of ratios that counts as none
_MARGIN = 1.05  # of the highest velocity over that at the nodes


def plant_tables(
    rig: Rig | ResolvedRig,
    ranges: PlantRanges,
    *,
    mode: VibrationMode | None = None,
    heat: PinHeat | None = None,
    advance: Callable[[int, int], None] | None = None,
) -> PlantTables:
    """Steady states of a rig over ranges of its inputs as tables, refined until other points agree to 1e-6.

    Parameters
    ----------
    rig : Rig or ResolvedRig
    ranges : PlantRanges
    mode : VibrationMode, optional
        Resonance of a rig without a structure; by default that of its structure, at each load.
    heat : PinHeat, optional
        For the temperature of the contact.
    advance : callable, optional
        Called with the number of vibrations done, and of all, of each table.

    Returns
    -------
    PlantTables

    Raises
    ------
    InvalidInput
        If the amplitude of the rig does not follow its voltage, or one mode cannot represent its resonance.
    OutsideRange
        If a point within the ranges has no friction or more than one steady vibration, or the tables do not come within
        1e-6 of other points.
    """
    steady = _SteadyStates(resolved_rig(rig), ranges, advance)
    title, loads = steady.resolved.rig.title, ranges.normal_load
    resonance = _resonances(steady.resolved.rig, loads, mode)
    steady(*np.meshgrid(ranges.level[1], ranges.frequency, loads, ranges.sliding_speed))  # refuses the corners at once
    tables = _refined(steady, _threshold(steady))
    if not tables.relative_error <= LARGEST_ERROR:
        raise OutsideRange(
            f"{title}: tables of {tables.slow_ratio.coefficients.size} coefficients miss other points by"
            f" {tables.relative_error:.1e}, more than {LARGEST_ERROR:g}: narrow the ranges"
        )
    return replace(_with_heat(tables, ranges, heat), resonance=resonance)


@dataclass(frozen=True, slots=True)
class _SteadyStates:
    """Operating points of a rig, all of which must have one vibration and a friction."""

    resolved: ResolvedRig
    ranges: PlantRanges
    advance: Callable[[int, int], None] | None

    def __call__(self, level: Floats, frequency: Floats, load: Floats, speed: Floats) -> OperatingPoints:
        """Operating points at levels, frequencies, loads and speeds that broadcast against each other."""
        level, frequency, load, speed = np.broadcast_arrays(level, frequency, load, speed)
        points = operating_points(
            self.resolved,
            **level_settings(self.resolved, level),
            frequency=frequency,
            normal_load=load,
            sliding_speed=speed,
            advance=self.advance,
        )
        bad = np.flatnonzero(points.failed.ravel() | (points.status.ravel() != "periodic"))
        if bad.size:
            i, unit = bad[0], commanded_quantity(self.resolved).unit
            at = f"{format_si(level.flat[i], unit)}, {format_si(frequency.flat[i], 'Hz', digits=6)}"
            raise OutsideRange(
                f"{self.resolved.rig.title}: at {at}, {format_si(load.flat[i], 'N')} and"
                f" {format_si(speed.flat[i], 'm/s')} {points.reason.flat[i]}; narrow the ranges of the plant"
            )
        return points


def _threshold(steady: _SteadyStates) -> ChebyshevTable | None:
    """Least speed over the vibration velocity from which the ratio is that for fast sliding, of the load.

    None where the ratio approaches it for ever.
    """
    loads = steady.ranges.normal_load
    if _threshold_at(steady, float(np.mean(loads))) is None:
        return None
    return of_one_variable(
        lambda every: np.array([_threshold_at(steady, load) or _FAST for load in every.tolist()]), loads, 1e-4
    )


def _threshold_at(steady: _SteadyStates, load: float) -> float | None:
    """Threshold at a load, to a part in a million."""
    drive = np.array(steady.ranges.level[1]), np.array(np.mean(steady.ranges.frequency)), np.array(load)
    velocity = float(steady(*drive, np.array(1.0)).vibration_velocity)
    limit = steady(*drive, np.array(_FASTEST * velocity)).friction_ratio
    scan = np.geomspace(1 / _FAST, _FASTEST, 901)
    for _ in range(4):
        differs = np.flatnonzero(np.abs(steady(*drive, scan * velocity).friction_ratio - limit) > _SAME)
        if not differs.size:
            break
        if scan[differs[-1]] > _FAST:
            return None
        scan = np.linspace(scan[differs[-1]], scan[differs[-1] + 1], 41)
    return float(scan[-1] if differs.size else scan[0])


def _refined(steady: _SteadyStates, threshold: ChebyshevTable | None) -> PlantTables:
    """Tables with more and more nodes along the variable that needs them most, until other points agree."""
    ranges, constant = steady.ranges, ChebyshevTable(ends=(steady.ranges.normal_load,), coefficients=np.ones(1))
    ends = (*ranges.ends, (0.0, 1.0))
    orders = [count if low < high else 1 for count, (low, high) in zip(_FIRST, ends, strict=True)]
    check = _HeldOut.of(steady)
    while True:
        full = _tables(steady, threshold or constant, threshold is not None, orders)
        tables = replace(
            full,
            amplitude_per_level=trimmed(full.amplitude_per_level, _TRIM),
            velocity_per_level=trimmed(full.velocity_per_level, _TRIM),
            slow_ratio=trimmed(full.slow_ratio, _TRIM),
            fast_ratio=trimmed(full.fast_ratio, _TRIM),
        )
        error = check.error(tables)
        last = unconverged(full.slow_ratio)
        last[:3] = np.maximum(last[:3], unconverged(full.amplitude_per_level))
        worst = int(np.argmax(last))
        orders[worst] = grown(orders[worst])
        if error <= _AIM or np.prod(orders) > _MOST:
            return replace(tables, relative_error=error)


def _tables(
    steady: _SteadyStates, threshold: ChebyshevTable, has_threshold: bool, orders: Sequence[int]
) -> PlantTables:
    """Tables of numbers of nodes for level, frequency, load and reduced speed."""
    ranges = steady.ranges
    axes = [nodes(ends, count) for ends, count in zip(ranges.ends, orders[:3], strict=True)]
    level, frequency, load = np.meshgrid(*axes, indexing="ij")
    moving = steady(level, frequency, load, np.array(ranges.sliding_speed[1]))
    amplitude, velocity = moving.vibration_amplitude / level, moving.vibration_velocity / level
    spread = np.ptp(moving.vibration_amplitude, axis=0)
    if not np.all(spread > 0):
        raise InvalidInput(
            f"{steady.resolved.rig.title}: the amplitude {moving.amplitude_source} does not follow the voltage; choose"
            " the amplitude computed"
        )
    scale = velocity * level * threshold(load)
    slowest = float(reduced_speed(np.array(ranges.sliding_speed[0] / (_MARGIN * scale.max())), has_threshold))
    ends = (*ranges.ends, (min(slowest, 0.999), 1.0))
    reduced = nodes(ends[3], orders[3])
    speeds = scale[..., np.newaxis] * speed_over_scale(reduced, has_threshold)
    level4, frequency4, load4 = (each[..., np.newaxis] for each in (level, frequency, load))
    slow = steady(level4, frequency4, load4, speeds).friction_ratio
    fast = steady(level, frequency, load, _FAST * scale).friction_ratio
    return PlantTables(
        rig=steady.resolved.rig,
        quantity=commanded_quantity(steady.resolved),
        ranges=ranges,
        amplitude_per_level=fitted(amplitude, ranges.ends),
        velocity_per_level=fitted(velocity, ranges.ends),
        threshold=threshold,
        has_threshold=has_threshold,
        slow_ratio=fitted(slow, ends),
        fast_ratio=fitted(fast, ranges.ends),
        resonance={},
        heat=None,
        heat_partition=None,
        flash_rise_per_heat=None,
    )


def _resonances(rig: Rig, loads: Ends, mode: VibrationMode | None) -> dict[str, ChebyshevTable]:
    """Resonance over the load."""
    known: dict[float, VibrationMode] = {}

    def at(load: float) -> VibrationMode:
        if mode is not None:
            return mode
        if load not in known:
            known[load] = mode_at_drive(replace(rig, normal_load=load))
        return known[load]

    def of(name: str) -> Callable[[Floats], Floats]:
        return lambda each: np.array([getattr(at(load), name) or 0.0 for load in each.tolist()])

    ends = loads if mode is None else (loads[0], loads[0])
    names = ("natural_frequency", "decay_rate", "motional_conductance", "parallel_capacitance")
    return {name: of_one_variable(of(name), ends, _SAME) for name in names}


def _with_heat(tables: PlantTables, ranges: PlantRanges, heat: PinHeat | None) -> PlantTables:
    """Tables with the heat partition and the flash rise of the contact, taken as circular, over the speed."""
    if heat is None:
        return tables
    radius = float(np.sqrt(tables.rig.contact.nominal_area / np.pi))
    source = thermal.EllipticSource(half_length=radius, half_width=radius)

    def rise(speeds: Floats) -> thermal.ContactRise:
        return thermal.contact_rise(
            heat.pin,
            heat.disc,
            source,
            heat_rate=1.0,
            sliding_speed=speeds,
            moving_rise=FLASH_MODELS.named("quadrature"),
        )

    ends = ranges.sliding_speed
    return replace(
        tables,
        heat=heat,
        heat_partition=of_one_variable(lambda v: rise(v).heat_partition, ends, _TOLERANCE),
        flash_rise_per_heat=of_one_variable(lambda v: rise(v).mean_temperature_rise, ends, _TOLERANCE),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _HeldOut:
    """Random points within the ranges, and their operating points."""

    inputs: tuple[Floats, Floats, Floats, Floats]
    found: OperatingPoints

    @classmethod
    def of(cls, steady: _SteadyStates) -> "_HeldOut":
        """Points of a seed that is always the same."""
        random, ranges = np.random.default_rng(_SEED), steady.ranges
        level, f, load, speed = (random.uniform(*ends, _HELD_OUT) for ends in (*ranges.ends, ranges.sliding_speed))
        return cls((level, f, load, speed), steady(level, f, load, speed))

    def error(self, tables: PlantTables) -> float:
        """Largest relative error of friction ratio and amplitude."""
        ratio = tables.friction_ratio(*self.inputs) / self.found.friction_ratio
        amplitude = tables.vibration_amplitude(*self.inputs[:3]) / self.found.vibration_amplitude
        return float(max(np.abs(ratio - 1).max(), np.abs(amplitude - 1).max()))
