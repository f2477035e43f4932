"""Optimum of a design in words: target, drive, tightest limit, amplifier, networks, and values at ends of ranges."""

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from pytest import MonkeyPatch, approx

from sonolube.design.optimisation import OBJECTIVES, OWN_ACTUATOR
from sonolube.design.optimisation.evaluation import LIMITS
from sonolube.models.actuator import MatchingNetwork
from sonolube.report.results.design import optimum as results


@dataclass
class Amplifier:
    voltage_maximum: float = 20.0
    peak_current: float = 0.5
    apparent_power: float = 4.0
    slew_rate: float = 2.5e6
    power_factor: float = 0.123


def point(
    *, actuator: str = "sa050510", power: float = 6.25, heat: float = 1.5, tension: float = 0.4, **used: float
) -> Any:
    utilisation = {name: np.array([used.get(name, 0.0)]) for name in LIMITS} | {"tension": np.array([tension])}
    utilisation["admissible_vibration"] = np.array([9.0])  # a condition, no limit
    return SimpleNamespace(
        candidate=SimpleNamespace(
            actuator=actuator, waveform="sine", entries={"tip_mass": 0.05, "static_stiffness": 2e6}
        ),
        frequency=22e3,
        voltage_peak_to_peak=28.125,
        objective=lambda name: {"power": power, "heat": heat, "voltage": 14.0}[name],
        evaluation=SimpleNamespace(
            quantities={
                "vibration_amplitude": np.array([2.5e-6]),
                "peak_current": np.array([0.5]),
                "charging_power": np.array([power]),
                "dissipated_power": np.array([heat - 0.25]),
            },
            utilisation=utilisation,
        ),
    )  # fmt: skip


NETWORK: Any = SimpleNamespace(
    name="L network", network=MatchingNetwork(series_inductance=2e-3, shunt_capacitance=1.5e-9), band=(21.5e3, 22.75e3),
    detuned_power_factor=0.456, voltage_gain=3.21,
)  # fmt: skip
ELECTRIC: Any = SimpleNamespace(amplifier=Amplifier(), networks=(NETWORK,))


def optimum(best: Any, *, tolerance: Any = None, front: tuple[Any, ...] = (), bounds: Any = None) -> Any:
    rig = SimpleNamespace(title="Own rig", friction_coefficient=0.2, friction_model=SimpleNamespace(name="kinematic"))
    space = SimpleNamespace(
        rig=rig,
        catalogue={"sa050510": SimpleNamespace(title="Small stack")},
        bounds=bounds or {"frequency": (18e3, 26e3), "tip_mass": (0.01, 0.1)},
    )
    screening = SimpleNamespace(
        feasible=np.array([True, False, True]), frequency=np.zeros(5), refused={"x": "no sheet"}
    )
    return SimpleNamespace(
        best=best, designs=(best, point(actuator="other")), front=front, minimise="power", second_objective="heat",
        problem=SimpleNamespace(space=space, friction_ratio=0.75, tolerance=tolerance), screening=screening,
    )  # fmt: skip


def test_the_facts_of_an_optimum_have_units_and_digits_of_a_drive() -> None:
    assert dict(results.facts(optimum(point(current=0.654)), ELECTRIC)) == {
        "target friction": "coefficient 0.15, ratio 0.75",  # 0.75 of 0.2
        "actuator": "Small stack",
        "drive": "28.12 V peak to peak, 22 kHz, sine",
        "tip mass": "50 g",
        "static stiffness": "2 MN/m",
        "amplitude": "2.5 um",
        "power to supply": "6.25 W",
        "of which": "the larger of 6.25 W, charge of the capacitance (D 1.9), and 1.25 W, heat of the motion",
        "heat in actuator": "1.5 W, the dielectric loss included",
        "tightest limit": "current of the amplifier, 65.4 %",
        "amplifier": "20 V, 500 mA peak, 4 VA, 2.5 V/us, power factor 0.123",
        "L network": "2 mH in the line, 1.5 nF across it; power factor above 0.9 from 21.5 to 22.75 kHz,"
        " at least 0.46 with the capacitance off by 20 %; voltage gain 3.21",
        "designs": "2 of 5 within all limits",
    }


@pytest.mark.parametrize(
    ("quantile", "text"),
    [(None, ", at every corner of 5 %"), (0.95, ", by 95 % of rigs with a standard deviation of 5 %")],
)
def test_the_target_is_reached_under_deviations(quantile: float | None, text: str) -> None:
    tolerance = SimpleNamespace(manufacturing_tolerance=0.05, quantile=quantile)
    found = dict(results.facts(optimum(point(actuator=OWN_ACTUATOR), tolerance=tolerance), ELECTRIC))
    assert found["target friction"] == f"coefficient 0.15, ratio 0.75{text}"
    assert found["actuator"] == "the rig's own"


