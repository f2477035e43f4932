"""Tasks whose result is one record of a rig: `contact`, `friction`, `wear`, `simulate` and `thermal`.

Their answer shows every field of the record that is a quantity, with its unit.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import field
from typing import Annotated, Any, Unpack

from sonolube import rig as rigs
from sonolube.errors import InvalidInput
from sonolube.models.contact.tangential_stiffness import DEFAULT_TANGENTIAL_STIFFNESS, TANGENTIAL_STIFFNESSES
from sonolube.models.friction import FRICTION_MODELS, FrictionModel
from sonolube.models.thermal.flash import FLASH_MODELS
from sonolube.prediction.applicability import applicability, crushing_load
from sonolube.prediction.bodies import softer_hardness
from sonolube.prediction.evidence import large_amplitude_caveats
from sonolube.prediction.rig_statement import WEAR_OF_LUBRICATED
from sonolube.prediction.verdict import PointVerdict, Verdict, point_verdict, verdict_of_rig
from sonolube.report import Drawing
from sonolube.report.results.rig_point import (
    beyond_the_model,
    measured_object,
    measured_on,
    measured_text,
    wear_error_object,
    wear_error_rows,
    worn_object,
    worn_on,
    worn_text,
)
from sonolube.rig import Rig, contact_point, friction_point, temperature_point, thermal_solid, wear_point
from sonolube.rig.datasets import LabelledArrays, result_quantities, result_texts
from sonolube.rig.figures import simulation_chart, temperature_chart
from sonolube.rig.power import PowerToSupply, with_former_key
from sonolube.rig.resolved_rig import resolved_rig
from sonolube.rig.responses import simulation_arrays
from sonolube.rig.simulation import friction_model_named, mechanism_text
from sonolube.tasks.answer import Answer, Block, Dataset, Rows, answer, si
from sonolube.tasks.own_evidence import Evidence, evidence_of
from sonolube.tasks.parameters import (
    Interval,
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
from sonolube.tasks.progress import stage
from sonolube.tasks.task import in_si, plausible, refuse_unused, shown, task
from sonolube.text.units import format_quantity, format_si
from sonolube.validation.published_tests import FrictionTest
from sonolube.vocabulary import quantities

_UNPRINTED = ("status", "amplitude_source")  # the amplitude's origin names the source
_MIN_FORCE = 1e-6  # of the load, below which a friction force means nothing
_LABELS = {"amplitude_origin": "amplitude", "energy_balance": "energy"}


@answer
class RigRecord(Answer):
    """Record of results of a rig: quantities by the vocabulary, other text as it is.

    Parameters
    ----------
    rig : Rig
    result : dataclass
        Its fields named in the vocabulary, and those of records within it, are the quantities; None is left out, NaN
        stands for a value outside the range of a model, null in JSON.
    measured : sequence of FrictionTest
        What was measured on the rig under the same conditions.
    verdict : PointVerdict or None
        On the operating point, the first line; None where it has no vibration to judge.
    headline : sequence of tuple of str
        Names and texts before the quantities.
    leading : sequence of str
        Caveats that stand above the result.
    further_caveats : sequence of str
        Caveats after those of the record.
    at_least : collection of str
        Quantities of which a lower bound is known.
    rows : sequence of tuple of str
        Further names and texts.
    entries : mapping of str to object
        Further entries for JSON.
    drawings : mapping of str to Drawing
    datasets : mapping of str to xarray.Dataset or LabelledArrays
    """

    rig: Rig
    result: Any
    measured: Sequence[FrictionTest] = ()
    verdict: PointVerdict | None = None
    headline: Sequence[tuple[str, str]] = ()
    leading: Sequence[str] = ()
    further_caveats: Sequence[str] = ()
    at_least: Collection[str] = ()
    rows: Sequence[tuple[str, str]] = ()
    entries: Mapping[str, Any] = field(default_factory=dict)
    drawings: Mapping[str, Drawing] = field(default_factory=dict)
    datasets: "Mapping[str, Dataset | LabelledArrays]" = field(default_factory=dict)

    def blocks(self) -> Sequence[Block]:
        """Load, quantities with the meaning and unit of the vocabulary, and text but for the status."""
        return [self._title(), Rows([*self._leading_rows(), *self._record_rows(), *self.rows])]

    def first_blocks(self) -> Sequence[Block]:
        """The same with what the numbers leave out before them."""
        return [self._title(), Rows([*self._leading_rows(), *self.rows, *self._record_rows()])]

    def _title(self) -> str:
        """Rig with its load."""
        return f"{self.rig.title}, {format_si(self.rig.normal_load, 'N')}"

    def _leading_rows(self) -> list[tuple[str, str]]:
        """Verdict and headline."""
        if self.verdict is None:
            return list(self.headline)
        is_told = self.verdict.verdict == Verdict.OUTSIDE_MODEL_RANGE  # by the reason of the record
        return [("this point is", self.verdict.words if is_told else self.verdict.text), *self.headline]

    def _record_rows(self) -> list[tuple[str, str]]:
        """Quantities and texts of the record, and what was measured."""
        known, values = quantities(), result_quantities(self.result)
        rows = [
            (known[name].meaning, self._text(name, value))
            for name, value in values.items()
            if not name.startswith("raw_")  # for JSON, as is what it is
        ]
        rows += [
            (_LABELS.get(name, name.replace("_", " ")), text)
            for name, text in result_texts(self.result).items()
            if name not in _UNPRINTED
        ]
        return rows + [(f"measured {one.label}", measured_text(one)) for one in self.measured]

    def object(self) -> dict[str, Any]:
        """Title of the rig, text and quantities."""
        content = {
            "rig": self.rig.title,
            **result_texts(self.result),
            **si(with_former_key(result_quantities(self.result))),
        }
        content |= {"at_least": list(self.at_least)} if self.at_least else {}
        content |= self.entries
        if self.verdict is not None:
            content |= self.verdict.object()
        return content | {"measured": [measured_object(one) for one in self.measured]} if self.measured else content

    def caveats(self) -> Sequence[str]:
        """Caveats of the record."""
        return (*self.result.caveats, *self.further_caveats)

    def leading_caveats(self) -> Sequence[str]:
        """Caveats that question the whole record."""
        return self.leading

    def figures(self) -> Mapping[str, Drawing]:
        """Figures of the record."""
        return self.drawings

    def files(self) -> "Mapping[str, Dataset | LabelledArrays]":
        """Datasets of the record."""
        return self.datasets

    def _text(self, name: str, value: float | None) -> str:
        """Quantity as text; a force that is nothing beside the load is said to be so."""
        least, unit = _MIN_FORCE * self.rig.normal_load, quantities()[name].unit
        if unit == "N" and value is not None and 0 < abs(value) < least:
            return f"below {format_si(least, unit)}"
        text = "none" if value is None else format_quantity(value, name)
        return f"at least {text}" if name in self.at_least else text


_STIFFNESS = Parameter(f"Model of the tangential stiffness: {', '.join(TANGENTIAL_STIFFNESSES)}.", "MODEL")


@task
def contact(
    rig: RestingRig,
    *,
    tangential_stiffness: Annotated[str, _STIFFNESS] = DEFAULT_TANGENTIAL_STIFFNESS,
    **entries: Unpack[RestingRigEntries],
) -> RigRecord:
    """Contact of the rig at rest: separation, real area, stiffness.

    Example: sonolube contact examples/rigs/poisson_al_steel.toml --load 40N

    Examples
    --------
    >>> import sonolube as sl
    >>> from sonolube.text.units import format_si
    >>> answer = sl.contact("examples/rigs/tribometer.toml")
    >>> format_si(float(answer["normal_stiffness"]), "N/m")  # 3 N over a decay length of 2 um
    '1.5 MN/m'
    """
    known = rig_of(rig)
    return RigRecord(rig=known, result=contact_point(known, tangential_stiffness_model=tangential_stiffness))


def _described_model(model: type[FrictionModel]) -> str:
    """Name, parameters with their units, and source of a friction model."""
    parameters = ", ".join(f"{each.name} in {each.unit}" if each.unit else each.name for each in model.parameters())
    return f"{model.name} ({parameters or 'no parameters'}; {model.citation})"


_FRICTION_MODEL = Parameter(
    "Friction model instead of the rig's own (D is the dissertation):"
    f" {'; '.join(map(_described_model, FRICTION_MODELS.values()))}.",
    "NAME",
)


def _lower_bounds(power: PowerToSupply | None) -> Sequence[str]:
    """Names of the quantities of a power of which a lower bound is known."""
    return ("power_to_supply",) if power is not None and power.is_at_least else ()


@task
def friction(
    rig: RigFile,
    *,
    model: Annotated[str | None, _FRICTION_MODEL] = None,
    interval: Interval = True,
    evidence: Evidence = None,
    **entries: Unpack[RigEntries],
) -> RigRecord:
    """Friction of the rig with and without vibration.

    Example: sonolube friction examples/rigs/collar.toml --set drive.voltage_peak_to_peak=14V

    Examples
    --------
    >>> import sonolube as sl
    >>> answer = sl.friction("examples/rigs/tribometer.toml")
    >>> round(float(answer["friction_ratio"]), 2)
    0.35
    >>> round(float(answer["friction_force"]), 2)  # in N
    0.36
    """
    known = rig_of(rig)
    resolved = resolved_rig(known)
    result = friction_point(resolved, model=model)
    by = known.friction_model if model is None else friction_model_named(known, model)
    if not interval:
        refuse_unused("evidence", because=f"without {shown('interval')}, which rests on it")
    beyond = beyond_the_model(
        resolved, by, interval=interval, evidence=evidence_of(evidence, known) if interval else None
    )
    mechanism = mechanism_text(resolved.with_friction_model(by)) if result.reason is None else ""
    return RigRecord(
        rig=known,
        result=result,
        measured=measured_on(known, vibration_amplitude=result.vibration_amplitude),
        at_least=_lower_bounds(result.power),
        verdict=point_verdict(resolved, friction=result),
        leading=large_amplitude_caveats(resolved, vibration_amplitude=result.vibration_amplitude),
        headline=beyond.predicted(),
        rows=[*([("mechanism", mechanism)] if mechanism else []), *beyond.left_out()],
        further_caveats=beyond.caveats(),
        entries=({"mechanism": mechanism} if mechanism else {}) | beyond.object(),
    )


def _load_caveats(rig: Rig) -> tuple[str, ...]:
    """Caveat of a load that the softer body cannot bear."""
    found = crushing_load(rig)
    return () if found is None else (found,)


def _lubricated_wear(rig: Rig) -> tuple[str, ...]:
    """Caveat of the wear of a contact that counts as lubricated by its friction."""
    return (
        (WEAR_OF_LUBRICATED[:1].lower() + WEAR_OF_LUBRICATED[1:].rstrip("."),) if applicability(rig).any_ratio else ()
    )


@task
def wear(rig: RigFile, **entries: Unpack[RigEntries]) -> RigRecord:
    """Wear of the rig's softer body with and without vibration.

    Example: sonolube wear examples/rigs/tribometer.toml

    Examples
    --------
    >>> import sonolube as sl
    >>> answer = sl.wear("examples/rigs/tribometer.toml")
    >>> round(float(answer["wear_reduction"]), 2)
    0.47
    """
    from sonolube.validation.published_wear_tests import wear_model_errors

    known = rig_of(rig)
    resolved = resolved_rig(known)
    result = wear_point(resolved)
    worn = worn_on(known, vibration_amplitude=result.vibration_amplitude)
    rows = [(f"measured {test.label}", worn_text(test)) for test in worn]
    measured: dict[str, Any] = {"measured": [worn_object(test) for test in worn]} if worn else {}
    if result.reason is None:
        errors = wear_model_errors(result.wear_model)
        rows += wear_error_rows(errors)
        measured |= wear_error_object(errors)
    return RigRecord(
        rig=known,
        result=result,
        rows=rows,
        entries=measured,
        verdict=verdict_of_rig(resolved),
        leading=(*_load_caveats(known), *_lubricated_wear(known)),
    )


@task
def simulate(rig: RigFile, **watch: Unpack[WatchedRig]) -> RigRecord:
    """Multi-scale model: drive, structure and contact in one steady vibration, and the friction and wear under it.

    Example: sonolube simulate examples/rigs/tribometer.toml --set drive.voltage_peak_to_peak=25.9V

    Examples
    --------
    >>> import sonolube as sl
    >>> from sonolube.text.units import format_si
    >>> answer = sl.simulate("examples/rigs/tribometer.toml")
    >>> format_si(float(answer["mean_displacement"]), "m", digits=2)
    '720 nm'
    """
    known = rig_of(rig)
    with stage("simulating"):
        result = rigs.simulate(known)
    name, labelled = f"{known.name}-simulation", simulation_arrays(known, result)
    return RigRecord(
        rig=known,
        result=result,
        at_least=_lower_bounds(result.friction.power),
        measured=measured_on(known, vibration_amplitude=result.vibration.vibration_amplitude),
        verdict=point_verdict(known, friction=result.friction),
        leading=(*_load_caveats(known), *_lubricated_wear(known)),
        drawings={name: Drawing(chart=lambda: simulation_chart(labelled))},
        datasets={f"{name}.nc": labelled},
    )


_PIN = Parameter("Material of the pin, which the contact stays on; by default the rig's.", "MATERIAL")
_DISC = Parameter("Material of the disc, which the contact moves over; by default the rig's.", "MATERIAL")
_CONDUCTANCE = Quantity("Thermal conductance from the pin to its surroundings.", "W/K", kind="CONDUCTANCE")
_VIBRATION_HEAT = Quantity(
    "Heat of the vibration in the contact; several, such as 1mW,5mW, one after another, each for as long.", "W"
)
_RATIO = Quantity(
    "Friction with vibration over that without, such as a measured one, instead of the friction model's.",
    "friction_ratio",
    kind="RATIO",
)
_FLASH_MODEL = Parameter(f"Model of the flash temperature: {', '.join(FLASH_MODELS)}.", "MODEL")


@task
def thermal(
    rig: RigFile,
    *,
    pin: Annotated[str | None, _PIN] = None,
    disc: Annotated[str | None, _DISC] = None,
    duration: Annotated[Number, Quantity("Duration of the test.", "s")] = "50s",
    heat_capacity: Annotated[Number, Quantity("Heat capacity of the pin.", "J/K", kind="CAPACITY")] = "1.5J/K",
    conductance: Annotated[Number, _CONDUCTANCE] = "0.05W/K",
    dry: Annotated[Number, Quantity("Time at the start of the test without vibration.", "s")] = "0s",
    vibration_heat: Annotated[Number, _VIBRATION_HEAT] = "0W",
    friction_ratio: Annotated[Number | None, _RATIO] = None,
    flash_model: Annotated[str, _FLASH_MODEL] = "quadrature",
    **entries: Unpack[RigEntries],
) -> RigRecord:
    """Heat of friction and vibration: flash, bulk and their share in each body.

    Example: sonolube thermal examples/rigs/tribometer.toml --pin stainless_steel_316 --disc aluminium_2024

    Examples
    --------
    >>> import sonolube as sl
    >>> from sonolube.text.units import format_si
    >>> answer = sl.thermal("examples/rigs/tribometer.toml", pin="stainless_steel_316", disc="aluminium_2024")
    >>> format_si(float(answer["frictional_heat_rate"]), "W", digits=2)  # 0.36 N at 20.3 mm/s
    '7.3 mW'
    """
    known = rig_of(rig)
    if (crushed := crushing_load(known)) is not None:
        _ = resolved_rig(known).separation  # which refuses a load that leaves none by that reason first
        raise InvalidInput(f"{known.title}: {crushed}")
    hardness = softer_hardness(known, pin, disc)
    levels = vibration_heat.split(",") if isinstance(vibration_heat, str) else [vibration_heat]
    result = temperature_point(
        known,
        pin=thermal_solid(_material(pin or known.pin_material, "pin")),
        disc=thermal_solid(_material(disc or known.disc_material, "disc")),
        heat_capacity=plausible("heat_capacity", heat_capacity),
        thermal_conductance=plausible("conductance", conductance),
        duration=plausible("duration", duration),
        dry_duration=plausible("dry", dry),
        vibration_heat_rate=[plausible("vibration_heat", level) for level in levels],
        friction_ratio=in_si("friction_ratio", friction_ratio),
        flash_model=flash_model,
        hardness=hardness,
    )
    drawing = Drawing(chart=lambda: temperature_chart(known, result))
    return RigRecord(
        rig=known, result=result, verdict=verdict_of_rig(known), drawings={f"{known.name}-thermal": drawing}
    )


def _material(name: str | None, role: str) -> str:
    """Material of a body, given or of the rig."""
    if name is None:
        raise InvalidInput(f'{shown(role)}: missing; give it, or contact.softer.role = "pin" or "disc" in the rig file')
    return name
