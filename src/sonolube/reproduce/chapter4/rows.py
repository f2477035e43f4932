"""Chapter 4, applications: power and efficiency, sliding over the vibration, skin replica and collar."""

from collections.abc import Iterator

import numpy as np
from scipy.constants import epsilon_0

from sonolube.figure import ReportFigure
from sonolube.metrics import peak_vibration_velocity, superimposed_speed
from sonolube.published.values import cell, over_rounding, stated
from sonolube.reproduce.chapter3.study_figures import load_figures
from sonolube.reproduce.chapter4.collar_figures import collar_figures
from sonolube.reproduce.chapter4.collar_rows import collar_rows
from sonolube.reproduce.chapter4.cutter import cutter_rows
from sonolube.reproduce.chapter4.figures import application_figures
from sonolube.reproduce.chapter4.load import load_rows
from sonolube.reproduce.chapter4.maps import map_figures, map_rows
from sonolube.reproduce.chapter4.power import amplitudes, power_map_rows, power_row, reduction_by_the_line, stresses
from sonolube.reproduce.chapter4.regimes import regime_figures, regime_rows
from sonolube.reproduce.chapter4.thermal import thermal_rows
from sonolube.reproduce.chapter4.thermal_figures import thermal_figures
from sonolube.reproduce.row import Row, compare, undetermined
from sonolube.validation.inputs import friction_drop, published_ends, said
from sonolube.validation.power_map import example_points, printed

__all__ = ["figures", "rows"]


def figures() -> tuple[ReportFigure, ...]:
    """Return the figures of chapter 4."""
    return (
        *map_figures(),
        *load_figures(),
        *regime_figures(),
        *thermal_figures(),
        *application_figures(),
        *collar_figures(),
    )


def rows() -> tuple[Row, ...]:
    """Return the rows of chapter 4."""
    return (
        *power_map_rows(),
        *map_rows(),
        *load_rows(),
        *_lubrication_settings(),
        *regime_rows(),
        *_temperature_settings(),
        *_superimposed_speeds(),
        _raised_speed(),
        *_speed_rises(),
        _example_reduction(),
        *thermal_rows(),
        *_skin_replica(),
        *cutter_rows(),
        *_collar_stack(),
        *collar_rows(),
        *(undetermined(stated(name), missing) for name, missing in _MISSING.items()),
    )


_COATED = "friction forces on coated plates, only drawn (Fig. 4.33); printed as forces, meant as coefficients (E18)"
_MISSING = {
    "4.1.3-friction-coated-first": _COATED,
    "4.1.3-friction-coated-last": _COATED,
}


def _lubrication_settings() -> Iterator[Row]:
    yield from stresses("4.3")
    yield power_row(cell("4.3", "actuator_power", 0), printed("4.3", "voltage_peak_to_peak")[0].value)


def _temperature_settings() -> Iterator[Row]:
    yield from stresses("4.4")
    yield from amplitudes("4.4")
    frequency = printed("4.4", "frequency")[0].value
    for row, amplitude in printed("4.4", "vibration_amplitude").items():
        peak = over_rounding(
            lambda a: float(peak_vibration_velocity(frequency=frequency, vibration_amplitude=a)), amplitude
        )
        yield compare(cell("4.4", "vibration_velocity", row), peak, f"2 pi f a with {amplitude.text} um")
    voltages = printed("4.4", "voltage_peak_to_peak")
    yield power_row(published_ends(cell("4.4", "actuator_power", 0))[1], voltages[max(voltages)].value)

    dry = said("4.3.3-motor-start").value + said("4.3.3-dry-duration").value
    yield compare(stated("4.3.3-vibration-start"), dry, "start of the motor and rotation without vibration")
    levels, level, cooling = len(voltages), said("4.3.3-level-duration").value, said("4.3.3-cooling-duration").value
    note = f"start of the vibration, {levels} levels of {level:g} s and {cooling:g} s of cooling"
    yield compare(stated("4.3.3-duration"), dry + levels * level + cooling, note)


def _superimposed_speeds() -> Iterator[Row]:
    """Yield the cells of Table 4.5 under vibration; each mean vibration velocity once."""
    speeds, peaks = printed("4.5", "sliding_speed"), printed("4.5", "vibration_velocity")
    for row, peak in peaks.items():
        if peak.value == 0:
            continue
        if speeds[row] == speeds[0]:
            mean = over_rounding(lambda v_1: v_1 / np.pi, peak)
            note = f"peak over pi, the half-wave mean; the mean of the modulus would be {2 * mean.value * 1e3:.0f} mm/s"
            yield compare(cell("4.5", "mean_vibration_velocity", row), mean, note)
        note = f"sqrt(v_r^2 + (v_1/pi)^2) with {speeds[row].text} and {peak.text} mm/s"
        yield compare(cell("4.5", "superimposed_speed", row), over_rounding(_superimposed, speeds[row], peak), note)


def _superimposed(sliding_speed: float, vibration_velocity: float) -> float:
    return float(superimposed_speed(sliding_speed=sliding_speed, vibration_velocity=vibration_velocity))


