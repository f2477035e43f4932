"""Command `plan`: the next tests of a rig, replicates and order, protocols, a table to fill and a sheet to print."""

import csv
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from sonolube.checks import Floats
from sonolube.cli.console.answer import deliver
from sonolube.cli.console.options import OUT, Amplitude, Changes, Json, Out, RigPath, loaded_rig, measured_runs
from sonolube.cli.console.outputs import OutputFolder
from sonolube.cli.design.factor_values import factor_values
from sonolube.cli.design.plan_answer import PlanAnswer
from sonolube.compilation import few_points
from sonolube.design.test_plan.candidates import Factors, RigLimits
from sonolube.design.test_plan.comparison import COMPARISONS
from sonolube.design.test_plan.plan import Procedure, Question, plan_tests, published_distances
from sonolube.design.test_plan.run_order import BLOCKINGS
from sonolube.design.test_plan.run_table import has_results
from sonolube.errors import InvalidInput
from sonolube.prediction.inputs import RigInputs, rig_inputs
from sonolube.rig import Rig
from sonolube.units import temperature_difference_to_si, to_si

_SPEEDS, _AMPLITUDES = 7, 5  # values of a range without a count
_SPEED_RANGE = 3.0  # times the rig's speed, and its part
_LEAST_AMPLITUDE = 0.2  # of the rig's


class ComparisonName(StrEnum):
    """Names of `COMPARISONS`."""

    PAIRED = "paired"
    SEPARATE = "separate"


class BlockName(StrEnum):
    """Names of `BLOCKINGS`."""

    DAY = "day"
    PAIR = "pair"


@few_points()
def plan(
    context: typer.Context,
    rig: RigPath,
    runs: Annotated[
        Path | None,
        typer.Option(metavar="RUNS.csv", help="Own earlier runs: they give the scatter and update the prediction."),
    ] = None,
    speed: Annotated[
        str | None,
        typer.Option(
            metavar="VALUES",
            help="Sliding speeds, such as 20:200mm/s or 20,40,87mm/s; by default 1/3 to 3 times the rig's.",
        ),
    ] = None,
    load: Annotated[
        str | None, typer.Option(metavar="VALUES", help="Normal loads, such as 3,5,7N; the rig's by default.")
    ] = None,
    vibration: Annotated[
        str | None,
        typer.Option(
            metavar="VALUES", help="Vibration amplitudes, such as 0.5:2.3um; by default 1/5 of the rig's up to it."
        ),
    ] = None,
    voltage: Annotated[
        str | None, typer.Option(metavar="VALUES", help="Drive voltages, peak to peak, instead of amplitudes.")
    ] = None,
    points: Annotated[int, typer.Option(help="Number of conditions to test.", min=1)] = 4,
    difference: Annotated[str, typer.Option(metavar="SHARE", help="Friction reduction to be shown.")] = "10%",
    power: Annotated[float, typer.Option(help="Probability to show it where it is there.")] = 0.9,
    significance: Annotated[float, typer.Option(help="Probability to show it where it is not.")] = 0.05,
    comparison: Annotated[
        ComparisonName,
        typer.Option(help="Each run without, with and again without vibration, or states on specimens of their own."),
    ] = ComparisonName.PAIRED,
    scatter: Annotated[
        str | None,
        typer.Option(metavar="SHARE", help="Standard deviation of friction between runs; by --runs, or D Table 2.3."),
    ] = None,
    block: Annotated[
        BlockName, typer.Option(help="What the runs of a block share: a day, or one pair of pin and disc.")
    ] = BlockName.DAY,
    running_in: Annotated[
        str | None,
        typer.Option(metavar="LENGTH", help="Sliding until friction is steady; the longest of D Table 2.3 by default."),
    ] = None,
    measuring_time: Annotated[str, typer.Option(metavar="TIME", help="In steady friction, in each state.")] = "12s",
    amplifier_voltage: Annotated[
        str | None, typer.Option(metavar="VOLTAGE", help="Greatest voltage of the amplifier, offset included.")
    ] = None,
    amplifier_power: Annotated[
        str | None, typer.Option(metavar="POWER", help="Greatest power of the amplifier.")
    ] = None,
    hottest: Annotated[
        str,
        typer.Option(
            "--temperature-rise",
            metavar="TEMPERATURE",
            help="Greatest rise of the contact by friction; needs both materials.",
        ),
    ] = "50K",
    pin: Annotated[str | None, typer.Option(metavar="MATERIAL", help="Material of the pin, for the heat.")] = None,
    disc: Annotated[str | None, typer.Option(metavar="MATERIAL", help="Material of the disc, for the heat.")] = None,
    seed: Annotated[int, typer.Option(min=0, help="Of the order of the runs.")] = 0,
    amplitude: Amplitude = None,
    changes: Changes = None,
    out: Annotated[Out, OutputFolder("{rig}-plan.* {rig}-plan-runs.csv {rig}-plan/*")] = OUT,
    json: Json = False,
) -> None:
    """Plan the next tests of a rig: points that tell models apart, replicates, order, protocols, and a sheet to print.

    Example: sonolube plan examples/rigs/power_map.toml --speed 20:200mm/s --points 3
    """
    _refuse_filled(out / f"{rig.stem}-plan-runs.csv")
    known = loaded_rig(rig, changes=changes, amplitude=amplitude)
    inputs = rig_inputs(known)
    result = plan_tests(
        known,
        _factors(known, inputs, speed=speed, load=load, vibration=vibration, voltage=voltage),
        question=Question(
            difference=to_si(difference, unit="", name="--difference"),
            power=power,
            significance=significance,
            comparison=COMPARISONS[comparison.value],
            scatter=None if scatter is None else to_si(scatter, unit="", name="--scatter"),
        ),
        procedure=_procedure(running_in, measuring_time, block.value),
        points=points,
        limits=RigLimits(
            voltage_maximum=_limit(amplifier_voltage, "V", "--amplifier-voltage"),
            actuator_power=_limit(amplifier_power, "W", "--amplifier-power"),
            mean_temperature_rise=temperature_difference_to_si(hottest, name="--temperature-rise"),
        ),
        runs=None if runs is None else measured_runs(runs),
        pin=pin,
        disc=disc,
        seed=seed,
    )
    answer = PlanAnswer(rig=known, plan=result, name=f"{rig.stem}-plan")
    deliver(answer, folder=out, as_json=json, context=context)


