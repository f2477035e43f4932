"""Maps of friction reduction over sliding speed and stress, sliding speed and power, or drive frequency and voltage."""

import inspect
from collections.abc import Callable, Mapping
from itertools import pairwise
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.errors import InvalidInput
from sonolube.models.dynamics.backend import Backend, device_name, usable_backend
from sonolube.rig import NUMBERS, STATUSES, Rig, amplitude_labels, gridded, point_batch
from sonolube.rig.driven_rig import require_drive
from sonolube.units import format_si
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr

SATURATION_GAIN = 0.05
"""Additional friction reduction per doubling of the power below which the reduction counts as saturated. []"""

_SAME_PANELS = 0.005  # of the friction reduction, which nobody sees in contours of 5 %


def velocity_stress_map(
    rig: Rig,
    *,
    sliding_speed: ArrayLike,
    normal_load: ArrayLike,
    voltage_peak_to_peak: ArrayLike,
    backend: Backend = "cpu",
) -> "xr.Dataset":
    """Friction reduction over sliding speed and nominal stress, for several drive voltages.

    Parameters
    ----------
    rig : Rig
        With a drive voltage; its vibration is by the source of its amplitude.
    sliding_speed : array_like, shape (n,)
        Macroscopic relative speeds. [m/s]
    normal_load : array_like, shape (m,)
        Forces pressing the bodies together; the structure is kept. [N]
    voltage_peak_to_peak : array_like, shape (p,)
        Drive voltages, one per panel; the offset is scaled in the rig's own ratio. [V]
    backend : {"cpu", "gpu"}
        Whether an NVIDIA GPU computes the vibrations that it supports; its name is then the attribute `device`.

    Returns
    -------
    xarray.Dataset
        Over `voltage_peak_to_peak`, `normal_load` and `sliding_speed`, with the coordinates `nominal_pressure` and
        `actuator_power`.

    Raises
    ------
    InvalidInput
        If the rig has no drive voltage or amplitude, or values are not positive and increasing.

    Warns
    -----
    GpuUnused
        If the GPU backend was requested but no GPU is present, or it does not support the rig's contact or structure.

    See Also
    --------
    velocity_power_map, frequency_voltage_map

    References
    ----------
    .. [1] D figures 4.9 and 4.10.
    """
    return _computed_map(
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
    """Friction reduction over sliding speed and amplifier power, for several normal loads, with the saturation power.

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
    backend : {"cpu", "gpu"}
        Whether an NVIDIA GPU computes the vibrations that it supports; its name is then the attribute `device`.

    Returns
    -------
    xarray.Dataset
        Over `normal_load`, `voltage_peak_to_peak` and `sliding_speed`, with the coordinates `actuator_power` and
        `nominal_pressure`. `saturation_power` holds, for each load and speed, the power beyond which doubling it
        reduces friction by no more than another 0.05; NaN where that exceeds half of the highest power of the map.

    Raises
    ------
    InvalidInput
        If the rig has no drive voltage or amplitude, or values are not positive and increasing.

    Warns
    -----
    GpuUnused
        If the GPU backend was requested but no GPU is present, or it does not support the rig's contact or structure.

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
        backend,
        normal_load=normal_load,
        voltage_peak_to_peak=voltage_peak_to_peak,
        sliding_speed=sliding_speed,
    )
    power, reduction = computed["actuator_power"].values, computed["friction_reduction"].values
    saturation = saturation_power(friction_reduction=np.moveaxis(reduction, 1, -1), actuator_power=power)
    labels = {"units": "W", "long_name": "Power beyond which doubling it reduces friction by no more than another 0.05"}
    return computed.assign(saturation_power=(("normal_load", "sliding_speed"), saturation, labels))


def frequency_voltage_map(
    rig: Rig, *, frequency: ArrayLike, voltage_peak_to_peak: ArrayLike, backend: Backend = "cpu"
) -> "xr.Dataset":
    """Friction reduction over drive frequency and voltage, at the rig's load and speed.

    Parameters
    ----------
    rig : Rig
        With a drive voltage; its vibration is by the source of its amplitude.
    frequency : array_like, shape (n,)
        Drive frequencies. [Hz]
    voltage_peak_to_peak : array_like, shape (m,)
        Drive voltages; the offset is scaled in the rig's own ratio. [V]
    backend : {"cpu", "gpu"}
        Whether an NVIDIA GPU computes the vibrations that it supports; its name is then the attribute `device`.

    Returns
    -------
    xarray.Dataset
        Over `voltage_peak_to_peak` and `frequency`, with the coordinate `actuator_power`.

    Raises
    ------
    InvalidInput
        If the rig has no drive voltage or amplitude, or values are not positive and increasing.

    Warns
    -----
    GpuUnused
        If the GPU backend was requested but no GPU is present, or it does not support the rig's contact or structure.

    See Also
    --------
    velocity_power_map, velocity_stress_map
    """
    return _computed_map(
        rig, "frequency-voltage", backend, voltage_peak_to_peak=voltage_peak_to_peak, frequency=frequency
    )


def saturation_power(*, friction_reduction: ArrayLike, actuator_power: ArrayLike) -> Floats:
    r"""Power beyond which doubling it reduces friction by no more than another 0.05. [W]

    Parameters
    ----------
    friction_reduction : array_like, shape (..., n)
        Friction reduction at each power, NaN where it is unknown. []
    actuator_power : array_like, shape (n,)
        Amplifier powers, increasing. [W]

    Returns
    -------
    ndarray, shape (...)
        NaN where doubling gains more up to the last power, or gains less everywhere.

    Raises
    ------
    InvalidInput
        If a power is negative or not finite.

    Notes
    -----
    The largest root :math:`P` of

    .. math:: \mu_r(2P) - \mu_r(P) = 0.05

    with the friction reduction :math:`\mu_r` interpolated linearly over the power.
    """
    power = require_non_negative(actuator_power=actuator_power)
    rows = np.asarray(friction_reduction, dtype=np.float64)
    lower = np.unique(np.concatenate([power, power / 2]))
    lower = lower[(lower >= power[0]) & (2 * lower <= power[-1])]
    saturation = np.full(rows.shape[:-1], np.nan)
    for index in np.ndindex(saturation.shape):
        excess = np.interp(2 * lower, power, rows[index]) - np.interp(lower, power, rows[index]) - SATURATION_GAIN
        above = np.flatnonzero(excess > 0)
        if above.size and above[-1] + 1 < lower.size and np.isfinite(excess).all():
            last = int(above[-1])
            fraction = excess[last] / (excess[last] - excess[last + 1])
            saturation[index] = lower[last] + fraction * (lower[last + 1] - lower[last])
    return saturation


def _computed_map(rig: Rig, kind: str, backend: Backend, **axes: ArrayLike) -> "xr.Dataset":
    """Operating points on the grid of some axes as a dataset, with amplifier power and nominal pressure."""
    backend = usable_backend(backend)
    values = {name: np.atleast_1d(require_positive(**{name: array})) for name, array in axes.items()}
    for name, array in values.items():
        if array.ndim != 1:
            raise InvalidInput(f"{name} must have one axis, got shape {array.shape}")
        for lower, upper in pairwise(array):
            if upper <= lower:
                raise InvalidInput(f"{name} must increase from value to value, got {lower:g} before {upper:g}")
    shape = tuple(array.size for array in values.values())
    mesh: dict[str, Any] = dict(zip(values, np.meshgrid(*values.values(), indexing="ij"), strict=True))
    offset = require_drive(rig).offset_ratio * mesh["voltage_peak_to_peak"]
    points = point_batch(rig, **mesh, voltage_offset=offset, backend=backend)
    columns: dict[str, NDArray[Any]] = {name: points.numbers[name].reshape(shape) for name in NUMBERS}
    columns["status"] = np.array(STATUSES)[points.status].reshape(shape)
    columns["reason"] = np.array(points.reasons)[points.reason].reshape(shape)
    power = columns.pop("actuator_power")
    about = (
        {"result": "map", "rig": rig.title, "map": kind}
        | amplitude_labels(rig)
        | ({"device": device_name(backend)} if backend == "gpu" else {})
    )
    computed = gridded(columns, axes=values, title=f"Friction reduction, {rig.title}", about=about)
    labels = {"units": "W", "long_name": "Power of a linear amplifier, D 1.9"}
    if "frequency" in values:
        return computed.assign_coords(actuator_power=(tuple(values), power, labels))
    if not np.any(np.isfinite(power)):
        raise InvalidInput(
            f"{rig.title}: no voltage has a power, which this map is over: actuator.capacitance is missing; give it, or"
            " map frequency-voltage"
        )
    voltage_axis = list(values).index("voltage_peak_to_peak")
    power_by_voltage = np.moveaxis(power, voltage_axis, 0).reshape(shape[voltage_axis], -1)[:, 0]
    pressure = {"units": "Pa", "long_name": "Nominal contact pressure"}
    return computed.assign_coords(
        actuator_power=("voltage_peak_to_peak", power_by_voltage, labels),
        nominal_pressure=("normal_load", values["normal_load"] / rig.contact.nominal_area, pressure),
    )


MAPS: Mapping[str, Callable[..., "xr.Dataset"]] = MappingProxyType(
    {
        "velocity-stress": velocity_stress_map,
        "velocity-power": velocity_power_map,
        "frequency-voltage": frequency_voltage_map,
    }
)
"""Functions that compute a map, by its kind; each takes a rig, the axes of its signature, and a backend."""

MAP_LAYOUTS: Mapping[str, tuple[str, str, str | None]] = MappingProxyType(
    {
        "velocity-stress": ("sliding_speed", "nominal_pressure", "voltage_peak_to_peak"),
        "velocity-power": ("sliding_speed", "actuator_power", "normal_load"),
        "frequency-voltage": ("frequency", "voltage_peak_to_peak", None),
    }
)
"""Quantities along the x axis, along the y axis, and of the panels of each kind of map."""


def same_panels(computed: "xr.Dataset") -> bool:
    """Whether every panel of a map shows the same friction reduction.

    Parameters
    ----------
    computed : xarray.Dataset
        Result of a function of `MAPS`.

    Returns
    -------
    bool
        True where the panels, of which there are several, differ nowhere by more than 0.005, a tenth of a contour step,
        and lack a result at the same points.
    """
    panel = MAP_LAYOUTS[computed.attrs["map"]][2]
    if panel is None or computed.sizes[panel] < 2:
        return False
    reduction = computed["friction_reduction"]
    missing = reduction.isnull()
    if bool((missing != missing.isel({panel: 0})).any()) or bool(missing.all()):
        return False
    return float(np.nanmax(np.abs(reduction - reduction.isel({panel: 0})))) <= _SAME_PANELS


def panels_text(computed: "xr.Dataset") -> str:
    """Sentence that stands for the panels of a map where all are the same; empty where they differ.

    Parameters
    ----------
    computed : xarray.Dataset
        Result of a function of `MAPS`.

    Returns
    -------
    str
    """
    if not same_panels(computed):
        return ""
    panel = MAP_LAYOUTS[computed.attrs["map"]][2]
    values, unit = computed[panel].values, quantity(str(panel)).unit
    low, high = (format_si(float(value), unit) for value in (values[0], values[-1]))
    reduction = computed["friction_reduction"]
    apart = float(np.nanmax(np.abs(reduction - reduction.isel({panel: 0}))))
    name = quantity(str(panel)).meaning.partition(",")[0].lower()
    return f"the same at each {name} from {low} to {high}, within {100 * max(apart, 1e-4):.1g} percentage points"


def default_axes(rig: Rig, *, kind: str) -> dict[str, Floats]:
    """Values of every axis of a map about the operating point of a rig.

    Parameters
    ----------
    rig : Rig
        With a drive voltage.
    kind : str
        Key of `MAPS`.

    Returns
    -------
    dict of str to ndarray
        By quantity: speeds from 10 to 200 mm/s, loads from 0.6 to 1.8 of the rig's, voltages up to the rig's,
        frequencies within a fifth of the rig's.
    """
    drive = require_drive(rig)
    assert drive.voltage_peak_to_peak is not None
    volts = drive.voltage_peak_to_peak or 1.0
    load_is_panel = kind != "velocity-stress"
    axes = {
        "sliding_speed": np.linspace(10e-3, 0.2, 77),
        "normal_load": rig.normal_load * np.linspace(0.6, 1.8, 7 if load_is_panel else 25),
        "voltage_peak_to_peak": volts * (np.linspace(0.02, 1, 50) if load_is_panel else np.linspace(0.2, 1, 5)),
        "frequency": drive.frequency * np.linspace(0.8, 1.2, 161),
    }
    return {name: axes[name] for name in inspect.signature(MAPS[kind]).parameters if name in axes}
