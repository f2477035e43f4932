"""Task `predict`: what vibration does to friction and wear on a rig, with intervals, updated by own runs."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import numpy as np

from sonolube.measurement.measured_runs import runs_help
from sonolube.prediction.figures import prediction_chart
from sonolube.prediction.live_prediction import LivePrediction
from sonolube.prediction.predictive import DRAWS
from sonolube.prediction.rig_statement import interval
from sonolube.prediction.scores import PROBABILITIES
from sonolube.report import Drawing
from sonolube.rig import Rig
from sonolube.rig.labelled_arrays import LabelledArrays
from sonolube.tasks.answer import Answer, answer
from sonolube.tasks.blocks import Block, Table
from sonolube.tasks.parameters import Disc, Parameter, Pin, RigFile, RigSource, RunsSource, rig_of, runs_of
from sonolube.tasks.results.measured import Measurement, measured_on
from sonolube.tasks.task import task
from sonolube.units import format_si
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr

Laboratory: TypeAlias = "Mapping[RigSource, RunsSource] | Sequence[tuple[RigSource, RunsSource]] | None"

_LABORATORY = Parameter(
    help="Another rig of your laboratory with its runs, which tell of the contact's decay length; may be repeated.",
    kind="RIG.toml=RUNS.csv",
    is_mapping=True,
)
_INPUT_HEADS = ["least known inputs", "value", "known well, it leaves of ratio and force", "known from"]
_MEASURE_HEADS = ["what would narrow it", "leaves of the interval"]
_INPUT_COLUMNS = (
    *("input", "input_label", "input_value", "input_spread", "reason"),
    *("interval_share_left", "force_interval_share_left"),
)
_PERCENT = ("friction_reduction", "wear_reduction")


@task
def predict(
    rig: RigFile,
    *,
    runs: Annotated[RunsSource, Parameter(help=runs_help("Own measured runs"), kind="RUNS.csv", is_file=True)] = None,
    laboratory: Annotated[Laboratory, _LABORATORY] = None,
    pin: Pin = None,
    disc: Disc = None,
    lubricant: Annotated[bool, Parameter(help="The contact is lubricated: a dry prediction does not hold.")] = False,
    draws: Annotated[
        int,
        Parameter(help="Equally probable outcomes, 4000 for two digits of the intervals.", lowest=100, highest=200_000),
    ] = DRAWS,
    seed: Annotated[int, Parameter(help="Of the draws.", lowest=0)] = 0,
) -> "PredictionAnswer":
    """Friction and wear under vibration with 50, 80 and 95 % intervals, and what to measure next.

    Example: sonolube predict examples/rigs/tribometer.toml --pin stainless_steel_316 --disc aluminium_2024
    """
    known = rig_of(rig)
    result = LivePrediction(
        known,
        runs=runs_of(runs),
        laboratory_runs=_rigs_with_runs(laboratory),
        pin=pin,
        disc=disc,
        lubricant=lubricant,
        draws=draws,
        seed=seed,
    ).first
    measured = measured_on(known, vibration_amplitude=result.attrs["vibration_amplitude"])
    return PredictionAnswer(rig=known, prediction=result, measured=measured)


def _rigs_with_runs(laboratory: Laboratory) -> "list[tuple[Rig, xr.Dataset]]":
    """Rigs of a laboratory with the runs of each."""
    pairs = laboratory.items() if isinstance(laboratory, Mapping) else laboratory or ()
    found = []
    for rig, table in pairs:
        known, runs = rig_of(rig), runs_of(table)
        if runs is not None:
            found.append((known, runs))
    return found


@answer
class PredictionAnswer(Answer):
    """Prediction of a rig with its intervals, in words, numbers, a figure and a dataset of draws."""

    rig: Rig
    prediction: LabelledArrays
    measured: Sequence[Measurement]

    def blocks(self) -> Sequence[Block]:
        """Statement in words, a table of quantities with their intervals, and the inputs."""
        heads = ["", "median", *(f"{100 * probability:.0f} %" for probability in PROBABILITIES)]
        attributes = self.prediction.attrs
        about = []
        if "friction_ratio_by_the_rigs_model" in attributes:
            ratio = attributes["friction_ratio_by_the_rigs_model"]
            about.append(f"  friction ratio by {attributes['friction_model']} alone: {ratio:.3g}")
        return [
            f"{self.rig.title}, {format_si(self.rig.normal_load, 'N')}",
            *attributes["statement"].split("\n"),
            Table(heads, [self._row(name) for name in self._names()]),
            Table(_MEASURE_HEADS, self._measure_rows()),
            *(f"  {line}" for line in self._probes()),
            Table(_INPUT_HEADS, [self._input_row(place) for place in range(self.prediction.sizes["input"])]),
            *about,
            *(f"  measured {one.label}: {one.text}" for one in self.measured),
        ]

    def object(self) -> dict[str, Any]:
        """Statement, quantities with median and intervals, inputs and weights of the closures."""
        return {
            "rig": self.rig.title,
            "statement": self.prediction.attrs["statement"].split("\n"),
            **{name: self._object(name) for name in self._names()},
            "inputs": self.prediction["input_text"].to_numpy().tolist(),
            "share_left_by_measurement": dict(
                zip(self._column("measure_label"), self._column("measure_share_left"), strict=True)
            ),
            "stiffness_probes": self._probes(),
            "measured": [one.object() for one in self.measured],
            "interval_share_left": dict(zip(self._column("input"), self._column("interval_share_left"), strict=True)),
            **{name: self.prediction.attrs.get(name) for name in ("runs", "actuator_power")},
            "operating_point": self._operating_point(),
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

    def _operating_point(self) -> list[dict[str, str]]:
        """Amplitude with its spread and power of the amplifier, as labels and texts."""
        spread = dict(zip(self._column("input"), self._column("input_spread"), strict=True))
        found = []
        for name in ("vibration_amplitude", "actuator_power"):
            value = self.prediction.attrs.get(name)
            if value is not None:
                within = f" within {100 * spread[name]:.0f} %" if name in spread else ""
                label = quantity(name).meaning
                found.append({"name": name, "label": label, "text": f"{format_si(value, quantity(name).unit)}{within}"})
        return found

    def _probes(self) -> list[str]:
        """Which resonances of the rig tell the contact stiffness, a sentence each."""
        return [line for line in self.prediction.attrs["stiffness_probes"].split("\n") if line]

    def _column(self, name: str) -> list[Any]:
        """Values of a variable over the uncertain inputs."""
        values: list[Any] = self.prediction[name].to_numpy().tolist()
        return values

    def _input_row(self, place: int) -> list[str]:
        """Uncertain input with its spread, what of the intervals is left if it is known well, and its origin."""
        one = {name: self._column(name)[place] for name in _INPUT_COLUMNS}
        left = [f"{100 * one[name]:.0f} %" for name in ("interval_share_left", "force_interval_share_left")]
        value = format_si(one["input_value"], quantity(one["input"]).unit)
        known = f"{value} within {100 * one['input_spread']:.0f} %"
        return [one["input_label"], known, " and ".join(left), one["reason"]]

    def _measure_rows(self) -> list[list[str]]:
        """Measurements that would narrow the interval, and what each leaves of it."""
        pairs = zip(self._column("measure_label"), self._column("measure_share_left"), strict=True)
        return [[label, f"{100 * share:.0f} %"] for label, share in pairs]

    def _names(self) -> list[str]:
        """Predicted quantities in their order."""
        return [name for name, values in self.prediction.variables.items() if values.dims == ("draw",)]

    def _row(self, name: str) -> list[str]:
        """Median and intervals of a quantity as text."""
        median = float(np.median(self.prediction[name].to_numpy()))
        ends = [interval(self.prediction, name, probability) for probability in PROBABILITIES]
        text = [f"{_text(name, low)} to {_text(name, high)}" for low, high in ends]
        return [quantity(name).meaning, _text(name, median), *text]

    def _object(self, name: str) -> dict[str, Any]:
        """Median and intervals of a quantity in SI."""
        return {
            "median": float(np.median(self.prediction[name].to_numpy())),
            **{
                f"interval_{100 * probability:.0f}": list(interval(self.prediction, name, probability))
                for probability in PROBABILITIES
            },
            "unit": quantity(name).unit,
        }


def _text(name: str, value: float) -> str:
    """Value with two or three digits, reductions in percent."""
    return f"{100 * value:.0f} %" if name in _PERCENT else format_si(value, quantity(name).unit, digits=2)
