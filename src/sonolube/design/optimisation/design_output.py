"""Output of an optimisation: figures, dataset of all designs, and the rig file of a design."""

import json
from collections.abc import Mapping
from dataclasses import asdict, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sonolube import __version__
from sonolube.charts import Axis, Band, Bars, Chart, Line, Note, Part, Points, Rule, one_panel
from sonolube.checks import Floats
from sonolube.design.optimisation.drive_electronics import (
    CAPACITANCE_TOLERANCE,
    DriveElectronics,
    design_rig,
    stack_admittance,
)
from sonolube.design.optimisation.evaluation import LIMITS
from sonolube.design.optimisation.gradient_search import DesignPoint
from sonolube.design.optimisation.optimum import Optimum
from sonolube.design.optimisation.screening import DesignProblem
from sonolube.design.optimisation.space import OWN_ACTUATOR, Candidate
from sonolube.models.actuator import matched_power_factor
from sonolube.rig import with_tables
from sonolube.rig.datasets import labels
from sonolube.text.units import format_si
from sonolube.vocabulary import quantities, quantity

if TYPE_CHECKING:
    import xarray as xr

_AXES = {
    "power": Axis("Power to supply", "W"),
    "heat": Axis("Heat in the actuator", "W"),
    "voltage": Axis("Voltage, peak to peak", "V"),
}
_MAX_CURVES = 6  # actuators drawn over frequency
_BANDS = 60  # of frequency, in each of which the least objective is drawn
_SPAN = 5.0  # ratio of its ends beyond which an axis of the front is logarithmic


def front_chart(optimum: Optimum) -> Chart:
    """Pareto front of two objectives among all feasible designs of the screening."""
    assert optimum.second_objective is not None
    screened = optimum.screening
    names = (optimum.minimise, optimum.second_objective)
    first, second = (screened.objectives[name][screened.feasible] for name in names)
    points = np.array([[point.objective(name) for name in names] for point in optimum.front])
    parts: list[Part] = [
        Points(x=first, y=second, label="designs looked at", colour="0.75", is_faint=True),
        Line(x=points[:, 0], y=points[:, 1], colour="0.2", weight=0.85, is_stepped=True),
    ]
    families = [_family(point.candidate) for point in optimum.front]
    for place, name in enumerate(dict.fromkeys(families)):
        own = [number for number, each in enumerate(families) if each == name]
        x, y = points[own].T
        sources = tuple(_drive(optimum.front[number]) for number in own)
        parts.append(Points(x=x, y=y, label=name, colour=place, marker=place, size=1.5, sources=sources))
    parts.append(Note(x=points[0, 0], y=points[0, 1], text=_drive(optimum.front[0]), side="above"))
    if len(points) > 1:
        parts.append(Note(x=points[-1, 0], y=points[-1, 1], text=_drive(optimum.front[-1]), side="above"))
    across, up = (_front_axis(name, values) for name, values in zip(names, points.T, strict=True))
    return one_panel(across, up, parts, size=(5.8, 3.8), legend="top")


def frequency_chart(optimum: Optimum) -> Chart:
    """Least objective over drive frequency, one curve for each actuator and waveform.

    With the refined designs as markers.
    """
    screened = optimum.screening
    families = np.array([_family(candidate) for candidate in screened.candidates])[screened.candidate_index]
    curves: list[Part] = []
    markers: list[Part] = []
    best = "best of each" if len(optimum.designs) > 1 else "best"
    for place, point in enumerate(optimum.designs[:_MAX_CURVES]):
        own = screened.feasible & (families == _family(point.candidate))
        f, least = _envelope(screened.frequency[own], screened.objectives[optimum.minimise][own])
        label = _family(point.candidate).replace(f"{OWN_ACTUATOR},", "the rig's actuator,", 1)
        curves.append(Line(x=1e-3 * f, y=least, label=label, colour=place, dash=place % 4))
        at, objective = np.array([1e-3 * point.frequency]), np.array([point.objective(optimum.minimise)])
        text = "" if place else best
        markers.append(Points(x=at, y=objective, label=text, colour=place, marker=place, size=1.5))
    low, high = optimum.problem.space.frequencies
    x = Axis("Drive frequency", "kHz", lowest=1e-3 * low, highest=1e-3 * high)
    y = replace(_AXES[optimum.minimise], logarithmic=True)
    return one_panel(x, y, (*curves, *markers), size=(5.8, 3.6), legend="top", legend_columns=2)


