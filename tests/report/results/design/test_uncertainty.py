"""Uncertainty of an outcome in words: intervals, quantiles, ranking in percent, and how the draws have converged."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import xarray as xr
from pytest import MonkeyPatch, approx

from sonolube.design import IntervalEstimate
from sonolube.design.uncertainty_summary import Band, BandPlace, RankedEntry
from sonolube.report.blocks import Rows, Table
from sonolube.report.results.design import uncertainty as results


def estimate(value: float, lower: float, upper: float) -> IntervalEstimate:
    return IntervalEstimate(value=value, lower=lower, upper=upper)


def structure(*, has_converged: bool = True) -> Any:
    """Draws of a mass from 40 to 60 g, and of a stiffness that no fact settles."""
    draws = {"tip_mass": np.linspace(0.04, 0.06, 201), "stack_stiffness": np.linspace(1e9, 3e9, 201)}
    directions = (SimpleNamespace(exponents={"tip_mass": 1.5, "stack_stiffness": -0.75, "tip_damping": 0.1}),)
    posterior = SimpleNamespace(
        unidentified=("stack_stiffness",), has_converged=has_converged, potential_scale_reduction=1.234
    )
    return SimpleNamespace(
        posterior=posterior,
        unidentifiable_directions=directions,
        draws_by_key=lambda: {f"structure.{name}": values for name, values in draws.items()},
    )


def law(text: str, cut: float = 0.0) -> Any:
    return SimpleNamespace(text=text, truncated_fraction=cut)


RIG: Any = SimpleNamespace(
    title="Own rig", name="own", file=None, source="", normal_load=3.0, sliding_speed=0.02, friction_coefficient=0.2,
    friction_model=SimpleNamespace(name="kinematic"),
    uncertainty={
        "contact.normal_load": law("normal 3 N +- 0.1 N", 0.0123), "drive.frequency": law("uniform", 1e-4),
        "structure.tip_mass": law("uniform 40 g to 60 g"), "idle.key": law("not drawn"),
    },
)  # fmt: skip
RESULT = xr.Dataset(
    {
        "friction_ratio": ("sample", [0.5, 0.6, np.nan, 0.8]),
        "contact_loss_fraction": ("sample", [0.0, 0.1, np.nan, 0.0]),
        "status": ("sample", [0, 0, 1, 0], {"flag_meanings": "stable failed"}),
        "reason": ("sample", ["", "", "too fast", ""]),
    },
    attrs={
        "outcome": "friction_ratio",
        "uncertain": ["contact.normal_load", "drive.frequency", "structure.tip_mass", "structure.stack_stiffness"],
    },
)


@pytest.fixture(autouse=True)
def amplitude(monkeypatch: MonkeyPatch) -> None:
    """Let every rig have the amplitude that it states."""
    labels = {"amplitude_source": "file", "amplitude_origin": "stated"}
    monkeypatch.setattr("sonolube.rig.amplitude_labels", lambda rig: labels)


def test_entries_have_their_distributions_and_what_is_cut_off_from_a_ten_thousandth_on() -> None:
    assert results.entry_rows(RIG, RESULT, None) == [
        ("contact.normal_load", "normal 3 N +- 0.1 N; 1.2% of it is impossible and cut off"),
        ("drive.frequency", "uniform"),
        ("structure.tip_mass", "uniform 40 g to 60 g"),
    ]


def test_entries_of_an_identified_structure_have_medians_and_intervals_of_their_draws() -> None:
    # uniform from 40 to 60 g: 5 % at 41 g, half at 50 g, 95 % at 59 g
    assert results.entry_rows(RIG, RESULT, structure())[2:] == [
        ("structure.tip_mass", "50 g, 90 % within 41 g to 59 g"),
        ("structure.stack_stiffness", "2 GN/m, 90 % within 1.1 GN/m to 2.9 GN/m; no fact settles it"),
    ]


def test_directions_that_are_free_name_exponents_above_a_tenth_and_say_whether_the_draws_agree() -> None:
    assert results.free_lines(None) == []
    assert results.free_lines(structure()) == [
        "  left free by the facts, to a factor of e and more: tip_mass^+1.50 stack_stiffness^-0.75",
        "  independent populations of draws agree (1.23)",
    ]
    assert results.agreement(structure(has_converged=False)) == (
        "independent populations of draws do not agree yet: take the ends with caution (1.23)"
    )


def test_a_posterior_in_json_has_its_free_parameters_and_quantiles() -> None:
    found = results.posterior_object(structure())
    assert (found["potential_scale_reduction"], found["settled"]) == (approx(1.234), True)
    assert found["free"] == ["structure.stack_stiffness"]
    assert found["quantiles"]["structure.tip_mass"] == approx([0.041, 0.05, 0.059])
    assert found["unidentifiable_directions"][0]["tip_mass"] == approx(1.5)


RANKING = [
    RankedEntry(key="contact.normal_load", first=estimate(0.75, 0.7, 0.8), total=estimate(0.8, 0.76, 0.84),
                deviation_if_known=0.05, matters=True),
    RankedEntry(key="drive.frequency", first=estimate(0.01, 0.0, 0.02), total=estimate(0.01, 0.0, 0.02),
                deviation_if_known=0.1, matters=False),
]  # fmt: skip
FACTS = [("mean", "0.63")]
SHARES = ("contact.normal_load", "75.0 % (70 to 80)", "80.0 % (76 to 84)", "0.05")


def test_an_uncertainty_in_words_has_facts_statuses_entries_and_what_to_measure_better() -> None:
    head, rows, failed, shares, lost, title, entries, ranked, table, idle = results.uncertainty_blocks(
        RIG, RESULT, None, ranking=RANKING, facts=FACTS
    )
    assert head == "Own rig, 4 points: friction force with vibration over that without"
    assert rows == Rows([("amplitude", "stated"), ("mean", "0.63")])
    assert failed == "  without result: 1: too fast"
    assert shares == "  stable 75.0%, failed 25.0% of the points"
    assert lost == "  contact lost for part of the time in 33.3% of them"  # one of three with a vibration
    assert (title, ranked) == ("uncertain entries", "which to measure better, by shares of the variance")
    assert isinstance(entries, Rows)
    assert table == Table(("entry", "share alone", "with the others", "deviation were it known"), [SHARES])
    assert idle == "  without effect: drive.frequency"
    held = RESULT.assign(contact_loss_fraction=("sample", np.zeros(4)))
    blocks = results.uncertainty_blocks(RIG, held, None, ranking=(), facts=FACTS)
    assert not any(isinstance(each, str) and ("effect" in each or "contact lost" in each) for each in blocks)
    assert blocks[-1] == Rows(results.entry_rows(RIG, held, None))


def test_the_page_of_an_uncertainty_has_tables_that_are_not_empty() -> None:
    page = results.uncertainty_page(RIG, RESULT, None, ranking=RANKING, facts=FACTS)
    assert (page.name, page.title) == (
        "uncertainty", "Uncertainty of the friction force with vibration over that without: Own rig",
    )  # fmt: skip
    assert list(page.facts) == [
        ("points", "4"), ("mean", "0.63"), ("contact lost", "for part of the time in 33.3% of the points"),
        ("without effect", "drive.frequency"),
    ]  # fmt: skip
    assert [table.title for table in page.tables] == [
        "Uncertain entries", "Which to measure better, by shares of the variance", "Points by status",
        "Points without a result",
    ]  # fmt: skip
    assert page.tables[1].rows == (SHARES,)
    held = RESULT.assign(contact_loss_fraction=("sample", np.zeros(4)))
    bare = results.uncertainty_page(RIG, held, None, ranking=(), facts=())
    assert list(bare.facts) == [("points", "4")]
    assert bare.tables[1].title == "Points by status"


def test_samples_in_json_have_their_statuses_and_distributions() -> None:
    found = results.sampled_object(RIG, RESULT, None)
    assert found["statuses"] == {"stable": 3, "failed": 1}
    assert found["without_result"] == [{"reason": "too fast", "points": 1}]
    assert (found["of"], found["unit"], found["points"]) == ("friction_ratio", "", 4)
    assert found["contact_lost"] == approx(1 / 3)
    assert found["uncertain"]["contact.normal_load"] == {
        "distribution": "normal 3 N +- 0.1 N", "truncated_fraction": 0.0123,
    }  # fmt: skip
    assert "identified" not in found
    joint = results.sampled_object(RIG, RESULT, structure())
    assert set(joint["uncertain"]) == {"contact.normal_load", "drive.frequency"}
    assert joint["identified"]["settled"] is True


def statistics(*, has_converged: bool) -> Any:
    return SimpleNamespace(
        mean=estimate(0.5, 0.49, 0.51), standard_deviation=estimate(0.1, 0.08, 0.12),
        quantiles={0.05: estimate(0.3, 0.29, 0.31), 0.5: estimate(0.52, 0.5, 0.54), 0.95: estimate(0.7, 0.6, 0.8)},
        relative_error=0.0345, has_converged=has_converged,
    )  # fmt: skip


def test_statistics_have_intervals_and_their_convergence_once_it_is_reached() -> None:
    rows = [
        ("mean", "0.5 (0.49 to 0.51)"),
        ("standard deviation", "0.1 (0.08 to 0.12)"),
        ("5 % lie below", "0.3 (0.29 to 0.31)"),
        ("median", "0.52 (0.5 to 0.54)"),
        ("95 % lie below", "0.7 (0.6 to 0.8)"),
    ]
    assert results.statistics_rows(statistics(has_converged=True), "friction_ratio") == [
        *rows, ("convergence", "intervals of 95 % within 3.5% of the spread"),
    ]  # fmt: skip
    assert results.statistics_rows(statistics(has_converged=False), "friction_ratio") == rows
    assert results.convergence(statistics(has_converged=False)) == (
        "not converged: an interval takes 3.5% of the spread; take more samples"
    )
    found = results.statistics_object(statistics(has_converged=True))
    assert found["quantiles"]["0.95"] == {"value": 0.7, "lower": 0.6, "upper": 0.8}
    assert found["mean"]["lower"] == approx(0.49)
    assert found["standard_deviation"]["upper"] == approx(0.12)
    assert (found["relative_error"], found["converged"]) == (approx(0.0345), True)


def test_a_band_is_said_where_it_is_narrowest_and_widest_with_units_of_the_outcome() -> None:
    narrow = BandPlace(
        at={"sliding.sliding_speed": 0.02, "drive.waveform": "sine"}, median=2e-11, lower=1e-11, upper=4e-11
    )
    band = Band(mean_width=3e-11, narrowest=narrow, widest=None)
    # 2e-11 m2 are 0.02 mm3/m
    text = "0.02 mm3/m, 90 % within 0.01 mm3/m to 0.04 mm3/m, at 20 mm/s, sine"
    assert results.band_rows(band, "wear_rate") == [("narrowest", text)]
    found = results.band_object(band)
    assert set(found) == {"mean_width", "narrowest"}
    assert found["narrowest"]["upper"] == approx(4e-11)


def test_a_meaning_within_a_sentence_begins_small() -> None:
    assert results.in_sentence("vibration_amplitude") == "vibration amplitude, zero to peak"
