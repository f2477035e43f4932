"""Figure of friction held in closed loop: friction with its reference, drive voltage and sliding speed over time."""

from typing import TYPE_CHECKING

from sonolube.figure import COLOURS
from sonolube.laboratory.closed_loop.record import HeldFriction

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_WIDTH = 6.85  # inches: 174 mm


def held_friction_figure(record: HeldFriction, *, simulated: bool) -> "Figure":
    """Friction force with its reference, drive voltage and sliding speed over time.

    Parameters
    ----------
    record : HeldFriction
    simulated : bool
        Whether no hardware moved.

    Returns
    -------
    matplotlib.figure.Figure
        Friction as means over the intervals, with the deviation of the samples within each as a band.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(_WIDTH, 5.2))
    friction, drive, speed = figure.subplots(3, 1, sharex=True, height_ratios=(2, 1, 1))
    hold, time, force = record.hold, record.time, record.friction_force
    source = "simulated" if simulated else "measured"
    band = record.friction_force_deviation
    friction.fill_between(
        time, force - band, force + band, color=COLOURS[5], alpha=0.5, linewidth=0, label="±1 deviation of samples"
    )
    friction.plot(time, force, color=COLOURS[0], label=f"friction, {source}")
    friction.plot(time, record.setpoint, color=COLOURS[6], linestyle="--", linewidth=1.2, label="reference")
    friction.axhline(
        record.intrinsic_friction_force, color=COLOURS[1], linestyle=":", label="without vibration, before"
    )
    friction.set(ylabel="Friction force [N]", ylim=(0, 1.05 * friction.get_ylim()[1]))
    friction.legend(loc="lower left", bbox_to_anchor=(0, 1.0), ncols=4, borderaxespad=0.2)
    drive.step(time, record.voltage_peak_to_peak, where="post", color=COLOURS[1])
    highest = hold.controller.level_maximum
    drive.axhline(highest, color="0.45", linestyle="-.", linewidth=1, label="highest of the controller")
    drive.set(ylabel="Drive, peak\nto peak [V]", ylim=(0, 1.35 * highest))
    drive.legend(loc="upper left")
    speed.step(time, 1e3 * record.sliding_speed, where="post", color=COLOURS[0])
    speed.set(ylabel="Sliding speed\n[mm/s]", xlabel="Time under control [s]")
    speed.set_ylim(0, 1.15e3 * float(record.sliding_speed.max(initial=0.0)) or 1.0)
    speed.margins(x=0)
    return figure
