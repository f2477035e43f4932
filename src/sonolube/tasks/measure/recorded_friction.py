"""Task `measure friction`: level, fluctuation, running-in, voltage steps, stick-slip and work in recordings."""

from collections.abc import Sequence
from functools import partial
from typing import Annotated, Unpack

from sonolube.errors import InvalidInput, SonolubeError
from sonolube.measurement.friction.motor_current import MotorCalibration
from sonolube.report.measured.friction import FrictionSettings, friction_sheet
from sonolube.report.measured.friction_comparison import comparison_sheet
from sonolube.report.measured.joined_friction import joined_friction_sheet
from sonolube.tasks.files import InputFile
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
    reason_of,
)
from sonolube.tasks.own_tables import Mapped
from sonolube.tasks.parameters import File, Number, Parameter, Quantity, Watched
from sonolube.tasks.task import in_si, refuse_unused, shown, task


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
    )
    measure = partial(friction_sheet, settings=settings)
    sheets, refused = each_file(files, measure, title="measuring")
    joined = []
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
