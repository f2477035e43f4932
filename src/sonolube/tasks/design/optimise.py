"""Task `optimise`: actuator, frequency, waveform and masses for a friction at least power, heat or voltage.

Its arguments become a design space, horn, bolt and target; its answer has best designs, Pareto front, amplifier,
matching networks and a rig file.
"""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal, Unpack

import tomli_w

from sonolube.checks import require_positive
from sonolube.design import optimisation
from sonolube.design.optimisation import (
    OWN_ACTUATOR,
    DesignSpace,
    DriveElectronics,
    HalfWaveHorn,
    Optimum,
    design_output as figures,
    design_text,
)
from sonolube.design.optimisation.confident_optimum import ReachedChance, optimum_with_chance
from sonolube.design.optimisation.design_output import design_counts, designs_dataset
from sonolube.design.optimisation.requirements import preload_bolt
from sonolube.errors import InvalidInput, UnknownName
from sonolube.facts.materials import material
from sonolube.measurement.run_columns import runs_help
from sonolube.models.actuator import CatalogueActuator, PreloadBolt, catalogue_actuator, catalogue_names, read_catalogue
from sonolube.report import Drawing, Page, PageTable
from sonolube.report.results.design import optimum as results
from sonolube.report.results.design.sweep import count_table
from sonolube.report.results.record_object import operating_point, rig_settings
from sonolube.rig import Rig, read_rig, structure_entries
from sonolube.rig.driven_rig import driven_rig
from sonolube.rig.file.rig_folder import rig_file
from sonolube.rig.resolved_rig import resolved_rig
from sonolube.storage.user_files import input_text
from sonolube.tasks.answer import Answer, Block, Dataset, Rows, Table, answer
from sonolube.tasks.design.chances import CONFIDENCE
from sonolube.tasks.design.control import friction_force
from sonolube.tasks.files import InputFile, file_path
from sonolube.tasks.own_evidence import Evidence, evidence_of
from sonolube.tasks.own_tables import MappedRuns, Values, ends_by_key, refuse_replaced, runs_of, values_by_key
from sonolube.tasks.parameters import (
    File,
    KeyValues,
    Number,
    Parameter,
    Quantity,
    RestingRig,
    RunsSource,
    WatchedRestingRig,
    rig_of,
)
from sonolube.tasks.progress import stage
from sonolube.tasks.task import in_si, refuse_unused, shown, task
from sonolube.text.units import format_si

_WAVEFORM = "drive.waveform"
_WAVEFORMS = ("sine", "square", "triangle", "sawtooth")


def target_ratio(rig: Rig, target: str | float | None, reduction: float | None = None) -> float:
    """Target friction over friction without vibration, from a coefficient or a force, or from the reduction."""
    if (target is None) == (reduction is None):
        raise InvalidInput(f"give {shown('target_friction')}, or {shown('target_reduction')} in its place")
    if reduction is not None:
        if not 0 < reduction < 1:
            raise InvalidInput(f"{shown('target_reduction')} must lie between 0 and 100 %, got {100 * reduction:.4g} %")
        return 1 - reduction
    assert target is not None
    force = friction_force("target_friction", target, normal_load=rig.normal_load)
    intrinsic = rig.friction_coefficient * rig.normal_load
    if not force < intrinsic:
        limit = f"{rig.friction_coefficient:.4g} or {format_si(intrinsic, 'N')}"
        raise InvalidInput(f"{shown('target_friction')} {target} must lie below friction without vibration, {limit}")
    return force / intrinsic


def half_wave_horn(material_name: str | None, limit: float | None) -> HalfWaveHorn | None:
    """Half-wave horn of a material with the stress amplitude allowed in it; None without both."""
    if material_name is None and limit is None:
        return None
    if material_name is None or limit is None:
        raise InvalidInput(
            f"{shown('horn')} and {shown('horn_limit')} belong together: a material and the stress it bears"
        )
    solid = material(material_name)
    return HalfWaveHorn(
        density=solid.value("density"), youngs_modulus=solid.value("youngs_modulus"), stress_limit=limit
    )