def limits_chart(point: DesignPoint) -> Chart:
    """Fraction of each limit that a design uses, as bars."""
    used = {name: 100 * float(values[0]) for name, values in point.evaluation.utilisation.items() if name in LIMITS}
    used = {name: percent for name, percent in sorted(used.items(), key=lambda item: item[1]) if percent > 0}
    percents = np.array(list(used.values()))
    bars = Bars(
        places=np.arange(len(used), dtype=np.float64),
        lengths=percents,
        texts=tuple(f"{each:.3g} %" for each in percents),
    )
    return one_panel(
        Axis("Share of the limit used", "%", lowest=0.0, highest=118.0),
        Axis(words=tuple(LIMITS[name] for name in used)),
        (bars, Rule(value=100.0, colour="0", dash=1)),
        size=(5.8, 0.9 + 0.3 * max(len(used), 1)),
    )


def power_factor_chart(optimum: Optimum, electric: DriveElectronics) -> Chart:
    """Power factor at the amplifier over frequency about the drive's, without and with matching networks.

    Bands are the range over the tolerance of the capacitance.
    """
    rig = design_rig(optimum.problem, optimum.best)
    f = optimum.best.frequency * np.linspace(0.85, 1.15, 401)
    bare = stack_admittance(rig, frequency=f)
    parts: list[Part] = [Line(x=1e-3 * f, y=bare.real / np.abs(bare), label="without a network", colour="0.4", dash=3)]
    for place, matched in enumerate(electric.networks):
        changed = [
            matched_power_factor(
                matched.network, admittance=stack_admittance(rig, frequency=f, capacitance_change=change), frequency=f
            )
            for change in np.linspace(-CAPACITANCE_TOLERANCE, CAPACITANCE_TOLERANCE, 9)
        ]
        low, high = np.min(changed, axis=0), np.max(changed, axis=0)
        label = "" if place else f"capacitance off by up to {100 * CAPACITANCE_TOLERANCE:.0f} %"
        parts += [
            Line(x=1e-3 * f, y=changed[4], label=matched.name, colour=place, dash=place),
            Band(x=1e-3 * f, low=low, high=high, label=label, colour=place, opacity=0.13),
        ]
    parts.append(Rule(value=1e-3 * optimum.best.frequency, label="the drive", dash=0))
    x = Axis("Frequency", "kHz", lowest=1e-3 * float(f[0]), highest=1e-3 * float(f[-1]))
    return one_panel(
        x, Axis("Power factor", lowest=0.0, highest=1.02), parts, size=(5.8, 3.4), legend="top", legend_columns=2
    )


def _family(candidate: Candidate) -> str:
    """Actuator and waveform of a design."""
    return f"{candidate.actuator}, {candidate.waveform}"


def _drive(point: DesignPoint) -> str:
    """Frequency and voltage of a design."""
    return f"{1e-3 * point.frequency:.2f} kHz, {point.voltage_peak_to_peak:.3g} V"


