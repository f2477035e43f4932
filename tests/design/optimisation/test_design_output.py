"""Charts, dataset, counts and rig file of designs made by hand."""

import tomllib
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import tomli_w
from numpy.typing import NDArray
from pytest import MonkeyPatch, approx

from sonolube.charts import Band, Bars, Line, Note, Points, Rule
from sonolube.design.optimisation import Candidate, DesignProblem, DesignSpace
from sonolube.design.optimisation.design_output import (
    _envelope,
    _front_axis,
    design_changes,
    design_counts,
    design_text,
    designs_dataset,
    frequency_chart,
    front_chart,
    limits_chart,
    power_factor_chart,
)
from sonolube.design.optimisation.drive_electronics import CAPACITANCE_TOLERANCE
from sonolube.design.optimisation.evaluation import CONSTRAINTS, LIMITS, Evaluation
from sonolube.design.optimisation.gradient_search import DesignPoint
from sonolube.design.optimisation.screening import ScreeningResult
from sonolube.models.actuator import MatchingNetwork, catalogue_actuator
from sonolube.rig import read_rig, rig_content, rig_from, structure_entries
from sonolube.rig.driven_rig import driven_rig

FILE = Path(__file__).parents[3] / "examples" / "rigs" / "tribometer.toml"
RIG = driven_rig(read_rig(FILE, changes=["vibration.amplitude_source=computed"]))
OWN, OTHER = (
    Candidate(actuator=name, waveform=waveform, entries={"tip_mass": mass})
    for name, waveform, mass in (("own", "sine", 0.1), ("nac2023", "triangle", 0.2))
)
PROBLEM = DesignProblem(
    space=DesignSpace(
        rig=RIG,
        entries=structure_entries(rig_content(FILE)),
        frequencies=(20e3, 24e3),
        ranges={"tip_mass": (0.1, 0.3)},
        actuators=("own", "nac2023"),
        catalogue={"nac2023": catalogue_actuator("nac2023")},
    ),
    friction_ratio=0.44,
)


def point(
    candidate: Candidate, frequency: float, volts: float, power: float, heat: float, **used: float
) -> DesignPoint:
    evaluation = Evaluation(
        voltage_peak_to_peak=np.array([volts]),
        objectives={"power": np.array([power]), "heat": np.array([heat]), "voltage": np.array([volts])},
        utilisation={name: np.array([used.get(name, 0.0)]) for name in CONSTRAINTS},
        quantities={"vibration_amplitude": np.array([3e-6])},
    )
    return DesignPoint(candidate=candidate, frequency=frequency, voltage_peak_to_peak=volts, evaluation=evaluation)


FIRST, SECOND = point(OWN, 21.5e3, 25.0, 5.0, 40.0), point(OTHER, 22.25e3, 60.0, 8.0, 10.0)
SCREENING = ScreeningResult(  # six designs, of which the third is out of reach and the fifth and sixth beyond limits
    candidates=(OWN, OTHER),
    candidate_index=np.array([0, 0, 0, 1, 1, 1]),
    frequency=1e3 * np.array([21.0, 22.0, 23.0, 21.5, 22.5, 23.5]),
    voltage_peak_to_peak=np.array([30.0, 26.0, np.nan, 70.0, 61.0, 62.0]),
    objectives={
        "power": np.array([7.0, 6.0, np.inf, 9.0, 8.5, 8.6]),
        "heat": np.array([50.0, 45.0, np.inf, 12.0, 11.0, 11.5]),
        "voltage": np.array([30.0, 26.0, np.inf, 70.0, 61.0, 62.0]),
    },
    utilisation={
        name: np.array({"voltage": [0.5, 0.4, np.inf, 1.0, 1.2, 1.1], "current": [0.1, 0.1, np.inf, 0.2, 1.3, 0.3]}.get(
            name, [0.0] * 6
        ))
        for name in CONSTRAINTS
    },
    refused={},
)  # fmt: skip
OPTIMUM: Any = SimpleNamespace(
    problem=PROBLEM, minimise="power", second_objective="heat", screening=SCREENING, designs=(FIRST, SECOND),
    front=(FIRST, SECOND), best=FIRST,
)  # fmt: skip


