"""Parametric study of `sweep --of`: friction over voltage, amplitude, speed, frequency, waveform or load, and power."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from sonolube import rig as rigs
from sonolube.charts import Chart
from sonolube.checks import Floats, require_positive
from sonolube.design.point_statistics import failure_counts
from sonolube.errors import InvalidInput
from sonolube.models.friction.models.range_check import ratio_caveats
from sonolube.report import Drawing
from sonolube.report.results.design import parametric_study as study_results
from sonolube.report.results.design.status_tables import failure_objects
from sonolube.report.results.rig_text import amplitude_object, amplitude_rows, friction_model_text
from sonolube.rig.resolved_rig import resolved_rig
from sonolube.tasks.answer import Answer, Block, Dataset, Rows, answer
from sonolube.tasks.progress import stage
from sonolube.tasks.task import shown
from sonolube.text.units import format_si, to_si
from sonolube.vocabulary import unit_of

_POINTS_AT_RESONANCE = 41  # frequencies about each resonance
_MAX_POINTS = 10_000
_OF_STRUCTURE = ("frequency", "power", "waveform")  # studies of a computed motion


@dataclass(frozen=True, slots=True)
class _Range:
    """Function of a study in `rig`, its quantity, and its default range."""

    study: str
    quantity: str
    lowest: str
    highest: str
    points: int
    even_ratios: bool = False
    from_zero: bool = False


_RANGES = {
    "voltage": _Range("voltage_study", "voltage_peak_to_peak", lowest="0V", highest="200V", points=101, from_zero=True),
    "amplitude": _Range(
        "amplitude_study", "vibration_amplitude", lowest="0um", highest="10um", points=101, from_zero=True
    ),
    "speed": _Range("speed_study", "sliding_speed", lowest="1mm/s", highest="1m/s", points=61, even_ratios=True),
    "frequency": _Range("frequency_study", "frequency", lowest="1kHz", highest="100kHz", points=120),
    "power": _Range("least_power_study", "frequency", lowest="1kHz", highest="100kHz", points=60),
    "load": _Range("load_study", "normal_load", lowest="3N", highest="9N", points=25),
}


def parametric_study(
    rig: rigs.Rig,
    *,
    of: str,
    lowest: str | None,
    highest: str | None,
    points: int | None,
    voltages: Sequence[str],
    amplitudes: Sequence[str],
) -> "ParametricStudyAnswer":
    """Study of a rig over one quantity, whose range has ends with units; default ones where None."""
    _require_studied(rig, of)
    curves = _curves(rig, of, voltages, amplitudes)
    if of == "waveform":
        if lowest or highest or points:
            raise InvalidInput(
                f"{shown('lowest')}, {shown('highest')} and {shown('points')} have no meaning for {shown('of')}"
                " waveform, which runs over names"
            )
        run: Callable[..., Dataset] = partial(rigs.waveform_study, rig)
    else:
        usual = _RANGES[of]
        values = {usual.quantity: _values(rig, of, lowest, highest, points)}
        own = {"friction_ratio": _present_ratio(rig)} if of == "power" else {}
        run = partial(getattr(rigs, usual.study), rig, **values, **curves, **own)
    with stage("sweeping") as advance:
        result = run(advance=lambda done, total: advance(of, done, total))
    answer = ParametricStudyAnswer(rig=rig, of=of, study=result)
    if result["friction_ratio"].isnull().all():
        raise InvalidInput(f"no point has a result: {next(iter(answer.failures()))}")
    return answer


@answer
class ParametricStudyAnswer(Answer):
    """Least friction over one quantity, and the points without a result."""

    rig: rigs.Rig
    of: str
    study: Dataset

    def blocks(self) -> Sequence[Block]:
        """Main results over the quantity, and the points without a result."""
        points, load = self.study["status"].size, format_si(self.rig.normal_load, "N")
        return [
            f"{self.rig.title}, {load}, {points} points, {friction_model_text(self.rig)}",
            Rows([*amplitude_rows(self.rig), *study_results.rows(self.study, self.of)]),
            *[f"  without result: {count} of {points}: {reason}" for reason, count in self.failures().items()],
        ]

    def object(self) -> dict[str, Any]:
        """Point of least friction of each curve, and the points without a result."""
        return {
            "rig": self.rig.title,
            "study": self.of,
            "friction_model": self.rig.friction_model.name,
            **amplitude_object(self.rig),
            "least_friction": study_results.best_objects(self.study),
            "points": int(self.study["status"].size),
            "without_result": failure_objects(self.failures()),
        }

    @property
    def _name(self) -> str:
        return f"{self.rig.name}-{self.of}"

    def caveats(self) -> Sequence[str]:
        """Caveats of the rig at its own operating point."""
        return (*rigs.operating_caveats(self.rig), *ratio_caveats(friction_ratio=self.study["friction_ratio"].values))

    def figures(self) -> Mapping[str, Drawing]:
        """Figure of the study."""

        def chart() -> Chart:
            return replace(rigs.STUDY_CHARTS[self.of](self.study), title=self.study.attrs["rig"])

        return {self._name: Drawing(chart=chart)}

    def files(self) -> Mapping[str, Dataset]:
        """Every point as netCDF."""
        return {f"{self._name}.nc": self.study}

    def failures(self) -> dict[str, int]:
        """Number of points without a result, by the reason."""
        return failure_counts(self.study, outcome="friction_ratio")


def _curves(rig: rigs.Rig, of: str, voltages: Sequence[str], amplitudes: Sequence[str]) -> dict[str, Any]:
    """Voltages or amplitudes of the curves of a study by name; empty where none are given."""
    if voltages and of not in ("speed", "frequency"):
        raise InvalidInput(f"{shown('voltage')} has no meaning for {shown('of')} {of}; it is for speed and frequency")
    if amplitudes and of != "speed":
        raise InvalidInput(f"{shown('vibration')} has no meaning for {shown('of')} {of}; it is for speed")
    own = rigs.commanded_quantity(rig)
    name, texts, others = (
        ("voltage", voltages, amplitudes) if own is rigs.VOLTAGE else ("vibration", amplitudes, voltages)
    )
    if others:
        raise InvalidInput(f"{rig.title}: its {own.word} sets its vibration; give {shown(name)} of each curve")
    if not texts:
        return {}
    read = [to_si(text, unit=own.unit, name=shown(name)) for text in texts]
    return {own.name: require_positive(**{own.name: read})}


def studies_of(rig: rigs.Rig) -> list[str]:
    """Names of the studies over one quantity that a rig has."""
    found = []
    for name in _RANGES | {"waveform": None}:
        with suppress(InvalidInput):
            _require_studied(rig, name)
            found.append(name)
    return found


def _require_studied(rig: rigs.Rig, of: str) -> None:
    """Raise if a rig lacks the structure that a study computes, or another quantity sets its vibration."""
    resolved = resolved_rig(rig)
    own = rigs.commanded_quantity(resolved)
    if of in (rigs.VOLTAGE.word, rigs.AMPLITUDE.word) and of != own.word:
        why = "has no drive voltage" if own is rigs.AMPLITUDE else "has a drive voltage, which sets its amplitude"
        raise InvalidInput(f"{rig.title} {why}: take {shown('of')} {own.word}")
    if of in _OF_STRUCTURE:
        _ = resolved.moved  # which refuses a rig without a structure that moves it
    elif of != "speed":
        _ = resolved.vibration  # which refuses a rig without an amplitude


def _values(rig: rigs.Rig, of: str, lowest: str | None, highest: str | None, points: int | None) -> Floats:
    """Values that a study runs over."""
    usual = _RANGES[of]
    unit = unit_of(usual.quantity)
    low = to_si(lowest or usual.lowest, unit=unit, name=shown("lowest"))
    high = to_si(highest or usual.highest, unit=unit, name=shown("highest"))
    if low < 0 or (low == 0 and not usual.from_zero) or low >= high:
        floor = f"not lie below 0 {unit}" if usual.from_zero else f"lie above 0 {unit}"
        raise InvalidInput(
            f"{shown('lowest')} {lowest or usual.lowest} must {floor} and must lie below {shown('highest')}"
            f" {highest or usual.highest}"
        )
    count = usual.points if points is None else points
    if not 2 <= count <= _MAX_POINTS:
        raise InvalidInput(f"{shown('points')} {count} must lie between 2 and {_MAX_POINTS} for {shown('of')} {of}")
    if of in ("frequency", "power"):
        return rigs.frequency_grid(rig, lowest=low, highest=high, points=count, resonance_points=_POINTS_AT_RESONANCE)
    return np.geomspace(low, high, count) if usual.even_ratios else np.linspace(low, high, count)


def _present_ratio(rig: rigs.Rig) -> float:
    """Friction ratio of the rig as it is driven."""
    own = rigs.operating_points(rig)
    if bool(own.failed):
        raise InvalidInput(f"{rig.title} has no friction ratio of its own to be had elsewhere: {own.reason}")
    return float(own.friction_ratio)
