"""Task `control`: closed-loop control of the friction force of a rig, with its C source and lookup table."""

from math import inf
from typing import Annotated, Any, Literal, Unpack

from sonolube.design import control as loops
from sonolube.design.control.stick_slip import stick_slip_suppression
from sonolube.errors import InvalidInput
from sonolube.facts.metrics import EfficiencyLine
from sonolube.rig import AMPLITUDE, VOLTAGE, Rig, commanded_quantity, own_level
from sonolube.tasks.design import closed_loop as loop
from sonolube.tasks.design.control_answer import ControlAnswer
from sonolube.tasks.parameters import Number, Parameter, Quantity, RigFile, Watched, rig_of
from sonolube.tasks.progress import stage
from sonolube.tasks.task import in_si, refuse_unused, shown, task
from sonolube.text.units import format_si
from sonolube.validation.efficiency import efficiency_line

# arguments without meaning for a commanded amplitude
_OF_VOLTAGE = (
    "efficiency",
    "voltage_limit",
    "current_limit",
    "slew_limit",
    "warming",
    "warming_time",
    "track",
    "coupling",
)


@task
def control(
    rig: RigFile,
    *,
    friction: Annotated[
        str | float | None,
        Parameter(
            "Target, a coefficient or a force, such as 0.2 or 0.6N; half way to the least by default.", "FRICTION"
        ),
    ] = None,
    feed_forward: Annotated[
        Literal["model", "efficiency", "none"], Parameter("Map from friction to voltage or amplitude.")
    ] = "model",
    efficiency: Annotated[
        Number | None,
        Quantity("Efficiency at the rig's speed, in m2/N, instead of the published.", "m2/N", kind="COEFFICIENT"),
    ] = None,
    delay: loop.Delay = "1ms",
    rate: loop.Rate = "5kHz",
    noise: Annotated[Number, Quantity("Standard deviation of the sensor.", "N")] = "0N",
    factor: Annotated[float, Parameter("Real friction over that of the model.", lowest=0.01, highest=100)] = 1.0,
    closed_loop: loop.ClosedLoop = None,
    amplitude_limit: Annotated[
        Number | None, Quantity("Largest amplitude of a rig without a voltage; the rig's own by default.", "m")
    ] = None,
    voltage_limit: loop.VoltageLimit = None,
    current_limit: Annotated[Number | None, Quantity("Largest current.", "A", kind="CURRENT")] = None,
    slew_limit: Annotated[Number | None, Quantity("Fastest change of voltage.", "V/s", kind="V/s")] = None,
    warming: Annotated[Number, Quantity("Final temperature rise, such as 40K.", "K")] = "0K",
    warming_time: Annotated[
        Number | None, Quantity("Time constant of the warming; a quarter of the run by default.", "s")
    ] = None,
    track: Annotated[bool, Parameter("Follow the resonance by the phase of the impedance.")] = True,
    quality: loop.Quality = 50.0,
    coupling: loop.Coupling = 0.2,
    stick_slip: Annotated[bool, Parameter("Also compute stick-slip of the slider on an elastic holder.")] = False,
    duration: Annotated[Number, Quantity("Duration of the run.", "s")] = "0.2s",
    **watch: Unpack[Watched],
) -> ControlAnswer:
    """Friction control: a tuned controller, its run in closed loop, its C source and its lookup table.

    Example: sonolube control examples/rigs/tribometer.toml --friction 0.5N --factor 1.15 --warming 40K
    """
    known = rig_of(rig)
    interval, dead_time, run_time = _times(rate, delay, duration)
    final_rise = in_si("warming", warming)
    if feed_forward != "efficiency":
        because = f"for {shown('feed_forward')} {feed_forward}; it is for efficiency"
        refuse_unused("efficiency", because=because)
    if commanded_quantity(known) is AMPLITUDE:
        refuse_unused(
            *_OF_VOLTAGE, because=f"for an amplitude that is commanded; give {VOLTAGE.key} to command a voltage"
        )
    else:
        refuse_unused("amplitude_limit", because="for a rig whose voltage is commanded")
    if known.structure is not None:
        refuse_unused("quality", "coupling", because="for a rig whose file has the table structure")
    if final_rise == 0:
        refuse_unused("warming_time", because=f"without {shown('warming')}")
    limits = _limits(known, amplitude_limit, voltage_limit, current_limit, slew_limit)
    settings = loops.ControlSettings(
        friction_force=None
        if friction is None
        else loop.friction_force("friction", friction, normal_load=known.normal_load),
        **limits,
        dead_time=dead_time,
        sample_interval=interval,
        closed_loop_time=in_si("closed_loop", closed_loop),
        feed_forward=feed_forward,
        tracking=track,
        duration=run_time,
        disturbance=loops.Disturbance(friction_factor=factor, friction_force_deviation=in_si("noise", noise)),
        drift=loops.ThermalDrift(
            final_temperature_rise=final_rise, warming_time=_value_or(run_time / 4, in_si("warming_time", warming_time))
        ),
    )
    with stage("controlling"):
        mode, assumed = _assumed(known, quality, coupling)
        line = _efficiency_line(in_si("efficiency", efficiency)) if feed_forward == "efficiency" else None
        study = loops.design_control(known, settings, mode=mode, line=line)
        suppression = stick_slip_suppression(known, study) if stick_slip else None
    if commanded_quantity(known) is AMPLITUDE and amplitude_limit is None:
        own = format_si(own_level(known), "m")
        assumed["amplitude limit"] = f"the rig's own amplitude, {own}; {shown('amplitude_limit')} gives another"
    return ControlAnswer(rig=known, settings=settings, study=study, suppression=suppression, assumed=assumed)


