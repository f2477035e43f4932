"""Command `predict`: what vibration does to friction and wear on a rig, with intervals, updated by own runs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer

from sonolube.cli.console.answer import Answer, deliver, grid
from sonolube.cli.console.options import OUT, Amplitude, Changes, Json, Load, Out, RigPath, loaded_rig, measured_runs
from sonolube.cli.console.outputs import OutputFolder
from sonolube.cli.predict.measured import Measurement, measured_on
from sonolube.compilation import few_points
from sonolube.errors import InvalidInput
from sonolube.measurement.measured_runs import runs_help
from sonolube.prediction.figures import prediction_figure
from sonolube.prediction.live_prediction import LivePrediction
from sonolube.prediction.rig_statement import interval
from sonolube.prediction.scores import PROBABILITIES
from sonolube.report import Drawing
from sonolube.rig import Rig
from sonolube.rig.labelled_arrays import LabelledArrays
from sonolube.units import format_si
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr

_INPUT_HEADS = ["  least known inputs", "value", "known well, it leaves of ratio and force", "known from"]
_MEASURE_HEADS = ["  what would narrow it", "leaves of the interval"]
_INPUT_COLUMNS = (
    *("input", "input_label", "input_value", "input_spread", "reason"),
    *("interval_share_left", "force_interval_share_left"),
)
_PERCENT = ("friction_reduction", "wear_reduction")


@few_points()
def predict(
    rig: RigPath,
    runs: Annotated[Path | None, typer.Option(metavar="RUNS.csv", help=runs_help("Own measured runs"))] = None,
    laboratory: Annotated[
        list[str] | None,
        typer.Option(
            metavar="RIG.toml=RUNS.csv",
            help="Another rig of your laboratory with its runs, which tell of the contact's decay length; may be"
            " repeated.",
        ),
    ] = None,
    pin: Annotated[
        str | None, typer.Option(metavar="MATERIAL", help="Material of the pin, for the heat; by default the rig's.")
    ] = None,
    disc: Annotated[
        str | None, typer.Option(metavar="MATERIAL", help="Material of the disc, for the heat; by default the rig's.")
    ] = None,
    load: Load = None,
    amplitude: Amplitude = None,
    lubricant: Annotated[
        bool, typer.Option("--lubricant", help="The contact is lubricated: a dry prediction does not hold.")
    ] = False,
    seed: Annotated[int, typer.Option(min=0, help="Of the draws.")] = 0,
    changes: Changes = None,
    out: Annotated[Out, OutputFolder("{rig}-prediction.*")] = OUT,
    json: Json = False,
) -> None:
    """Friction and wear under vibration with 50, 80 and 95 % intervals, and what to measure next.

    Example: sonolube predict examples/rigs/tribometer.toml --pin stainless_steel_316 --disc aluminium_2024
    """
    known = loaded_rig(rig, load=load, changes=changes, amplitude=amplitude)
    own = None if runs is None else measured_runs(runs)
    others = [_rig_with_runs(text) for text in laboratory or []]
    result = LivePrediction(
        known, runs=own, laboratory_runs=others, pin=pin, disc=disc, lubricant=lubricant, seed=seed
    ).first
    measured = measured_on(known, vibration_amplitude=result.attrs["vibration_amplitude"])
    answer = PredictionAnswer(rig=known, prediction=result, measured=measured, name=f"{rig.stem}-prediction")
    deliver(answer, folder=out, as_json=json)


def _rig_with_runs(text: str) -> "tuple[Rig, xr.Dataset]":
    """Rig and runs of `--laboratory`."""
    rig, equals, runs = text.partition("=")
    if not (rig and equals and runs):
        raise InvalidInput(f"--laboratory {text}: give a rig file and the table of its runs as RIG.toml=RUNS.csv")
    return loaded_rig(Path(rig), changes=None, amplitude=None), measured_runs(Path(runs))


@dataclass(frozen=True, kw_only=True)
class PredictionAnswer(Answer):
    """Prediction of a rig with its intervals, in words, numbers, a figure and a dataset of draws."""

    rig: Rig
    prediction: LabelledArrays
    measured: Sequence[Measurement]
    name: str

    def lines(self) -> list[str]:
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
            *grid([heads, *map(self._row, self._names())]),
            *grid([_MEASURE_HEADS, *self._measure_rows()]),
            *(f"  {line}" for line in self._probes()),
            *grid([_INPUT_HEADS, *map(self._input_row, range(self.prediction.sizes["input"]))]),
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
        }

    def caveats(self) -> Sequence[str]:
        """Caveats of the prediction."""
        return [line for line in self.prediction.attrs["caveats"].split("\n") if line]

    def figures(self) -> Mapping[str, Drawing]:
        """Friction ratio over amplitude and speed with its intervals."""
        return {self.name: Drawing(draw=lambda: prediction_figure(self.prediction))}

    def files(self) -> Mapping[str, LabelledArrays]:
        """Draws and curves."""
        return {f"{self.name}.nc": self.prediction}

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
        return [f"  {one['input_label']}", known, " and ".join(left), one["reason"]]

    def _measure_rows(self) -> list[list[str]]:
        """Measurements that would narrow the interval, and what each leaves of it."""
        pairs = zip(self._column("measure_label"), self._column("measure_share_left"), strict=True)
        return [[f"  {label}", f"{100 * share:.0f} %"] for label, share in pairs]

    def _names(self) -> list[str]:
        """Predicted quantities in their order."""
        return [name for name, values in self.prediction.variables.items() if values.dims == ("draw",)]

    def _row(self, name: str) -> list[str]:
        """Median and intervals of a quantity as text."""
        median = float(np.median(self.prediction[name].to_numpy()))
        ends = [interval(self.prediction, name, probability) for probability in PROBABILITIES]
        text = [f"{_text(name, low)} to {_text(name, high)}" for low, high in ends]
        return [f"  {quantity(name).meaning}", _text(name, median), *text]

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
