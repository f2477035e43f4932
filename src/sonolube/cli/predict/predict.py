"""Command `predict`: what vibration does to friction and wear on a rig, with intervals, updated by own runs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from sonolube.cli.console.answer import Answer, deliver, grid
from sonolube.cli.console.options import OUT, Amplitude, Changes, Json, Load, Out, RigPath, loaded_rig, measured_runs
from sonolube.cli.console.outputs import OutputFolder
from sonolube.cli.predict.measured import Measurement, measured_on
from sonolube.compilation import few_points
from sonolube.measurement.measured_runs import runs_help
from sonolube.prediction.figures import prediction_figure
from sonolube.prediction.rig_prediction import interval, predict as predicted
from sonolube.prediction.scores import PROBABILITIES
from sonolube.report import Drawing
from sonolube.rig import Rig
from sonolube.units import format_si
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr


_INPUT_HEADS = [
    "  least known inputs",
    "value",
    "to know it better",
    "left of the intervals of ratio and force",
    "known from",
]
_PERCENT = ("friction_reduction", "wear_reduction")


@few_points()
def predict(
    rig: RigPath,
    runs: Annotated[Path | None, typer.Option(metavar="RUNS.csv", help=runs_help("Own measured runs"))] = None,
    pin: Annotated[
        str | None, typer.Option(metavar="MATERIAL", help="Material of the pin, for the heat; by default the rig's.")
    ] = None,
    disc: Annotated[
        str | None, typer.Option(metavar="MATERIAL", help="Material of the disc, for the heat; by default the rig's.")
    ] = None,
    load: Load = None,
    amplitude: Amplitude = None,
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
    result = predicted(known, runs=own, pin=pin, disc=disc, seed=seed)
    measured = measured_on(known, vibration_amplitude=result.attrs["vibration_amplitude"])
    answer = PredictionAnswer(rig=known, prediction=result, measured=measured, name=f"{rig.stem}-prediction")
    deliver(answer, folder=out, as_json=json)


@dataclass(frozen=True, kw_only=True)
class PredictionAnswer(Answer):
    """Prediction of a rig with its intervals, in words, numbers, a figure and a dataset of draws."""

    rig: Rig
    prediction: "xr.Dataset"
    measured: Sequence[Measurement]
    name: str

    def lines(self) -> list[str]:
        """Statement in words, a table of quantities with their intervals, and the inputs."""
        heads = ["", "median", *(f"{100 * probability:.0f} %" for probability in PROBABILITIES)]
        attributes = self.prediction.attrs
        about = [f"  closures: {attributes['closures']}"]
        if "friction_ratio_by_the_rigs_model" in attributes:
            ratio = attributes["friction_ratio_by_the_rigs_model"]
            about.append(f"  friction ratio by {attributes['friction_model']} alone: {ratio:.3g}")
        return [
            f"{self.rig.title}, {format_si(self.rig.normal_load, 'N')}",
            *attributes["statement"].split("\n"),
            *grid([heads, *map(self._row, self._names())]),
            *grid([_INPUT_HEADS, *map(self._input_row, self._inputs())]),
            *about,
            *(f"  measured {one.label}: {one.text}" for one in self.measured),
        ]

    def object(self) -> dict[str, Any]:
        """Statement, quantities with median and intervals, inputs and weights of the closures."""
        return {
            "rig": self.rig.title,
            "statement": self.prediction.attrs["statement"].split("\n"),
            **{name: self._object(name) for name in self._names()},
            "inputs": [one.input_text.item() for one in self._inputs()],
            "measured": [one.object() for one in self.measured],
            "interval_share_left": {
                str(name): float(share) for name, share in self.prediction["interval_share_left"].to_series().items()
            },
            **{name: self.prediction.attrs.get(name) for name in ("closures", "runs", "actuator_power")},
        }

    def caveats(self) -> Sequence[str]:
        """Caveats of the prediction."""
        return [line for line in self.prediction.attrs["caveats"].split("\n") if line]

    def figures(self) -> Mapping[str, Drawing]:
        """Friction ratio over amplitude and speed with its intervals."""
        return {self.name: Drawing(draw=lambda: prediction_figure(self.prediction))}

    def files(self) -> "Mapping[str, xr.Dataset]":
        """Draws and curves."""
        return {f"{self.name}.nc": self.prediction}

    def _inputs(self) -> "list[xr.Dataset]":
        """Uncertain inputs, the least known first."""
        return [self.prediction.sel(input=name) for name in self.prediction["input"].to_numpy()]

    def _input_row(self, one: "xr.Dataset") -> list[str]:
        """Uncertain input with its spread, how to know it better, and what of the intervals would be left."""
        left = [f"{100 * one[name].item():.0f} %" for name in ("interval_share_left", "force_interval_share_left")]
        value = format_si(one.input_value.item(), quantity(one.input.item()).unit)
        known = f"{value} within {100 * one.input_spread.item():.0f} %"
        return [f"  {one.input_label.item()}", known, one.remedy.item(), " and ".join(left), one.reason.item()]

    def _names(self) -> list[str]:
        """Predicted quantities in their order."""
        return [str(name) for name, values in self.prediction.data_vars.items() if values.dims == ("draw",)]

    def _row(self, name: str) -> list[str]:
        """Median and intervals of a quantity as text."""
        median = float(self.prediction[name].median())
        ends = [interval(self.prediction, name, probability) for probability in PROBABILITIES]
        text = [f"{_text(name, low)} to {_text(name, high)}" for low, high in ends]
        return [f"  {quantity(name).meaning}", _text(name, median), *text]

    def _object(self, name: str) -> dict[str, Any]:
        """Median and intervals of a quantity in SI."""
        return {
            "median": float(self.prediction[name].median()),
            **{
                f"interval_{100 * probability:.0f}": list(interval(self.prediction, name, probability))
                for probability in PROBABILITIES
            },
            "unit": quantity(name).unit,
        }


def _text(name: str, value: float) -> str:
    """Value with two or three digits, reductions in percent."""
    return f"{100 * value:.0f} %" if name in _PERCENT else format_si(value, quantity(name).unit, digits=2)
