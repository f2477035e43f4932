"""Dry run in words: a line per set point, time, data, and temperatures."""

from collections.abc import Iterator

from sonolube.laboratory.dry_run.record import DryRun, PlannedPoint
from sonolube.text.units import format_si


def dry_run_lines(found: DryRun) -> list[str]:
    """Lines of a dry run: one a set point, then time, data, drive and temperatures.

    Parameters
    ----------
    found : DryRun

    Returns
    -------
    list of str
        Refusals, caveats and assumptions are not among them.
    """
    cells = (dry_run_cells(point, found) for point in found.points)
    lines = [f"{time}  {step:<6}{kind:<14}{content}".rstrip() for time, step, kind, content in cells]
    return [*lines, "", *(f"{name:<13}{text}" for name, text in dry_run_sums(found))]


def dry_run_cells(point: PlannedPoint, found: DryRun) -> tuple[str, str, str, str]:
    """Time, step, kind and content of a set point of a dry run.

    Parameters
    ----------
    point : PlannedPoint
    found : DryRun

    Returns
    -------
    tuple of str
        The times of all points are equally long.
    """
    at, width = point.setting, len(clock(found.duration))
    content = point.content if at.kind == "prompt" else "  ".join(_facts(point))
    return f"{clock(at.time):>{width}}", at.step, at.kind.replace("_", " "), content


def clock(seconds: float) -> str:
    """Time as hours, minutes and seconds, such as 4:00:00 or 0:32.5."""
    tenths = round(10 * seconds)
    minutes, rest = divmod(tenths, 600)
    hours, minutes = divmod(minutes, 60)
    text = f"{rest / 10:04.1f}".removesuffix(".0")
    return f"{hours}:{minutes:02d}:{text}" if hours else f"{minutes}:{text}"


def _facts(point: PlannedPoint) -> Iterator[str]:
    """Set point in words, with the amplitude, current and heat that follow from it."""
    at = point.setting
    if at.rotation_speed:
        yield f"{60 * at.rotation_speed:.3g} rpm"
    if point.sliding_speed:
        yield format_si(point.sliding_speed, "m/s", digits=3)
    if at.frequency is not None:
        yield f"{at.voltage_peak_to_peak:.3g} V pp {at.frequency / 1e3:.4g} kHz"
        if point.vibration_amplitude is not None:
            yield format_si(point.vibration_amplitude, "m", digits=3)
        if point.load is not None:
            yield f"{format_si(point.load.peak_current, 'A', digits=3)} peak"
    if point.friction_force:
        yield format_si(point.friction_force, "N", digits=3)
    if at.channels and at.kind == "acquire" and at.sample_rate is not None:
        lasts = (at.recorded_until or at.time) - at.time
        yield f"{', '.join(at.channels)} at {format_si(at.sample_rate, 'Hz')} for {clock(lasts)}"
    if point.content:
        yield point.content


def dry_run_sums(found: DryRun) -> Iterator[tuple[str, str]]:
    """Time, data, drive and temperatures of a whole dry run, each as its name and its text.

    Parameters
    ----------
    found : DryRun

    Yields
    ------
    tuple of str
    """
    prompts = sum(point.setting.kind == "prompt" for point in found.points)
    whole = clock(found.duration + found.prompt_time)
    beside = f", about {whole} with {_counted(prompts, 'prompt')}" if prompts else ""
    yield "duration", f"{clock(found.duration)}{beside}"
    recordings = _counted(len(found.recordings), "recording")
    yield "data", f"{recordings}, {found.samples:,} samples, {found.bytes / 1e6:.3g} MB"
    loads = [point.load for point in found.points if point.load is not None]
    if loads and any(load.peak_current for load in loads):
        current = format_si(max(load.peak_current for load in loads), "A", digits=3)
        power = format_si(max(load.actuator_power for load in loads), "W", digits=3)
        energy = found.amplifier_energy
        in_all = "" if energy is None else f", {format_si(energy, 'J', digits=3)} in all"
        yield "drive", f"at most {current} peak, {power} of a linear amplifier{in_all}"
    heating = found.heating
    if heating is not None:
        yield "friction", f"{format_si(heating.frictional_heat, 'J', digits=3)} of work"
        if heating.contact_rise is not None:
            yield "contact", f"warms by {float(heating.contact_rise.max()):.3g} K at most"
        yield "actuator", f"warms by {float(heating.actuator_rise.max()):.3g} K at most"


def _counted(number: int, thing: str) -> str:
    """Number of things, in the plural where it is not 1."""
    return f"{number} {thing}{'' if number == 1 else 's'}"