def test_designs_are_counted_by_what_rules_them_out() -> None:
    assert design_counts(OPTIMUM) == {
        "within all limits": 3,
        "target friction not reached by any voltage": 1,
        "beyond the limit on voltage of the amplifier": 2,
        "beyond the limit on current of the amplifier": 1,
    }


def test_the_front_is_drawn_over_the_feasible_designs_with_its_ends_named() -> None:
    (panel,) = front_chart(OPTIMUM).panels
    seen, line, own, other, *notes = panel.parts
    assert isinstance(seen, Points)
    assert (seen.x.tolist(), seen.y.tolist()) == ([7.0, 6.0, 9.0], [50.0, 45.0, 12.0])
    assert isinstance(line, Line)
    assert (line.x.tolist(), line.y.tolist(), line.is_stepped) == ([5.0, 8.0], [40.0, 10.0], True)
    for part, label, x, y, text in (
        (own, "own, sine", 5.0, 40.0, "21.50 kHz, 25 V"),
        (other, "nac2023, triangle", 8.0, 10.0, "22.25 kHz, 60 V"),
    ):
        assert isinstance(part, Points)
        assert (part.label, part.x.tolist(), part.y.tolist(), part.sources) == (label, [x], [y], (text,))
    assert [(part.x, part.y, part.text) for part in notes if isinstance(part, Note)] == [
        (5.0, 40.0, "21.50 kHz, 25 V"),
        (8.0, 10.0, "22.25 kHz, 60 V"),
    ]
    assert (panel.x.text, panel.y.text) == ("Power to supply [W]", "Heat in the actuator [W]")
    alone: Any = SimpleNamespace(**{**vars(OPTIMUM), "front": (FIRST,)})
    assert len([part for part in front_chart(alone).panels[0].parts if isinstance(part, Note)]) == 1


def test_an_axis_of_the_front_leaves_a_margin_and_is_logarithmic_beyond_a_factor_of_five() -> None:
    # ends of 4 and 9: a reach of 1.5, below by its root
    axis = _front_axis("power", np.array([9.0, 4.0]))
    assert axis.lowest == approx(4 / 1.5**0.5)
    assert axis.highest == approx(13.5)
    assert not axis.logarithmic
    narrow = _front_axis("heat", np.array([10.0, 10.1]))
    assert (narrow.lowest, narrow.highest) == approx((10 / 1.15**0.5, 10.1 * 1.15))
    assert _front_axis("voltage", np.array([1.0, 4.0])).logarithmic  # from 0.71 to 8


def test_each_actuator_has_a_curve_of_its_least_objective_and_its_refined_design() -> None:
    (panel,) = frequency_chart(OPTIMUM).panels
    curves = [part for part in panel.parts if isinstance(part, Line)]
    markers = [part for part in panel.parts if isinstance(part, Points)]
    assert [curve.label for curve in curves] == ["the rig's actuator, sine", "nac2023, triangle"]
    assert curves[0].x.tolist() == [21.0, 22.0]
    assert curves[0].y.tolist() == [7.0, 6.0]
    assert (curves[1].x.tolist(), curves[1].y.tolist()) == ([21.5], [9.0])
    assert [(each.x.tolist(), each.y.tolist(), each.label) for each in markers] == [
        ([21.5], [5.0], "best of each"),
        ([22.25], [8.0], ""),
    ]
    assert (panel.x.lowest, panel.x.highest, panel.y.logarithmic) == (20.0, 24.0, True)
    alone: Any = SimpleNamespace(**{**vars(OPTIMUM), "designs": (FIRST,)})
    assert next(p.label for p in frequency_chart(alone).panels[0].parts if isinstance(p, Points)) == "best"


def test_the_least_of_each_of_sixty_bands_is_drawn() -> None:
    f = np.array([0.0, 0.5, 0.9, 1.1, 59.5, 60.0])
    assert [each.tolist() for each in _envelope(f, np.array([3.0, 1.0, 2.0, 5.0, 4.0, 7.0]))] == [
        [0.5, 1.1, 59.5],
        [1.0, 5.0, 4.0],
    ]