def bolt_of_thread(thread: str | None, tension: float | None, strength: float) -> PreloadBolt | None:
    """Preload bolt of a thread such as M6x40mm; None without thread and tension."""
    if thread is None and tension is None:
        return None
    if thread is None or tension is None:
        raise InvalidInput(
            f"{shown('bolt')} and {shown('preload')} belong together, such as {shown('bolt')} M6x40mm"
            f" {shown('preload')} 1kN"
        )
    return preload_bolt(thread, preload=tension, yield_strength=strength, name=shown("bolt"))


def design_space(
    rig: Rig,
    *,
    over: Values,
    actuators: Sequence[str],
    catalogue: InputFile | None,
    mechanical_quality_factor: float,
    bolt: PreloadBolt | None,
) -> DesignSpace:
    """Design space of actuators, frequencies, waveforms and entries of the structure."""
    if rig.direction.is_in_plane:
        _ = resolved_rig(rig).moved  # which refuses it
    driven = driven_rig(rig)
    drive = driven.drive
    known: dict[str, CatalogueActuator] = {name: catalogue_actuator(name) for name in catalogue_names()}
    if catalogue is not None:
        known |= read_catalogue(file_path(catalogue))
    entries = structure_entries(rig.content())
    numbers = {key: ends for key, ends in over.items() if key != _WAVEFORM}
    for key in numbers:
        _require_range_key(key, entries)
    ranges = ends_by_key(numbers)
    for key, (low, high) in ranges.items():
        if not 0 < low < high:
            raise InvalidInput(f"{shown('over')} {key}: needs a range from above 0 that rises, got {low:g} to {high:g}")
    frequencies = ranges.pop("drive.frequency", (0.8 * drive.frequency, 1.2 * drive.frequency))
    return DesignSpace(
        rig=driven,
        entries=entries,
        frequencies=frequencies,
        ranges={key.removeprefix("structure."): ends for key, ends in ranges.items()},
        actuators=_actuator_names(actuators, known),
        waveforms=_waveform_names(over, drive.waveform),
        catalogue=known,
        mechanical_quality_factor=mechanical_quality_factor,
        bolt=bolt,
    )


def _require_range_key(key: str, entries: Mapping[str, float]) -> None:
    """Raise for a key that no range can be chosen over."""
    table, _, name = key.rpartition(".")
    if table == "structure" and name not in entries:
        raise UnknownName.among(entries, kind="entry of structure", name=name)
    if table != "structure" and key != "drive.frequency":
        raise InvalidInput(
            f"{shown('over')} {key}: choose over drive.frequency, drive.waveform or an entry of structure"
        )


def _actuator_names(actuators: Sequence[str], known: Mapping[str, CatalogueActuator]) -> tuple[str, ...]:
    """Names of the actuators to choose from, "catalogue" replaced by those whose data sheets are complete."""
    names: list[str] = []
    for name in actuators or [OWN_ACTUATOR]:
        every = [each for each, entry in known.items() if entry.complete] if name == "catalogue" else [name]
        names += [each for each in every if each not in names]
    return tuple(names)


def _waveform_names(over: Values, default: str) -> tuple[str, ...]:
    """Names of the waveforms to choose from."""
    chosen = {key: values for key, values in over.items() if key == _WAVEFORM}
    names = tuple(str(value) for value in values_by_key(chosen).get(_WAVEFORM, ()))
    for name in names:
        if name not in _WAVEFORMS:
            raise InvalidInput(f"{shown('over')} {_WAVEFORM}: {name!r} is none of {', '.join(_WAVEFORMS)}")
    return names or (default,)


