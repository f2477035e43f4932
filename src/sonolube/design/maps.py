"""Maps of friction reduction: over sliding speed and stress, sliding speed and power, drive frequency and voltage."""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.dynamics.backend import Backend, device_name, usable_backend
from sonolube.errors import InvalidInput
from sonolube.rig import NUMBERS, STATUSES, Rig, gridded, point_batch
from sonolube.rig.driven_rig import require_drive

if TYPE_CHECKING:
    import xarray as xr

SATURATION = 0.05
"""Friction reduction by which doubling the power must add to be worth it; the ridge is where it no longer is. []"""


def velocity_stress_map(
    rig: Rig,
    *,
    sliding_speed: ArrayLike,
    normal_load: ArrayLike,
    voltage_peak_to_peak: ArrayLike,
    backend: Backend = "cpu",
) -> "xr.Dataset":
    """Return friction reduction over sliding speed and nominal stress, at some drive voltages.

    Parameters
    ----------
    rig : Rig
        With a stack, a structure and a drive voltage.
    sliding_speed : array_like, shape (n,)
        Macroscopic relative speeds. [m/s]
    normal_load : array_like, shape (m,)
        Forces pressing the bodies together; the structure stays as it is. [N]
    voltage_peak_to_peak : array_like, shape (p,)
        Swings of the drive, one to a panel; the offset goes with them in the rig's own proportion. [V]
    backend : {"cpu", "gpu"}
        Whether an NVIDIA GPU finds the vibrations that it can; its name then stands in the attribute `device`.

    Returns
    -------
    xarray.Dataset
        Over `voltage_peak_to_peak`, `normal_load` and `sliding_speed`, with `nominal_pressure` and `actuator_power`
        beside.

    Raises
    ------
    InvalidInput
        If the rig has no structure, or a value is not positive.

    Warns
    -----
    GpuUnused
        If a GPU was asked for and there is none, or it does not serve the rig's contact or structure.

    References
    ----------
    .. [1] D figures 4.9 and 4.10.
    """
    return _mapped(
        rig,
        "velocity-stress",
        backend,
        voltage_peak_to_peak=voltage_peak_to_peak,
        normal_load=normal_load,
        sliding_speed=sliding_speed,
    )


def velocity_power_map(
    rig: Rig,
    *,
    sliding_speed: ArrayLike,
    voltage_peak_to_peak: ArrayLike,
    normal_load: ArrayLike,
    backend: Backend = "cpu",
) -> "xr.Dataset":
    """Return friction reduction over sliding speed and the amplifier's power, under some loads, and its ridge.

    Parameters
    ----------
    rig : Rig
        With a stack, a structure and a drive voltage.
    sliding_speed : array_like, shape (n,)
        Macroscopic relative speeds. [m/s]
    voltage_peak_to_peak : array_like, shape (m,)
        Swings of the drive that give the powers; the offset goes with them in the rig's own proportion. [V]
    normal_load : array_like, shape (p,)
        Forces pressing the bodies together, one to a panel; the structure stays as it is. [N]
    backend : {"cpu", "gpu"}
        Whether an NVIDIA GPU finds the vibrations that it can; its name then stands in the attribute `device`.

    Returns
    -------
    xarray.Dataset
        Over `normal_load`, `voltage_peak_to_peak` and `sliding_speed`, with `actuator_power` and `nominal_pressure`
        beside. `sufficient_power` is the ridge: at each load and speed the power whose doubling reduces friction by
        only another 0.05, NaN where that lies beyond half of the highest power of the map.

    Raises
    ------
    InvalidInput
        If the rig has no structure, or a value is not positive.

    Warns
    -----
    GpuUnused
        If a GPU was asked for and there is none, or it does not serve the rig's contact or structure.

    References
    ----------
    .. [1] D figures 4.11, 4.12, 4.20 and B.1 to B.6.
    """
    found = _mapped(
        rig,
        "velocity-power",
        backend,
        normal_load=normal_load,
        voltage_peak_to_peak=voltage_peak_to_peak,
        sliding_speed=sliding_speed,
    )
    power, reduction = found["actuator_power"].values, found["friction_reduction"].values
    ridge = sufficient_power(friction_reduction=np.moveaxis(reduction, 1, -1), actuator_power=power)
    labels = {"units": "W", "long_name": "Power whose doubling reduces friction by only another 0.05"}
    return found.assign(sufficient_power=(("normal_load", "sliding_speed"), ridge, labels))


