"""Tasks that measure recordings: friction, rotation, temperature, calibration of a force gauge, and vibration."""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Annotated, Unpack

from sonolube.errors import InvalidInput, SonolubeError
from sonolube.measurement.friction.rotation import MotorCalibration
from sonolube.measurement.friction.stated_load import StatedLoad
from sonolube.measurement.friction.stated_parts import Span, StatedParts
from sonolube.report.measured.friction import FrictionSettings, friction_sheet, joined_friction_sheet
from sonolube.report.measured.friction_steps import comparison_sheet
from sonolube.report.measured.sensors import (
    CalibrationSettings,
    RotationSettings,
    TemperatureSettings,
    calibrated_hysteresis,
    calibration_sheet,
    force_sheet,
    rotation_sheet,
    temperature_sheet,
)
from sonolube.report.measured.vibration import VibrationSettings, has_voltage, proportion_sheet, vibration_sheet
from sonolube.tasks.files import InputFile, file_path
from sonolube.tasks.measure.measured_files import (
    Channels,
    Files,
    Group,
    MeasuredFiles,
    Sections,
    TestSheet,
    column_mapping,
    conditions,
    each_file,
    files_of,
    measured,
    reason_of,
)
from sonolube.tasks.own_tables import Mapped, number_table
from sonolube.tasks.parameters import File, KeyValues, Number, Parameter, Quantity, Watched
from sonolube.tasks.task import in_si, refuse_unused, shown, task
from sonolube.text.units import to_si


@task
def friction(
    files: Files,
    *,
    mapping: Mapped = None,
    group: Group = None,
    channel: Channels = (),
    section: Sections = (),
    join: Annotated[bool, Parameter("The files are one test, in this order: measure it too.")] = False,
    without_vibration: Annotated[Sequence[InputFile], File("A test without vibration; may come again.", "FILE")] = (),
    sliding_speed: Annotated[Number | None, Quantity("For the distance to the steady state.", "sliding_speed")] = None,
    load: Annotated[
        Number | None, Quantity("Normal load, for the coefficient, or the force of a coefficient.", "normal_load")
    ] = None,
    load_uncertainty: Annotated[
        Number | None, Quantity("Of the load, standard; enters the coefficient.", "normal_load_uncertainty")
    ] = None,
    zero_uncertainty: Annotated[
        Number | None,
        Quantity("Of the zero of the force, standard; enters coefficient and reduction.", "force_zero_uncertainty"),
    ] = None,
    window: Annotated[Number, Quantity("Duration of the windows.", "s")] = "2s",
    rotation_speed: Annotated[
        Number | None,
        Quantity("Of the disc, to remove its wobble; without it found at voltage steps.", "rotation_speed"),
    ] = None,
    torque_constant: Annotated[
        Number | None, Quantity("Of the motor, such as '0.5 N m/A'.", "torque_constant", kind="QUANTITY")
    ] = None,
    idle_current: Annotated[
        Number | None, Quantity("Of the motor with the pin lifted.", "idle_current", kind="CURRENT")
    ] = None,
    groove_diameter: Annotated[Number | None, Quantity("Of the circle under the pin.", "groove_diameter")] = None,
    part: Annotated[str | None, Parameter("What is measured, such as 5s:55s; else all of it.", "START:END")] = None,
    rest: Annotated[
        Sequence[str], Parameter("Where the surfaces rest, such as 0s:3s; may come again.", "START:END")
    ] = (),
    step: Annotated[
        Mapping[str, str] | None,
        KeyValues(
            "Step of a voltage that is not recorded, such as 10s:20s=28V; may come again, one of them 0V.",
            "START:END=VOLTAGE",
        ),
    ] = None,
    test_sheet: TestSheet = None,
    **watch: Unpack[Watched],
) -> MeasuredFiles:
    """Friction in recordings: level, fluctuation, running-in, steps of the voltage, stick-slip, work.

    Example: sonolube measure friction test.csv --sliding-speed 20.3mm/s --report test.html

    Examples
    --------
    >>> import sonolube as sl
    >>> from sonolube.tasks.files import NamedBytes
    >>> rows = ["time (s),friction_force (N)", *(f"{k / 100},{0.4 + 0.02 * (-1) ** k}" for k in range(2000))]
    >>> file = NamedBytes("test.csv", chr(10).join(rows).encode())  # or the path of a file
    >>> answer = sl.measure.friction(file)
    >>> round(float(answer["mean_force"]), 3), round(float(answer["friction_force_fluctuation"]), 3)
    (0.4, 0.02)
    """
    settings = FrictionSettings(
        mapping=column_mapping(mapping, group=group, channels=channel, sections=section),
        window_duration=in_si("window", window),
        sliding_speed=in_si("sliding_speed", sliding_speed),
        rotation_speed=in_si("rotation_speed", rotation_speed),
        motor=_motor(torque_constant, idle_current, groove_diameter),
        parts=_stated_parts(part, rest, step),
        load=_stated_load(load, load_uncertainty, zero_uncertainty),
    )
    measure = partial(friction_sheet, settings=settings)
    sheets, refused = each_file(files, measure, title="measuring")
    joined = []
    if join and settings.parts != StatedParts():
        raise InvalidInput(
            f"{shown('join')}: {shown('part')}, {shown('rest')} and {shown('step')} are of one recording"
        )
    if join and not refused:
        try:
            joined = [joined_friction_sheet(files_of(files), settings=settings)]
        except SonolubeError as failure:
            refused["all files as one test"] = reason_of(failure)
    if without_vibration:
        others, others_refused = each_file(without_vibration, measure, title="measuring without vibration")
        refused |= others_refused
        compared = [comparison_sheet(joined or sheets, others)] if sheets and others else []
        sheets = [*sheets, *joined, *others, *compared]
    else:
        sheets += joined
    return MeasuredFiles(title="friction", sheets=sheets, refused=refused, test=conditions(test_sheet))


