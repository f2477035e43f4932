"""Task `predict`: what vibration does to friction and wear on a rig, with intervals, updated by own runs."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, TypeAlias, Unpack

from sonolube.measurement.measured_runs import runs_text
from sonolube.measurement.run_columns import runs_help
from sonolube.prediction.figures import prediction_chart
from sonolube.prediction.live_prediction import LivePrediction
from sonolube.prediction.predictive import DRAWS
from sonolube.prediction.verdict import PointVerdict, Verdict
from sonolube.report import Drawing
from sonolube.report.results import prediction as results
from sonolube.report.results.rig_point import measured_object, measured_on, measured_text
from sonolube.rig import Rig
from sonolube.rig.datasets import LabelledArrays
from sonolube.tasks.answer import Answer, Block, Dataset, ScreenBlock, Table, answer
from sonolube.tasks.own_evidence import Evidence, evidence_of
from sonolube.tasks.own_tables import MappedRuns, required_runs, runs_of
from sonolube.tasks.parameters import (
    Disc,
    File,
    KeyValues,
    Parameter,
    Pin,
    RigEntries,
    RigFile,
    RigSource,
    RunsSource,
    rig_of,
)
from sonolube.tasks.task import task
from sonolube.text.units import format_si
from sonolube.validation.published_tests import FrictionTest

Laboratory: TypeAlias = "Mapping[RigSource, RunsSource] | Sequence[tuple[RigSource, RunsSource]] | None"

_LABORATORY = KeyValues(
    "Another rig of your laboratory with its runs, which tell of the contact's decay length; may be repeated.",
    "RIG.toml=RUNS.csv",
)
_MEASURE_HEADS = ["what would narrow it", "leaves of the interval"]


@task
def predict(
    rig: RigFile,
    *,
    runs: Annotated[RunsSource, File(runs_help("Own measured runs"), "RUNS.csv")] = None,
    mapping: MappedRuns = None,
    laboratory: Annotated[Laboratory, _LABORATORY] = None,
    evidence: Evidence = None,
    pin: Pin = None,
    disc: Disc = None,
    lubricant: Annotated[bool, Parameter("The contact is lubricated: a dry prediction does not hold.")] = False,
    draws: Annotated[
        int, Parameter("Equally probable outcomes, 4000 for two digits of the intervals.", lowest=100, highest=200_000)
    ] = DRAWS,
    seed: Annotated[int, Parameter("Of the draws.", lowest=0)] = 0,
    **entries: Unpack[RigEntries],
) -> "PredictionAnswer":
    """Friction and wear under vibration with 50, 80 and 95 % intervals, and what to measure next.

    Example: sonolube predict examples/rigs/tribometer.toml --pin stainless_steel_316 --disc aluminium_2024

    Examples
    --------
    >>> import sonolube as sl
    >>> answer = sl.predict("examples/rigs/tribometer.toml", seed=1)
    >>> round(float(answer["friction_ratio"].median()), 1)
    0.3
    """
    known = rig_of(rig)
    own = runs_of(runs, mapping, known)
    result = LivePrediction(
        known,
        runs=own,
        laboratory_runs=_rigs_with_runs(laboratory),
        evidence=evidence_of(evidence, known),
        pin=pin,
        disc=disc,
        lubricant=lubricant,
        draws=draws,
        seed=seed,
    ).first
    measured = measured_on(known, vibration_amplitude=result.attrs["vibration_amplitude"])
    read_as = "" if own is None else runs_text(own)
    return PredictionAnswer(rig=known, prediction=result, measured=measured, read_as=read_as)


def _rigs_with_runs(laboratory: Laboratory) -> "list[tuple[Rig, Dataset]]":
    """Rigs of a laboratory with the runs of each."""
    pairs = laboratory.items() if isinstance(laboratory, Mapping) else laboratory or ()
    return [(rig_of(rig), required_runs(table)) for rig, table in pairs if table is not None]


@answer
class PredictionAnswer(Answer):
    """Prediction of a rig with its intervals, in words, numbers, a figure and a dataset of draws."""

    rig: Rig
    prediction: LabelledArrays
    measured: Sequence[FrictionTest]
    read_as: str = ""

    def blocks(self) -> Sequence[Block]:
        """Statement in words, a table of quantities with their intervals, and the inputs."""
        attributes = self.prediction.attrs
        about, measured = [], results.measurement_shares(self.prediction)
        if "friction_ratio_by_the_rigs_model" in attributes:
            ratio = attributes["friction_ratio_by_the_rigs_model"]
            about.append(f"  friction ratio by {attributes['friction_model']} alone: {ratio:.3g}")
        return [
            f"{self.rig.title}, {format_si(self.rig.normal_load, 'N')}",
            *([self.read_as] if self.read_as else []),
            f"This point is {self._verdict().words}.",
            *attributes["statement"].split("\n"),
            Table(results.HEADS, results.quantity_rows(self.prediction)),
            Table(_MEASURE_HEADS, [(label, f"{100 * share:.0f} %") for label, share in measured.items()]),
            *(f"  {line}" for line in self._probes()),
            Table(results.INPUT_HEADS, results.input_rows(self.prediction)),
            *about,
            *(f"  measured {one.label}: {measured_text(one)}" for one in self.measured),
        ]

    def first_blocks(self) -> Sequence[ScreenBlock]:
        """Statement on friction, changes of friction and wear with power as bars, and what one run would leave."""
        contradiction, said = self.prediction.attrs["contradiction"], self.prediction.attrs["statement"].split("\n")
        verdict, one_run = self._verdict(), results.one_run_object(self.prediction)
        return [
            results.operating_line(self.rig, self.prediction),
            *([self.read_as] if self.read_as else []),
            *said[: 2 if contradiction else 1],
            *([] if verdict.verdict == Verdict.IN_RANGE else [f"This point is {verdict.words}."]),
            results.change_bars(self.prediction),
            *([f"One run of yours here: {one_run['text']}; see sonolube plan."] if one_run else []),
            *(f"  measured {one.label}: {measured_text(one)}" for one in self.measured),
        ]

    def object(self) -> dict[str, Any]:
        """Statement, quantities with median and intervals, inputs and weights of the friction models."""
        found = self.prediction
        shares = results.column(found, "interval_share_left")
        return {
            "rig": self.rig.title,
            **self._verdict().object(),
            "statement": found.attrs["statement"].split("\n"),
            **{name: results.predicted_object(found, name) for name in results.predicted_names(found)},
            **dict.fromkeys(results.unknown_names(found)),
            "inputs": results.column(found, "input_text"),
            "share_left_by_measurement": results.measurement_shares(found),
            "measurements": results.measurement_objects(found),
            "one_run": results.one_run_object(found),
            "stiffness_probes": self._probes(),
            "measured": [measured_object(one) for one in self.measured],
            "interval_share_left": dict(zip(results.column(found, "input"), shares, strict=True)),
            "runs": found.attrs.get("runs"),
            "disagreeing_runs": [int(number) for number in found.attrs["disagreeing_runs"].split()],
            **results.power_object(found),
            "evidence": results.evidence_object(found),
            "operating_point": results.operating_texts(found),
        }

    def caveats(self) -> Sequence[str]:
        """Caveats of the prediction."""
        return [line for line in self.prediction.attrs["caveats"].split("\n") if line]

    def figures(self) -> Mapping[str, Drawing]:
        """Friction ratio over amplitude and speed with its intervals."""
        return {f"{self.rig.name}-prediction": Drawing(chart=lambda: prediction_chart(self.prediction))}

    def files(self) -> Mapping[str, LabelledArrays]:
        """Draws and curves."""
        return {f"{self.rig.name}-prediction.nc": self.prediction}

    def _verdict(self) -> PointVerdict:
        """Verdict on the operating point."""
        found = self.prediction.attrs
        reasons = tuple(line for line in found["verdict_reasons"].split("\n") if line)
        return PointVerdict(verdict=Verdict(found["verdict"]), reasons=reasons)

    def _probes(self) -> list[str]:
        """Sentences on the resonances of the rig that show its contact stiffness."""
        return [line for line in self.prediction.attrs["stiffness_probes"].split("\n") if line]
