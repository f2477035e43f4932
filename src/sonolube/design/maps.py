"""Maps of friction reduction over sliding speed or frequency, and stress, power, voltage or vibration amplitude."""

import inspect
from collections.abc import Callable, Mapping
from itertools import pairwise
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats, require_positive
from sonolube.design.point_statistics import saturation_power
from sonolube.errors import InvalidInput
from sonolube.rig import (
    AMPLITUDE,
    NUMBERS,
    STATUSES,
    VOLTAGE,
    CommandedQuantity,
    Rig,
    amplitude_labels,
    commanded_quantity,
    gridded,
    level_settings,
    own_level,
    point_batch,
    quantity_of_axis,
    require_commanded,
)
from sonolube.rig.datasets import labels as labels_of
from sonolube.rig.power import POWERS, FiguredPower

if TYPE_CHECKING:
    import xarray as xr


_MAP_POWERS = ("power_to_supply", "charging_power")  # coordinates of a map under a voltage


def velocity_stress_map(
    rig: Rig,
    *,
    sliding_speed: ArrayLike,
    normal_load: ArrayLike,
    voltage_peak_to_peak: ArrayLike | None = None,
    vibration_amplitude: ArrayLike | None = None,
    power: FiguredPower = "power_to_supply",
) -> "xr.Dataset":
    """Friction reduction over sliding speed and nominal stress, for several drive voltages or amplitudes.

    Parameters
    ----------
    rig : Rig
        Its vibration is by the source of its amplitude.
    sliding_speed : array_like, shape (n,)
        Macroscopic relative speeds. [m/s]
    normal_load : array_like, shape (m,)
        Forces pressing the bodies together; the structure is kept. [N]
    voltage_peak_to_peak : array_like, shape (p,), optional
        Drive voltages, one per panel; the offset is scaled in the rig's own ratio. [V]
    vibration_amplitude : array_like, shape (p,), optional
        Amplitudes of a rig without a drive voltage, one per panel. [m]
    power : {"power_to_supply", "charging_power"}
        Power that stands beside a voltage in figures; the charge of the capacitance alone is D 1.9's.

    Returns
    -------
    xarray.Dataset
        Over `voltage_peak_to_peak` or `vibration_amplitude`, `normal_load` and `sliding_speed`, with the coordinate
        `nominal_pressure`; of voltages also with `power_to_supply` and
        `charging_power`.

    Raises
    ------
    InvalidInput
        If the rig has no amplitude, the quantity given does not set its vibration, or values are not positive and
        increasing.

    See Also
    --------
    velocity_power_map, velocity_amplitude_map, frequency_voltage_map

    References
    ----------
    .. [1] D figures 4.9 and 4.10.
    """
    given = {"voltage_peak_to_peak": voltage_peak_to_peak, "vibration_amplitude": vibration_amplitude}
    panels = {name: values for name, values in given.items() if values is not None}
    if len(panels) != 1:
        raise InvalidInput("a velocity-stress map needs either voltage_peak_to_peak or vibration_amplitude")
    return _computed_map(
        rig, "velocity-stress", power=power, **panels, normal_load=normal_load, sliding_speed=sliding_speed
    )


def velocity_amplitude_map(
    rig: Rig, *, sliding_speed: ArrayLike, vibration_amplitude: ArrayLike, normal_load: ArrayLike
) -> "xr.Dataset":
    """Friction reduction over sliding speed and vibration amplitude, for several normal loads.

    Parameters
    ----------
    rig : Rig
        Without a drive voltage; its vibration is a sine.
    sliding_speed : array_like, shape (n,)
        Macroscopic relative speeds. [m/s]
    vibration_amplitude : array_like, shape (m,)
        Zero to peak, the same under every load. [m]
    normal_load : array_like, shape (p,)
        Forces pressing the bodies together, one per panel. [N]

    Returns
    -------
    xarray.Dataset
        Over `normal_load`, `vibration_amplitude` and `sliding_speed`, with the coordinate `nominal_pressure`.

    Raises
    ------
    InvalidInput
        If the rig has a drive voltage or no amplitude, or values are not positive and increasing.

    See Also
    --------
    velocity_power_map, velocity_stress_map, frequency_amplitude_map
    """
    return _computed_map(
        rig,
        "velocity-amplitude",
        normal_load=normal_load,
        vibration_amplitude=vibration_amplitude,
        sliding_speed=sliding_speed,
    )


