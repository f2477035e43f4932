"""The command that designs: the least power, heat or voltage for a friction wanted."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from sonolube.cli.operate import Changes, Json, RigPath


class Objective(StrEnum):
    """What can be made least."""

    POWER = "power"
    HEAT = "heat"
    VOLTAGE = "voltage"


def optimise(
    context: typer.Context,
    rig: RigPath,
    friction: Annotated[
        str,
        typer.Option("--target-friction", metavar="FRICTION", help="Coefficient or force, such as 0.1 or 0.3N."),
    ],
    over: Annotated[
        list[str] | None,
        typer.Option(
            metavar="KEY=FIRST:LAST",
            help="A range to choose from: drive.frequency or an entry of structure; or drive.waveform=one,two."
            " May come again; the frequency by a fifth either way where absent.",
        ),
    ] = None,
    actuator: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="own, a name that `sonolube actuators` lists, or catalogue. May come again."),
    ] = None,
    catalogue: Annotated[
        Path | None, typer.Option(metavar="FILE.toml", help="Further actuators, laid out as the house's own.")
    ] = None,
    minimise: Annotated[Objective, typer.Option(help="What to make least.")] = Objective.POWER,
    pareto: Annotated[Objective | None, typer.Option(help="A second objective, for the front between both.")] = None,
    robust: Annotated[
        float | None, typer.Option(help="Relative tolerance of stiffness, masses and gain to stand.", min=0, max=0.3)
    ] = None,
    share: Annotated[
        float | None,
        typer.Option("--quantile", help="Share of built rigs that must do; the worst where absent.", min=0.5, max=1),
    ] = None,
    samples: Annotated[int, typer.Option(help="Structures drawn for each actuator.", min=2, max=4096)] = 16,
    voltage_limit: Annotated[str | None, typer.Option(metavar="VOLTAGE", help="Highest voltage either way.")] = None,
    current_limit: Annotated[str | None, typer.Option(metavar="CURRENT", help="Highest current.")] = None,
    slew_limit: Annotated[str | None, typer.Option(metavar="RATE", help="Fastest change, such as 3V/us.")] = None,
    pressure_limit: Annotated[
        str | None, typer.Option("--stress-limit", metavar="STRESS", help="Highest nominal stress.")
    ] = None,
    temperature_limit: Annotated[str | None, typer.Option(metavar="KELVIN", help="Most warming, such as 40K.")] = None,
    conductance: Annotated[
        str | None, typer.Option(metavar="CONDUCTANCE", help="Heat the actuator loses, such as 0.5W/K.")
    ] = None,
    horn: Annotated[str | None, typer.Option(metavar="MATERIAL", help="Of a half-wave horn at the tip.")] = None,
    horn_limit: Annotated[str | None, typer.Option(metavar="STRESS", help="Amplitude the horn bears.")] = None,
    bolt: Annotated[str | None, typer.Option(metavar="THREAD", help="Preload bolt, such as M6x40mm.")] = None,
    pressed_by: Annotated[str | None, typer.Option("--preload", metavar="FORCE", help="Tension of the bolt.")] = None,
    bolt_strength: Annotated[str, typer.Option(metavar="STRESS", help="Proof strength; class 8.8.")] = "640MPa",
    quality: Annotated[float, typer.Option(help="Mechanical quality factor of the catalogue's ceramics.")] = 80.0,
    source: Annotated[
        str | None,
        typer.Option("--source-resistance", metavar="RESISTANCE", help="To match by two elements, such as 50ohm."),
    ] = None,
    changes: Changes = None,
    out: Annotated[Path, typer.Option(help="Folder for the report optimise.html, figures, data and rig file.")] = Path(
        "out"
    ),
    json: Json = False,
) -> None:
    """Design: actuator, frequency, waveform and masses that give a friction for least power, heat or voltage.

    Example: sonolube optimise examples/rigs/tribometer.toml --target-friction 0.15
    """
    import json as json_module

    from sonolube.checks import require_positive
    from sonolube.cli.design_page import asked_of, settings_of
    from sonolube.cli.optimise_output import optimum_lines, optimum_object, write_optimum
    from sonolube.cli.optimise_task import bolt_of, limits_of, space_of, wanted_ratio
    from sonolube.cli.progress import progress
    from sonolube.design.optimisation import DesignProblem, Tolerance, required_electronics
    from sonolube.design.optimisation import optimise as optimised
    from sonolube.errors import InvalidInput
    from sonolube.rig import read_rig, rig_content
    from sonolube.units import to_si

    known = read_rig(rig, changes=list(changes or ()))
    content = rig_content(rig, changes=list(changes or ()))
    if share is not None and robust is None:
        raise InvalidInput("--quantile needs --robust, the tolerance")
    limits = limits_of(
        voltage_limit, current_limit, slew_limit, pressure_limit, temperature_limit, conductance, horn, horn_limit
    )
    space = space_of(
        known,
        content,
        list(over or ()),
        list(actuator or ()),
        catalogue,
        quality,
        bolt_of(bolt, pressed_by, bolt_strength),
    )
    problem = DesignProblem(
        space=space,
        friction_ratio=wanted_ratio(known, friction),
        limits=limits,
        tolerance=None if robust is None else Tolerance(manufacturing_tolerance=robust, quantile=share),
    )
    resistance = None
    if source is not None:
        resistance = to_si(source, unit="ohm", name="--source-resistance")
        require_positive(source_resistance=resistance)
    with progress("optimising") as advance:
        found = optimised(
            problem,
            minimise=minimise.value,
            second_objective=None if pareto is None or pareto == minimise else pareto.value,
            samples=samples,
            advance=lambda done, total: advance("structures", done, total),
        )
        electric = required_electronics(problem, found.best, source_resistance=resistance)
        asked = [*asked_of(context, title=known.title, source=known.source), *settings_of(known)]
        name = f"{rig.stem}-optimum"
        written = write_optimum(rig, content, found, electric, asked=asked, folder=out, name=name)
    if json:
        typer.echo(json_module.dumps(optimum_object(found, electric, written), indent=2, allow_nan=False))
    else:
        typer.echo("\n".join(optimum_lines(found, electric, written)))
