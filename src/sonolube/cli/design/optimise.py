"""Command `optimise`: actuator, frequency, waveform and masses for a friction at least power, heat or voltage."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from sonolube.checks import require_positive
from sonolube.cli.console.answer import deliver
from sonolube.cli.console.options import OUT, Changes, Json, Out, RigPath, option_value
from sonolube.cli.console.progress import progress
from sonolube.cli.design import optimisation_options as options
from sonolube.cli.design.optimisation_answer import OptimisationAnswer
from sonolube.design import optimisation
from sonolube.errors import InvalidInput
from sonolube.rig import read_rig, rig_content
from sonolube.units import temperature_difference_to_si


class Objective(StrEnum):
    """Quantity that is minimised."""

    POWER = "power"
    HEAT = "heat"
    VOLTAGE = "voltage"


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
    voltage_limit: Annotated[str | None, typer.Option(metavar="VOLTAGE", help="Highest voltage either way.")] = None,
    current_limit: Annotated[str | None, typer.Option(metavar="CURRENT", help="Highest current.")] = None,
    slew_limit: Annotated[str | None, typer.Option(metavar="RATE", help="Fastest change, such as 3V/us.")] = None,
    pressure_limit: Annotated[
        str | None, typer.Option("--stress-limit", metavar="STRESS", help="Highest nominal stress.")
    ] = None,
    warming_limit: Annotated[
        str | None, typer.Option("--temperature-limit", metavar="KELVIN", help="Highest temperature rise, such as 40K.")
    ] = None,
    conductance: Annotated[
        str | None, typer.Option(metavar="CONDUCTANCE", help="Thermal conductance of the actuator, such as 0.5W/K.")
    ] = None,
    horn: Annotated[str | None, typer.Option(metavar="MATERIAL", help="Of a half-wave horn at the tip.")] = None,
    horn_limit: Annotated[str | None, typer.Option(metavar="STRESS", help="Stress amplitude allowed in it.")] = None,
    bolt: Annotated[str | None, typer.Option(metavar="THREAD", help="Preload bolt, such as M6x40mm.")] = None,
    bolt_tension: Annotated[str | None, typer.Option("--preload", metavar="FORCE", help="Tension of the bolt.")] = None,
    bolt_strength: Annotated[str, typer.Option(metavar="STRESS", help="Proof strength; class 8.8.")] = "640MPa",
    quality: Annotated[float, typer.Option(help="Mechanical quality factor of the catalogue's ceramics.")] = 80.0,
    source: Annotated[
        str | None,
        typer.Option("--source-resistance", metavar="RESISTANCE", help="To match by two elements, such as 50ohm."),
    ] = None,
    changes: Changes = None,
    out: Out = OUT,
    json: Json = False,
) -> None:
    """Design: actuator, frequency, waveform and masses that give a friction for least power, heat or voltage.

    Example: sonolube optimise examples/rigs/tribometer.toml --target-friction 0.15
    """
    known = read_rig(rig, changes=changes or ())
    content = rig_content(rig, changes=changes or ())
    if share is not None and robust is None:
        raise InvalidInput("--quantile needs --robust, the tolerance")
    if warming_limit is not None and conductance is None:
        raise InvalidInput("--temperature-limit needs --conductance, the heat that the actuator loses per kelvin")
    limits = optimisation.Limits(
        voltage_maximum=option_value(voltage_limit, unit="V", option="--voltage-limit"),
        current_maximum=option_value(current_limit, unit="A", option="--current-limit"),
        slew_rate_maximum=option_value(slew_limit, unit="V/s", option="--slew-limit"),
        nominal_pressure=option_value(pressure_limit, unit="Pa", option="--stress-limit"),
        temperature_rise=None
        if warming_limit is None
        else temperature_difference_to_si(warming_limit, name="--temperature-limit"),
        thermal_conductance=option_value(conductance, unit="W/K", option="--conductance"),
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
    resistance = option_value(source, unit="ohm", option="--source-resistance")
    if resistance is not None:
        require_positive(source_resistance=resistance)
    with progress("optimising") as advance:
        optimum = optimisation.optimise(
            problem,
            minimise=minimise.value,
            second_objective=None if pareto is None or pareto == minimise else pareto.value,
            samples=samples,
            advance=lambda done, total: advance("structures", done, total),
        )
        electric = optimisation.required_electronics(problem, optimum.best, source_resistance=resistance)
    answer = OptimisationAnswer(rig_file=rig, content=content, optimum=optimum, electric=electric)
    deliver(answer, folder=out, as_json=json, context=context)
