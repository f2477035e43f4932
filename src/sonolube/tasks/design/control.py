"""Task `control`: closed-loop control of the friction force of a rig, with its C source and lookup table.

Other tasks that control friction share its arguments: target, controller, and the resonance where the rig has no
structure.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import inf
from typing import Annotated, Any, Literal, Unpack

from sonolube.charts import Part
from sonolube.checks import Floats
from sonolube.design import control as loops
from sonolube.design.control import stick_slip as figures
from sonolube.design.control.control_design import control_dataset
from sonolube.design.control.predicted_loop import predicted_force_parts, predicted_forces, with_posterior
from sonolube.design.control.rejection import rejection_chart
from sonolube.design.control.stick_slip import StickSlipSuppression, stick_slip_suppression
from sonolube.errors import InvalidInput, OutsideRange, SonolubeError
from sonolube.facts.metrics import EfficiencyLine
from sonolube.measurement.run_columns import runs_help
from sonolube.prediction.chances import ReductionChances, odds_text, reduction_chances
from sonolube.prediction.evidence_posterior import EvidencePosterior
from sonolube.prediction.predictive import DRAWS
from sonolube.report import Drawing, Page
from sonolube.report.results.design import control_design as results
from sonolube.report.results.record_object import amplitude_rows, operating_point, rig_settings
from sonolube.rig import AMPLITUDE, VOLTAGE, Rig, commanded_quantity, own_level
from sonolube.tasks.answer import Answer, Block, Dataset, Rows, answer
from sonolube.tasks.own_evidence import Evidence, evidence_of
from sonolube.tasks.own_tables import MappedRuns, runs_of
from sonolube.tasks.parameters import File, Number, Parameter, Quantity, RigFile, RunsSource, WatchedRig, rig_of
from sonolube.tasks.progress import stage
from sonolube.tasks.task import in_si, refuse_unused, shown, task
from sonolube.text.units import format_si, to_si
from sonolube.validation.contacts import efficiency_line

Delay = Annotated[Number, Quantity("Delay of the friction measurement.", "s")]
Rate = Annotated[Number, Quantity("Sampling rate of the controller.", "Hz")]
ClosedLoop = Annotated[Number | None, Quantity("Time constant of the closed loop; the delay by default.", "s")]
VoltageLimit = Annotated[Number | None, Quantity("Largest swing, peak to peak; the rig's own by default.", "V")]
Quality = Annotated[float, Parameter("Quality factor, where the rig has no structure.", lowest=0.6)]
Coupling = Annotated[float, Parameter("Effective coupling, where it has none.", lowest=0.001, highest=0.999)]


def sampling_and_duration(*, rate: Number, duration: Number) -> tuple[float, float]:
    """Sampling rate and duration of the running task in SI, both positive.

    Parameters
    ----------
    rate : float or str
        Of the controller, in Hz or with its unit.
    duration : float or str
        Of the run. [s]

    Returns
    -------
    tuple of two float
    """
    sampling, run_time = in_si("rate", rate), in_si("duration", duration)
    if sampling <= 0 or run_time <= 0:
        raise InvalidInput(f"{shown('rate')} {rate} and {shown('duration')} {duration} must be positive")
    return sampling, run_time


def assumed_resonance(rig: Rig, *, quality: float, coupling: float) -> tuple[loops.VibrationMode, dict[str, str]]:
    """Resonance at the frequency of the drive of a rig without a structure, with what is assumed of it.

    Parameters
    ----------
    rig : Rig
    quality, coupling : float
        Quality factor and effective coupling.

    Returns
    -------
    VibrationMode
    dict of str to str
    """
    text = f"at the drive's frequency, quality factor {quality:g}, coupling {coupling:g}; not measured"
    return loops.assumed_mode(rig, quality_factor=quality, coupling_factor=coupling), {"resonance": text}


def resonance_without_structure(
    rig: Rig, quality: float, coupling: float
) -> tuple[loops.VibrationMode | None, dict[str, str]]:
    """Resonance of a rig without a structure, with what is assumed of it; None of one with a structure.

    Parameters
    ----------
    rig : Rig
    quality, coupling : float
        Quality factor and effective coupling.

    Returns
    -------
    VibrationMode or None
    dict of str to str
    """
    if rig.structure is not None:
        return None, {}
    if commanded_quantity(rig) is AMPLITUDE:
        text = f"the amplitude follows its set point as a resonance of quality factor {quality:g}; not measured"
        return loops.amplitude_mode(rig, quality_factor=quality), {"amplitude control": text}
    return assumed_resonance(rig, quality=quality, coupling=coupling)


def friction_force(name: str, target: str | float, *, normal_load: float) -> float:
    """Friction force of an argument that takes a coefficient or a force.

    Parameters
    ----------
    name : str
        Of the argument.
    target : str or float
        A coefficient such as 0.1, or a text such as "0.1" or "0.3N".
    normal_load : float
        Force pressing the bodies together. [N]

    Returns
    -------
    float
        In N.

    Raises
    ------
    InvalidInput
        If the text is neither a pure number nor a force, or not positive.
    """
    text = str(target)
    is_force = text.strip()[-1:].isalpha()
    value = to_si(text, unit="N" if is_force else "", name=shown(name)) * (1.0 if is_force else normal_load)
    if not value > 0:
        raise InvalidInput(f"{shown(name)} {text} must be positive, a coefficient such as 0.2 or a force such as 0.6N")
    return value


_RUNS = File(
    runs_help("Own measured runs, on which the predicted friction rests beside the published tests. Columns"),
    "RUNS.csv",
    option="--runs --measured",
)


@answer
class ControlAnswer(Answer):
    """A tuned controller with its margins, step response and energy, and stick-slip where it was computed."""

    rig: Rig
    settings: loops.ControlSettings
    study: loops.ControlDesign
    rejection: loops.DisturbanceRejection
    suppression: StickSlipSuppression | None
    assumed: Mapping[str, str]
    posterior: loops.PosteriorLoop | str
    tuned_for: str = "model"

    def blocks(self) -> Sequence[Block]:
        """Operating point, controller, margins, step response and energy."""
        return [operating_point(self.rig), Rows([*amplitude_rows(self.rig), *self._facts()])]

    def object(self) -> dict[str, Any]:
        """Controller, margins, step response, energy, stick-slip; reach and margins by the prediction."""
        found = results.control_object(self.rig, self.settings, self.study, self.rejection, self.suppression)
        found["summary"] = [*results.posterior_summary(self.study, self.posterior), *found["summary"]]
        return found | results.posterior_object(self.posterior, tuned_for=self.tuned_for)

    def caveats(self) -> Sequence[str]:
        """Those of the rig at its own operating point, thin margins, and a resonance that tracking has lost."""
        feed_forward = self.settings.feed_forward
        predicted = results.posterior_caveats(self.posterior, feed_forward=feed_forward, tuned_for=self.tuned_for)
        return [*results.caveats(self.rig, self.study), *predicted]

    def assumptions(self) -> Mapping[str, str]:
        """Assumptions of the rig file, of the resonance and of the holder."""
        assumptions = {**self.rig.assumptions, **self.assumed}
        if self.suppression is not None:
            assumptions["stick-slip"] = results.holder_text()
        return assumptions

    def figures(self) -> Mapping[str, Drawing]:
        """Run in closed loop, design of the loop, a disturbance, and stick-slip where it was computed."""
        study, suppression = self.study, self.suppression
        drawings = {
            self._name: Drawing(
                chart=lambda: figures.closed_loop_chart(study),
                caption=f"Friction of {self.rig.title} in closed loop; every point computed.",
            ),
            f"{self._name}-design": Drawing(
                chart=lambda: figures.control_design_chart(study).with_parts(0, *self._predicted_parts()),
                caption=f"Map from {study.plant.quantity.word} to friction of the controller, and magnitude of the"
                " sensitivity function.",
            ),
        }
        drawings[f"{self._name}-disturbance"] = Drawing(
            chart=lambda: rejection_chart(study, self.rejection),
            caption=f"Friction of {self.rig.title} at its target when the real friction steps; every point computed.",
        )
        if suppression is not None:
            drawings[f"{self._name}-stick-slip"] = Drawing(
                chart=lambda: figures.stick_slip_chart(suppression),
                caption="Force in the holder of the slider as the counterface drags it along.",
            )
        return drawings

    def files(self) -> "Mapping[str, str | Dataset]":
        """Run as netCDF, controller as C source, and its lookup table."""
        from sonolube import __version__

        controller, title = self.study.controller, self.rig.title
        origin = "; ".join([title, *self.rig.changes, f"made by sonolube {__version__}"])
        return {
            f"{self._name}.nc": with_posterior(
                control_dataset(self.study, title=f"Friction control of {title}"), self.study, self.posterior
            ),
            f"{self._name}.c": loops.controller_source(controller, self.study.tracker, title=origin),
            f"{self._name}.csv": loops.lookup_table(controller, predicted=self._predicted_forces()),
        }

    def page(self) -> Page:
        """Page `control.html`."""
        return Page(
            name="control",
            title=f"Friction control of {self.rig.title}",
            settings=rig_settings(self.rig),
            facts=self._facts(),
            tables=[results.lookup_table(self.study, self.posterior)],
        )

    def _facts(self) -> list[tuple[str, str]]:
        """Facts of the design, those of the prediction after the first."""
        first, *rest = results.facts(self.settings, self.study, self.rejection, self.suppression)
        return [first, *results.posterior_facts(self.study, self.posterior, tuned_for=self.tuned_for), *rest]

    def _predicted_parts(self) -> tuple[Part, ...]:
        """Predicted friction over the level, where there is a prediction."""
        return () if isinstance(self.posterior, str) else predicted_force_parts(self.study, self.posterior)

    def _predicted_forces(self) -> Floats | None:
        """Predicted friction force at the points of the lookup table, where there is a prediction."""
        if isinstance(self.posterior, str):
            return None
        return predicted_forces(self.study, self.posterior, level=self.study.controller.level)

    @property
    def _name(self) -> str:
        """Name of the files, without ending."""
        return f"{self.rig.name}-control"


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
        Literal["model", "prediction", "efficiency", "none"],
        Parameter("Map from friction to voltage or amplitude; prediction is by the median of sonolube predict."),
    ] = "model",
    efficiency: Annotated[
        Number | None,
        Quantity("Efficiency at the rig's speed, in m2/N, instead of the published.", "m2/N", kind="COEFFICIENT"),
    ] = None,
    delay: Delay = "1ms",
    rate: Rate = "5kHz",
    noise: Annotated[Number, Quantity("Standard deviation of the sensor.", "N")] = "0N",
    factor: Annotated[float, Parameter("Real friction over that of the model.", lowest=0.01, highest=100)] = 1.0,
    disturbance: Annotated[
        Number, Quantity("Step of the real friction, whose rejection is computed.", "", kind="SHARE")
    ] = "10%",
    closed_loop: ClosedLoop = None,
    amplitude_limit: Annotated[
        Number | None, Quantity("Largest amplitude of a rig without a voltage; the rig's own by default.", "m")
    ] = None,
    voltage_limit: VoltageLimit = None,
    current_limit: Annotated[Number | None, Quantity("Largest current.", "A", kind="CURRENT")] = None,
    slew_limit: Annotated[Number | None, Quantity("Fastest change of voltage.", "V/s", kind="V/s")] = None,
    warming: Annotated[Number, Quantity("Final temperature rise, such as 40K.", "K")] = "0K",
    warming_time: Annotated[
        Number | None, Quantity("Time constant of the warming; a quarter of the run by default.", "s")
    ] = None,
    track: Annotated[bool, Parameter("Follow the resonance by the phase of the impedance.")] = True,
    quality: Quality = 50.0,
    coupling: Coupling = 0.2,
    stick_slip: Annotated[bool, Parameter("Also compute stick-slip of the slider on an elastic holder.")] = False,
    duration: Annotated[Number, Quantity("Duration of the run.", "s")] = "0.2s",
    tuned_for: Annotated[
        Literal["model", "worst"],
        Parameter("Gain at which the loop has its margins: that of the model, or the highest of the predicted 80 %."),
    ] = "model",
    runs: Annotated[RunsSource, _RUNS] = None,
    mapping: MappedRuns = None,
    evidence: Evidence = None,
    **watch: Unpack[WatchedRig],
) -> ControlAnswer:
    """Friction control: a tuned controller, its run in closed loop, its C source and its lookup table.

    Example: sonolube control examples/rigs/tribometer.toml --friction 0.5N --factor 1.15 --warming 40K
    """
    known = rig_of(rig)
    measured = runs_of(runs, mapping, known)
    interval, dead_time, run_time = _times(rate, delay, duration)
    final_rise = in_si("warming", warming)
    friction_step = in_si("disturbance", disturbance)
    if not -0.9 <= friction_step <= 9 or friction_step == 0:
        raise InvalidInput(f"{shown('disturbance')} {disturbance} must lie between -90 and 900 %, and not be zero")
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
        else friction_force("friction", friction, normal_load=known.normal_load),
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
        mode, assumed = resonance_without_structure(known, quality, coupling)
        line = _efficiency_line(in_si("efficiency", efficiency)) if feed_forward == "efficiency" else None
        is_needed = feed_forward == "prediction" or tuned_for == "worst"
        chances = _chances(known, measured, evidence_of(evidence, known), is_needed=is_needed)
        settings, study, posterior = _designed(known, settings, chances, tuned_for, mode=mode, line=line)
        rejection = loops.disturbance_rejection(
            study.loop,
            friction_force=study.friction_force,
            friction_step=friction_step,
            duration=run_time,
            friction_factor=factor,
        )
        suppression = stick_slip_suppression(known, study) if stick_slip else None
    if commanded_quantity(known) is AMPLITUDE and amplitude_limit is None:
        own = format_si(own_level(known), "m")
        assumed["amplitude limit"] = f"the rig's own amplitude, {own}; {shown('amplitude_limit')} gives another"
    return ControlAnswer(
        rig=known,
        settings=settings,
        study=study,
        rejection=rejection,
        suppression=suppression,
        assumed=assumed,
        posterior=posterior,
        tuned_for=tuned_for,
    )


def _chances(
    rig: Rig, runs: "Dataset | None", evidence: EvidencePosterior | None, *, is_needed: bool
) -> ReductionChances | str:
    """Distribution of the friction ratio of a rig; why there is none, which is refused where it is needed."""
    try:
        return reduction_chances(rig, runs=runs, evidence=evidence, draws=DRAWS)
    except SonolubeError as refusal:
        if is_needed or runs is not None:
            raise
        reason = str(refusal).removeprefix(f"{rig.title}: ")
        refuse_unused("evidence", because=f"where nothing is predicted: {reason}")
        return reason


def _designed(
    rig: Rig,
    settings: loops.ControlSettings,
    chances: ReductionChances | str,
    tuned_for: str,
    *,
    mode: loops.VibrationMode | None,
    line: EfficiencyLine | None,
) -> tuple[loops.ControlSettings, loops.ControlDesign, loops.PosteriorLoop | str]:
    """Settings with the time constant that is taken, the design, and the loop over the posterior where there is one."""
    if isinstance(chances, str):
        return settings, loops.design_control(rig, settings, mode=mode, line=line), chances
    study = loops.design_control(rig, settings, mode=mode, line=line, chances=chances)
    usual = settings.closed_loop_time
    found = loops.posterior_loop(rig, study, chances, closed_loop_time=usual)
    if tuned_for == "model":
        return settings, study, found
    if found.cautious is None:
        raise OutsideRange(
            f"{shown('tuned_for')} worst: the target is within reach with {odds_text(found.target_chance)}, so that"
            " no gain is known; ask for more friction"
        )
    slower = replace(settings, closed_loop_time=found.cautious.closed_loop_time)
    study = loops.design_control(rig, slower, mode=mode, line=line, chances=chances)
    return slower, study, loops.posterior_loop(rig, study, chances, closed_loop_time=usual)


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


def _times(rate: Number, delay: Number, duration: Number) -> tuple[float, float, float]:
    """Sampling interval, delay and duration of the run, in s."""
    sampling, run_time = sampling_and_duration(rate=rate, duration=duration)
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
