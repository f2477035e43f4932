"""Dry run: a protocol gone through without devices, with the rig that it is meant for."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from itertools import pairwise
from math import isnan, pi

import numpy as np

from sonolube.design.control import Amplifier
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.facts.protocol import PROMPT_DURATIONS, Metadata, Prompt, Protocol, SetPoint, flattened, step_at
from sonolube.laboratory.devices import DriveSetting
from sonolube.laboratory.dry_run.record import DryRun, Heating, PlannedPoint, drive_load, heating_over, rubbed_contact
from sonolube.laboratory.dry_run.report import caveats_of, refusals_of
from sonolube.laboratory.heating_assumptions import HeatingAssumptions as HeatingAssumptions
from sonolube.laboratory.run_plan import drive_setting
from sonolube.laboratory.set_and_measured import SELF_TEST_TIME, self_test_setting
from sonolube.laboratory.supervision import LATE
from sonolube.rig import OperatingPoints, Rig, operating_points, thermal_solid
from sonolube.rig.driven_rig import actuator_capacitance
from sonolube.text.units import format_si


def dry_run(
    protocol: Protocol,
    *,
    rig: Rig | None,
    amplifier: Amplifier | None = None,
    heating: HeatingAssumptions | None = None,
) -> DryRun:
    """Planned course of a protocol: its duration, its amount of data, and the limits of drive and heat.

    Parameters
    ----------
    protocol : Protocol
    rig : Rig or None
        None leaves out amplitude, friction, drive and heat.
    amplifier : Amplifier, optional
        Limits of the amplifier; without it only those of the protocol are held against the drive.
    heating : HeatingAssumptions, optional
        Thermal properties that a rig file does not hold.

    Returns
    -------
    DryRun
        Also where the test is impossible: `refusals` says why.

    Notes
    -----
    Friction and amplitude are steady values of `sonolube.rig.operating_points`, heat is friction force times sliding
    speed and the loss of the actuator, bodies have one temperature each (first order), and the flash rise of the
    contact follows without delay. Prompts take no time in the temperatures: what cools meanwhile stays out.
    """
    settings = flattened(protocol)
    assumed, notes = heating or HeatingAssumptions(), _Notes(caveats=[], refusals=[])
    points = tuple(
        PlannedPoint(
            setting=point,
            duration=following.time - point.time,
            content=_content(protocol, point),
            sliding_speed=_sliding_speed(point, protocol.metadata),
        )
        for point, following in pairwise((*settings, settings[-1]))
    )
    heated = None
    if rig is not None:
        points = _with_vibration(points, rig, protocol.metadata, notes)
        points = _with_loads(points, actuator_capacitance(rig), notes)
        heated = _heating(points, rig, protocol.metadata, assumed, notes)
    prompts = [step for step in (step_at(protocol, each.step) for each in settings[:-1]) if isinstance(step, Prompt)]
    found = DryRun(
        protocol=protocol,
        rig_title="" if rig is None else rig.title,
        points=points,
        duration=settings[-1].time,
        prompt_time=sum(PROMPT_DURATIONS[prompt.task] for prompt in prompts),
        heating=heated,
        assumptions=_assumptions(
            assumed, rig, prompts, self_test_setting(next(filter(None, map(drive_setting, settings)), None))
        ),
    )
    return replace(
        found, refusals=(*notes.refusals, *refusals_of(found, amplifier)), caveats=(*notes.caveats, *caveats_of(found))
    )


@dataclass(frozen=True, slots=True)
class _Notes:
    """Lines that are found on the way.

    Parameters
    ----------
    caveats, refusals : list of str
    """

    caveats: list[str]
    refusals: list[str]


def _content(protocol: Protocol, point: SetPoint) -> str:
    """Description of a step."""
    return step_at(protocol, point.step).content if point.step else "motor and drive off"


def _sliding_speed(point: SetPoint, metadata: Metadata) -> float | None:
    """Sliding speed of a set point; None where the disc's groove is unknown. [m/s]"""
    if point.rotation_speed is None:
        return point.sliding_speed or 0.0
    if point.rotation_speed == 0:
        return 0.0
    return None if metadata.groove_diameter is None else pi * metadata.groove_diameter * point.rotation_speed


def _with_vibration(
    points: Sequence[PlannedPoint], rig: Rig, metadata: Metadata, notes: _Notes
) -> tuple[PlannedPoint, ...]:
    """Points with amplitude and friction force of the rig."""
    usual = metadata.normal_load or rig.normal_load
    loads = [usual if point.setting.normal_load is None else point.setting.normal_load for point in points]
    is_used = [bool(point.sliding_speed) or point.setting.frequency is not None for point in points]
    stated = [metadata.normal_load is not None or point.setting.normal_load is not None for point in points]
    if not all(is_stated for is_stated, used in zip(stated, is_used, strict=True) if used):
        notes.caveats.append(f"the protocol states no load; taken is the rig's, {format_si(usual, 'N')}")
    if any(point.sliding_speed is None for point in points):
        notes.caveats.append("metadata.groove_diameter is missing: speeds of the disc are no sliding speeds, no heat")
    still = [
        replace(
            point,
            vibration_amplitude=0.0 if point.setting.frequency is None else None,
            friction_force=rig.friction_coefficient * load if point.sliding_speed else 0.0,
        )
        for point, load in zip(points, loads, strict=True)
    ]
    driven = [index for index, point in enumerate(points) if point.setting.frequency is not None]
    if not driven:
        return tuple(still)
    try:
        found, rows = _vibrated([points[index] for index in driven], rig, [loads[index] or usual for index in driven])
    except SonolubeError as refusal:
        notes.caveats.append(f"amplitude and friction under vibration are left out: {refusal}")
        return tuple(still)
    for index, row in zip(driven, rows, strict=True):
        still[index] = _vibrating(still[index], found, int(row), notes, is_lifted=loads[index] == 0)
    notes.caveats.append(f"amplitude {found.amplitude_origin}; friction by {rig.friction_model.name}")
    return tuple(still)


