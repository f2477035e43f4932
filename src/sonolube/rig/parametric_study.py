"""Parametric studies of a rig over voltage or amplitude, speed, frequency, waveform and load, as labelled datasets."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.errors import InvalidInput
from sonolube.models.dynamics import WAVEFORMS, Status, contact_motion, modes
from sonolube.rig import operating_conditions as conditions
from sonolube.rig.datasets import Dataset, gridded
from sonolube.rig.driven_rig import DrivenRig, require_drive
from sonolube.rig.friction_and_wear import prescribed_sine
from sonolube.rig.operating_point_batch import NUMBERS
from sonolube.rig.operating_point_grid import Advance, OperatingPoints, operating_points, steady_states
from sonolube.rig.power import POWERS
from sonolube.rig.record import Rig
from sonolube.rig.resolved_rig import ResolvedRig, amplitude_labels, resolved_rig
from sonolube.rig.responses import structure_in_contact

_GRAVITY = 9.80665  # m/s2
_PHASES = 128
_PHASE = 2 * np.pi * np.arange(_PHASES) / _PHASES
_POINT = ("status", "reason", *(name for name in NUMBERS if name != "friction_coefficient"))


def voltage_study(rig: Rig, *, voltage_peak_to_peak: ArrayLike, advance: Advance | None = None) -> Dataset:
    """Operating points over drive voltage, with one period of the contact at each.

    Parameters
    ----------
    rig : Rig or ResolvedRig
        With a drive voltage.
    voltage_peak_to_peak : array_like, shape (n,)
        Peak-to-peak voltages; the offset keeps the rig's ratio to them. [V]
    advance : callable, optional
        Called with the number of points done, and of all.

    Returns
    -------
    xarray.Dataset
        Over `voltage_peak_to_peak`, and `phase` where a period is shown.

    Raises
    ------
    InvalidInput
        If the rig has no drive voltage, or a voltage has no meaning.

    See Also
    --------
    amplitude_study

    References
    ----------
    .. [1] D 3.3.5, figure 3.15.
    """
    return _level_study(rig, conditions.VOLTAGE, voltage_peak_to_peak, "over drive voltage", advance)


def amplitude_study(rig: Rig, *, vibration_amplitude: ArrayLike, advance: Advance | None = None) -> Dataset:
    """Operating points over vibration amplitude, with one period of the contact at each.

    Parameters
    ----------
    rig : Rig or ResolvedRig
        Without a drive voltage; its vibration is a sine.
    vibration_amplitude : array_like, shape (n,)
        Zero to peak. [m]
    advance : callable, optional
        Called with the number of points done, and of all.

    Returns
    -------
    xarray.Dataset
        Over `vibration_amplitude`, and `phase` where a period is shown.

    Raises
    ------
    InvalidInput
        If the rig has a drive voltage or no amplitude, or an amplitude has no meaning.

    See Also
    --------
    voltage_study
    """
    return _level_study(rig, conditions.AMPLITUDE, vibration_amplitude, "over vibration amplitude", advance)


def speed_study(
    rig: Rig | ResolvedRig,
    *,
    sliding_speed: ArrayLike,
    voltage_peak_to_peak: ArrayLike | None = None,
    vibration_amplitude: ArrayLike | None = None,
    advance: Advance | None = None,
) -> Dataset:
    """Operating points over sliding speed at some drive voltages, or amplitudes of a rig without a voltage.

    Parameters
    ----------
    rig : Rig or ResolvedRig
    sliding_speed : array_like, shape (n,)
        Macroscopic relative speeds. [m/s]
    voltage_peak_to_peak : array_like, shape (m,), optional
        Peak-to-peak voltages, the rig's own where absent; the offset keeps its ratio to them. [V]
    vibration_amplitude : array_like, shape (m,), optional
        Amplitudes of a rig without a voltage, its own where absent. [m]
    advance : callable, optional
        Called with the number of vibrations done, and of all.

    Returns
    -------
    xarray.Dataset
        Over `voltage_peak_to_peak` or `vibration_amplitude`, and `sliding_speed`; `velocity_ratio` is sliding speed
        over the highest speed of the vibration.

    Raises
    ------
    InvalidInput
        If the rig has no amplitude, a speed, voltage or amplitude is not positive, or the one given does not set the
        vibration of the rig.

    References
    ----------
    .. [1] D 3.50, figure 3.16.
    """
    resolved = resolved_rig(rig)
    quantity, level = _curves(resolved, voltage_peak_to_peak, vibration_amplitude)
    speeds = np.atleast_1d(require_positive(sliding_speed=sliding_speed))
    points = _by_level(resolved, level, sliding_speed=speeds, advance=advance)
    found = _values(points) | {"velocity_ratio": speeds / points.vibration_velocity}
    return _study(resolved, "over sliding speed", found, **{quantity.name: level, "sliding_speed": speeds})


def frequency_study(
    rig: Rig | ResolvedRig,
    *,
    frequency: ArrayLike,
    voltage_peak_to_peak: ArrayLike | None = None,
    advance: Advance | None = None,
) -> Dataset:
    """Rig over drive frequencies, at some drive voltages.

    Parameters
    ----------
    rig : Rig or ResolvedRig
        With a stack, a structure and a drive voltage.
    frequency : array_like, shape (n,)
        Frequencies of the drive, such as `frequency_grid` gives. [Hz]
    voltage_peak_to_peak : array_like, shape (m,), optional
        Peak-to-peak voltages, the rig's own where absent; the offset keeps its ratio to them. [V]
    advance : callable, optional
        Called with the number of points done, and of all.

    Returns
    -------
    xarray.Dataset
        Over `voltage_peak_to_peak` and `frequency`.

    Raises
    ------
    InvalidInput
        If the rig has no structure, or a frequency or voltage is not positive.

    References
    ----------
    .. [1] D 3.3.5, figure 3.17.
    """
    resolved = resolved_rig(rig)
    require_drive(resolved.rig)
    _, volts = _curves(resolved, voltage_peak_to_peak, None)
    f = np.atleast_1d(require_positive(frequency=frequency))
    points = _by_level(resolved, volts, frequency=f, advance=advance)
    return _study(resolved, "over drive frequency", _values(points), voltage_peak_to_peak=volts, frequency=f)


def waveform_study(rig: Rig | ResolvedRig, *, advance: Advance | None = None) -> Dataset:
    """Rig under each named waveform at its own voltage, and one period of its contact under each.

    Parameters
    ----------
    rig : Rig or ResolvedRig
        With a stack, a structure and a drive voltage.
    advance : callable, optional
        Told how many waveforms are done, and of how many.

    Returns
    -------
    xarray.Dataset
        Over `waveform`, and `phase` where a period is shown.

    Raises
    ------
    InvalidInput
        If the rig has no structure.

    References
    ----------
    .. [1] D 3.3.5, figure 3.18.
    """
    resolved = resolved_rig(rig)
    moved = resolved.moved
    shaped = [resolved_rig(replace(moved, drive=replace(moved.drive, waveform=name))) for name in WAVEFORMS]
    points = _one_by_one(shaped, operating_points, advance)
    periods = [_computed_periods(one, np.array([moved.voltage_peak_to_peak])) for one in shaped]
    displacement, normal_force = (np.concatenate(rows) for rows in zip(*periods, strict=True))
    found = points | {"displacement": displacement, "normal_force": normal_force}
    return _study(resolved, "under waveforms of equal swing", found, waveform=np.array(list(WAVEFORMS)), phase=_PHASE)


def load_study(rig: Rig, *, normal_load: ArrayLike, advance: Advance | None = None) -> Dataset:
    """Operating points over normal load; of a structure, by weights that add to the mass they hang on.

    Parameters
    ----------
    rig : Rig or ResolvedRig
        With a sine of its amplitude, which every load has; or with a structure that says where the dead load hangs, its
        heights exponential.
    normal_load : array_like, shape (n,)
        Forces pressing the bodies together. [N]
    advance : callable, optional
        Called with the number of loads done, and of all.

    Returns
    -------
    xarray.Dataset
        Over `normal_load`; of a structure, `natural_frequency` is that of its slowest vibration on the contact, the
        arm's.

    Raises
    ------
    InvalidInput
        If the structure does not say where the load hangs, or a load is not positive or leaves no mass.

    Notes
    -----
    A load that differs from the rig's own adds the mass of the difference in weight where the weights hang.

    References
    ----------
    .. [1] D 4.1.2, figures 4.7 and 4.8.
    """
    loads = np.atleast_1d(require_positive(normal_load=normal_load))
    resolved = resolved_rig(rig)
    driven = resolved.vibration.driven
    if driven is None:
        found = _values(operating_points(resolved, normal_load=loads, advance=advance))
        return _study(resolved, "over normal load", found, normal_load=loads)
    loaded = [resolved_rig(_weighted(driven, float(load))) for load in loads]
    points = _one_by_one(loaded, operating_points, advance)
    found = points | {"natural_frequency": np.array([_slowest(one) for one in loaded])}
    return _study(resolved, "over normal load", found, normal_load=loads)


def _level_study(
    rig: Rig | ResolvedRig,
    quantity: conditions.CommandedQuantity,
    level: ArrayLike,
    title: str,
    advance: Advance | None,
) -> Dataset:
    """Points over voltage or amplitude, with one period of the contact at each."""
    resolved = resolved_rig(rig)
    conditions.require_commanded(resolved, quantity)
    levels = np.atleast_1d(require_non_negative(**{quantity.name: level}))
    points = operating_points(resolved, **conditions.level_settings(resolved, levels), advance=advance)
    is_sine = resolved.vibration.driven is None
    displacement, normal_force = _sine_periods(resolved.rig, points) if is_sine else _computed_periods(resolved, levels)
    found = _values(points) | {"displacement": displacement, "normal_force": normal_force}
    return _study(resolved, title, found, **{quantity.name: levels, "phase": _PHASE})


def _by_level(resolved: ResolvedRig, level: Floats, **others: Any) -> OperatingPoints:
    """Points over voltage or amplitude, a row each, and over another condition."""
    return operating_points(resolved, **conditions.level_settings(resolved, level[:, np.newaxis]), **others)


def _values(points: OperatingPoints) -> dict[str, NDArray[Any]]:
    return {name: getattr(points, name) for name in _POINT}


def _one_by_one(
    rigs: Sequence[ResolvedRig], study: Callable[[ResolvedRig], OperatingPoints], advance: Advance | None
) -> dict[str, NDArray[Any]]:
    every = []
    for done, rig in enumerate(rigs, start=1):
        every.append(_values(study(rig)))
        if advance is not None:
            advance(done, len(rigs))
    return {name: np.stack([one[name] for one in every]) for name in _POINT}


def _curves(
    resolved: ResolvedRig, volts: ArrayLike | None, amplitudes: ArrayLike | None
) -> tuple[conditions.CommandedQuantity, Floats]:
    """Commanded quantity of a rig, and its value for each curve: those given, or the rig's own."""
    for quantity, given in ((conditions.VOLTAGE, volts), (conditions.AMPLITUDE, amplitudes)):
        if given is not None:
            conditions.require_commanded(resolved, quantity)
            return quantity, np.atleast_1d(require_positive(**{quantity.name: given}))
    own = conditions.commanded_quantity(resolved)
    return own, np.atleast_1d(require_positive(**{own.name: conditions.own_level(resolved)}))


