"""Every rig of examples/rigs gives by command the numbers that `reproduce` prints for it."""

import json
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytest import CaptureFixture, approx, raises
from tests.reproduced import reproduced_rows

from dong2015.chapter4 import temperature_tests
from sonolube.cli import main

RIGS = Path(__file__).parents[3] / "examples" / "rigs"
Answer = Callable[..., dict[str, Any]]

_PERCENT, _MICRO, _MM3_PER_M = 100.0, 1e6, 1e9  # from SI to the printed unit
_SINE = ("--amplitude", "per-volt")
_COMPUTED = ("--amplitude", "computed")
# rows of the cutter head are of soft layers fitted to the measurement, which no rig file holds; the others are not of D
_NO_ROW = {
    *("cutter_head", "bronze_bush", "contact_resonance", "vibrating_base"),
    *("finger_on_glass", "pom_on_steel", "webbing_on_ring"),
}


@dataclass(frozen=True, kw_only=True)
class Case:
    """A row of `reproduce` and the command that gives its number."""

    row: str
    rig: str
    command: str
    options: tuple[str, ...] = ()
    quantity: str
    factor: float = 1.0
    tolerance: float = 2e-3
    alternative: str = ""

    @property
    def name(self) -> str:
        return f"{self.rig}-{self.row}{'-' * bool(self.alternative)}{self.alternative}".replace(" ", "-")

    @property
    def chapter(self) -> int:
        """Chapter of the row: of published tests that of their set's first letter, else the first digit of its name."""
        fitted = {"A": 2, "B": 4, "G": 2, "H": 2}
        if self.row.startswith(_FITTED):
            return fitted[self.row.removeprefix(_FITTED)[0]]
        return int(re.sub(r"^table-", "", self.row)[0])


_FITTED = "friction-model-asperity-stick-slip-fitted-"


def friction(row: str, rig: str, *options: str, **more: Any) -> Case:
    """Return the case of a friction reduction."""
    return Case(
        row=row, rig=rig, command="friction", options=options, quantity="friction_reduction", factor=_PERCENT, **more
    )


def at(**settings: str) -> tuple[str, ...]:
    """Return options that replace entries of a rig file, `speed` and `voltage` by their short names."""
    keys = {"speed": "sliding.sliding_speed", "voltage": "drive.voltage_peak_to_peak"}
    return tuple(word for name, value in settings.items() for word in ("--set", f"{keys[name]}={value}"))


_FIT = ("--set", "friction.memory_length=MEMORY")  # fitted length of the row's note
_CUBE = ("--model", "dong_2015_half_period", "--load", "150N")
_RESONANCE = ("--set", "drive.frequency=24.922kHz")  # of the modes in examples/rigs/modes
_ON_COMPUTED = "asperity-stick-slip on computed motion"

CASES = (
    Case(
        row="2.3.5-wear-reduction-by-the-cube",
        rig="tribometer",
        command="wear",
        quantity="wear_reduction",
        factor=_PERCENT,
    ),
    Case(row="table-3.4-model-1", rig="tribometer", command="wear", quantity="intrinsic_wear_rate", factor=_MM3_PER_M),
    Case(row="table-3.4-model-4", rig="tribometer", command="wear", quantity="wear_rate", factor=_MM3_PER_M),
    *(
        friction(f"{_FITTED}A-{number}", rig, *_FIT, *_SINE, *at(speed=speed))
        for number, speed in ((1, "20.3mm/s"), (2, "40.6mm/s"), (3, "87mm/s"))
        for rig in ("tribometer", "tribometer_uncertain")
    ),
    *(
        friction(f"{_FITTED}A-{number}", "tribometer", *_COMPUTED, *at(speed=speed), alternative=_ON_COMPUTED)
        for number, speed in ((1, "20.3mm/s"), (2, "40.6mm/s"), (3, "87mm/s"))
    ),
    *(
        Case(
            row="3.3.4-amplitude",
            rig=rig,
            command="simulate",
            options=(*_COMPUTED, *at(voltage="28.02V")),
            quantity="vibration_amplitude",
            factor=_MICRO,
        )
        for rig in ("tribometer", "tribometer_uncertain")
    ),
    friction(f"{_FITTED}B-5", "power_map", *_FIT, *_SINE),
    friction(f"{_FITTED}B-5", "power_map", *_COMPUTED, alternative=_ON_COMPUTED),
    friction("4.1.2-reduction-highest-voltage-by-the-multi-scale-model", "power_map", *_COMPUTED, *at(speed="50mm/s")),
    *(
        Case(row="table-4.1-actuator-power-15", rig=rig, command="friction", quantity="actuator_power")
        for rig in ("power_map", "coated_plate")
    ),
    Case(row="table-4.4-actuator-power-1-to", rig="coated_temperature", command="friction", quantity="actuator_power"),
    friction("2.1.5-reduction-aluminium-horn-cube", "poisson_al_steel", *_CUBE, tolerance=1e-6),
    friction("2.1.5-reduction-steel-on-aluminium", "poisson_steel_al", *_CUBE, tolerance=1e-6),
    friction("2.1.5-reduction-steel-on-steel", "poisson_steel_steel", *_CUBE, tolerance=1e-6),
    *(
        Case(
            row=f"3.1.4-separation-{row}",
            rig="poisson_al_steel",
            command="contact",
            options=("--load", "40N", *law),
            quantity="separation",
            factor=_MICRO,
            tolerance=1e-6,
        )
        for row, law in (("elastic-plastic", ()), ("elastic", ("--set", "contact.asperity_law=elastic")))
    ),
    friction("2.2.6-reduction", "flextensional", *at(speed="3.5mm/s")),
    friction(f"{_FITTED}H-1", "flextensional", *_FIT, *at(speed="3.5mm/s")),
    Case(row="2.2.5-power-1", rig="flextensional", command="friction", quantity="actuator_power"),
    friction(f"{_FITTED}G-1", "welder_round", *_FIT),
    friction(f"{_FITTED}G-2", "welder_flat", *_FIT),
    friction("4.5.4-work-reduction", "collar"),
    # modes of another mesh, driven at their own resonance: 0.2 % below that of the row
    friction("4.5.4-reduction-to", "collar", *_COMPUTED, *_RESONANCE, "--load", "6.71N", tolerance=0.01),
    friction("4.5.4-reduction-from", "collar", *_COMPUTED, *_RESONANCE, "--load", "13.42N", tolerance=0.01),
)


