"""Section 4.3: temperatures of the vibrated contact and of the welder's waveguide."""

from collections.abc import Iterator

import numpy as np

from sonolube.checks import Floats
from sonolube.materials import material
from sonolube.published.values import stated
from sonolube.reproduce.chapter4.temperature_tests import (
    ASSUMED,
    FRICTION_KEPT,
    POWDER_COATING,
    ROOM_TEMPERATURE,
    TemperatureTest,
    dry_heat,
    example_heat,
    heated_contact,
    history,
    loads,
    slow_friction_kept,
    speeds,
    vibration_heat,
    vibration_heat_fraction,
    vibration_heat_window,
    voltages,
)
from sonolube.reproduce.row import Row, compare
from sonolube.thermal import (
    adiabatic_heat_rate,
    flash_rise,
    half_wave_bar_energy,
    interface_conductance,
    layer_conductance,
    superimposed_heat_rate,
    vibration_loss_heat_rate,
)
from sonolube.validation.inputs import named, said
from sonolube.validation.power_map import printed

_KEPT_NOTE = (
    f"Friction held at {FRICTION_KEPT:g} of its dry value at every voltage: the text has it fall further beyond 10.3 "
    "V, "
    "by how much is only drawn (Fig. 4.33), and that could only cool"
)
_CERAMIC = "pic255"  # soft, as stacks have; D does not print which


def thermal_rows() -> Iterator[Row]:
    """Yield the rows of section 4.3."""
    yield _slopes()
    yield from _example_by_superimposed_speed()
    yield from _example_by_vibration_heat()
    yield _low_speed()
    yield _tribometer_peak()
    yield _waveguide_peak()
    yield _foil_peak()


def _slopes() -> Row:
    rises = np.array([[_at_vibration_start(load, speed) for speed in speeds()] for load in loads()])
    low, high = (float(np.polyfit(speeds(), rise, 1)[0]) for rise in rises)
    per_speed = rises[0] / speeds()
    note = (
        f"Least-squares slopes of the rise at 12 s without vibration. Heat of friction goes with the load; a rise per "
        f"speed that falls by {100 * (1 - per_speed[-1] / per_speed[0]):.0f} % from the lowest to the highest speed "
        f"passes for a straight line. {ASSUMED}."
    )
    return compare(stated("4.3.4-slope-ratio"), low / high, note)


def _at_vibration_start(load: float, speed: float) -> float:
    record = history(TemperatureTest(normal_load=load, sliding_speed=speed, vibrated=False))
    return float(np.interp(said("4.3.3-vibration-start").value, record.time, record.temperature_rise))


def _example_by_superimposed_speed() -> Iterator[Row]:
    speed = said("4.3.4-example-speed").value
    peaks = np.array([peak.value for peak in printed("4.4", "vibration_velocity").values()])
    heat = superimposed_heat_rate(friction_force=FRICTION_KEPT, sliding_speed=speed, vibration_velocity=peaks)
    note = f"D's own picture: heat goes with friction times superimposed speed of Table 4.5. {_KEPT_NOTE}"
    yield from _example(heat / speed, "by-superimposed-speed", note)


def _example_by_vibration_heat() -> Iterator[Row]:
    low, high = vibration_heat_window()
    note = (
        f"Heat of friction and a share of the actuator's power (D 1.9) in the contact. The share is not printed: these "
        f"four statements leave {1e2 * low:.2f} to {1e2 * high:.2f} %, and {1e2 * vibration_heat_fraction():.2f} %, "
        f"their geometric mean, is taken, so that the rows show that there is one, not which. {_KEPT_NOTE}; a fall by "
        f"more than {100 * (1 - FRICTION_KEPT) * high / low:.0f} % at 20.7 V would leave none. A stack "
        f"of {_CERAMIC} would lose {100 * np.pi / 4 * _loss_tangent():.1f} % of that power in its ceramic"
    )
    yield from _example(FRICTION_KEPT + vibration_heat() / example_heat(), "by-vibration-heat", note)


def _loss_tangent() -> float:
    return material(_CERAMIC).value("loss_tangent")


def _example(ratios: Floats, suffix: str, note: str) -> Iterator[Row]:
    for voltage, ratio in zip(voltages(), ratios, strict=True):
        if voltage < 15:
            yield compare(named(stated(f"4.3.4-example-cooler-{voltage:g}V"), suffix), float(ratio), note)
        elif voltage > 20:
            yield compare(named(stated(f"4.3.4-example-warmer-{voltage:g}V"), suffix), float(1 / ratio), note)