@answer
class OptimisationAnswer(Answer):
    """Best designs and front of an optimisation, with the amplifier and the networks of the best."""

    rig: Rig
    optimum: Optimum
    electric: DriveElectronics
    chance: ReachedChance | None = None

    def blocks(self) -> Sequence[Block]:
        """Best design, table of all, and actuators that were not used."""
        return [
            operating_point(self._space.rig),
            Rows([*self._chance, *results.facts(self.optimum, self.electric)]),
            Table(*results.designs_table(self.optimum)),
            *[f"  not used: {reason}" for reason in self.optimum.screening.refused.values()],
        ]

    def object(self) -> dict[str, Any]:
        """Best designs and front with the entries that make each, number of designs, amplifier and networks."""
        found = results.optimum_object(self.optimum, self.electric, content=self.rig.content())
        return found | results.chance_object(self.chance)

    def caveats(self) -> Sequence[str]:
        """Values at the end of their range, heat beyond the amplifier's power, no preload, and own evidence."""
        return (*results.optimum_caveats(self.optimum), *(() if self.chance is None else self.chance.caveats))

    def assumptions(self) -> Mapping[str, str]:
        """Quality factor and loss tangent of the ceramics, and the assumptions of the rig file."""
        assumed = {}
        if any(point.candidate.actuator != OWN_ACTUATOR for point in self.optimum.designs):
            factor = self._space.mechanical_quality_factor
            assumed["quality factor"] = f"{factor:g} for the catalogue's ceramics; no sheet has it"
        loss = self.optimum.problem.limits.loss_tangent
        return assumed | {"loss tangent": f"{loss:g} for the ceramic, in its heat"} | dict(self._space.rig.assumptions)

    def figures(self) -> Mapping[str, Drawing]:
        """Objective over frequency, front, limits used, and power factor."""
        optimum, name = self.optimum, self._name
        drawings = {
            f"{name}-frequency": Drawing(
                chart=lambda: figures.frequency_chart(optimum),
                caption=f"Least {optimum.minimise} for the target at each frequency, over all structures of the"
                " screening; markers are the refined designs.",
            )
        }
        if optimum.front:
            drawings[f"{name}-front"] = Drawing(
                chart=lambda: figures.front_chart(optimum),
                caption=f"Pareto front of {optimum.minimise} and {optimum.second_objective} within the limits.",
            )
        if results.tightest_limit(optimum.best) != results.NO_LIMIT:
            drawings[f"{name}-limits"] = Drawing(
                chart=lambda: figures.limits_chart(optimum.best),
                caption="Fraction of each limit, set or of the actuator, that the best design uses.",
            )
        drawings[f"{name}-power-factor"] = Drawing(
            chart=lambda: figures.power_factor_chart(optimum, self.electric),
            caption="Power factor at the amplifier about the drive's frequency (vertical line).",
        )
        return drawings

    def files(self) -> "Mapping[str, str | Dataset]":
        """All designs as netCDF, and the best as a rig file."""
        content = self.rig.content()
        file = self.rig.file
        is_unchanged = file is not None and read_rig(file).content() == content
        source = input_text(rig_file(file)) if file is not None and is_unchanged else tomli_w.dumps(content)
        return {
            f"{self._name}.nc": designs_dataset(self.optimum),
            f"{self._name}.toml": design_text(source, content, self.optimum.problem, self.optimum.best),
        }

    def page(self) -> Page:
        """Page `optimise.html`."""
        optimum, rig = self.optimum, self._space.rig
        counts, total = design_counts(optimum), optimum.screening.frequency.size
        heads, rows = results.designs_table(optimum)
        refused = [("not used", reason) for reason in optimum.screening.refused.values()]
        return Page(
            name="optimise",
            title=f"Least {optimum.minimise} for a friction ratio of {optimum.problem.friction_ratio:.3g}: {rig.title}",
            settings=rig_settings(rig),
            facts=[*self._chance, *results.facts(optimum, self.electric), *refused],
            tables=[
                PageTable(title="Designs, the best first", heads=tuple(heads), rows=tuple(rows)),
                count_table("Screened designs by status", "designs", counts, total=total),
            ],
        )

    @property
    def _chance(self) -> list[tuple[str, str]]:
        """Chance of the target by the best design, where it is known."""
        return [] if self.chance is None else [("predicted", self.chance.text)]

    @property
    def _space(self) -> Any:
        """Design space of the problem."""
        return self.optimum.problem.space

    @property
    def _name(self) -> str:
        """Name of the files, without ending."""
        return f"{self.rig.name}-optimum"


