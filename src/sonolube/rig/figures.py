"""Figures of results of a rig: steady vibration, linear response, start-up, temperature and lubrication regime."""

from typing import TYPE_CHECKING

import numpy as np

from sonolube.charts import Axis, Chart, Field, Line, Panel, Part, Points, Rule, Zone
from sonolube.checks import Floats
from sonolube.models.friction import LubricationMethod

if TYPE_CHECKING:
    import xarray as xr

    from sonolube.rig.contact_temperature import TemperaturePoint
    from sonolube.rig.datasets import LabelledArrays
    from sonolube.rig.linear_response import FrequencyResponse
    from sonolube.rig.lubrication import LubricationMap, LubricationPoint
    from sonolube.rig.record import Rig
    from sonolube.rig.start_up_transient import StartUp

_CONTACT_LOSS_FORCE = 0.01  # force over load below which contact counts as lost
_LAST_PERIODS = 4  # periods of the drive shown enlarged at the end of a start-up
_LAST_POINTS = 801  # points drawn of those periods


def simulation_chart(result: "xr.Dataset | LabelledArrays") -> Chart:
    """Displacement of the tip and contact force over one repetition of the steady vibration.

    Two panels over time; intervals without contact are shaded.
    """
    time = 1e6 * result["time"].to_numpy()
    displacement, normal_force = result["displacement"].to_numpy(), result["normal_force"].to_numpy()
    attributes = result.attrs
    rest, load, rise = (attributes[name] for name in ("separation_at_rest_m", "normal_load_N", "mean_displacement_m"))
    lost = _zones(time, normal_force < _CONTACT_LOSS_FORCE * load, label="contact lost")
    gap: tuple[Part, ...] = (
        *lost,
        Line(x=time, y=1e6 * displacement),
        Rule(along="y", value=1e6 * rise, label=f"mean gap, {1e6 * (rest + rise):.2f} µm", colour=1, dash=1),
        Rule(along="y", value=0.0, label=f"gap at rest, {1e6 * rest:.2f} µm"),
    )
    force: tuple[Part, ...] = (
        *lost,
        Line(x=time, y=normal_force),
        Rule(along="y", value=load, label=f"load, {load:.4g} N"),
    )
    x = Axis(label="Time", unit="µs", lowest=0.0, highest=float(time[-1]))
    return Chart(
        panels=(
            Panel(x=x, y=Axis(label="Displacement of the tip\nfrom rest", unit="µm"), parts=gap),
            Panel(x=x, y=Axis(label="Contact force", unit="N", lowest=0.0), parts=force),
        ),
        size=(5.2, 4.8),
        title=f"{attributes['rig']}\n{attributes['interval']}",
        legend="top",
        shares_x=True,
    )


def _zones(time: Floats, inside: "np.ndarray[tuple[int], np.dtype[np.bool_]]", *, label: str) -> tuple[Zone, ...]:
    """Intervals of time in which something holds; none where there are none."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], inside, [False]]).astype(np.int8)))
    if not edges.size:
        return ()
    return (Zone(first=time[edges[::2]], last=time[np.minimum(edges[1::2], time.size - 1)], label=label),)


def response_chart(rig: "Rig", result: "FrequencyResponse") -> Chart:
    """Amplitude per volt, electrical impedance and phase of the linear response over frequency."""
    kilohertz = 1e-3 * result.frequency
    drive = () if rig.drive is None else (Rule(value=1e-3 * rig.drive.frequency, label="drive"),)
    x = Axis(label="Frequency", unit="kHz")
    rows = (
        (1e6 * result.amplitude_per_volt, Axis(label="Amplitude per volt", unit="µm/V", logarithmic=True)),
        (result.impedance, Axis(label="Impedance", unit="ohm", logarithmic=True)),
        (np.degrees(result.phase), Axis(label="Phase", unit="deg", ticks=(-90, -45, 0, 45, 90))),
    )
    panels = [
        Panel(x=x, y=y, parts=(Line(x=kilohertz, y=values, colour=place), *drive))
        for place, (values, y) in enumerate(rows)
    ]
    return Chart(panels=tuple(panels), size=(5.2, 5.4), title=rig.title, legend="top", shares_x=True)


def start_up_chart(rig: "Rig", result: "StartUp") -> Chart:
    """Displacement of the tip from rest over the whole start-up and over its last four periods.

    Between steps of the time integration the last periods are drawn by cubic Hermite interpolation of displacement
    and velocity.
    """
    from scipy.interpolate import CubicHermiteSpline

    assert rig.drive is not None
    time, contact = result.trajectory.time, result.trajectory.contact
    micrometres = 1e6 * contact.displacement
    end = int(np.searchsorted(time, time[-1] - _LAST_PERIODS / rig.drive.frequency))
    interpolated = CubicHermiteSpline(time[end:], micrometres[end:], 1e6 * contact.velocity[end:])
    dense = np.linspace(time[end], time[-1], _LAST_POINTS)
    x, y = Axis(label="Time", unit="ms"), Axis(label="Displacement\nof the tip", unit="µm")
    return Chart(
        panels=(
            Panel(x=x, y=y, parts=(Line(x=1e3 * time, y=micrometres, weight=0.5),)),
            Panel(x=x, y=y, parts=(Line(x=1e3 * dense, y=interpolated(dense)),), title="the last four periods"),
        ),
        size=(5.2, 4.6),
        title=rig.title,
    )


def temperature_chart(rig: "Rig", result: "TemperaturePoint") -> Chart:
    """Temperature rise of the contact and of the bulk of the pin over a test, with and without vibration."""
    lines = [
        Line(x=history.time, y=rise, label=f"{body}, {label}", colour=place, dash=dash)
        for place, (label, history) in enumerate(
            (("without vibration", result.without_vibration), ("with vibration", result.with_vibration))
        )
        for dash, (body, rise) in enumerate(
            (("contact", history.temperature_rise), ("bulk of the pin", history.bulk_rise))
        )
    ]
    x = Axis(label="Time", unit="s", lowest=0.0, highest=float(result.with_vibration.time[-1]))
    y = Axis(label="Rise of the temperature", unit="K", lowest=0.0)
    panel = Panel(x=x, y=y, parts=tuple(lines))
    return Chart(panels=(panel,), title=rig.title, legend="top", legend_columns=2)


def lubrication_chart(rig: "Rig", result: "LubricationPoint", surroundings: "LubricationMap") -> Chart:
    """Map of the method of least friction over sliding speed and nominal pressure, with the rig on it."""
    names = [str(method) for method in LubricationMethod]
    places = {name: float(place) for place, name in enumerate(names)}
    best = np.array([[places[str(name)] for name in row] for row in surroundings.best])
    x, y = 1e3 * surroundings.sliding_speed, 1e-6 * surroundings.nominal_pressure
    parts = (
        Field(x=x, y=y, values=best, words=tuple(names)),
        Points(
            x=np.array([1e3 * result.sliding_speed]),
            y=np.array([1e-6 * result.nominal_pressure]),
            label="the rig",
            colour="0",
            size=1.3,
        ),
    )
    panel = Panel(
        x=Axis(label="Sliding speed", unit="mm/s", logarithmic=True),
        y=Axis(label="Nominal pressure", unit="MPa", logarithmic=True),
        parts=parts,
    )
    return Chart(panels=(panel,), size=(5.2, 4.0), title=rig.title, legend="bottom", legend_columns=5)