def _low_speed() -> Row:
    slowest = float(speeds()[0])
    ratios = slow_friction_kept() + vibration_heat() / dry_heat(normal_load=float(loads()[0]), sliding_speed=slowest)
    listed = ", ".join(f"{ratio:.2f}" for ratio in ratios)
    note = (
        f"At {1e3 * slowest:g} mm/s and 26 MPa, the voltage that warms least. Friction by the stick-slip closure, "
        "heat of "
        "vibration by the share that the example at 220 mm/s leaves; rises with vibration over those without, from "
        "5.1 "
        f"to 25.9 V: {listed}"
    )
    return compare(stated("4.3.4-low-speed-warmer"), float(np.max(1 / ratios)), note)


def _tribometer_peak() -> Row:
    load, speed = float(loads()[-1]), float(speeds()[-1])
    record = history(TemperatureTest(normal_load=load, sliding_speed=speed))
    peak = ROOM_TEMPERATURE + float(record.temperature_rise.max())
    contact = heated_contact()
    flux = record.heat_rate.max() / contact.source.area
    alone = flash_rise(POWDER_COATING, contact.source, heat_flux=flux, sliding_speed=speed).mean_temperature_rise
    note = (
        f"Highest of the computed tests, 52 MPa, 220 mm/s and 25.9 V, {1e3 * record.heat_rate.max():.0f} mW of heat of "
        f"which {100 * record.heat_partition[record.heat_rate.argmax()]:.0f} % enter the pin. {ASSUMED}. If the "
        f"thermocouple's adhesive let nothing through, the coating alone would give "
        f"{ROOM_TEMPERATURE - 273.15 + float(alone):.0f} degC: the measured peak lies between, "
        "and the bond of the thermocouple decides"
    )
    return compare(stated("4.3.5-tribometer-temperature-peak"), peak, note)


def _waveguide_peak() -> Row:
    aluminium = material("aluminium_2024")
    length, width, thickness = (said(f"2.1.2-waveguide-{side}").value for side in ("length", "width", "thickness"))
    volume, density = length * width * thickness, aluminium.value("density")
    capacity = volume * density * aluminium.value("specific_heat_capacity")
    first, peak = (said(f"4.3.5-temperature-{state}").value for state in ("first", "peak"))
    duration = said("4.3.5-vibration-duration").value
    needed = float(adiabatic_heat_rate(heat_capacity=capacity, temperature_rise=peak - first, duration=duration))
    power = said("2.1.2-welder-power").value
    energy = half_wave_bar_energy(
        density=density,
        cross_section=width * thickness,
        length=length,
        frequency=said("2.1.2-welder-frequency").value,
        axial_amplitude=said("4.3.5-waveguide-amplitude").value,
    )
    at_one = vibration_loss_heat_rate(
        stored_energy=energy, frequency=said("2.1.2-welder-frequency").value, quality_factor=1.0
    )
    note = (
        f"The aluminium waveguide of section 2.1 warmed evenly, without loss, by all {1e-3 * power:g} kW of the "
        "welder. "
        f"To reach the printed peak it would take {1e-3 * needed:.1f} kW, a quality factor of "
        f"{float(at_one) / needed:.0f} "
        f"where metals have a thousand and more, which warms it by less than "
        f"{float(at_one) / 1000 * duration / capacity:.1f} K. So the waveguide did not reach that temperature: what "
        "did "
        "is the thermocouple that rubs on it, as the text has it"
    )
    return compare(stated("4.3.5-temperature-peak"), first + power * duration / capacity, note)


def _foil_peak() -> Row:
    first, peak = (said(f"4.3.5-temperature-{state}").value for state in ("first", "peak"))
    sheltered = said("4.3.5-foil-temperature-peak").value
    foil = float(
        layer_conductance(
            thermal_conductivity=material("aluminium_2024").value("thermal_conductivity"),
            thickness=said("4.3.5-foil-thickness").value,
        )
    )
    onward = 100.0  # W/(m2 K), tape and air
    joint = float(
        interface_conductance(
            temperature_rise=peak - first, rise_behind_interface=sheltered - first, convection_coefficient=onward
        )
    )
    behind = first + (peak - first) * foil / (foil + onward)
    note = (
        f"Through the foil alone, {1e-3 * foil:.0f} kW/(m2 K) with the conductivity of 2024, from the printed peak; "
        "the "
        "thermocouple loses 100 W/(m2 K) onwards, assumed and generous. The foil's thickness takes next to nothing "
        "off: "
        f"the printed {sheltered - 273.15:.0f} degC ask for a joint of {joint / onward:.2f} times what the "
        "thermocouple "
        "loses onwards, the foil's spreading of the heat included"
    )
    return compare(stated("4.3.5-foil-temperature-peak"), behind, note)
