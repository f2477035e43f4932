"""Task `uncertainty`: uncertainty of an outcome from the distributions in a rig file, and its ranking by Sobol."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from functools import cached_property
from typing import Annotated, Any, Unpack

import numpy as np

from sonolube.checks import Floats
from sonolube.design import SampleStatistics, band_chart, histogram_chart, outcome_statistics, propagate, sobol_chart
from sonolube.design.point_statistics import failure_counts
from sonolube.design.uncertainty import IdentifiedStructure, identified_structure
from sonolube.design.uncertainty_summary import Band, RankedEntry, outcome_band, outcome_indices, ranked_entries
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.models.friction.models.range_check import ratio_caveats
from sonolube.prediction.evidence import large_amplitude_caveats
from sonolube.prediction.evidence_posterior import EvidencePosterior
from sonolube.report import Drawing, Page
from sonolube.report.results.design import uncertainty as results
from sonolube.report.results.design.uncertainty import agreement
from sonolube.report.results.rig_point import BeyondTheModel, beyond_the_model
from sonolube.rig import Rig, operating_caveats, steady_vibration
from sonolube.rig.resolved_rig import ResolvedRig, resolved_rig
from sonolube.tasks.answer import Answer, Block, Dataset, answer
from sonolube.tasks.own_evidence import Evidence, evidence_of
from sonolube.tasks.own_tables import Values, refuse_replaced, values_by_key
from sonolube.tasks.parameters import (
    DoorParameter,
    Interval,
    Kept,
    KeyValues,
    Parameter,
    RigFile,
    WatchedRig,
    kept,
    rig_of,
)
from sonolube.tasks.progress import stage
from sonolube.tasks.task import refuse_unused, shown, task

_SAMPLES_CAPTION = "Histogram of the samples that have a result, quantiles with intervals of 95 %, and the mean."
_OF_THE_MODEL = ("friction_ratio", "friction_reduction")  # outcomes that have the error of the friction model
_BAND_CAPTION = "Median of the samples and their intervals over the keys that were swept."
_SOBOL_CAPTION = "Contribution of each uncertain entry to the variance, with intervals of 95 %."


@task
def uncertainty(
    rig: RigFile,
    *,
    of: Annotated[
        str, Parameter("The outcome, such as vibration_amplitude or wear_rate_ratio.", "QUANTITY")
    ] = "friction_ratio",
    samples: Annotated[
        int, Parameter("Number of samples, up to the next power of two; for Sobol indices of each block.", lowest=32)
    ] = 1024,
    sobol: Annotated[
        bool, Parameter("Rank the entries by their contribution to the variance, by Sobol indices.")
    ] = False,
    over: Annotated[
        Values | None,
        KeyValues(
            "A band over a key, first:last:count or one,two,...; given twice, a map of median and interval.",
            "KEY=VALUES",
        ),
    ] = None,
    identified: Annotated[
        bool, Parameter("Draw the tribometer's masses, springs and dampers from the published facts.")
    ] = False,
    seed: Annotated[int, Parameter("Of the samples.", lowest=0)] = 0,
    workers: Annotated[int, Parameter("Threads.", lowest=1)] = 2,
    interval: Interval = True,
    evidence: Evidence = None,
    keep: Annotated[Kept | None, DoorParameter(files="sweep.nc sweep.json")] = None,
    **watch: Unpack[WatchedRig],
) -> "UncertaintyAnswer":
    """Uncertainty of an outcome from the distributions in the rig's file, and which entry to measure better.

    Example: sonolube uncertainty examples/rigs/tribometer_uncertain.toml --samples 256
    """
    if sobol and (over or identified):
        raise InvalidInput(
            f"{shown('sobol')} needs independent entries and one outcome each: leave out {shown('over')} and"
            f" {shown('identified')}"
        )
    if not interval or of not in _OF_THE_MODEL:
        refuse_unused(
            "evidence", because=f"without {shown('interval')} of {' or '.join(_OF_THE_MODEL)}, which rests on it"
        )
    known = rig_of(rig)
    learned = evidence_of(evidence, known) if interval and of in _OF_THE_MODEL else None
    refuse_replaced(known, over or {})
    axes = _axes(over or {})
    structure = None
    with stage("uncertainty") as advance:
        if identified:
            structure = identified_structure(
                known, seed=seed, advance=lambda done, total: advance("facts", done, total)
            )
        result = propagate(
            known,
            outcome=of,
            samples=samples,
            indices=sobol,
            over=axes,
            joint_samples=None if structure is None else structure.draws_by_key(),
            seed=seed,
            folder=kept(keep, f"{known.name}-uncertainty-{of}"),
            workers=workers,
            advance=lambda done, total: advance("points", done, total),
        )
    found = UncertaintyAnswer(rig=known, result=result, structure=structure, interval=interval, evidence=learned)
    if result[of].isnull().all():
        raise InvalidInput(f"no sample has a result: {next(iter(found.failures()))}")
    return found


@answer
class UncertaintyAnswer(Answer):
    """Statistics of an uncertain outcome, or its band over swept keys, and the ranking of the uncertain entries."""

    rig: Rig
    result: Dataset
    structure: IdentifiedStructure | None
    interval: bool = True
    evidence: EvidencePosterior | None = None

    def blocks(self) -> Sequence[Block]:
        """Statistics or band, statuses, uncertain entries, and their ranking."""
        return results.uncertainty_blocks(
            self.rig, self.result, self.structure, ranking=self._ranking, facts=self._facts()
        )

    def first_blocks(self) -> Sequence[Block]:
        """The same, the ranking before the entries."""
        return results.uncertainty_blocks(
            self.rig, self.result, self.structure, ranking=self._ranking, facts=self._facts(), is_ranking_first=True
        )

    def object(self) -> dict[str, Any]:
        """Statistics or band, statuses, uncertain entries, and their ranking."""
        content = results.sampled_object(self.rig, self.result, self.structure)
        if self._swept:
            content["band"] = results.band_object(self._band)
        else:
            content |= results.statistics_object(self._statistics)
        if self._of in _OF_THE_MODEL:
            content |= self._beyond.object()
        if self._ranked:
            content["sobol"] = [asdict(row) for row in self._ranking]
        return content

    def caveats(self) -> Sequence[str]:
        """Too few samples, draws that have not converged, and those of the rig at its own operating point."""
        caveats: list[str] = []
        if not self._swept and not self._statistics.has_converged:
            caveats.append(results.convergence(self._statistics))
        if self.structure is not None and not self.structure.posterior.has_converged:
            caveats.append(agreement(self.structure))
        meaning = ratio_caveats(friction_ratio=self.result[self._of].values) if self._of == "friction_ratio" else ()
        of_model = self._beyond.caveats() if self._of in _OF_THE_MODEL else ()
        return [*caveats, *operating_caveats(self._resolved), *meaning, *of_model]

    def leading_caveats(self) -> Sequence[str]:
        """An amplitude beyond that of all published tests, where friction is the outcome."""
        if self._of not in _OF_THE_MODEL:
            return ()
        try:
            amplitude = steady_vibration(self._resolved).vibration_amplitude
            return large_amplitude_caveats(self._resolved, vibration_amplitude=amplitude)
        except SonolubeError:  # at the values of the file, which need not be those of the samples
            return ()

    def figures(self) -> Mapping[str, Drawing]:
        """Histogram or band of the outcome, and the ranking of the entries."""
        result = self.result
        chart, caption = (band_chart, _BAND_CAPTION) if self._swept else (histogram_chart, _SAMPLES_CAPTION)
        outcome = Drawing(chart=lambda: chart(result), caption=caption)
        if not self._ranked:
            return {self._name: outcome}
        ranking = Drawing(chart=lambda: sobol_chart(result, outcome_indices(result)), caption=_SOBOL_CAPTION)
        return {self._name: outcome, f"{self._name}-sobol": ranking}

    def files(self) -> Mapping[str, Dataset]:
        """Samples as netCDF."""
        return {f"{self._name}.nc": self.result}

    def page(self) -> Page:
        """Page `uncertainty.html`."""
        return results.uncertainty_page(
            self.rig, self.result, self.structure, ranking=self._ranking, facts=self._facts()
        )

    def failures(self) -> dict[str, int]:
        """Number of samples without a result, by the reason."""
        return failure_counts(self.result, outcome=self._of)

    @property
    def _of(self) -> str:
        """Quantity whose uncertainty is propagated."""
        return str(self.result.attrs["outcome"])

    @property
    def _swept(self) -> bool:
        """Whether the outcome is a band over swept keys."""
        return bool(self.result.attrs["swept"])

    @property
    def _ranked(self) -> bool:
        """Whether the samples are those of Sobol indices."""
        return "block" in self.result.dims

    @property
    def _name(self) -> str:
        """Name of the files, without ending."""
        return f"{self.rig.name}-uncertainty-{self._of}"

    def _facts(self) -> list[tuple[str, str]]:
        """Statistics of the outcome, or its band, and the error of the friction model."""
        of_model = self._beyond.rows() if self._of in _OF_THE_MODEL else []
        if self._swept:
            return [*results.band_rows(self._band, self._of), *of_model]
        return [*results.statistics_rows(self._statistics, self._of), *of_model]

    @cached_property
    def _resolved(self) -> ResolvedRig:
        """Rig at its own operating point."""
        return resolved_rig(self.rig)

    @cached_property
    def _statistics(self) -> SampleStatistics:
        """Mean, deviation and quantiles of the outcome."""
        return outcome_statistics(self.result)

    @cached_property
    def _band(self) -> Band:
        """Interval of the outcome over the swept keys."""
        return outcome_band(self.result)

    @cached_property
    def _beyond(self) -> BeyondTheModel:
        """Uncertainty of the friction ratio that the samples leave out."""
        return beyond_the_model(self._resolved, self.rig.friction_model, interval=self.interval, evidence=self.evidence)

    @cached_property
    def _ranking(self) -> list[RankedEntry]:
        """Entries by their contribution to the variance; empty without Sobol indices."""
        return ranked_entries(self.result) if self._ranked else []


def _axes(over: Values) -> dict[str, Floats]:
    """Values that a band or a map runs over, by key."""
    if len(over) > 2:
        raise InvalidInput(f"{shown('over')} gives a band once and a map twice, not {len(over)} times")
    axes = {}
    for key, given in values_by_key(over).items():
        values = np.atleast_1d(given)
        if values.dtype.kind == "U":
            raise InvalidInput(f"{shown('over')} {key}: a band needs numbers to run over, not words")
        axes[key] = values.astype(np.float64)
        if values.size < 2 or np.any(np.diff(axes[key]) <= 0):
            raise InvalidInput(f"{shown('over')} {key}: a band needs at least 2 values that rise")
    return axes