def frequency_voltage_map(
    rig: Rig, *, frequency: ArrayLike, voltage_peak_to_peak: ArrayLike, backend: Backend = "cpu"
) -> "xr.Dataset":
    """Return friction reduction over drive frequency and voltage, at the rig's load and speed.

    Parameters
    ----------
    rig : Rig
        With a stack, a structure and a drive voltage.
    frequency : array_like, shape (n,)
        Frequencies of the drive. [Hz]
    voltage_peak_to_peak : array_like, shape (m,)
        Swings of the drive; the offset goes with them in the rig's own proportion. [V]
    backend : {"cpu", "gpu"}
        Whether an NVIDIA GPU finds the vibrations that it can; its name then stands in the attribute `device`.

    Returns
    -------
    xarray.Dataset
        Over `voltage_peak_to_peak` and `frequency`.

    Raises
    ------
    InvalidInput
        If the rig has no structure, or a value is not positive.

    Warns
    -----
    GpuUnused
        If a GPU was asked for and there is none, or it does not serve the rig's contact or structure.
    """
    return _mapped(rig, "frequency-voltage", backend, voltage_peak_to_peak=voltage_peak_to_peak, frequency=frequency)


def sufficient_power(*, friction_reduction: ArrayLike, actuator_power: ArrayLike) -> Floats:
    """Return the power beyond which doubling it reduces friction by no more than another 0.05. [W]

    Parameters
    ----------
    friction_reduction : array_like, shape (..., n)
        Reductions over rising power, NaN where nothing is known. []
    actuator_power : array_like, shape (n,)
        Power of the amplifier. [W]

    Returns
    -------
    ndarray, shape (...)
        By lines between the powers; NaN where doubling buys more up to the end, or nowhere.

    Raises
    ------
    InvalidInput
        If a power is negative or not finite.
    """
    power = require_non_negative(actuator_power=actuator_power)
    rows = np.asarray(friction_reduction, dtype=np.float64)
    halves = np.unique(np.concatenate([power, power / 2]))
    halves = halves[(halves >= power[0]) & (2 * halves <= power[-1])]
    found = np.full(rows.shape[:-1], np.nan)
    for place in np.ndindex(found.shape):
        gain = np.interp(2 * halves, power, rows[place]) - np.interp(halves, power, rows[place]) - SATURATION
        worth = np.flatnonzero(gain > 0)
        if worth.size and worth[-1] + 1 < halves.size and np.isfinite(gain).all():
            last = int(worth[-1])
            share = gain[last] / (gain[last] - gain[last + 1])
            found[place] = halves[last] + share * (halves[last + 1] - halves[last])
    return found


def _mapped(rig: Rig, kind: str, backend: Backend, **axes: ArrayLike) -> "xr.Dataset":
    backend = usable_backend(backend)
    values = {name: np.atleast_1d(require_positive(**{name: array})) for name, array in axes.items()}
    for name, array in values.items():
        if array.ndim != 1 or np.any(np.diff(array) <= 0):
            raise InvalidInput(f"{name} must be one row of values that rise")
    shape = tuple(array.size for array in values.values())
    mesh = dict(zip(values, np.meshgrid(*values.values(), indexing="ij"), strict=True))
    share = require_drive(rig).offset_ratio
    points = point_batch(rig, **mesh, voltage_offset=share * mesh["voltage_peak_to_peak"], backend=backend)
    columns: dict[str, NDArray[Any]] = {name: points.numbers[name].reshape(shape) for name in NUMBERS}
    columns["status"] = np.array(STATUSES)[points.status].reshape(shape)
    columns["reason"] = np.array(points.reasons)[points.reason].reshape(shape)
    power = columns.pop("actuator_power")
    about = {"rig": rig.title, "map": kind} | ({"device": device_name(backend)} if backend == "gpu" else {})
    found = gridded(columns, axes=values, title=f"Friction reduction, {rig.title}", about=about)
    labels = {"units": "W", "long_name": "Power of a linear amplifier, D 1.9"}
    if "frequency" in values:
        return found.assign_coords(actuator_power=(tuple(values), power, labels))
    along = list(values).index("voltage_peak_to_peak")
    at_each_voltage = np.moveaxis(power, along, 0).reshape(shape[along], -1)[:, 0]
    pressure = {"units": "Pa", "long_name": "Nominal contact pressure"}
    return found.assign_coords(
        actuator_power=("voltage_peak_to_peak", at_each_voltage, labels),
        nominal_pressure=("normal_load", values["normal_load"] / rig.contact.nominal_area, pressure),
    )


MAPS: Mapping[str, Callable[..., "xr.Dataset"]] = MappingProxyType(
    {
        "velocity-stress": velocity_stress_map,
        "velocity-power": velocity_power_map,
        "frequency-voltage": frequency_voltage_map,
    }
)
"""The maps by kind; each takes a rig, the axes that its docstring names, and a backend."""

PLACES: Mapping[str, tuple[str, str, str | None]] = MappingProxyType(
    {
        "velocity-stress": ("sliding_speed", "nominal_pressure", "voltage_peak_to_peak"),
        "velocity-power": ("sliding_speed", "actuator_power", "normal_load"),
        "frequency-voltage": ("frequency", "voltage_peak_to_peak", None),
    }
)
"""What each kind of map has across, up, and one panel to each of."""