Objective = Literal["power", "heat", "voltage"]

_OVER = KeyValues(
    "A range to choose from: drive.frequency or an entry of structure; or drive.waveform=one,two."
    " May come again; the frequency by a fifth either way by default.",
    "KEY=FIRST:LAST",
)
_ACTUATOR = Parameter("own, a name that sonolube actuators lists, or catalogue. May come again.", "NAME")
_RUNS = File(
    runs_help("Own measured runs, on which the chance of the target rests beside the published tests. Columns"),
    "RUNS.csv",
    option="--runs --measured",
)
_CATALOGUE = File("Further actuators, in the format of the built-in list.", "FILE.toml")


@task
def optimise(
    rig: RestingRig,
    *,
    target_friction: Annotated[
        str | float | None, Parameter("Coefficient or force, such as 0.1 or 0.3N.", "FRICTION")
    ] = None,
    target_reduction: Annotated[
        Number | None, Quantity("Reduction of friction in its place, such as 60 %.", "", kind="SHARE")
    ] = None,
    confidence: Annotated[Number | None, CONFIDENCE] = None,
    runs: Annotated[RunsSource, _RUNS] = None,
    mapping: MappedRuns = None,
    evidence: Evidence = None,
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
    **watch: Unpack[WatchedRestingRig],
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
    space = design_space(
        known,
        over=ranges,
        actuators=actuator,
        catalogue=catalogue,
        mechanical_quality_factor=quality,
        bolt=bolt_of_thread(bolt, in_si("preload", preload), in_si("bolt_strength", bolt_strength)),
    )
    limits = optimisation.Limits(
        voltage_maximum=in_si("voltage_limit", voltage_limit),
        current_maximum=in_si("current_limit", current_limit),
        slew_rate_maximum=in_si("slew_limit", slew_limit),
        nominal_pressure=in_si("stress_limit", stress_limit),
        temperature_rise=in_si("temperature_limit", temperature_limit),
        thermal_conductance=in_si("conductance", conductance),
        horn=half_wave_horn(horn, in_si("horn_limit", horn_limit)),
    )
    problem = optimisation.DesignProblem(
        space=space,
        friction_ratio=target_ratio(known, target_friction, in_si("target_reduction", target_reduction)),
        limits=limits,
        tolerance=None if robust is None else optimisation.Tolerance(manufacturing_tolerance=robust, quantile=quantile),
    )
    source = in_si("source_resistance", source_resistance)
    if source is not None:
        require_positive(source_resistance=source)
    wanted = in_si("confidence", confidence)
    if wanted is not None and not 0 < wanted < 1:
        raise InvalidInput(f"{shown('confidence')} must lie between 0 and 100 %, got {100 * wanted:.4g} %")
    measured, learned = runs_of(runs, mapping, known), evidence_of(evidence, known)
    with stage("optimising") as advance:
        optimum, chance = optimum_with_chance(
            problem,
            known,
            confidence=wanted,
            runs=measured,
            evidence=learned,
            minimise=minimise,
            second_objective=pareto,
            samples=samples,
            advance=lambda done, total: advance("structures", done, total),
        )
        electric = optimisation.required_electronics(problem, optimum.best, source_resistance=source)
    return OptimisationAnswer(rig=known, optimum=optimum, electric=electric, chance=chance)


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
