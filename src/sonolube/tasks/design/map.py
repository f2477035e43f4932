"""Task `map`: friction reduction of a rig over two quantities, beside measured runs."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Annotated, Any, Literal, Unpack

import numpy as np

from sonolube import design
from sonolube.checks import Floats
from sonolube.design import map_chart, map_kinds, map_page, measured_map_chart
from sonolube.design.map_chances import chance_chart, chance_facts, chance_object, with_chances
from sonolube.design.maps import default_axes
from sonolube.design.predicted_results import with_verdicts
from sonolube.design.runs_map import require_mappable, runs_map, runs_on_map
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.measurement.run_columns import runs_help
from sonolube.models.friction.models.range_check import ratio_caveats
from sonolube.prediction.applicability import FrictionInterval
from sonolube.prediction.chances import reduction_chances
from sonolube.prediction.evidence_posterior import EvidencePosterior
from sonolube.prediction.predicted_points import PredictedRig
from sonolube.prediction.verdict import verdict_counts
from sonolube.report import Drawing, Page
from sonolube.report.results.design import friction_map as results
from sonolube.report.results.design.predicted_points import verdict_lines
from sonolube.report.results.rig_point import own_point_lines, own_point_object
from sonolube.rig import AMPLITUDE, VOLTAGE, Rig, commanded_quantity, operating_caveats
from sonolube.tasks.answer import Answer, Block, Dataset, Rows, answer
from sonolube.tasks.design.chances import CONFIDENCE, TARGET_REDUCTION, target_chance
from sonolube.tasks.own_evidence import Evidence, evidence_of
from sonolube.tasks.own_tables import MappedRuns, Values, refuse_replaced, runs_of, values_by_key
from sonolube.tasks.parameters import File, KeyValues, Number, Parameter, RigFile, RunsSource, WatchedRig, rig_of
from sonolube.tasks.progress import stage
from sonolube.tasks.task import refuse_unused, shown, task

_AXIS_KEYS = ("sliding.sliding_speed", "contact.normal_load", VOLTAGE.key, AMPLITUDE.key, "drive.frequency")
_MEASURED_CAPTION = "Friction reduction between the measured runs alone by a Gaussian process, with its uncertainty."
_CHANCE_CAPTION = (
    "Chance that the target reduction is reached, by the distribution of `sonolube predict`: with the errors of the"
    " model and of what is not known of the rig."
)
_NO_AMPLITUDE = "the runs state neither amplitude nor voltage, so that the prediction rests on published tests alone"
_FORMS = ("png", "svg", "pdf")  # of figures, where none is given
_OVER = KeyValues(
    "Other values of an axis, first:last:count or one,two,...: sliding.sliding_speed, contact.normal_load,"
    " drive.frequency, drive.voltage_peak_to_peak or, without a voltage, vibration.vibration_amplitude. May come"
    " again.",
    "KEY=VALUES",
)
_RUNS = File(
    runs_help(
        "Measured runs to draw as points, and to interpolate from six on, with the quantities of both axes; a voltage"
        " gives its power, a load its stress. Columns"
    ),
    "RUNS.csv",
    option="--runs --measured",
)


@task
def map(  # noqa: A001 - the command's name
    rig: RigFile,
    *,
    kind: Annotated[
        Literal["velocity-stress", "velocity-power", "velocity-amplitude", "frequency-voltage", "frequency-amplitude"]
        | None,
        Parameter(
            "Quantities that the map runs over; velocity-power by default, velocity-amplitude without a voltage."
        ),
    ] = None,
    over: Annotated[Values | None, _OVER] = None,
    runs: Annotated[RunsSource, _RUNS] = None,
    mapping: MappedRuns = None,
    target_reduction: Annotated[Number | None, TARGET_REDUCTION] = None,
    confidence: Annotated[Number | None, CONFIDENCE] = None,
    evidence: Evidence = None,
    form: Annotated[
        Sequence[Literal["png", "pdf", "svg", "html"]],
        Parameter("png, pdf, svg or an interactive html; may come again."),
    ] = (),
    **watch: Unpack[WatchedRig],
) -> "MapAnswer":
    """Map of friction reduction: over sliding speed or frequency, and stress, power, voltage or vibration amplitude.

    Example: sonolube map examples/rigs/power_map.toml --kind velocity-power

    Examples
    --------
    >>> import sonolube as sl
    >>> answer = sl.map("examples/rigs/power_map.toml", kind="velocity-power")
    >>> round(float(answer["friction_reduction"].max()), 2)
    0.95
    """
    known = rig_of(rig)
    learned = evidence_of(evidence, known)
    refuse_replaced(known, over or {})
    chosen = _kind(known, kind)
    axes = _axes(known, chosen, over or {})
    measured = runs_of(runs, mapping, known)
    if measured is not None:
        try:
            require_mappable(measured, kind=chosen, commanded=commanded_quantity(known))
        except InvalidInput:
            if runs is not None:
                raise
            measured = None  # of the folder of the rig, for which nobody asked
    with stage("mapping"):
        mapped = design.MAPS[chosen](known, **axes)
    target, wanted = target_chance(target_reduction, confidence)
    with stage("predicting"):
        predicted = _predicted(known, _with_amplitude(measured), learned, is_needed=target is not None)
    if target is not None and predicted.chances is not None:
        with stage("chances"):
            mapped = with_chances(mapped, predicted.chances, friction_reduction=target)
    mapped = with_verdicts(mapped, predicted)
    left_out: tuple[str, ...] = ()
    if measured is not None:
        unused = _with_amplitude(measured) is None
        measured, left_out = runs_on_map(measured, known, mapped)
        left_out = (*left_out, *((_NO_AMPLITUDE,) if unused else ()))
    return MapAnswer(
        rig=known,
        mapped=mapped,
        runs=measured,
        interpolated=None if measured is None else runs_map(measured, kind=chosen),
        forms=tuple(form) or _FORMS,
        left_out=left_out,
        confidence=wanted,
        predicted=predicted,
    )


@answer
class MapAnswer(Answer):
    """Map of friction reduction: its greatest value, the ridge of sufficient power, and the measured runs."""

    rig: Rig
    mapped: Dataset
    runs: "Dataset | None"
    interpolated: "Dataset | None"
    forms: tuple[str, ...]
    predicted: PredictedRig
    left_out: tuple[str, ...] = ()
    confidence: float | None = None

    def blocks(self) -> Sequence[Block]:
        """Verdicts, chance of the target, greatest reduction, ridge, and points without a result."""
        title, facts = results.map_blocks(self.rig, self.mapped, results.predicted_text(self._predicted_there))
        rows = Rows([*self._chances, *facts.rows])
        return [title, *own_point_lines(self.rig), *verdict_lines(self.mapped), rows]

    def object(self) -> dict[str, Any]:
        """Greatest reduction with the point where it occurs, and the number of points without a result."""
        found = results.map_object(self.rig, self.mapped) | own_point_object(self.rig)
        found |= {"verdicts": verdict_counts(self.mapped["verdict"].values)}
        found |= results.predicted_there_object(self._predicted_there)
        if not self._has_chances:
            return found
        return found | chance_object(self.mapped, confidence=self.confidence)

    def caveats(self) -> Sequence[str]:
        """Caveats of the rig at its own point and of ratios on the map, runs without a place, and own evidence."""
        ratios = 1 - self.mapped["friction_reduction"].values
        tested = self.predicted.caveats(self.mapped["verdict"].values)
        return (*operating_caveats(self.rig), *ratio_caveats(friction_ratio=ratios), *tested, *self.left_out)

    def figures(self) -> Mapping[str, Drawing]:
        """Contours of the map, and those between the measured runs."""
        forms = tuple(form for form in self.forms if form != "html")
        runs, between = self.runs, self.interpolated
        caption = results.caption(self.mapped, has_runs=runs is not None)
        chart = lambda: map_chart(self.mapped, measured=runs)  # noqa: E731
        drawings = {self._name: Drawing(chart=chart, caption=caption, forms=forms)}
        if runs is not None and between is not None:
            drawings[f"{self._name}-measured"] = Drawing(
                chart=lambda: measured_map_chart(between, runs), caption=_MEASURED_CAPTION, forms=forms
            )
        if self._has_chances:
            drawings[f"{self._name}-chance"] = Drawing(
                chart=lambda: chance_chart(self.mapped, confidence=self.confidence),
                caption=_CHANCE_CAPTION,
                forms=forms,
            )
        return drawings

    def files(self) -> "Mapping[str, str | Dataset]":
        """Interactive page where it is wanted, and the datasets."""
        files: dict[str, str | Dataset] = {}
        if "html" in self.forms:
            files[f"{self._name}.html"] = map_page(self.mapped)
        files[f"{self._name}.nc"] = self.mapped
        if self.interpolated is not None:
            files[f"{self._name}-measured.nc"] = self.interpolated
        return files

    def page(self) -> Page:
        """Page `map.html`."""
        there = results.predicted_text(self._predicted_there)
        page = results.map_page(self.rig, self.mapped, self.runs, self.interpolated, there)
        verdicts = [("points", line.strip()) for line in verdict_lines(self.mapped)]
        return replace(page, facts=[*verdicts, *self._chances, *page.facts])

    @property
    def _predicted_there(self) -> FrictionInterval | None:
        """Predicted friction ratio where the map has its greatest reduction."""
        return results.predicted_there(self.mapped, self.predicted)

    @property
    def _has_chances(self) -> bool:
        """Whether the map has the chance of a target."""
        return "target_reduction" in self.mapped.attrs

    @property
    def _chances(self) -> list[tuple[str, str]]:
        """Chances of the target, where one is asked for."""
        return chance_facts(self.mapped, confidence=self.confidence) if self._has_chances else []

    @property
    def _name(self) -> str:
        """Name of the files, without ending."""
        return f"{self.rig.name}-{self.mapped.attrs['map']}"


def _predicted(
    rig: Rig, runs: "Dataset | None", evidence: EvidencePosterior | None, *, is_needed: bool
) -> PredictedRig:
    """Prediction of a rig on a map; why there is none, which is refused where a chance is asked for."""
    try:
        return PredictedRig(rig=rig, chances=reduction_chances(rig, runs=runs, evidence=evidence))
    except SonolubeError as refusal:
        if is_needed:
            raise
        reason = str(refusal).removeprefix(f"{rig.title}: ")
        refuse_unused("evidence", because=f"where nothing is predicted: {reason}")
        return PredictedRig(rig=rig, chances=None, reason=reason)


def _with_amplitude(runs: "Dataset | None") -> "Dataset | None":
    """Runs that state an amplitude or a voltage, on which a prediction may rest; else None."""
    return None if runs is None or not {"vibration_amplitude", VOLTAGE.name} & {*runs.variables} else runs


def _kind(rig: Rig, kind: str | None) -> str:
    """Kind of map that was chosen, which the rig must have, or its default one."""
    quantity = commanded_quantity(rig)
    known = map_kinds(quantity)
    if kind is None or kind in known:
        return kind or known[0]
    if quantity is AMPLITUDE:
        raise InvalidInput(
            f"{shown('kind')} {kind} needs a drive voltage, and {rig.title} has an amplitude alone: take"
            f" {shown('kind')} {_listed(known)}, or give {VOLTAGE.key}"
        )
    raise InvalidInput(
        f"{shown('kind')} {kind} is for a rig without a drive voltage, and that of {rig.title} sets its amplitude:"
        f" take {shown('kind')} {_listed(known)}"
    )


def _listed(names: Sequence[str]) -> str:
    """Names in a sentence, the last after "or"."""
    return f"{', '.join(names[:-1])} or {names[-1]}"


def _axes(rig: Rig, kind: str, over: Values) -> dict[str, Floats]:
    """Values of each axis of a kind of map: those given, and the default ones of the others."""
    axes = default_axes(rig, kind=kind)
    across_and_up = list(axes)[:2]
    for key, given in values_by_key(over).items():
        name, values = key.rpartition(".")[2], np.atleast_1d(given)
        known = [each for each in _AXIS_KEYS if each.rpartition(".")[2] in axes]
        if key not in known:
            raise InvalidInput(f"{shown('over')} {key}: no axis of a {kind} map; its axes are {', '.join(known)}")
        if values.size < 2 and name in across_and_up:
            raise InvalidInput(f"{shown('over')} {key}: a {kind} map runs over it, and needs at least 2 values")
        axes[name] = values.astype(np.float64)
    return axes