def test_the_tightest_limit_is_the_one_of_which_most_is_used() -> None:
    assert results.tightest_limit(point(tension=0.25, current=0.2)) == f"{LIMITS['tension']}, 25 %"
    assert results.tightest_limit(point(tension=0.0)) == "none set"


def test_designs_are_those_of_the_front_where_there_is_one() -> None:
    heads, rows = results.designs_table(optimum(point(current=0.654)))
    assert heads == [
        "actuator", "waveform", "f [kHz]", "U_pp [V]", "tip_mass [SI]", "static_stiffness [SI]", "power [W]",
        "heat [W]", "tightest limit",
    ]  # fmt: skip
    assert rows[0] == (
        "sa050510", "sine", "22.000", "28.12", "0.05", "2e+06", "6.25", "1.5", "current of the amplifier, 65.4 %",
    )  # fmt: skip
    assert [row[0] for row in rows] == ["sa050510", "other"]
    assert [row[0] for row in results.designs_table(optimum(point(), front=(point(actuator="front"),)))[1]] == ["front"]


END = "a better design may lie beyond"


@pytest.mark.parametrize(
    ("bounds", "found"),
    [
        # a relative distance of 0.0018 is at the end, of 0.0022 is not
        ({"frequency": (22e3 * 1.0018, 30e3)}, [f"frequency lies at the lowest value allowed: {END}"]),
        ({"frequency": (22e3 * 0.9982, 30e3)}, [f"frequency lies at the lowest value allowed: {END}"]),
        ({"frequency": (22e3 * 0.9978, 22e3 * 1.0022)}, []),
        ({"tip_mass": (0.01, 0.05)}, [f"tip_mass lies at the highest value allowed: {END}"]),
    ],
)
def test_a_value_at_the_end_of_its_range_is_a_caveat(bounds: dict[str, tuple[float, float]], found: list[str]) -> None:
    assert results.optimum_caveats(optimum(point(), bounds=bounds)) == found


def test_a_tension_that_is_not_judged_is_a_caveat() -> None:
    (loose,) = results.optimum_caveats(optimum(point(power=1.5, heat=1.5, tension=0.0)))
    assert loose == "no preload is given, so that tension in the stack is not judged: give bolt and preload"
    assert results.optimum_caveats(optimum(point(power=1.5, heat=1.5))) == []


def test_an_optimum_in_json_has_designs_front_amplifier_and_networks(monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(
        results, "design_changes", lambda content, problem, each: {"of": f"{content['a']} {each.candidate.actuator}"}
    )
    found = results.optimum_object(
        optimum(point(current=0.654), front=(point(actuator="front"),)), ELECTRIC, content={"a": "file"}
    )
    assert (found["minimise"], found["pareto"], found["screened"], found["feasible"]) == ("power", "heat", 5, 2)
    assert found["friction_ratio"] == {"value": 0.75, "unit": ""}
    assert [each["changes"]["of"] for each in found["designs"]] == ["file sa050510", "file other"]
    assert [each["actuator"] for each in found["front"]] == ["front"]
    first = found["designs"][0]
    assert first["frequency"] == {"value": 22e3, "unit": "Hz"}
    assert first["voltage_peak_to_peak"]["value"] == approx(28.125)
    assert first["tip_mass"] == {"value": 0.05, "unit": "kg"}
    assert first["vibration_amplitude"] == {"value": 2.5e-6, "unit": "m"}
    for name in ("charging_power", "actuator_power"):
        assert first[name] == {"value": 6.25, "unit": "W"}
    assert "horn_stress" not in first
    assert first["objectives"] == {"power": 6.25, "heat": 1.5, "voltage": 14.0}
    assert set(first["objectives"]) == set(OBJECTIVES)
    assert set(first["limits_used"]) == set(LIMITS)
    assert first["limits_used"]["current"] == approx(0.654)
    assert found["amplifier"]["apparent_power"] == {"value": 4.0, "unit": "W"}
    assert found["networks"] == [
        {"name": "L network", "series_inductance": {"value": 2e-3, "unit": "H"},
         "shunt_capacitance": {"value": 1.5e-9, "unit": "F"},
         "lowest_frequency": {"value": 21.5e3, "unit": "Hz"}, "highest_frequency": {"value": 22.75e3, "unit": "Hz"},
         "detuned_power_factor": 0.456, "voltage_gain": 3.21}
    ]  # fmt: skip
    assert found["refused"] == {"x": "no sheet"}
