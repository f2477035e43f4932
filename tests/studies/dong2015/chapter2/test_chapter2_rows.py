"""Chapter 2: hand arithmetic on its printed numbers, verdicts of its rows, and figures."""

import re
import warnings
from collections.abc import Iterator

import matplotlib as mpl
import matplotlib.pyplot as plt
import pytest
from pytest import approx
from tests.reproduced import reproduced, reproduced_rows

from dong2015 import SECTIONS, Row, Verdict
from sonolube.facts.published import PublishedValue, published_value
from sonolube.figure import ReportFigure, publication_style
from sonolube.text.units import convert
from sonolube.vocabulary import unit_of

FIGURES = [figure for section in SECTIONS if section.chapter == 2 for figure in section.figures()]


def rows() -> dict[str, Row]:
    return reproduced_rows(2)


@pytest.fixture(autouse=True)
def screenless() -> Iterator[None]:
    with mpl.rc_context({"backend": "Agg"}), publication_style():
        yield
    plt.close("all")


@pytest.mark.parametrize(
    ("row", "computed"),
    [
        ("2.2.5-power-1", 1.53e-6 * 6 * 4 * 16e3),
        ("2.2.5-power-2", 1.53e-6 * 8 * 4 * 16e3),
        ("2.2.5-power-3", 1.53e-6 * 10 * 4 * 16e3),
        ("table-2.5-vibration-contact-count-1", 22e3 * 4 * 3600),
        ("table-2.5-vibration-contact-count-2", 22e3 * 2 * 3600),
        ("table-2.5-vibration-contact-count-3", 22e3 * 0.93 * 3600),
    ],
)
def test_driver_powers_and_contact_counts_are_reproduced(row: str, computed: float) -> None:
    assert rows()[row].verdict is Verdict.REPRODUCED
    assert rows()[row].computed == approx(computed)


@pytest.mark.parametrize(
    ("row", "computed"),
    [
        ("table-2.2-groove-diameter-1", 58.19),  # 292.5 m/(1600 pi)
        ("A.1.3.6-groove-radius", 29.10),
        ("2.3.7-friction-reduction-87", 29.28),  # 1 - 1.041/1.472
        ("table-2.4-total-height-7", 111.122),  # 44.245 + 66.877
        ("2.3.4-indentation-20.3", 0.203),
        ("2.3.4-indentation-40.6", 0.406),
        ("2.3.4-indentation-87", 0.870),
        ("table-2.6-sliding-speed-1", 20.889),  # 75.2 m/3600 s
        ("table-2.6-revolutions-1", 950),  # 1900/2
        ("2.3.6-revolutions-1", 950),
        ("2.4.2-flat-stress-before", 35.0),  # 70 N/2 mm2
        ("2.4.2-flat-stress-after", 31.11),  # 70 N/2.25 mm2
        ("table-2.8-sliding-distance-3", 2.28221),  # 11 pi 66.04 mm
        ("2.4.6-sliding-speed", 265.9),  # 76.9/min on 66.04 mm
        ("table-2.9-friction-reduction-2-from", 41.17),  # 1 - 9.93/16.88
        ("table-2.9-friction-reduction-2-to", 45.13),  # 1 - 10.71/19.52
        ("table-2.10-wear-rate-3", 0.005698),  # 0.013/2.2814
        ("2.5.5-friction-m50-on", 0.15303),  # 0.769 (1 - 0.801)
        ("2.5.7-friction-reduction", 80.0),
        ("2.5.7-wear-reduction", 73.0),
    ],
)
def test_arithmetic_finds_the_misprints(row: str, computed: float) -> None:
    assert rows()[row].verdict is Verdict.MISPRINT
    assert rows()[row].computed == approx(computed, rel=2e-4)


def test_vibration_shortens_the_way_to_steady_friction_and_lengthens_that_to_a_steady_fluctuation() -> None:
    for speed, quotient, of_fluctuation in (("20.3", 2.78 / 4.17, 3.11 / 35.71), ("87", 4.64 / 8.94, 3.22 / 31.53)):
        for name, expected in (("distance", quotient), ("fluctuation-distance", of_fluctuation)):
            row = rows()[f"2.3.3-{name}-ratio-{speed}"]
            assert row.verdict is Verdict.REPRODUCED
            assert row.computed == approx(expected)


def test_the_motor_effect_drives_the_block_at_the_outer_points() -> None:
    row = rows()["2.1.4-motor-reduction"]
    assert row.verdict is Verdict.REPRODUCED
    assert row.published_low == approx(100.0)
    assert rows()["2.1.4-motor-force-slope"].verdict is Verdict.TRIVIALLY_MET
    limits = [rows()[f"2.1.7-transition-reduction-{end}"] for end in ("from", "to")]
    assert [row.errata for row in limits] == [("E36",)] * 2
    assert [row.computed for row in limits] == approx([25.0, 56.0])


@pytest.mark.parametrize(
    ("row", "computed", "erratum"),
    [
        ("table-2.5-friction-reduction-1", 62.99, "E27"),  # 1 - 0.379/1.024
        ("table-2.5-friction-reduction-2", 37.72, "E27"),  # 1 - 0.748/1.201
        ("2.5.2-friction-reduction", 54.135, "E32"),  # 1 - 0.61/1.33
        ("table-2.14-friction-reduction-3", 54.135, "E32"),
    ],
)
def test_means_of_forces_are_another_averaging(row: str, computed: float, erratum: str) -> None:
    assert rows()[row].verdict is Verdict.OTHER_AVERAGING
    assert rows()[row].errata == (erratum,)
    assert rows()[row].computed == approx(computed, rel=2e-4)