def velocity_power_map(
    rig: Rig,
    *,
    sliding_speed: ArrayLike,
    voltage_peak_to_peak: ArrayLike,
    normal_load: ArrayLike,
    power: FiguredPower = "power_to_supply",
) -> "xr.Dataset":
    """Friction reduction over sliding speed and power, for several normal loads, with the saturation power.

    Parameters
    ----------
    rig : Rig
        With a drive voltage; its vibration is by the source of its amplitude.
    sliding_speed : array_like, shape (n,)
        Macroscopic relative speeds. [m/s]
    voltage_peak_to_peak : array_like, shape (m,)
        Drive voltages, which determine the powers; the offset is scaled in the rig's own ratio. [V]
    normal_load : array_like, shape (p,)
        Forces pressing the bodies together, one per panel; the structure is kept. [N]
    power : {"power_to_supply", "charging_power"}
        Power that the map is over; the charge of the capacitance alone is D 1.9's.

    Returns
    -------
    xarray.Dataset
        Over `normal_load`, `voltage_peak_to_peak` and `sliding_speed`, with the coordinates `power_to_supply` and
        `charging_power` of each load and voltage, and `nominal_pressure`. `saturation_power` holds, for each load and
        speed, the power beyond which doubling it reduces friction by no more than another 0.05; NaN where that exceeds
        half of the highest power of the map.

    Raises
    ------
    InvalidInput
        If the rig has no drive voltage or amplitude, or values are not positive and increasing.

    See Also
    --------
    saturation_power, velocity_stress_map, frequency_voltage_map

    References
    ----------
    .. [1] D figures 4.11, 4.12, 4.20 and B.1 to B.6.
    """
    computed = _computed_map(
        rig,
        "velocity-power",
        power=power,
        normal_load=normal_load,
        voltage_peak_to_peak=voltage_peak_to_peak,
        sliding_speed=sliding_speed,
    )
    reduction = np.moveaxis(computed["friction_reduction"].values, 1, -1)
    saturation = [
        saturation_power(friction_reduction=of_load[:, order], actuator_power=watts[order])
        for of_load, watts in zip(reduction, computed[power].values, strict=True)
        for order in [np.argsort(watts)]
    ]
    labels = {"units": "W", "long_name": "Power beyond which doubling it reduces friction by no more than another 0.05"}
    return computed.assign(saturation_power=(("normal_load", "sliding_speed"), saturation, labels))


def frequency_voltage_map(rig: Rig, *, frequency: ArrayLike, voltage_peak_to_peak: ArrayLike) -> "xr.Dataset":
    """Friction reduction over drive frequency and voltage, at the rig's load and speed.

    Parameters
    ----------
    rig : Rig
        With a drive voltage; its vibration is by the source of its amplitude.
    frequency : array_like, shape (n,)
        Drive frequencies. [Hz]
    voltage_peak_to_peak : array_like, shape (m,)
        Drive voltages; the offset is scaled in the rig's own ratio. [V]

    Returns
    -------
    xarray.Dataset
        Over `voltage_peak_to_peak` and `frequency`, with the coordinates `power_to_supply` and `charging_power`.

    Raises
    ------
    InvalidInput
        If the rig has no drive voltage or amplitude, or values are not positive and increasing.

    See Also
    --------
    velocity_power_map, velocity_stress_map
    """
    return _computed_map(rig, "frequency-voltage", voltage_peak_to_peak=voltage_peak_to_peak, frequency=frequency)


def frequency_amplitude_map(rig: Rig, *, frequency: ArrayLike, vibration_amplitude: ArrayLike) -> "xr.Dataset":
    """Friction reduction over frequency and vibration amplitude, at the rig's load and speed.

    Parameters
    ----------
    rig : Rig
        Without a drive voltage; its vibration is a sine.
    frequency : array_like, shape (n,)
        Frequencies of the vibration. [Hz]
    vibration_amplitude : array_like, shape (m,)
        Zero to peak, the same at every frequency. [m]

    Returns
    -------
    xarray.Dataset
        Over `vibration_amplitude` and `frequency`.

    Raises
    ------
    InvalidInput
        If the rig has a drive voltage or no amplitude, or values are not positive and increasing.

    See Also
    --------
    velocity_amplitude_map, frequency_voltage_map
    """
    return _computed_map(rig, "frequency-amplitude", vibration_amplitude=vibration_amplitude, frequency=frequency)