def _computed_periods(resolved: ResolvedRig, volts: Floats) -> tuple[Floats, Floats]:
    """Displacement and normal force of the contact over a period at each voltage; NaN where not converged."""
    states = steady_states(resolved, **conditions.level_settings(resolved, volts))
    displacement, normal_force = np.full((2, volts.size, _PHASES), np.nan)
    for point in np.flatnonzero(states.status != Status.NOT_CONVERGED):
        period = contact_motion(states, int(point), samples=_PHASES)
        displacement[point], normal_force[point] = period.displacement, period.normal_force
    return displacement, normal_force


def _sine_periods(rig: Rig, points: OperatingPoints) -> tuple[Floats, Floats]:
    """Displacement and normal force of the contact over a period of each sine; NaN where there is none."""
    displacement, normal_force = np.full((2, points.vibration_amplitude.size, _PHASES), np.nan)
    for point in np.flatnonzero(np.isfinite(points.vibration_amplitude)):
        period = prescribed_sine(rig, vibration_amplitude=float(points.vibration_amplitude[point]))
        step = period.displacement.size // _PHASES
        displacement[point], normal_force[point] = period.displacement[::step], period.normal_force[::step]
    return displacement, normal_force


def _weighted(rig: DrivenRig, load: float) -> DrivenRig:
    """Rig with another dead load, whose weights add to the masses where it hangs."""
    structure = rig.structure
    if structure.load_vector is None:
        raise InvalidInput(f"{rig.title}: structure.loaded is missing; name the mass that the weights hang on")
    added = (load - rig.normal_load) / _GRAVITY * np.multiply.outer(structure.load_vector, structure.load_vector)
    try:
        weighted = replace(structure, mass_matrix=structure.mass_matrix + added)
    except InvalidInput:
        raise InvalidInput(
            f"normal_load {load:g} N leaves no mass on the loading arm: it is {rig.normal_load - load:.3g} N less than"
            " the rig's own"
        ) from None
    return replace(rig, normal_load=load, structure=weighted)


def _slowest(resolved: ResolvedRig) -> float:
    natural = modes(structure_in_contact(resolved))
    return float(natural.natural_frequency[~natural.rigid].min())


def _study(resolved: ResolvedRig, title: str, values: Mapping[str, NDArray[Any]], **axes: NDArray[Any]) -> Dataset:
    rig, known = resolved.rig, conditions.commanded_quantity(resolved)
    values = {
        name: array
        for name, array in values.items()
        if name not in axes and not (known is conditions.AMPLITUDE and name in POWERS)
    }
    about = {"rig": rig.title, "friction_model": rig.friction_model.name} | amplitude_labels(resolved)
    return gridded(values, axes=axes, title=f"Friction {title}, {rig.title}", about=about)
