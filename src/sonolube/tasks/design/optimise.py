"""Task `optimise`: actuator, frequency, waveform and masses for a friction at least power, heat or voltage."""

from collections.abc import Sequence
from typing import Annotated, Literal, Unpack

from sonolube.checks import require_positive
from sonolube.design import optimisation
from sonolube.errors import InvalidInput
from sonolube.models.actuator import read_catalogue
from sonolube.tasks.design import design_choices as choices
from sonolube.tasks.design.optimisation_answer import OptimisationAnswer
from sonolube.tasks.files import InputFile, file_path
from sonolube.tasks.parameters import File, KeyValues, Number, Parameter, Quantity, RestingRig, Watched, rig_of
from sonolube.tasks.progress import stage
from sonolube.tasks.ranges import Values, refuse_replaced
from sonolube.tasks.task import in_si, refuse_unused, shown, task

Objective = Literal["power", "heat", "voltage"]

_OVER = KeyValues(
    "A range to choose from: drive.frequency or an entry of structure; or drive.waveform=one,two."
    " May come again; the frequency by a fifth either way by default.",
    "KEY=FIRST:LAST",
)
_ACTUATOR = Parameter("own, a name that sonolube actuators lists, or catalogue. May come again.", "NAME")
_CATALOGUE = File("Further actuators, in the format of the built-in list.", "FILE.toml")


@task
def optimise(
    rig: RestingRig,
    *,
    target_friction: Annotated[str | float, Parameter("Coefficient or force, such as 0.1 or 0.3N.", "FRICTION")],
    over: Annotated[Values | None, _OVER] = None,
    actuator: Annotated[Sequence[str], _ACTUATOR] = (),
    catalogue: Annotated[InputFile | None, _CATALOGUE] = None,
    minimise: Annotated[Objective, Parameter("Quantity to minimise.")] = "power",
    pareto: Annotated[Objective | None, Parameter("A second objective, for the front between both.")] = None,
    robust: Annotated[
        float | None, Parameter("Relative tolerance of stiffness, masses and gain.", lowest=0, highest=0.3)
    ] = None,
    quantile: Annotated[
        float | None,
        Parameter("Fraction of built rigs that must reach it; the worst by default.", lowest=0.5, highest=1),
    ] = None,
    samples: Annotated[int, Parameter("Structures drawn for each actuator.", lowest=2, highest=4096)] = 16,
    voltage_limit: Annotated[Number | None, Quantity("Highest voltage either way.", "V")] = None,
    current_limit: Annotated[Number | None, Quantity("Highest current.", "A", kind="CURRENT")] = None,
    slew_limit: Annotated[Number | None, Quantity("Fastest change, such as 3V/us.", "V/s", kind="RATE")] = None,
    stress_limit: Annotated[Number | None, Quantity("Highest nominal stress.", "Pa", kind="STRESS")] = None,
    temperature_limit: Annotated[Number | None, Quantity("Highest temperature rise, such as 40K.", "K")] = None,
    conductance: Annotated[
        Number | None, Quantity("Thermal conductance of the actuator, such as 0.5W/K.", "W/K", kind="CONDUCTANCE")
    ] = None,
    horn: Annotated[str | None, Parameter("Of a half-wave horn at the tip.", "MATERIAL")] = None,
    horn_limit: Annotated[Number | None, Quantity("Stress amplitude allowed in it.", "Pa", kind="STRESS")] = None,
    bolt: Annotated[str | None, Parameter("Preload bolt, such as M6x40mm.", "THREAD")] = None,
    preload: Annotated[Number | None, Quantity("Tension of the bolt.", "N")] = None,
    bolt_strength: Annotated[Number, Quantity("Proof strength; class 8.8.", "Pa", kind="STRESS")] = "640MPa",
    quality: Annotated[float, Parameter("Mechanical quality factor of the catalogue's ceramics.")] = 80.0,
    source_resistance: Annotated[
        Number | None, Quantity("To match by two elements, such as 50ohm.", "ohm", kind="RESISTANCE")
    ] = None,
    **watch: Unpack[Watched],
) -> OptimisationAnswer:
    """Design: actuator, frequency, waveform and masses that give a friction for least power, heat or voltage.

    Example: sonolube optimise examples/rigs/tribometer.toml --target-friction 0.15
    """
    known = rig_of(rig)
    ranges = over or {}
    refuse_replaced(known, ranges)
    _refuse_unused(actuator, catalogue, bolt=bolt, same_objective=pareto == minimise)
    if not any(key.startswith("structure.") for key in ranges):
        because = f"unless {shown('over')} gives an entry of structure, whose values are drawn"
        refuse_unused("samples", because=because)
    if quantile is not None and robust is None:
        raise InvalidInput(f"{shown('quantile')} needs {shown('robust')}, the tolerance")
    if temperature_limit is not None and conductance is None:
        needed = f"{shown('conductance')}, the heat that the actuator loses per kelvin"
        raise InvalidInput(f"{shown('temperature_limit')} needs {needed}")
    space = choices.design_space(
        known,
        over=ranges,
        actuators=actuator,
        catalogue=catalogue,
        mechanical_quality_factor=quality,
        bolt=choices.bolt_of_thread(bolt, in_si("preload", preload), in_si("bolt_strength", bolt_strength)),
    )
    limits = optimisation.Limits(
        voltage_maximum=in_si("voltage_limit", voltage_limit),
        current_maximum=in_si("current_limit", current_limit),
        slew_rate_maximum=in_si("slew_limit", slew_limit),
        nominal_pressure=in_si("stress_limit", stress_limit),
        temperature_rise=in_si("temperature_limit", temperature_limit),
        thermal_conductance=in_si("conductance", conductance),
        horn=choices.half_wave_horn(horn, in_si("horn_limit", horn_limit)),
    )
    problem = optimisation.DesignProblem(
        space=space,
        friction_ratio=choices.target_ratio(known, target_friction),
        limits=limits,
        tolerance=None if robust is None else optimisation.Tolerance(manufacturing_tolerance=robust, quantile=quantile),
    )
    source = in_si("source_resistance", source_resistance)
    if source is not None:
        require_positive(source_resistance=source)
    with stage("optimising") as advance:
        optimum = optimisation.optimise(
            problem,
            minimise=minimise,
            second_objective=pareto,
            samples=samples,
            advance=lambda done, total: advance("structures", done, total),
        )
        electric = optimisation.required_electronics(problem, optimum.best, source_resistance=source)
    return OptimisationAnswer(rig=known, optimum=optimum, electric=electric)


def _refuse_unused(
    actuators: Sequence[str], catalogue: InputFile | None, *, bolt: str | None, same_objective: bool
) -> None:
    """Refuse arguments for actuators, bolts and a second objective that the others leave without effect."""
    further = {"catalogue", *(() if catalogue is None else read_catalogue(file_path(catalogue)))}
    if not further & set(actuators):
        names = f"unless {shown('actuator')} names one of its actuators, or is catalogue"
        refuse_unused("catalogue", because=names)
    if set(actuators) <= {optimisation.OWN_ACTUATOR}:
        refuse_unused("quality", because="for the rig's own actuator; it is for those of the catalogue")
    if bolt is None:
        refuse_unused("bolt_strength", because=f"without {shown('bolt')}")
    if same_objective:
        refuse_unused("pareto", because="for the quantity that is minimised; name another")