def _vibrated(
    points: Sequence[PlannedPoint], rig: Rig, loads: Sequence[float]
) -> tuple[OperatingPoints, Sequence[int]]:
    """Operating points of the distinct settings, and that of each point, by its load in N."""
    at_rest = rig.sliding_speed  # the amplitude is the same, and friction is not asked for
    names = ("voltage_peak_to_peak", "voltage_offset", "frequency")
    settings = [
        (*(getattr(each.setting, name) for name in names), each.sliding_speed or at_rest, load)
        for each, load in zip(points, loads, strict=True)
    ]
    distinct, rows = np.unique(np.array(settings, dtype=np.float64), axis=0, return_inverse=True)
    columns = dict(zip((*names, "sliding_speed", "normal_load"), distinct.T, strict=True))
    found = operating_points(rig, **columns)
    return found, rows.ravel().tolist()


def _vibrating(
    point: PlannedPoint, found: OperatingPoints, row: int, notes: _Notes, *, is_lifted: bool
) -> PlannedPoint:
    """Point with amplitude and friction under vibration, and what its status says; a lifted pin has no friction."""
    amplitude, force = float(found.vibration_amplitude[row]), float(found.friction_force[row])
    status, moving = str(found.status[row]), bool(point.sliding_speed)
    if status == "refused" or (moving and isnan(force)):
        line = f"step {point.setting.step}: {found.reason[row]}"
        lines = notes.refusals if status == "refused" else notes.caveats
        if line not in lines:
            lines.append(line)
    return replace(
        point,
        vibration_amplitude=None if isnan(amplitude) else amplitude,
        friction_force=force if moving and not isnan(force) and not is_lifted else point.friction_force,
        dissipated_power=_known(found.dissipated_power[row]),
        peak_current=_known(found.peak_current[row]),
    )


def _known(value: float) -> float | None:
    """Value, or None where it is NaN."""
    return None if isnan(value) else float(value)


def _with_loads(points: Sequence[PlannedPoint], capacitance: float | None, notes: _Notes) -> tuple[PlannedPoint, ...]:
    """Points with the load of their drive."""
    if capacitance is None:
        notes.caveats.append("actuator.capacitance is missing in the rig file: current, power and heat are left out")
        return tuple(points)
    load_of = cache(partial(drive_load, capacitance=capacitance))
    return tuple(
        replace(
            point,
            load=load_of(
                drive_setting(point.setting), dissipated_power=point.dissipated_power, peak_current=point.peak_current
            ),
        )
        for point in points
    )


def _heating(
    points: Sequence[PlannedPoint], rig: Rig, metadata: Metadata, assumed: HeatingAssumptions, notes: _Notes
) -> Heating | None:
    """Temperatures over the time line."""
    try:
        pin = thermal_solid(_material(assumed.pin_material or rig.pin_material, metadata.pin_material, "pin"))
        disc = thermal_solid(_material(assumed.disc_material or rig.disc_material, metadata.disc_material, "disc"))
        bodies = rubbed_contact(pin, disc, nominal_area=rig.contact.nominal_area, assumed=assumed)
    except SonolubeError as refusal:
        notes.caveats.append(f"temperature of the contact is left out: {refusal}")
        bodies = None
    return heating_over(points, bodies=bodies, assumed=assumed)


def _material(known: str | None, of_protocol: str, role: str) -> str:
    """Name of a material of the catalogue: the known one, else that of the protocol."""
    name = known or of_protocol.strip().lower().replace(" ", "_")
    if not name:
        raise InvalidInput(f"the material of the {role} is not known; give metadata.{role}_material")
    return name


def _assumptions(
    assumed: HeatingAssumptions, rig: Rig | None, prompts: Sequence[Prompt], tested: DriveSetting | None
) -> dict[str, str]:
    """Assumptions, by their subject."""
    late = format_si(LATE, "s")
    found = {"supervisor": f"on devices, motor and drive are switched off where a block is late by more than {late}"}
    if tested is not None:
        swing, frequency = format_si(tested.voltage_peak_to_peak, "V"), format_si(tested.frequency, "Hz")
        found["self-test"] = (
            f"on devices with a channel of the voltage, {swing} peak to peak at {frequency} for"
            f" {format_si(SELF_TEST_TIME, 's')} before the first step, which vibrates the specimens: set and measured"
            " are compared, as at every block; it can be left out"
        )
    if prompts:
        tasks = dict.fromkeys(prompt.task for prompt in prompts)
        found["prompts"] = ", ".join(f"{task} {PROMPT_DURATIONS[task] / 60:g} min" for task in tasks)
    if rig is not None:
        found["pin"] = f"one temperature, {assumed.pin_heat_capacity:g} J/K, loses {assumed.pin_conductance:g} W/K"
        found["actuator"] = (
            f"one temperature, {assumed.actuator_heat_capacity:g} J/K, loses {assumed.actuator_conductance:g} W/K"
            f" (time constant {assumed.actuator_heat_capacity / assumed.actuator_conductance:.3g} s);"
            f" {assumed.loss_factor:g} of its reactive power becomes heat, the 10 K of D Table 2.2 under cooling air"
        )
        found["start"] = f"all at {assumed.ambient_temperature - 273.15:.3g} degC; prompts take no time"
    return found
