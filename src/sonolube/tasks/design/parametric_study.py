"""Parametric study of `sweep --of`: friction over voltage, amplitude, speed, frequency, waveform or load, and power."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube import rig as rigs
from sonolube.charts import Chart
from sonolube.checks import Floats, require_positive
from sonolube.design.point_statistics import extreme_place, extreme_point, failure_counts
from sonolube.errors import InvalidInput
from sonolube.models.friction.models.range_check import ratio_caveats
from sonolube.report import Drawing
from sonolube.rig import (
    AMPLITUDE,
    STUDY_CHARTS,
    VOLTAGE,
    Rig,
    commanded_quantity,
    energy_balance,
    frequency_grid,
    operating_caveats,
    operating_points,
    quantity_of_axis,
    resolved_vibration,
)
from sonolube.rig.amplitude_source import moved_rig
from sonolube.rig.linear_response import gap_law_of
from sonolube.tasks.answer import Answer, answer, si
from sonolube.tasks.blocks import Block, Rows
from sonolube.tasks.progress import stage
from sonolube.tasks.results.rig_text import amplitude_object, amplitude_rows, friction_model_text
from sonolube.tasks.task import shown
from sonolube.units import format_si, to_si
from sonolube.vocabulary import quantity

Named = Iterator[tuple[str, str]]

if TYPE_CHECKING:
    import xarray as xr


OUTCOMES = ("friction_ratio", "vibration_amplitude", "actuator_power", "dissipated_power")
"""Quantities that the answer of a sweep has of a point."""

_POINTS_AT_RESONANCE = 41  # frequencies about each resonance
_MOST_POINTS = 10_000
_OF_STRUCTURE = ("frequency", "power", "waveform")  # studies of a computed motion


@dataclass(frozen=True, kw_only=True, slots=True)
class _Range:
    """Default range of a study."""

    unit: str
    lowest: str
    highest: str
    points: int
    even_ratios: bool = False
    from_zero: bool = False


_RANGES = {
    "voltage": _Range(unit="V", lowest="0V", highest="200V", points=101, from_zero=True),
    "amplitude": _Range(unit="m", lowest="0um", highest="10um", points=101, from_zero=True),
    "speed": _Range(unit="m/s", lowest="1mm/s", highest="1m/s", points=61, even_ratios=True),
    "frequency": _Range(unit="Hz", lowest="1kHz", highest="100kHz", points=120),
    "power": _Range(unit="Hz", lowest="1kHz", highest="100kHz", points=60),
    "load": _Range(unit="N", lowest="3N", highest="9N", points=25),
}


def parametric_study(
    rig: Rig,
    *,
    of: str,
    lowest: str | None,
    highest: str | None,
    points: int | None,
    voltages: Sequence[str],
    amplitudes: Sequence[str],
) -> "ParametricStudyAnswer":
    """Study of a rig over one quantity.

    Parameters
    ----------
    rig : Rig
    of : str
        "voltage", "amplitude", "speed", "frequency", "power", "waveform" or "load".
    lowest, highest : str or None
        Ends of the range with their units; the default ones where None.
    points : int or None
        Number of values.
    voltages : sequence of str
        Drive voltage of each curve over speed or frequency, with its unit.
    amplitudes : sequence of str
        Vibration amplitude of each curve over speed, with its unit, of a rig without a voltage.

    Returns
    -------
    ParametricStudyAnswer

    Raises
    ------
    InvalidInput
        If the rig lacks the structure or voltage of the study, the range is empty, an option has no meaning for the
        study, or no point has a result.
    """
    run = _study(rig, of, lowest, highest, points, voltages, amplitudes)
    with stage("sweeping") as advance:
        result = run(advance=lambda done, total: advance(of, done, total))
    answer = ParametricStudyAnswer(rig=rig, of=of, study=result)
    if result["friction_ratio"].isnull().all():
        raise InvalidInput(f"no point has a result: {next(iter(answer.failures()))}")
    return answer


@answer
class ParametricStudyAnswer(Answer):
    """Least friction over one quantity, and the points without a result."""

    rig: Rig
    of: str
    study: "xr.Dataset"

    def blocks(self) -> Sequence[Block]:
        """Main results over the quantity, and the points without a result."""
        points, load = self.study["status"].size, format_si(self.rig.normal_load, "N")
        return [
            f"{self.rig.title}, {load}, {points} points, {friction_model_text(self.rig)}",
            Rows([*amplitude_rows(self.rig), *_ROWS[self.of](self.study), *_energy_rows(self.study)]),
            *[f"  without result: {count} of {points}: {reason}" for reason, count in self.failures().items()],
        ]

    def object(self) -> dict[str, Any]:
        """Point of least friction of each curve, and the points without a result."""
        return {
            "rig": self.rig.title,
            "study": self.of,
            "friction_model": self.rig.friction_model.name,
            **amplitude_object(self.rig),
            "least_friction": [_point_object(best) for best in _best_points(self.study)],
            "points": int(self.study["status"].size),
            "without_result": [{"reason": reason, "points": count} for reason, count in self.failures().items()],
        }

    @property
    def _name(self) -> str:
        return f"{self.rig.name}-{self.of}"

    def caveats(self) -> Sequence[str]:
        """Caveats of the rig at its own operating point."""
        return (*operating_caveats(self.rig), *ratio_caveats(friction_ratio=self.study["friction_ratio"].values))

    def figures(self) -> Mapping[str, Drawing]:
        """Figure of the study."""

        def chart() -> Chart:
            return replace(STUDY_CHARTS[self.of](self.study), title=self.study.attrs["rig"])

        return {self._name: Drawing(chart=chart)}

    def files(self) -> "Mapping[str, xr.Dataset]":
        """Every point as netCDF."""
        return {f"{self._name}.nc": self.study}

    def failures(self) -> dict[str, int]:
        """Number of points without a result, by the reason."""
        return failure_counts(self.study, outcome="friction_ratio")


def _study(
    rig: Rig,
    of: str,
    lowest: str | None,
    highest: str | None,
    points: int | None,
    voltages: Sequence[str],
    amplitudes: Sequence[str],
) -> "Callable[..., xr.Dataset]":
    """Function that runs the study, all options read and checked; it takes `advance`."""
    _require_studied(rig, of)
    curves = _curves(rig, of, voltages, amplitudes)
    if of == "waveform":
        if lowest or highest or points:
            raise InvalidInput(
                f"{shown('lowest')}, {shown('highest')} and {shown('points')} have no meaning for {shown('of')}"
                " waveform, which runs over names"
            )
        return partial(rigs.waveform_study, rig)
    values = _values(rig, of, lowest, highest, points)
    if of == "voltage":
        return partial(rigs.voltage_study, rig, voltage_peak_to_peak=values)
    if of == "amplitude":
        return partial(rigs.amplitude_study, rig, vibration_amplitude=values)
    if of == "speed":
        return partial(rigs.speed_study, rig, sliding_speed=values, **curves)
    if of == "frequency":
        return partial(rigs.frequency_study, rig, frequency=values, **curves)
    if of == "power":
        return partial(rigs.least_power_study, rig, frequency=values, friction_ratio=_present_ratio(rig))
    return partial(rigs.load_study, rig, normal_load=values)


def _curves(rig: Rig, of: str, voltages: Sequence[str], amplitudes: Sequence[str]) -> dict[str, Any]:
    """Voltages or amplitudes of the curves of a study by name; empty where none are given."""
    if voltages and of not in ("speed", "frequency"):
        raise InvalidInput(f"{shown('voltage')} has no meaning for {shown('of')} {of}; it is for speed and frequency")
    if amplitudes and of != "speed":
        raise InvalidInput(f"{shown('vibration')} has no meaning for {shown('of')} {of}; it is for speed")
    own = commanded_quantity(rig)
    name, texts, others = ("voltage", voltages, amplitudes) if own is VOLTAGE else ("vibration", amplitudes, voltages)
    if others:
        raise InvalidInput(f"{rig.title}: its {own.word} sets its vibration; give {shown(name)} of each curve")
    if not texts:
        return {}
    read = [to_si(text, unit=own.unit, name=shown(name)) for text in texts]
    return {own.name: require_positive(**{own.name: read})}


def studies_of(rig: Rig) -> list[str]:
    """Names of the studies over one quantity that a rig has."""
    found = []
    for name in _RANGES | {"waveform": None}:
        with suppress(InvalidInput):
            _require_studied(rig, name)
            found.append(name)
    return found


def _require_studied(rig: Rig, of: str) -> None:
    """Raise if a rig lacks the structure that a study computes, or another quantity sets its vibration."""
    own = commanded_quantity(rig)
    if of in (VOLTAGE.word, AMPLITUDE.word) and of != own.word:
        why = "has no drive voltage" if own is AMPLITUDE else "has a drive voltage, which sets its amplitude"
        raise InvalidInput(f"{rig.title} {why}: take {shown('of')} {own.word}")
    if of in _OF_STRUCTURE:
        gap_law_of(moved_rig(rig))
    elif of != "speed" and (driven := resolved_vibration(rig).driven) is not None:
        gap_law_of(driven)


def _values(rig: Rig, of: str, lowest: str | None, highest: str | None, points: int | None) -> Floats:
    """Values that a study runs over."""
    usual = _RANGES[of]
    low = to_si(lowest or usual.lowest, unit=usual.unit, name=shown("lowest"))
    high = to_si(highest or usual.highest, unit=usual.unit, name=shown("highest"))
    if low < 0 or (low == 0 and not usual.from_zero) or low >= high:
        floor = f"not lie below 0 {usual.unit}" if usual.from_zero else f"lie above 0 {usual.unit}"
        raise InvalidInput(
            f"{shown('lowest')} {lowest or usual.lowest} must {floor} and must lie below {shown('highest')}"
            f" {highest or usual.highest}"
        )
    count = usual.points if points is None else points
    if not 2 <= count <= _MOST_POINTS:
        raise InvalidInput(f"{shown('points')} {count} must lie between 2 and {_MOST_POINTS} for {shown('of')} {of}")
    if of in ("frequency", "power"):
        return frequency_grid(rig, lowest=low, highest=high, points=count, resonance_points=_POINTS_AT_RESONANCE)
    return np.geomspace(low, high, count) if usual.even_ratios else np.linspace(low, high, count)


def _present_ratio(rig: Rig) -> float:
    """Friction ratio of the rig as it is driven."""
    own = operating_points(rig)
    if bool(own.failed):
        raise InvalidInput(f"{rig.title} has no friction ratio of its own to be had elsewhere: {own.reason}")
    return float(own.friction_ratio)


def _level_rows(study: "xr.Dataset") -> Named:
    """Least friction, voltage or amplitude at which contact is lost, and power of the amplifier where it is known."""
    quantity = quantity_of_axis(study.dims)
    for best in _best_points(study):
        yield "least friction", f"ratio {_text(best, 'friction_ratio')} at {_text(best, quantity.name)}"
    lost = study[quantity.name].values[study["contact_loss_fraction"].values > 0]
    yield "contact is lost", f"from {format_si(float(lost.min()), quantity.unit)}" if lost.size else "nowhere"
    if "actuator_power" in study and not study["actuator_power"].isnull().all():
        yield "amplifier", f"up to {format_si(float(study['actuator_power'].max()), 'W')}, D 1.9"


def _speed_rows(study: "xr.Dataset") -> Named:
    """Range of the friction ratio at each voltage or amplitude."""
    quantity = quantity_of_axis(study.dims)
    for index in range(study.sizes[quantity.name]):
        curve = study.isel({quantity.name: index})
        low, high = float(curve["friction_ratio"].min()), float(curve["friction_ratio"].max())
        yield f"at {_text(curve, quantity.name)}", f"ratio {low:.3g} to {high:.3g}, slow to fast"


def _frequency_rows(study: "xr.Dataset") -> Named:
    """Least friction at each voltage."""
    for best in _best_points(study):
        at = f"{_text(best, 'frequency', digits=4)}, {_text(best, 'vibration_amplitude')}"
        text = f"least friction ratio {_text(best, 'friction_ratio')} at {at}, {_text(best, 'actuator_power')}"
        yield f"at {_text(best, 'voltage_peak_to_peak')}", text


def _power_rows(study: "xr.Dataset") -> Named:
    """Least power that the friction ratio takes, of the amplifier and dissipated."""
    for name, label in (("actuator_power", "least power, D 1.9"), ("dissipated_power", "least dissipation")):
        if not study[name].isnull().all():
            least = study.isel(frequency=extreme_place(study, outcome=name) or 0)
            at = f"{_text(least, 'frequency', digits=4)} and {_text(least, 'voltage_peak_to_peak')}"
            yield label, f"{_text(least, name)} at {at} for friction ratio {_text(least, 'friction_ratio')}"


def _waveform_rows(study: "xr.Dataset") -> Named:
    """Friction ratio of each waveform, the least first."""
    for index in study["friction_ratio"].values.argsort():
        one = study.isel(waveform=int(index))
        text = f"ratio {_text(one, 'friction_ratio')}, {_text(one, 'vibration_amplitude')}"
        yield str(one["waveform"].values), text


def _load_rows(study: "xr.Dataset") -> Named:
    """Range of the friction ratio and, of a structure, of the natural frequency of the loading arm."""
    ratios = study["friction_ratio"]
    yield "friction ratio", f"{float(ratios.min()):.4g} to {float(ratios.max()):.4g}"
    if "natural_frequency" in study:
        arm = study["natural_frequency"]
        yield "arm's frequency", f"{format_si(float(arm.min()), 'Hz')} to {format_si(float(arm.max()), 'Hz')}"


def _energy_rows(study: "xr.Dataset") -> Named:
    """How the powers of the study compare, at its point of least friction."""
    best = extreme_point(study, outcome="friction_ratio")
    balance = None if best is None else _balance(best)
    if balance is not None:
        yield "energy", balance


def _balance(point: "xr.Dataset") -> str | None:
    """How the power of the amplifier and the dissipated power of a point compare; None where it has no power."""
    if "actuator_power" not in point:
        return None
    return energy_balance(
        actuator_power=float(point["actuator_power"]), dissipated_power=float(point["dissipated_power"])
    )


_ROWS: "dict[str, Callable[[xr.Dataset], Named]]" = {
    "voltage": _level_rows,
    "amplitude": _level_rows,
    "speed": _speed_rows,
    "frequency": _frequency_rows,
    "power": _power_rows,
    "waveform": _waveform_rows,
    "load": _load_rows,
}


def _best_points(study: "xr.Dataset") -> "Iterator[xr.Dataset]":
    """Point of least friction of each curve that has a result."""
    dims = study["friction_ratio"].dims
    curves = [study] if len(dims) == 1 else [study.isel({dims[0]: i}) for i in range(study.sizes[dims[0]])]
    for curve in curves:
        best = extreme_point(curve, outcome="friction_ratio")
        if best is not None:
            yield best


def _point_object(point: "xr.Dataset") -> dict[str, Any]:
    """Coordinates and outcomes of a point, for JSON."""
    known = dict.fromkeys([*point.coords, *(name for name in OUTCOMES if name in point)])
    names = [str(name) for name in known if point[name].ndim == 0 and not _missing(point, name)]
    waveform = {"waveform": str(point["waveform"].values)} if "waveform" in names else {}
    balance = _balance(point)
    return (
        waveform
        | si({name: float(point[name]) for name in names if name != "waveform"})
        | ({} if balance is None else {"energy_balance": balance})
    )


def _missing(point: "xr.Dataset", name: Any) -> bool:
    """Whether a number of a point is not known, as heat of a sine that no structure gives."""
    return bool(point[name].dtype.kind == "f" and np.isnan(point[name]))


def _text(point: "xr.Dataset", name: str, *, digits: int = 3) -> str:
    """Quantity of a point with its unit."""
    return format_si(float(point[name]), quantity(name).unit, digits=digits)