def _stated_parts(part: str | None, rest: Sequence[str], step: Mapping[str, str] | None) -> StatedParts:
    """Parts of a recording by their texts."""
    steps = [
        (_span(text, "step"), to_si(voltage, unit="V", name=shown("step"))) for text, voltage in (step or {}).items()
    ]
    rests = [_span(text, "rest") for text in ([rest] if isinstance(rest, str) else rest)]
    return StatedParts(
        part=None if part is None else _span(part, "part"), rests=tuple(rests), steps=tuple(sorted(steps))
    )


def _stated_load(
    load: Number | None, load_uncertainty: Number | None, zero_uncertainty: Number | None
) -> StatedLoad | None:
    """Load with the uncertainties that enter a coefficient."""
    newton = in_si("load", load)
    if newton is None:
        refuse_unused("load_uncertainty", "zero_uncertainty", because=f"without {shown('load')}, for the coefficient")
        return None
    return StatedLoad(
        normal_load=newton,
        normal_load_uncertainty=in_si("load_uncertainty", load_uncertainty) or 0.0,
        force_zero_uncertainty=in_si("zero_uncertainty", zero_uncertainty) or 0.0,
    )


def _span(text: str, name: str) -> Span:
    """Begin and end of a part by a text such as "5s:55s"."""
    ends = text.split(":")
    if len(ends) != 2:
        raise InvalidInput(f"{shown(name)} {text[:60]!r} needs a begin and an end, such as 5s:55s", key=name)
    begin, end = (to_si(each.strip(), unit="s", name=shown(name)) for each in ends)
    return begin, end


def _motor(
    torque_constant: Number | None, idle_current: Number | None, groove_diameter: Number | None
) -> MotorCalibration | None:
    """Calibration from the current of a motor to the friction force."""
    torque = in_si("torque_constant", torque_constant)
    idle, diameter = in_si("idle_current", idle_current), in_si("groove_diameter", groove_diameter)
    if torque is None:
        unused = "idle_current", "groove_diameter"
        refuse_unused(*unused, because=f"without {shown('torque_constant')}, for the force by the current")
        return None
    if idle is None or diameter is None:
        needed = f"{shown('idle_current')} and {shown('groove_diameter')}"
        raise InvalidInput(f"{shown('torque_constant')} needs {needed}")
    return MotorCalibration(torque_constant=torque, idle_current=idle, groove_diameter=diameter)


@task
def rotation(
    files: Files,
    *,
    groove_diameter: Annotated[Number, Quantity("Of the circle under the pin.", "groove_diameter")],
    magnets: Annotated[int, Parameter("Magnets at the rim.", lowest=1)] = 1,
    prominence: Annotated[
        float, Parameter("Weakest pulse that counts over the strongest.", lowest=0.01, highest=1.0)
    ] = 0.25,
    mapping: Mapped = None,
    test_sheet: TestSheet = None,
    **watch: Unpack[Watched],
) -> MeasuredFiles:
    """Rotation from a Hall probe: speed of the disc and of the pin on it, missing pulses repaired.

    Example: sonolube measure rotation hall.csv --groove-diameter 50mm --magnets 2 --report hall.html

    Examples
    --------
    >>> from math import exp
    >>> import sonolube as sl
    >>> from sonolube.tasks.files import NamedBytes
    >>> pulses = (f"{k / 200},{exp(-(((k % 250 - 125) / 6) ** 2))}" for k in range(4000))
    >>> file = NamedBytes("hall.csv", chr(10).join(["time (s),magnetic_flux_density (mT)", *pulses]).encode())
    >>> answer = sl.measure.rotation(file, groove_diameter="50mm")
    >>> round(float(answer["rotation_speed"]), 3), round(float(answer["sliding_speed"]), 3)  # pi 50 mm 0.8/s
    (0.8, 0.126)
    """
    settings = RotationSettings(
        groove_diameter=in_si("groove_diameter", groove_diameter),
        magnets=magnets,
        prominence=prominence,
        mapping=column_mapping(mapping),
    )
    return measured("rotation", files, partial(rotation_sheet, settings=settings), test_sheet)