def test_limits_are_drawn_as_bars_by_their_share_the_unused_left_out() -> None:
    chart = limits_chart(point(OWN, 22e3, 25.0, 5.0, 40.0, voltage=0.5, tension=0.9, current=0.1234))
    (panel,) = chart.panels
    bars, rule = panel.parts
    assert isinstance(bars, Bars)
    assert isinstance(rule, Rule)
    assert panel.y.words == tuple(LIMITS[name] for name in ("current", "voltage", "tension"))
    assert bars.lengths == approx([12.34, 50.0, 90.0])
    assert bars.texts == ("12.3 %", "50 %", "90 %")
    assert bars.places.tolist() == [0.0, 1.0, 2.0]
    assert (rule.value, panel.x.lowest) == (100.0, 0.0)


def test_the_dataset_has_a_row_for_every_design() -> None:
    found = designs_dataset(OPTIMUM)
    assert found.sizes["design"] == 6
    assert found["frequency"].values.tolist() == SCREENING.frequency.tolist()
    assert found["power_to_supply"].values.tolist() == SCREENING.objectives["power"].tolist()
    assert found["heat_rate"].values.tolist() == SCREENING.objectives["heat"].tolist()
    assert found["tip_mass"].values.tolist() == [0.1] * 3 + [0.2] * 3
    assert found["actuator"].values.tolist() == ["own"] * 3 + ["nac2023"] * 3
    assert found["waveform"].values.tolist() == ["sine"] * 3 + ["triangle"] * 3
    assert found["used_voltage"].values.tolist() == SCREENING.utilisation["voltage"].tolist()
    assert found["feasible"].values.tolist() == [1, 1, 0, 1, 0, 0]
    assert found.attrs["title"].startswith("Designs for a friction ratio of 0.44, Modified pin-on-disc")
    assert found["frequency"].attrs["units"] == "Hz"


@pytest.mark.parametrize("chosen", [FIRST, SECOND], ids=["own", "catalogue"])
def test_the_file_of_a_design_is_read_as_its_rig(chosen: DesignPoint) -> None:
    content = rig_content(FILE)
    text = design_text("#:schema ../rig.json\n" + FILE.read_text(encoding="utf-8"), content, PROBLEM, chosen)
    assert "#:schema" not in text
    rig = driven_rig(rig_from(found := tomllib.loads(text)))
    assert rig.drive.frequency == approx(chosen.frequency)
    assert rig.drive.voltage_peak_to_peak == approx(chosen.voltage_peak_to_peak)
    assert rig.drive.voltage_offset == approx(chosen.voltage_peak_to_peak / 2)
    assert rig.drive.waveform == chosen.candidate.waveform
    assert found["structure"]["tip_mass"] == f"{chosen.candidate.entries['tip_mass']!r} kg"
    assert found["structure"]["reaction_mass"] == "2.41 kg"
    assert rig.amplitude_per_volt == approx(3e-6 / chosen.voltage_peak_to_peak)
    assert (rig.amplitude_source, rig.vibration_amplitude) == ("computed", None)
    assert rig.capacitance == approx(rig.stack.free_capacitance)
    assert rig.assumptions["drive"] == "optimised for a friction ratio of 0.44"
    assert rig.assumptions["actuator.amplitude_per_volt"] == "computed at this drive"
    assert not any(key.startswith("vibration.") for key in rig.assumptions)
    if chosen is FIRST:
        assert rig.stack.free_stroke_per_volt == approx(8.68e-9)
        assert "stack" not in rig.assumptions
    else:
        assert rig.assumptions["stack"].endswith("by its data sheet; quality factor 80 assumed for its ceramic")
        assert rig.stack.free_stroke_per_volt != approx(8.68e-9, rel=0.01)
    assert rig.normal_load == 3.0