def test_the_velocity_of_the_flextensional_test_depends_on_a_gain_that_is_not_printed() -> None:
    row = rows()["2.2.5-vibration-velocity"]
    assert row.verdict is Verdict.UNDETERMINED
    assert row.computed == approx(69.70, rel=2e-4)  # 2 pi 16 kHz times 52 um 4 V/150 V/2
    assert row.possible_high == approx(20 * 69.70, rel=2e-4)


@pytest.mark.parametrize(
    ("row", "computed"),
    [
        ("2.3.4-dots-calculated", 87 / 22),  # um
        ("2.3.4-indentation-measured", 0.870),
        ("2.3.7-stick-slip-reduction", 100 * (1 - 0.096 / 0.251)),
        ("table-2.4-total-height-1", 18.887),
        ("table-2.5-wear-reduction-1", 100 * (2.237 - 1.214) / 2.237),
        ("table-2.5-wear-rate-drop-2", 1.243e-2),
        ("table-2.7-intrinsic-wear-rate-3", 3.839 / 150.5),
        ("table-2.8-nominal-pressure-1-from", 70 / 1.27),
        ("table-2.8-sliding-speed-1", 172.473),  # 54.9/60 s times pi 60 mm
        ("table-2.9-friction-reduction-1-to", 100 * (1 - 5.323 / 10.73)),
        ("table-2.10-wear-volume-per-turn-2", 0.335 / 11),
        ("2.4.4-current-drop-round", 0.427),
        ("table-2.11-sliding-distance-1", 16.9 * 3 * 3.6),
        ("table-2.12-revolutions-3", 4574.6),  # 16.9 mm/s 6 h/(pi 25.4 mm)
        ("2.5.4-friction-reduction", 100 * (1 - 0.224 / 0.665)),
    ],
)
def test_derived_numbers_are_reproduced(row: str, computed: float) -> None:
    assert rows()[row].verdict is Verdict.REPRODUCED
    assert rows()[row].computed == approx(computed, rel=1e-4)


def test_a_uniform_bar_lies_below_the_modes_of_the_tapered_horns() -> None:
    # sqrt(E/rho)/(2 L) by hand: 5124 m/s and 5000 m/s over 254 mm
    assert rows()["2.1.3-first-mode-aluminium"].computed == approx(20.17, abs=0.01)
    assert rows()["2.1.3-first-mode-steel"].computed == approx(19.69, abs=0.01)


def test_a_hertzian_peak_is_one_and_a_half_times_the_mean() -> None:
    assert rows()["2.4.2-round-stress-centre"].computed == approx(1.5)


def test_the_cube_has_the_same_ratio_at_every_speed() -> None:
    ratios = [
        _computed(f"table-2.3-friction-force-{row}") / intrinsic
        for row, intrinsic in ((2, 1.024), (4, 1.201), (6, 1.472))
    ]
    assert ratios == approx([ratios[0]] * 3)
    assert rows()["table-2.3-friction-force-6"].verdict is Verdict.NOT_REPRODUCED


def test_what_was_not_printed_stays_undetermined_and_is_named() -> None:
    for row in ("2.4.5-wear-reduction", "table-2.13-nominal-pressure-1", "table-2.14-wear-reduction-6"):
        assert rows()[row].verdict is Verdict.UNDETERMINED
        assert rows()[row].note.startswith("Missing: the ")


def test_every_id_is_unique_and_every_row_notes_its_method() -> None:
    assert len(rows()) == len(reproduced(2).rows)
    assert all(row.note.endswith((".", "]")) and row.chapter == 2 for row in rows().values())


def test_every_misprint_has_a_correction_and_computes_to_the_corrected_number() -> None:
    misprints = [row for row in rows().values() if row.verdict is Verdict.MISPRINT]
    assert misprints
    for row in misprints:
        published = published_value(row.id.removesuffix("-from").removesuffix("-to"))
        assert published.evidence, row.id
        assert row.computed is not None, row.id
        widening = (row.published_high - row.published_low) / 2
        corrected = [_printed(number.low, number.high, published) for number in published.corrected]
        assert not corrected or any(low - widening <= row.computed <= high + widening for low, high in corrected), (
            row.id
        )


@pytest.mark.parametrize("figure", FIGURES, ids=lambda figure: figure.name)
def test_figures_are_drawn_without_warnings_with_a_unit_on_every_axis(figure: ReportFigure) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        drawn = figure.draw()
        drawn.canvas.draw()
    labels = {label for axes in drawn.axes for label in (axes.get_xlabel(), axes.get_ylabel()) if label}
    assert labels
    assert all(label.endswith("]") or label == "Revolutions of the disc" for label in labels)


def test_every_figure_cites_the_source_of_its_data_or_says_that_none_is_printed() -> None:
    assert all(re.search(r"Table|D [23]\.|no number is printed", figure.caption) for figure in FIGURES)
    assert len({figure.name for figure in FIGURES}) == len(FIGURES)


def _computed(row_id: str) -> float:
    computed = rows()[row_id].computed
    assert computed is not None
    return computed


def _printed(low: float, high: float, published: PublishedValue) -> tuple[float, float]:
    si = unit_of(published.quantity)
    return (convert(low, from_unit=si, to_unit=published.unit), convert(high, from_unit=si, to_unit=published.unit))