def _limits(
    rig: Rig,
    amplitude_limit: Number | None,
    voltage_limit: Number | None,
    current_limit: Number | None,
    slew_limit: Number | None,
) -> dict[str, Any]:
    """Largest amplitude, or limits of the amplifier, as settings of the design."""
    if commanded_quantity(rig) is AMPLITUDE:
        return {"amplitude_maximum": _value_or(own_level(rig), in_si("amplitude_limit", amplitude_limit))}
    amplifier = loops.Amplifier(
        voltage_maximum=_value_or(own_level(rig), in_si("voltage_limit", voltage_limit)),
        current_maximum=_value_or(inf, in_si("current_limit", current_limit)),
        slew_rate_maximum=_value_or(inf, in_si("slew_limit", slew_limit)),
    )
    return {"amplifier": amplifier}


def _assumed(rig: Rig, quality: float, coupling: float) -> tuple[loops.VibrationMode | None, dict[str, str]]:
    """Resonance of a rig without a structure, with what is assumed of it; None of one with a structure."""
    if rig.structure is not None:
        return None, {}
    if commanded_quantity(rig) is AMPLITUDE:
        text = f"the amplitude follows its set point as a resonance of quality factor {quality:g}; not measured"
        return loops.amplitude_mode(rig, quality_factor=quality), {"amplitude control": text}
    return loop.assumed_resonance(rig, quality=quality, coupling=coupling)


def _times(rate: Number, delay: Number, duration: Number) -> tuple[float, float, float]:
    """Sampling interval, delay and duration of the run, in s."""
    sampling, run_time = loop.sampling_and_duration(rate=rate, duration=duration)
    dead_time = in_si("delay", delay)
    if dead_time > run_time:
        raise InvalidInput(f"{shown('delay')} {delay} must not exceed {shown('duration')} {duration}")
    return 1 / sampling, dead_time, run_time


def _value_or(default: float, value: float | None) -> float:
    """Value of an option, or its default where it was not given."""
    return default if value is None else value


def _efficiency_line(coefficient: float | None) -> EfficiencyLine:
    """Efficiency coefficient given, at every speed, or the line of D 4.2."""
    if coefficient is None:
        return efficiency_line()
    return EfficiencyLine(slope=0.0, intercept=coefficient)