def _computed_map(rig: Rig, kind: str, *, power: FiguredPower = "power_to_supply", **axes: ArrayLike) -> "xr.Dataset":
    """Operating points on the grid of some axes as a dataset, with nominal pressure and, under a voltage, its power."""
    quantity = quantity_of_axis(axes)
    require_commanded(rig, quantity)
    values = {name: np.atleast_1d(require_positive(**{name: array})) for name, array in axes.items()}
    for name, array in values.items():
        if array.ndim != 1:
            raise InvalidInput(f"{name} must have one axis, got shape {array.shape}")
        for lower, upper in pairwise(array):
            if upper <= lower:
                raise InvalidInput(f"{name} must increase from value to value, got {lower:g} before {upper:g}")
    shape = tuple(array.size for array in values.values())
    mesh: dict[str, Any] = dict(zip(values, np.meshgrid(*values.values(), indexing="ij"), strict=True))
    settings = level_settings(rig, mesh.pop(quantity.name))
    points = point_batch(rig, **mesh, **settings)
    left_out = (*values, *_MAP_POWERS) if quantity is VOLTAGE else (*values, *POWERS)
    columns: dict[str, NDArray[Any]] = {
        name: points.numbers[name].reshape(shape) for name in NUMBERS if name not in left_out
    }
    columns["status"] = np.array(STATUSES)[points.status].reshape(shape)
    columns["reason"] = np.array(points.reasons)[points.reason].reshape(shape)
    about = (
        {"result": "map", "rig": rig.title, "map": kind}
        | amplitude_labels(rig)
        | ({"power": power} if quantity is VOLTAGE else {})
    )
    computed = gridded(columns, axes=values, title=f"Friction reduction, {rig.title}", about=about)
    if "normal_load" in values:
        labels = {"units": "Pa", "long_name": "Nominal contact pressure"}
        pressure = values["normal_load"] / rig.contact.nominal_area
        computed = computed.assign_coords(nominal_pressure=("normal_load", pressure, labels))
    if quantity is AMPLITUDE:
        return computed
    return _with_powers(rig, computed, {name: points.numbers[name].reshape(shape) for name in _MAP_POWERS})


def _with_powers(rig: Rig, computed: "xr.Dataset", powers: Mapping[str, Floats]) -> "xr.Dataset":
    """Map with the power to supply and its charging part over the axes that change them, all but the speed."""
    dims = [str(name) for name in computed["status"].dims]
    if "frequency" not in dims and not any(np.any(np.isfinite(power)) for power in powers.values()):
        raise InvalidInput(
            f"{rig.title}: no voltage has a power, which this map is over: actuator.capacitance is missing; give it, or"
            " map frequency-voltage"
        )
    if "sliding_speed" in dims:
        at = dims.index("sliding_speed")
        dims.pop(at)
        powers = {name: np.take(power, 0, axis=at) for name, power in powers.items()}
    return computed.assign_coords({name: (dims, power, labels_of(name)) for name, power in powers.items()})


MAPS: Mapping[str, Callable[..., "xr.Dataset"]] = MappingProxyType(
    {
        "velocity-power": velocity_power_map,
        "velocity-amplitude": velocity_amplitude_map,
        "velocity-stress": velocity_stress_map,
        "frequency-voltage": frequency_voltage_map,
        "frequency-amplitude": frequency_amplitude_map,
    }
)
"""Functions that compute a map, by its kind; each takes a rig and the axes of its signature."""


def map_kinds(quantity: CommandedQuantity) -> tuple[str, ...]:
    """Kinds of maps of rigs whose vibration is set by a quantity, the usual one first.

    Parameters
    ----------
    quantity : CommandedQuantity

    Returns
    -------
    tuple of str
        Keys of `MAPS`.
    """
    return tuple(kind for kind, function in MAPS.items() if quantity.name in inspect.signature(function).parameters)


def default_axes(rig: Rig, *, kind: str) -> dict[str, Floats]:
    """Values of every axis of a map about the operating point of a rig.

    By quantity: speeds from 10 to 200 mm/s, loads from 0.6 to 1.8 of the rig's, voltages or amplitudes up to the rig's,
    frequencies within a fifth of the rig's.
    """
    quantity, own = commanded_quantity(rig), own_level(rig)
    wanted = inspect.signature(MAPS[kind]).parameters
    load_is_panel = kind != "velocity-stress"
    shares = np.linspace(0.02, 1, 50) if load_is_panel else np.linspace(0.2, 1, 5)
    axes = {
        "sliding_speed": np.linspace(10e-3, 0.2, 77),
        "normal_load": rig.normal_load * np.linspace(0.6, 1.8, 7 if load_is_panel else 25),
        quantity.name: (own or 1 / quantity.axis_scale) * shares,
    }
    if "frequency" in wanted:
        if rig.drive is None:
            raise InvalidInput(f"{rig.title}: drive.frequency is missing; give it, or map over the sliding speed")
        axes["frequency"] = rig.drive.frequency * np.linspace(0.8, 1.2, 41 if quantity is AMPLITUDE else 161)
    return {name: axes[name] for name in wanted if name in axes}