@task
def temperature(
    files: Files,
    *,
    start_time: Annotated[
        Number | None, Quantity("Of the step of the heat; else the first sample.", "start_time")
    ] = None,
    end_time: Annotated[Number | None, Quantity("Of the response; else the last sample.", "end_time")] = None,
    exponentials: Annotated[
        int | None, Parameter("In the response; else as many as the samples tell apart.", lowest=1, highest=2)
    ] = None,
    without_vibration: Annotated[InputFile | None, File("The test without vibration, to compare with.", "FILE")] = None,
    mapping: Mapped = None,
    test_sheet: TestSheet = None,
    **watch: Unpack[Watched],
) -> MeasuredFiles:
    """Temperature after a step of the heat: final rise, time constants, and rise over a test without vibration.

    Example: sonolube measure temperature heated.csv --start-time 2s --report heated.html
    """
    start, end = in_si("start_time", start_time), in_si("end_time", end_time)
    if start is not None and end is not None and end <= start:
        raise InvalidInput(f"{shown('end_time')} {end:g} s must be later than {shown('start_time')} {start:g} s")
    settings = TemperatureSettings(
        start_time=start,
        end_time=end,
        exponentials=exponentials,
        without_vibration=None if without_vibration is None else file_path(without_vibration),
        mapping=column_mapping(mapping),
    )
    return measured("temperature", files, partial(temperature_sheet, settings=settings), test_sheet)


@task
def calibration(
    files: Files,
    *,
    apply: Annotated[Sequence[InputFile], File("A displacement to compute the force of; may come again.", "FILE")] = (),
    mapping: Mapped = None,
    degree: Annotated[int, Parameter("Of the polynomials of loading and unloading.", lowest=1, highest=7)] = 3,
    levels: Annotated[int, Parameter("Of displacement in the Preisach model.", lowest=2, highest=64)] = 16,
    displacement_uncertainty: Annotated[
        Number, Quantity("Of a reading, standard.", "displacement_uncertainty")
    ] = "0um",
    test_sheet: TestSheet = None,
    **watch: Unpack[Watched],
) -> MeasuredFiles:
    """Calibration of a displacement sensor as a force gauge with hysteresis, and forces by it.

    Example: sonolube measure calibration loops.csv --apply test.csv --report gauge.html
    """
    if not apply:
        because = f"without {shown('apply')}, whose forces it makes uncertain"
        refuse_unused("displacement_uncertainty", because=because)
    settings = CalibrationSettings(
        mapping=column_mapping(mapping),
        degree=degree,
        levels=levels,
        displacement_uncertainty=in_si("displacement_uncertainty", displacement_uncertainty),
    )
    sheets, refused = each_file(files, partial(calibration_sheet, settings=settings), title="calibrating")
    if apply:
        paths = files_of(files)
        if len(paths) != 1:
            raise InvalidInput(f"{shown('apply')} needs one calibration, got {len(paths)} files")
        gauge = calibrated_hysteresis(paths[0], settings=settings)
        measure = partial(force_sheet, calibration=gauge, settings=settings)
        forces, forces_refused = each_file(apply, measure, title="computing forces")
        sheets, refused = [*sheets, *forces], refused | forces_refused
    return MeasuredFiles(title="calibration", sheets=sheets, refused=refused, test=conditions(test_sheet))


@task
def vibration(
    files: Files,
    *,
    frequency: Annotated[Number, Quantity("Of the drive, such as 22kHz.", "frequency")],
    modes: Annotated[InputFile | None, File("Computed shapes at the points, one a column.", "MODES.csv")] = None,
    mapping: Mapped = None,
    test_sheet: TestSheet = None,
    **watch: Unpack[Watched],
) -> MeasuredFiles:
    """Vibration at the drive frequency: amplitude, amplitude per volt, operating shape, likeness to computed modes.

    Example: sonolube measure vibration tip.csv --frequency 22kHz --report tip.html

    Examples
    --------
    >>> from math import pi, sin
    >>> import sonolube as sl
    >>> from sonolube.tasks.files import NamedBytes
    >>> rows = ["time (s),tip (um)", *(f"{k / 20e3},{2.5 * sin(2 * pi * k / 20)}" for k in range(2000))]
    >>> file = NamedBytes("tip.csv", chr(10).join(rows).encode())  # or the path of a file
    >>> round(1e6 * float(sl.measure.vibration(file, frequency="1kHz")["vibration_amplitude"]), 3)
    2.5
    """
    settings = VibrationSettings(
        frequency=in_si("frequency", frequency),
        mapping=column_mapping(mapping),
        modes=None if modes is None else number_table(file_path(modes)),
    )
    sheets, refused = each_file(files, partial(vibration_sheet, settings=settings), title="measuring")
    if sum(map(has_voltage, sheets)) > 1:
        sheets.append(proportion_sheet(sheets))
    return MeasuredFiles(title="vibration", sheets=sheets, refused=refused, test=conditions(test_sheet))