def _raised_speed() -> Row:
    slowest, second, *_ = printed("4.4", "sliding_speed").values()
    *_, peak = printed("4.4", "vibration_velocity").values()
    note = (
        f"as Table 4.5 at {second.text} mm/s and the highest voltage; at {slowest.text} mm/s"
        f" {_superimposed(slowest.value, peak.value) * 1e3:.0f} mm/s; the peak velocity itself is {peak.text} mm/s"
    )
    return compare(stated("4.3.4-raised-speed"), over_rounding(_superimposed, second, peak), note)


def _speed_rises() -> Iterator[Row]:
    example, speeds = said("4.3.4-example-speed").value, printed("4.5", "sliding_speed")
    rows = [row for row, speed in speeds.items() if speed.value == example]
    raised, peaks = printed("4.5", "superimposed_speed"), printed("4.5", "vibration_velocity")
    for name, row in (("low", rows[2]), ("high", rows[-1])):
        rise = over_rounding(lambda after, before: after - before, raised[row], raised[rows[0]])
        unrounded = _superimposed(example, peaks[row].value) - example
        note = f"{raised[row].text} less {raised[rows[0]].text} mm/s of Table 4.5; unrounded {unrounded * 1e3:.1f} mm/s"
        yield compare(stated(f"4.3.4-example-speed-rise-{name}"), rise, note)


def _example_reduction() -> Row:
    """Return the row of the reduction at 10.3 V, where the efficiency line has almost fallen to zero."""
    load = printed("4.4", "normal_load")[0].value
    example = {
        "intrinsic_friction_force": said("4.1.3-friction-coated-last").value * load,  # a coefficient: erratum E18
        "sliding_speed": said("4.3.4-example-speed").value,
        "nominal_area": printed("4.4", "nominal_area")[0].value,
        "normal_load": load,
    }
    return reduction_by_the_line(stated("4.3.4-example-reduction"), example, example_points()[1].actuator_power)


def _skin_replica() -> Iterator[Row]:
    with_vibration = []
    for load in printed("4.6", "normal_load").values():
        off, on = (said(f"4.4.3-friction-{state}-{load.text}N") for state in ("off", "on"))
        with_vibration.append(on.value / load.value)
        for state, friction in (("off", off), ("on", on)):
            coefficient = over_rounding(lambda force, load=load.value: force / load, friction)
            note = f"{friction.text} N over {load.text} N, the load taken as exact"
            yield compare(stated(f"4.4.3-coefficient-{state}-{load.text}N"), coefficient, note)
        reduction = over_rounding(friction_drop, off, on)
        yield compare(stated(f"4.4.3-reduction-{load.text}N"), reduction, f"D 2.1 from {off.text} N and {on.text} N")
    mean = float(np.mean(with_vibration))
    yield compare(stated("4.4.3-coefficient-on"), mean, "mean over the three loads of force over load")

    lowest, *higher = (load.value for load in printed("4.6", "normal_load").values())
    heads = said("4.4.2-total-load-6").value / lowest
    for total, each in zip(("9", "12"), higher, strict=True):
        yield compare(stated(f"4.4.2-total-load-{total}"), heads * each, f"{each:g} N on each of {heads:g} heads")


def _collar_stack() -> Iterator[Row]:
    modulus, permittivity = _stack_modulus(), _stack_permittivity()
    factor, charge_constant = cell("4.7", "coupling_factor", 0), printed("4.7", "charge_constant_33")[0].value
    needed = factor.number.value**2 * permittivity / charge_constant**2
    note = (
        f"d33 sqrt(E/eps) with E = k_p L/A = {modulus * 1e-9:.3g} GPa, as of ceramic alone; the printed factor"
        f" needs {needed * 1e-9:.3g} GPa; end pieces and glue, which soften a stack, would account for the difference"
    )
    yield compare(factor, charge_constant * float(np.sqrt(modulus / permittivity)), note)
    capacitance = cell("4.7", "capacitance", 0)
    of_one_layer = permittivity * _stack_area() / printed("4.7", "length")[0].value
    layers = np.sqrt(capacitance.number.value / of_one_layer)
    missing = f"number of layers; C = N^2 eps A/L, ceramic over the whole length, would take {layers:.1f} of them"
    yield undetermined(capacitance, missing)


def _stack_modulus() -> float:
    """Return Young's modulus of the collar's stack from its stiffness. [Pa]"""
    return printed("4.7", "stack_stiffness")[0].value * printed("4.7", "length")[0].value / _stack_area()


def _stack_permittivity() -> float:
    """Return the permittivity of the collar's stack. [F/m]"""
    return printed("4.7", "relative_permittivity")[0].value * float(epsilon_0)


def _stack_area() -> float:
    """Return the cross section of the collar's stack. [m2]"""
    outer, inner = (printed("4.7", f"{side}_diameter")[0].value for side in ("outer", "inner"))
    return float(np.pi / 4 * (outer**2 - inner**2))
