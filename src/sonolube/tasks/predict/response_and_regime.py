"""Tasks `response`, `transient` and `regime`: linear response, start-up from rest, and lubrication regime of a rig."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal, TypeAlias, Unpack

from sonolube import rig as rigs
from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.facts.materials import material
from sonolube.models.dynamics import modes
from sonolube.models.friction import BoundaryLubricant, FilmLubricant
from sonolube.models.wear import WearMechanismAssessment
from sonolube.report import Drawing
from sonolube.report.results import rig_point as results
from sonolube.rig.datasets import LabelledArrays, labels
from sonolube.rig.figures import lubrication_chart, response_chart, start_up_chart
from sonolube.rig.resolved_rig import resolved_rig
from sonolube.rig.responses import response_arrays, start_up_arrays
from sonolube.tasks.answer import Answer, Block, Dataset, Rows, Table, answer, si
from sonolube.tasks.parameters import (
    Number,
    Parameter,
    Quantity,
    RestingRig,
    RestingRigEntries,
    RigEntries,
    RigFile,
    WatchedRig,
    rig_of,
)
from sonolube.tasks.predict.response_curve import ResponseCurveAnswer, followed_curve, rising_range
from sonolube.tasks.progress import stage
from sonolube.tasks.task import in_si, plausible, refuse_unused, shown, task
from sonolube.text.units import format_si


@task
def response(
    rig: RestingRig,
    *,
    lowest: Annotated[Number | None, Quantity("Lowest frequency.", "Hz", option="--from")] = None,
    highest: Annotated[Number | None, Quantity("Highest frequency.", "Hz", option="--to")] = None,
    curve: Annotated[
        Literal["frequency", "voltage"] | None,
        Parameter("Steady vibration of the whole contact along this, through folds, in place of small motions."),
    ] = None,
    lowest_voltage: Annotated[
        Number | None, Quantity("Lowest voltage peak to peak of --curve voltage.", "V", option="--from-voltage")
    ] = None,
    highest_voltage: Annotated[
        Number | None, Quantity("Highest voltage peak to peak of --curve voltage.", "V", option="--to-voltage")
    ] = None,
    **entries: Unpack[RestingRigEntries],
) -> "ResponseAnswer | ResponseCurveAnswer":
    """Linear response over frequency: tip amplitude per volt and electrical impedance; or the steady vibration.

    Frequencies are from 1 kHz to 100 kHz where none is given, along a curve a sixth about the drive's; voltages along
    a curve are to twice the drive's.

    Example: sonolube response examples/rigs/tribometer.toml --from 15kHz --to 35kHz

    Examples
    --------
    >>> import sonolube as sl
    >>> from sonolube.text.units import format_si
    >>> answer = sl.response("examples/rigs/tribometer.toml", lowest="15kHz", highest="35kHz")
    >>> format_si(float(answer["amplitude_per_volt"].idxmax()), "Hz")  # the resonance
    '22 kHz'
    """
    known = rig_of(rig)
    resolved = resolved_rig(known)
    voltages = {"lowest_voltage": lowest_voltage, "highest_voltage": highest_voltage}
    if curve is not None:
        return followed_curve(resolved, along=curve, lowest=lowest, highest=highest, **voltages)
    refuse_unused(*voltages, because="without --curve voltage")
    low, high = rising_range("lowest", lowest, "highest", highest, usual=("1kHz", "100kHz"))
    result = rigs.frequency_response(resolved, frequency=rigs.frequency_grid(resolved, lowest=low, highest=high))
    natural = modes(rigs.structure_in_contact(resolved))
    return ResponseAnswer(rig=known, result=result, natural_frequency=natural.natural_frequency[~natural.rigid])


@answer
class ResponseAnswer(Answer):
    """Linear response of a rig: natural frequencies and the largest amplitude per volt."""

    rig: rigs.Rig
    result: rigs.FrequencyResponse
    natural_frequency: Floats

    def blocks(self) -> Sequence[Block]:
        """Natural frequencies and the largest amplitude per volt."""
        frequency, amplitude = self._largest()
        found = ", ".join(format_si(f, "Hz", digits=4) for f in self.natural_frequency.tolist()) or "none"
        at = format_si(frequency, "Hz", digits=4)
        largest = f"{format_si(amplitude, 'm')} per volt peak to peak at {at}"
        return [
            f"{self.rig.title}, {format_si(self.rig.normal_load, 'N')}, small motions",
            Rows([("natural frequencies", found), ("largest amplitude", largest)]),
        ]

    def object(self) -> dict[str, Any]:
        """Natural frequencies, and frequency and value of the largest amplitude per volt."""
        frequency, amplitude = self._largest()
        return {
            "rig": self.rig.title,
            "resonances": [{"value": f, "unit": "Hz"} for f in self.natural_frequency.tolist()],
            **si({"frequency": frequency, "amplitude_per_volt": amplitude}),
        }

    def figures(self) -> Mapping[str, Drawing]:
        """Response over frequency."""
        return {f"{self.rig.name}-response": Drawing(chart=lambda: response_chart(self.rig, self.result))}

    def files(self) -> Mapping[str, LabelledArrays]:
        """Response over frequency as netCDF."""
        return {f"{self.rig.name}-response.nc": response_arrays(self.rig, self.result)}

    def _largest(self) -> tuple[float, float]:
        """Frequency and value of the largest amplitude per volt."""
        best = int(self.result.amplitude_per_volt.argmax())
        return float(self.result.frequency[best]), float(self.result.amplitude_per_volt[best])


_QUANTITIES = ("settling_time", "vibration_amplitude", "mean_displacement", "beat_frequency")


@task
def transient(
    rig: RigFile,
    *,
    duration: Annotated[Number, Quantity("Time that is integrated.", "s")] = "0.1s",
    **watch: Unpack[WatchedRig],
) -> "StartUpAnswer":
    """Start-up from rest: settling of the tip's vibration, step by step.

    Example: sonolube transient examples/rigs/tribometer.toml --duration 0.06s

    Examples
    --------
    >>> import sonolube as sl
    >>> from sonolube.text.units import format_si
    >>> answer = sl.transient("examples/rigs/tribometer.toml", duration="20ms")
    >>> format_si(answer.object()["settling_time"]["value"], "s", digits=2)
    '1.2 ms'
    """
    known = rig_of(rig)
    with stage("marching"):
        resolved = resolved_rig(known)
        result = rigs.start_up(resolved, duration=in_si("duration", duration))
    return StartUpAnswer(rig=known, vibration=resolved.vibration, result=result)


@answer
class StartUpAnswer(Answer):
    """Start-up of a rig: settling time, final amplitude and slow oscillation."""

    rig: rigs.Rig
    vibration: rigs.ResolvedVibration
    result: rigs.StartUp

    def blocks(self) -> Sequence[Block]:
        """Settling time, amplitude, mean displacement, slow oscillation and status."""
        found = self.result
        rows = [
            ("amplitude settles", f"within 2 % after {format_si(found.settling_time, 's')}"),
            ("amplitude", f"{format_si(found.vibration_amplitude, 'm')}: {self.vibration.text}"),
            ("mean displacement", format_si(found.mean_displacement, "m")),
            ("slow oscillation", format_si(found.beat_frequency, "Hz")),
            ("status", found.status + (f": {found.reason}" if found.reason else "")),
        ]
        return [f"{self.rig.title}, {format_si(self.rig.normal_load, 'N')}, from rest", Rows(rows)]

    def object(self) -> dict[str, Any]:
        """Status, settling time, amplitude, mean displacement and frequency of the slow oscillation."""
        return {
            "rig": self.rig.title,
            "amplitude_source": self.vibration.source,
            "status": self.result.status,
            "reason": self.result.reason,
            **si({name: getattr(self.result, name) for name in _QUANTITIES}),
        }

    def figures(self) -> Mapping[str, Drawing]:
        """Displacement of the tip over time."""
        return {f"{self.rig.name}-transient": Drawing(chart=lambda: start_up_chart(self.rig, self.result))}

    def files(self) -> Mapping[str, LabelledArrays]:
        """Trajectory as netCDF."""
        return {f"{self.rig.name}-transient.nc": start_up_arrays(self.rig, self.result)}


_FILM = Quantity("Coefficient of friction of the lubricant film, where it is known.", "", kind="NUMBER")
_PRESSURE = Quantity("Pressure at which asperities carry all the load, with it.", "Pa")
_VISCOSITY = Quantity(
    "Dynamic viscosity of the lubricant, such as '0.1 Pa s', by which film and asperities share the load.",
    "Pa s",
    kind="VISCOSITY",
)
_BALL = Quantity("Radius of the pin's ball, whose film is elastohydrodynamic; without it a flat, inclined pad.", "m")
_INLET = Quantity(
    "Gap at the inlet of a flat pad over that at its outlet; by default the best, 2.2.", "inlet_ratio", kind="RATIO"
)
_BARUS = Quantity(
    "Growth of the viscosity with pressure, for a ball; by default that of mineral oils, 2e-8 /Pa.",
    "1/Pa",
    kind="COEFFICIENT",
)
_GAIN = Quantity("Least reduction of a lubricant's friction that is worth the power of vibration.", "", kind="SHARE")


@task
def regime(
    rig: RigFile,
    *,
    film_coefficient: Annotated[Number | None, _FILM] = None,
    asperity_pressure: Annotated[Number | None, _PRESSURE] = None,
    viscosity: Annotated[Number | None, _VISCOSITY] = None,
    tip_radius: Annotated[Number | None, _BALL] = None,
    inlet_ratio: Annotated[Number | None, _INLET] = None,
    pressure_viscosity: Annotated[Number | None, _BARUS] = None,
    smallest_gain: Annotated[Number, _GAIN] = "0",
    pin: Annotated[str | None, Parameter("Material of the pin, for its wear.", "MATERIAL")] = None,
    disc: Annotated[str | None, Parameter("Material of the disc, for its wear.", "MATERIAL")] = None,
    **entries: Unpack[RigEntries],
) -> "RegimeAnswer":
    """Lubrication regime: dry, vibrated, lubricated or both, and the kind of wear to expect.

    Example: sonolube regime examples/rigs/tribometer.toml --film-coefficient 0.25 --asperity-pressure 10MPa

    Examples
    --------
    >>> import sonolube as sl
    >>> answer = sl.regime("examples/rigs/tribometer.toml", film_coefficient=0.25, asperity_pressure="10MPa")
    >>> coefficient = answer["friction_coefficient"]
    >>> str(coefficient.idxmin().item()), round(float(coefficient.min()), 2)
    ('ultrasonic', 0.12)
    """
    if (pin is None) != (disc is None):
        raise InvalidInput(f"{shown('pin')} and {shown('disc')} belong together: give both or neither")
    known = rig_of(rig)
    stated = {"film_coefficient": film_coefficient, "asperity_pressure": asperity_pressure}
    viscous = {
        "dynamic_viscosity": ("viscosity", viscosity),
        "tip_radius": ("tip_radius", tip_radius),
        "inlet_ratio": ("inlet_ratio", inlet_ratio),
        "pressure_viscosity": ("pressure_viscosity", pressure_viscosity),
    }
    lubricant = _stated_lubricant(stated, viscous) if viscosity is None else _viscous_lubricant(stated, viscous)
    gain = in_si("smallest_gain", smallest_gain)
    return RegimeAnswer(
        rig=known,
        result=rigs.lubrication_point(known, lubricant=lubricant, smallest_gain=gain),
        wear=rigs.wear_of_materials(material(pin), material(disc)) if pin is not None and disc is not None else None,
        surroundings=rigs.lubrication_map(known, lubricant=lubricant, smallest_gain=gain),
    )


_Viscous: TypeAlias = "Mapping[str, tuple[str, Number | None]]"  # argument and value, by the name of the lubricant's


def _stated_lubricant(stated: "Mapping[str, Number | None]", viscous: _Viscous) -> BoundaryLubricant:
    """Lubricant whose film is stated."""
    film, pressure = stated.values()
    if film is None or pressure is None:
        raise InvalidInput(f"give {shown('viscosity')}, or both {' and '.join(map(shown, stated))}")
    _refuse_needless(viscous, tuple(viscous), f"belongs to {shown('viscosity')}: leave it out, or give that")
    return BoundaryLubricant(
        film_coefficient=plausible("film_coefficient", film),
        full_asperity_pressure=plausible("asperity_pressure", pressure),
    )


def _viscous_lubricant(stated: "Mapping[str, Number | None]", viscous: _Viscous) -> FilmLubricant:
    """Lubricant whose film follows from its viscosity."""
    if any(value is not None for value in stated.values()):
        raise InvalidInput(f"{shown('viscosity')} gives the film: leave out {' and '.join(map(shown, stated))}")
    if viscous["tip_radius"][1] is None:
        _refuse_needless(viscous, ("pressure_viscosity",), f"is of a ball: leave it out, or give {shown('tip_radius')}")
    else:
        _refuse_needless(viscous, ("inlet_ratio",), f"is of a flat pad: leave out it or {shown('tip_radius')}")
    return FilmLubricant(
        **{name: plausible(argument, value) for name, (argument, value) in viscous.items() if value is not None}
    )


def _refuse_needless(viscous: _Viscous, names: Sequence[str], why: str) -> None:
    """Refuse an argument that nothing takes."""
    for name in names:
        argument, value = viscous[name]
        if value is not None:
            raise InvalidInput(f"{shown(argument)} {why}", key=argument)


@answer
class RegimeAnswer(Answer):
    """Coefficients of friction of a rig dry, vibrated, lubricated and both, the best of them, and its wear."""

    rig: rigs.Rig
    result: rigs.LubricationPoint
    wear: WearMechanismAssessment | None
    surroundings: rigs.LubricationMap

    def blocks(self) -> Sequence[Block]:
        """Coefficient of friction of each method, the best marked, and the kind of wear."""
        result = self.result
        return [
            f"{self.rig.title}, {format_si(result.nominal_pressure, 'Pa')}, {format_si(result.sliding_speed, 'm/s')}",
            Table(["method", "coefficient of friction", ""], results.method_rows(result)),
            Rows(results.regime_rows(result, self.wear)),
        ]

    def object(self) -> dict[str, Any]:
        """Coefficients of friction by method, the best of them, and the kind of wear."""
        return {"rig": self.rig.title, **results.regime_object(self.result, self.wear)}

    def caveats(self) -> Sequence[str]:
        """Caveats of the regime."""
        return self.result.caveats

    def figures(self) -> Mapping[str, Drawing]:
        """Map of the best method about the rig's speed and pressure."""
        chart = lambda: lubrication_chart(self.rig, self.result, self.surroundings)  # noqa: E731
        return {f"{self.rig.name}-regime": Drawing(chart=chart)}

    def dataset(self) -> Dataset:
        """Coefficients of friction over `lubrication`, and the operating point."""
        methods = self.result.coefficients._asdict()
        found = super().dataset().assign_coords(lubrication=list(methods))
        coefficients = [float(value) for value in methods.values()]
        return found.assign(friction_coefficient=("lubrication", coefficients, labels("friction_coefficient")))