@pytest.fixture
def answer(capfd: CaptureFixture[str], tmp_path: Path) -> Answer:
    """JSON answer of a command of the program, run in this process."""

    def run(command: str, rig: str, *options: str) -> dict[str, Any]:
        out = ("--out", str(tmp_path)) if command in {"simulate", "thermal"} else ()
        with raises(SystemExit) as end:
            main([command, str(RIGS / f"{rig}.toml"), *options, *out, "--json"])
        printed, refusal = capfd.readouterr()
        assert not end.value.code, refusal
        content: dict[str, Any] = json.loads(printed)
        return content

    return run


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_a_rig_gives_by_command_what_reproduce_prints(case: Case, answer: Answer) -> None:
    row = reproduced_rows(case.chapter)[case.row]
    expected = row.alternatives[case.alternative].computed if case.alternative else row.computed
    if expected is None:
        pytest.skip(f"{case.row} is not computed: {row.note}")
    fitted = re.search(r"memory_length (\S+) m", row.note)
    options = (word.replace("MEMORY", f"{fitted[1]}m" if fitted else "") for word in case.options)
    found = answer(case.command, case.rig, *options)[case.quantity]["value"]
    assert case.factor * found == approx(expected, rel=case.tolerance)


def test_every_example_rig_has_a_row() -> None:
    assert {path.stem for path in RIGS.glob("*.toml")} - _NO_ROW == {case.rig for case in CASES}


def _rise_without_vibration(answer: Answer, *, load: float, speed: float) -> float:
    """Return the rise of the coated rig after the ten seconds of the tests without vibration, by `thermal`. [K]"""
    changes = (f"contact.normal_load={load}N", f"sliding.sliding_speed={speed}m/s", "friction.friction_coefficient=0.1")
    found = answer(
        *("thermal", "coated_temperature", "--duration", "10s"),
        *(word for change in changes for word in ("--set", change)),
    )
    return float(found["temperature_rise"]["value"] / found["temperature_rise_ratio"]["value"])


def test_the_slope_of_temperature_over_speed_is_that_of_reproduce(answer: Answer) -> None:
    speeds = temperature_tests.speeds()
    slopes = [
        np.polyfit(speeds, [_rise_without_vibration(answer, load=load, speed=speed) for speed in speeds], 1)[0]
        for load in temperature_tests.loads()
    ]
    assert slopes[0] / slopes[1] == approx(reproduced_rows(4)["4.3.4-slope-ratio"].computed, rel=1e-6)


def test_the_coated_rig_warms_without_vibration_as_the_test_of_d_4_3(answer: Answer) -> None:
    dry = temperature_tests.history(
        temperature_tests.TemperatureTest(normal_load=6.0, sliding_speed=0.22, vibrated=False)
    )
    expected = np.interp(12.0, dry.time, dry.temperature_rise)  # 10 s after the start of the motor
    assert _rise_without_vibration(answer, load=6.0, speed=0.22) == approx(expected, rel=1e-3)


def test_the_warming_by_vibration_at_the_lowest_speed_is_that_of_reproduce(answer: Answer) -> None:
    ratios = []
    for volts, heat in zip(temperature_tests.voltages(), temperature_tests.vibration_heat(), strict=True):
        changes = (*at(speed="36mm/s", voltage=f"{volts}V"), "--set", "friction.friction_coefficient=0.1")
        found = answer("thermal", "coated_temperature", *changes, *_SINE, "--vibration-heat", f"{heat}W")
        ratios.append(found["temperature_rise_ratio"]["value"])
    assert 1 / min(ratios) == approx(reproduced_rows(4)["4.3.4-low-speed-warmer"].computed, rel=2e-3)


def test_the_highest_temperature_of_the_coated_rig_is_that_of_reproduce(answer: Answer) -> None:
    levels = ",".join(f"{heat}W" for heat in temperature_tests.vibration_heat())
    found = answer(
        *("thermal", "coated_temperature", "--set", "contact.normal_load=6N"),
        *(
            "--set",
            "friction.friction_coefficient=0.1",
            "--friction-ratio",
            str(temperature_tests.EXAMPLE_FRICTION_RATIO),
        ),
        *("--dry", "10s", "--duration", "30s", "--vibration-heat", levels),
    )
    reached = temperature_tests.ROOM_TEMPERATURE - 273.15 + found["temperature_rise"]["value"]
    assert reached == approx(reproduced_rows(4)["4.3.5-tribometer-temperature-peak"].computed, abs=0.01)
