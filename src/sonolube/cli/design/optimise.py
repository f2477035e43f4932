"""Command `optimise`: actuator, frequency, waveform and masses for a friction at least power, heat or voltage."""

from collections.abc import Sequence
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from sonolube.checks import require_positive
from sonolube.cli.console.answer import deliver
from sonolube.cli.console.options import (
    OUT,
    Changes,
    Json,
    Out,
    RigPath,
    TypedNumber,
    refuse_replaced,
    refuse_unused,
    si_option,
)
from sonolube.cli.console.outputs import OutputFolder
from sonolube.cli.console.progress import progress
from sonolube.cli.design import optimisation_options as options
from sonolube.cli.design.optimisation_answer import OptimisationAnswer
from sonolube.compilation import few_points
from sonolube.design import optimisation
from sonolube.errors import InvalidInput
from sonolube.models.actuator import read_catalogue
from sonolube.rig import read_rig, rig_content


class Objective(StrEnum):
    """Quantity that is minimised."""

    POWER = "power"
    HEAT = "heat"
    VOLTAGE = "voltage"


@few_points()
def optimise(
    context: typer.Context,
    rig: RigPath,
    friction: Annotated[
        str, typer.Option("--target-friction", metavar="FRICTION", help="Coefficient or force, such as 0.1 or 0.3N.")
    ],
    over: Annotated[
        list[str] | None,
        typer.Option(
            metavar="KEY=FIRST:LAST",
            help="A range to choose from: drive.frequency or an entry of structure; or drive.waveform=one,two."
            " May come again; the frequency by a fifth either way by default.",
        ),
    ] = None,
    actuator: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="own, a name that `sonolube actuators` lists, or catalogue. May come again."),
    ] = None,
    catalogue: Annotated[
        Path | None, typer.Option(metavar="FILE.toml", help="Further actuators, in the format of the built-in list.")
    ] = None,
    minimise: Annotated[Objective, typer.Option(help="Quantity to minimise.")] = Objective.POWER,
    pareto: Annotated[Objective | None, typer.Option(help="A second objective, for the front between both.")] = None,
    robust: Annotated[
        float | None, typer.Option(help="Relative tolerance of stiffness, masses and gain.", min=0, max=0.3)
    ] = None,
    share: Annotated[
        float | None,
        typer.Option(
            "--quantile", help="Fraction of built rigs that must reach it; the worst by default.", min=0.5, max=1
        ),
    ] = None,
    samples: Annotated[int, typer.Option(help="Structures drawn for each actuator.", min=2, max=4096)] = 16,
    voltage_limit: Annotated[float | None, si_option("V", "Highest voltage either way.")] = None,
    current_limit: Annotated[float | None, si_option("A", "Highest current.", metavar="CURRENT")] = None,
    slew_limit: Annotated[float | None, si_option("V/s", "Fastest change, such as 3V/us.", metavar="RATE")] = None,
    pressure_limit: Annotated[
        float | None, si_option("Pa", "Highest nominal stress.", "--stress-limit", metavar="STRESS")
    ] = None,
    warming_limit: Annotated[
        float | None, si_option("K", "Highest temperature rise, such as 40K.", "--temperature-limit")
    ] = None,
    conductance: Annotated[
        float | None, si_option("W/K", "Thermal conductance of the actuator, such as 0.5W/K.", metavar="CONDUCTANCE")
    ] = None,
    horn: Annotated[str | None, typer.Option(metavar="MATERIAL", help="Of a half-wave horn at the tip.")] = None,
    horn_limit: Annotated[float | None, si_option("Pa", "Stress amplitude allowed in it.", metavar="STRESS")] = None,
    bolt: Annotated[str | None, typer.Option(metavar="THREAD", help="Preload bolt, such as M6x40mm.")] = None,
    bolt_tension: Annotated[float | None, si_option("N", "Tension of the bolt.", "--preload")] = None,
    bolt_strength: Annotated[float, si_option("Pa", "Proof strength; class 8.8.", metavar="STRESS")] = TypedNumber(
        "640MPa", "Pa"
    ),
    quality: Annotated[float, typer.Option(help="Mechanical quality factor of the catalogue's ceramics.")] = 80.0,
    source: Annotated[
        float | None,
        si_option("ohm", "To match by two elements, such as 50ohm.", "--source-resistance", metavar="RESISTANCE"),
    ] = None,
    changes: Changes = None,
    out: Annotated[Out, OutputFolder("optimise.html {rig}-optimum.* {rig}-optimum-*.*")] = OUT,
    json: Json = False,
) -> None:
    """Design: actuator, frequency, waveform and masses that give a friction for least power, heat or voltage.

    Example: sonolube optimise examples/rigs/tribometer.toml --target-friction 0.15
    """
    known = read_rig(rig, changes=changes or ())
    content = rig_content(rig, changes=changes or ())
    refuse_replaced(changes, over)
    _refuse_unused(context, actuator or [], catalogue)
    if not any(entry.strip().startswith("structure.") for entry in over or ()):
        refuse_unused(context, "samples", because="unless --over gives an entry of structure, whose values are drawn")
    if share is not None and robust is None:
        raise InvalidInput("--quantile needs --robust, the tolerance")
    if warming_limit is not None and conductance is None:
        raise InvalidInput("--temperature-limit needs --conductance, the heat that the actuator loses per kelvin")
    limits = optimisation.Limits(
        voltage_maximum=voltage_limit,
        current_maximum=current_limit,
        slew_rate_maximum=slew_limit,
        nominal_pressure=pressure_limit,
        temperature_rise=warming_limit,
        thermal_conductance=conductance,
        horn=options.horn(horn, horn_limit),
    )
    space = options.design_space(
        known,
        content,
        over=over or [],
        actuators=actuator or [],
        catalogue=catalogue,
        mechanical_quality_factor=quality,
        bolt=options.bolt(bolt, bolt_tension, bolt_strength),
    )
    problem = optimisation.DesignProblem(
        space=space,
        friction_ratio=options.friction_ratio(known, friction),
        limits=limits,
        tolerance=None if robust is None else optimisation.Tolerance(manufacturing_tolerance=robust, quantile=share),
    )
    if source is not None:
        require_positive(source_resistance=source)
    with progress("optimising") as advance:
        optimum = optimisation.optimise(
            problem,
            minimise=minimise.value,
            second_objective=None if pareto is None else pareto.value,
            samples=samples,
            advance=lambda done, total: advance("structures", done, total),
        )
        electric = optimisation.required_electronics(problem, optimum.best, source_resistance=source)
    answer = OptimisationAnswer(rig_file=rig, content=content, optimum=optimum, electric=electric)
    deliver(answer, folder=out, as_json=json, context=context)


def _refuse_unused(context: typer.Context, actuators: Sequence[str], catalogue: Path | None) -> None:
    """Refuse options for actuators, bolts and a second objective that the others leave without effect."""
    further = {"catalogue", *(() if catalogue is None else read_catalogue(catalogue))}
    if not further & set(actuators):
        refuse_unused(context, "catalogue", because="unless --actuator names one of its actuators, or is catalogue")
    if set(actuators) <= {optimisation.OWN_ACTUATOR}:
        refuse_unused(context, "quality", because="for the rig's own actuator; it is for those of the catalogue")
    if context.params["bolt"] is None:
        refuse_unused(context, "bolt_strength", because="without --bolt")
    if context.params["pareto"] == context.params["minimise"]:
        refuse_unused(context, "pareto", because="for the quantity that is minimised; name another")