def test_the_changes_of_a_design_are_its_entries_with_units() -> None:
    content = rig_content(FILE)
    own = design_changes(content, PROBLEM, FIRST)
    assert own == {
        "drive.frequency": "21.5 kHz",
        "drive.voltage_peak_to_peak": "25 V",
        "drive.voltage_offset": "12.5 V",
        "drive.waveform": "sine",
        "structure.tip_mass": "100 g",
        "vibration.amplitude_source": "computed",
        "actuator.amplitude_per_volt": "120 nm/V",
    }
    other = design_changes(content, PROBLEM, SECOND)
    assert {key for key in other if key.startswith("stack.")} >= {"stack.free_capacitance", "stack.stack_stiffness"}
    assert "stack.coupling_factor" not in other
    assert other["actuator.capacitance"] == other["stack.free_capacitance"]
    assert other["actuator.amplitude_per_volt"] == "50 nm/V"
    bare = {name: table for name, table in content.items() if name != "actuator"}
    assert not [key for key in design_changes(bare, PROBLEM, SECOND) if key.startswith("actuator.")]
    coupled = {**content, "stack": {**content["stack"], "coupling_factor": 0.6}}
    assert "stack.coupling_factor" in design_changes(coupled, PROBLEM, SECOND)
    assert "stack.coupling_factor" not in design_changes(coupled, PROBLEM, FIRST)


def test_a_file_without_an_actuator_or_a_vibration_gets_none() -> None:
    content = {name: table for name, table in rig_content(FILE).items() if name not in ("actuator", "vibration")}
    content["assumptions"] = {}
    text = design_text(tomli_w.dumps(content), content, PROBLEM, FIRST)
    found = tomllib.loads(text)
    assert "actuator" not in found
    assert "vibration" not in found
    assert found["assumptions"] == {"drive": "optimised for a friction ratio of 0.44"}
    assert found["drive"]["frequency"] == "21500.0 Hz"


def admittance(frequency: NDArray[np.float64], change: float = 0.0) -> NDArray[np.complex128]:
    """Of a capacitor of 100 nF, off by a share of it, beside 50 ohm."""
    return np.asarray(1 / 50 + 2j * np.pi * frequency * 100e-9 * (1 + change))


def test_the_power_factor_about_the_drive_is_that_of_the_stack_alone_and_behind_each_network(
    monkeypatch: MonkeyPatch,
) -> None:
    monkeypatch.setattr(
        "sonolube.design.optimisation.design_output.stack_admittance",
        lambda rig, *, frequency, capacitance_change=0.0: admittance(frequency, capacitance_change),
    )
    coil = 1 / ((2 * np.pi * FIRST.frequency) ** 2 * 100e-9)
    networks = tuple(
        SimpleNamespace(network=MatchingNetwork(shunt_inductance=factor * coil), name=name)
        for factor, name in ((1.0, "coil"), (2.0, "half"))
    )
    electric: Any = SimpleNamespace(networks=networks)
    (panel,) = power_factor_chart(OPTIMUM, electric).panels
    bare, coil_line, half_line = (part for part in panel.parts if isinstance(part, Line))
    coil_band, half_band = (part for part in panel.parts if isinstance(part, Band))
    drive = panel.parts[-1]
    f = np.linspace(0.85, 1.15, 401) * FIRST.frequency
    assert bare.x == approx(1e-3 * f)
    assert bare.y == approx(admittance(f).real / np.abs(admittance(f)))
    assert bare.dash == 3

    def behind(inductance: float, change: float = 0.0) -> NDArray[np.float64]:
        whole = admittance(f, change) + 1 / (2j * np.pi * f * inductance)
        return np.asarray(whole.real / np.abs(whole))

    assert coil_line.y == approx(behind(coil))
    assert coil_line.y[200] == approx(1.0)  # the coil compensates the capacitor at the drive
    assert half_line.y == approx(behind(2 * coil))
    ends = [behind(coil, change) for change in np.linspace(-CAPACITANCE_TOLERANCE, CAPACITANCE_TOLERANCE, 9)]
    assert coil_band.low == approx(np.min(ends, axis=0))
    assert coil_band.high == approx(np.max(ends, axis=0))
    assert (coil_band.label, half_band.label) == (f"capacitance off by up to {100 * CAPACITANCE_TOLERANCE:.0f} %", "")
    assert [(part.colour, part.dash) for part in (coil_line, half_line)] == [(0, 0), (1, 1)]
    assert isinstance(drive, Rule)
    assert drive.value == approx(21.5)
    assert (panel.x.lowest, panel.x.highest) == approx((0.85 * 21.5, 1.15 * 21.5))
    assert (panel.y.lowest, panel.y.highest) == approx((0.0, 1.02))