def _refuse_filled(table: Path) -> None:
    """Raise for a table of runs that holds results already."""
    if not table.is_file():
        return
    try:
        filled = has_results(table.read_text(encoding="utf-8-sig"))
    except (OSError, UnicodeDecodeError, csv.Error):
        filled = True
    if filled:
        raise InvalidInput(f"{table}: holds results, which would be lost; move it, or name another folder by --out")


def _factors(
    rig: Rig, inputs: RigInputs, *, speed: str | None, load: str | None, vibration: str | None, voltage: str | None
) -> Factors:
    """Values of loads, speeds and amplitudes: as given, else about those of the rig."""
    about = inputs.sliding_speed
    speeds = f"{about / _SPEED_RANGE:.6g}:{about * _SPEED_RANGE:.6g} m/s" if speed is None else speed
    return Factors(
        normal_load=np.array([rig.normal_load])
        if load is None
        else factor_values(load, unit="N", option="--load", count=3),
        sliding_speed=factor_values(speeds, unit="m/s", option="--speed", count=_SPEEDS),
        vibration_amplitude=_amplitudes(inputs, vibration, voltage),
    )


def _amplitudes(inputs: RigInputs, vibration: str | None, voltage: str | None) -> Floats:
    """Amplitudes as given, by voltages, or up to the rig's."""
    if vibration is not None and voltage is not None:
        raise InvalidInput("--vibration and --voltage both set the amplitude; give one")
    if voltage is not None:
        if inputs.voltage_peak_to_peak is None:
            raise InvalidInput("--voltage needs the rig's drive.voltage_peak_to_peak to scale by; give --vibration")
        volts = factor_values(voltage, unit="V", option="--voltage", count=_AMPLITUDES)
        return np.asarray(inputs.amplitude.value * volts / inputs.voltage_peak_to_peak)
    if vibration is not None:
        return factor_values(vibration, unit="m", option="--vibration", count=_AMPLITUDES)
    return inputs.amplitude.value * np.linspace(_LEAST_AMPLITUDE, 1.0, _AMPLITUDES)


def _procedure(running_in: str | None, measuring_time: str, block: str) -> Procedure:
    """Form of each run."""
    without, vibrated = published_distances()
    if running_in is not None:
        without = vibrated = to_si(running_in, unit="m", name="--running-in")
    return Procedure(
        intrinsic_distance=without,
        vibrated_distance=vibrated,
        measuring_time=to_si(measuring_time, unit="s", name="--measuring-time"),
        blocking=BLOCKINGS[block],
    )


def _limit(text: str | None, unit: str, option: str) -> float | None:
    """Limit in SI, where it is given."""
    return None if text is None else to_si(text, unit=unit, name=option)