def _envelope(f: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Frequency and value of the least value in each of 60 bands of frequency."""
    edges = np.linspace(f.min(), f.max() * (1 + 1e-12), _BANDS + 1)
    bins = np.clip(np.digitize(f, edges) - 1, 0, _BANDS - 1)
    places = [np.flatnonzero(bins == each) for each in np.unique(bins)]
    best = np.array([own[np.argmin(values[own])] for own in places])
    return f[best], values[best]


def _front_axis(objective: str, values: Floats) -> Axis:
    """Axis of an objective about the front with a margin, logarithmic where it spans a factor of five."""
    low, high = float(values.min()), float(values.max())
    reach = max((high / low) ** 0.5, 1.15)
    first, last = low / reach**0.5, high * reach
    return replace(_AXES[objective], lowest=first, highest=last, logarithmic=last > _SPAN * first)


def designs_dataset(optimum: Optimum) -> "xr.Dataset":
    """All designs of a screening with their objectives and the fraction of each limit that they use; over `design`."""
    import xarray as xr

    screened, space = optimum.screening, optimum.problem.space

    def by_design(of_candidates: list[Any]) -> NDArray[Any]:
        return np.array(of_candidates)[screened.candidate_index]

    columns = {
        "frequency": screened.frequency,
        "voltage_peak_to_peak": screened.voltage_peak_to_peak,
        "power_to_supply": screened.objectives["power"],
        "heat_rate": screened.objectives["heat"],
        **{name: by_design([each.entries[name] for each in screened.candidates]) for name in space.ranges},
    }
    data: dict[str, Any] = {name: ("design", values, labels(name)) for name, values in columns.items()}
    data["actuator"] = ("design", by_design([each.actuator for each in screened.candidates]))
    data["waveform"] = ("design", by_design([each.waveform for each in screened.candidates]))
    for name, text in LIMITS.items():
        used = {"units": "1", "long_name": f"Share used: {text}"}
        data[f"used_{name}"] = ("design", screened.utilisation[name], used)
    data["feasible"] = ("design", screened.feasible.astype(np.int8), {"long_name": "Whether it keeps to every limit"})
    return xr.Dataset(
        data,
        attrs={
            "title": f"Designs for a friction ratio of {optimum.problem.friction_ratio:.4g}, {space.rig.title}",
            "source": f"sonolube {__version__}",
            "friction_model": space.rig.friction_model.name,
        },
    )


def design_counts(optimum: Optimum) -> dict[str, int]:
    """Number of screened designs within all limits, out of reach, and beyond each limit that rules out any.

    By status; a design beyond two limits counts for both.
    """
    screened = optimum.screening
    reached = np.isfinite(screened.voltage_peak_to_peak)
    beyond = {text: int((screened.utilisation[name][reached] > 1).sum()) for name, text in LIMITS.items()}
    return {
        "within all limits": int(screened.feasible.sum()),
        "target friction not reached by any voltage": int((~reached).sum()),
        **{f"beyond the limit on {text}": count for text, count in beyond.items() if count},
    }


def design_changes(content: Mapping[str, Any], problem: DesignProblem, point: DesignPoint) -> dict[str, str]:
    """Entries of a rig file, as texts with units by dotted key, that make the rig of the file that of a design point.

    Parameters
    ----------
    content : mapping
        Parsed content of the file, including entries changed on the command line.
    problem : DesignProblem
    point : DesignPoint

    Returns
    -------
    dict of str to str
        With six digits. An amplitude that was measured stays in the file, but is no longer the one that is taken.

    See Also
    --------
    design_text
    """
    rig, candidate = design_rig(problem, point), point.candidate
    drive = {name: getattr(rig.drive, name) for name in ("frequency", "voltage_peak_to_peak", "voltage_offset")}
    changes: dict[str, Any] = {f"drive.{name}": value for name, value in drive.items()}
    changes["drive.waveform"] = candidate.waveform
    changes |= {f"structure.{name}": value for name, value in candidate.entries.items()}
    changes["vibration.amplitude_source"] = "computed"
    actuator = content.get("actuator", {})
    if candidate.actuator != OWN_ACTUATOR or problem.space.bolt is not None:
        stack = asdict(replace(rig.stack, coupling_factor=None))
        if "coupling_factor" in content["stack"]:
            stack["coupling_factor"] = rig.stack.derived_coupling_factor  # the stated one was of the unaltered stack
        changes |= {f"stack.{name}": value for name, value in stack.items() if value is not None}
        if "capacitance" in actuator:
            changes["actuator.capacitance"] = rig.stack.free_capacitance
    if "amplitude_per_volt" in actuator:
        changes["actuator.amplitude_per_volt"] = _amplitude_per_volt(rig.voltage_peak_to_peak, point)
    return {key: value if isinstance(value, str) else _entry_text(key, value) for key, value in changes.items()}


def _amplitude_per_volt(voltage_peak_to_peak: float, point: DesignPoint) -> float:
    """Computed amplitude of a design over its voltage. [m/V]"""
    return float(point.evaluation.quantities["vibration_amplitude"][0]) / voltage_peak_to_peak


def _entry_text(key: str, value: float) -> str:
    """Value of an entry with its unit, to six digits."""
    return format_si(value, quantity(key.rpartition(".")[2]).unit, digits=6)


def design_text(text: str, content: Mapping[str, Any], problem: DesignProblem, point: DesignPoint) -> str:
    """Rig file of a design point: the original file with the tables that the design changes.

    Parameters
    ----------
    text : str
        Text of the original file.
    content : mapping
        Its parsed content, including entries changed on the command line.
    problem : DesignProblem
    point : DesignPoint

    Returns
    -------
    str
    """
    rig = design_rig(problem, point)
    drive = rig.drive
    changed: dict[str, dict[str, Any]] = {
        name: {key: value for key, value in content[name].items() if not isinstance(value, dict)}
        for name in ("contact", "friction", "sliding")
    }
    changed["drive"] = dict(content["drive"]) | {
        name: getattr(drive, name) for name in ("voltage_peak_to_peak", "voltage_offset", "frequency", "waveform")
    }
    if drive.waveform_samples is None:
        changed["drive"].pop("waveform_samples", None)
    changed["stack"] = asdict(replace(rig.stack, coupling_factor=None))  # the stated one was of the unaltered stack
    changed["structure"] = {**problem.space.entries, **point.candidate.entries}
    assumptions = dict(content.get("assumptions", {}))
    assumptions["drive"] = f"optimised for a friction ratio of {problem.friction_ratio:.4g}"
    if "actuator" in content:
        changed["actuator"] = dict(content["actuator"]) | {"capacitance": rig.stack.free_capacitance}
        if "amplitude_per_volt" in content["actuator"]:
            changed["actuator"]["amplitude_per_volt"] = _amplitude_per_volt(rig.voltage_peak_to_peak, point)
            assumptions["actuator.amplitude_per_volt"] = "computed at this drive"
    if "vibration" in content:
        assumptions = {key: text for key, text in assumptions.items() if not key.startswith("vibration.")}
        changed["vibration"] = {"amplitude_source": "computed"}  # what was measured was another design
    if point.candidate.actuator != OWN_ACTUATOR:
        assumptions["stack"] = (
            f"{problem.space.catalogue[point.candidate.actuator].title}, by its data sheet; quality"
            f" factor {problem.space.mechanical_quality_factor:g} assumed for its ceramic"
        )
    tables = [*changed.items(), ("assumptions", assumptions)]
    # the relative path of the schema holds only where the original file lies
    original = "\n".join(line for line in text.splitlines() if not line.startswith("#:schema"))
    return with_tables(original + "\n", "\n".join(_table(name, entries) for name, entries in tables))


def _table(name: str, entries: Mapping[str, Any]) -> str:
    """TOML text of a table."""
    lines = [f"{_key(key)} = {_value(key, value)}" for key, value in entries.items() if value is not None]
    return "\n".join([f"[{name}]", *lines]) + "\n"


def _key(key: str) -> str:
    """TOML text of a key, quoted where needed."""
    return key if key.replace("_", "").isalnum() else json.dumps(key)


def _value(key: str, value: Any) -> str:
    """TOML text of a value, a quantity with its unit."""
    unit = quantities()[key].unit if key in quantities() else ""
    if isinstance(value, bool | str | list | tuple) or not unit:
        return json.dumps(list(value) if isinstance(value, tuple) else value, ensure_ascii=False)
    return json.dumps(f"{float(value)!r} {unit}")
