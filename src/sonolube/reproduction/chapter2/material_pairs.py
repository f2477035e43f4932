"""Section 2.5, pairs of materials: rows of settings, friction and the summary over all pairs, and its figure."""

from collections.abc import Iterator
from operator import mul
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from sonolube.facts.published import as_setting, propagate_rounding, table
from sonolube.figure import COLOURS, ReportFigure
from sonolube.reproduction import formulas
from sonolube.reproduction.chapter2.tribometer import reductions_of_table_2_3, wear_reductions
from sonolube.reproduction.chapter2.welder import welder_friction_reductions
from sonolube.reproduction.plots import single_axes
from sonolube.reproduction.row import Row, formula_row, published_formula_row, undetermined_row

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_TESTS: Final = (("2.11", 1), ("2.12", 1), ("2.12", 2), ("2.12", 3), ("2.13", 1))  # table and row


def material_pair_rows() -> Iterator[Row]:
    """Yield the rows of section 2.5."""
    yield from _settings()
    yield from _friction()
    yield from _summary()


def material_pair_figures() -> Iterator[ReportFigure]:
    """Figures of section 2.5."""
    yield ReportFigure(
        name="table-2-14-pairs",
        title="Reductions of friction and wear for six pairs of materials",
        caption="Pin on disc, as printed in Table 2.14. Where titanium takes part, wear did not fall.",
        draw=_pairs,
    )


def _settings() -> Iterator[Row]:
    """Yield distance, revolutions and speed of each test from the other settings, and the pressure of Table 2.13."""

    def turns(speed: float, time: float, diameter: float) -> float:
        return speed * time / (np.pi * diameter)

    def speed(turns: float, time: float, diameter: float) -> float:
        return formulas.sliding_speed(turns / time, diameter)

    for table_id, row in _TESTS:
        v, n, d = (f"table-{table_id}-{column}-{row}" for column in ("sliding_speed", "revolutions", "groove_diameter"))
        time = as_setting(f"table-{table_id}-running_time-{row}")
        yield formula_row(f"table-{table_id}-sliding_distance-{row}", "Speed times running time.", mul, v, time)
        yield formula_row(n, "Distance over the length of the groove.", turns, v, time, d)
        yield formula_row(v, "Turns over time, times the groove's length.", speed, n, time, d)
    yield undetermined_row("table-2.13-nominal_pressure-1", "the radius of the pins' tips, or the first contact area.")


def _friction() -> Iterator[Row]:
    """Yield the friction reductions of the text from forces."""
    for section, pair in (("2.5.2", "titanium"), ("2.5.4", "ceramic")):
        reduction, forces = f"{section}-friction-reduction", (f"{section}-friction-{pair}-{x}" for x in ("off", "on"))
        yield formula_row(reduction, "D 2.1 from the mean forces.", formulas.friction_reduction, *forces)

    def reduced(force: float, reduction: float) -> float:
        return force * (1 - reduction)

    note, inputs = "Force without vibration, less the stated reduction.", ("friction-m50-off", "friction-reduction")
    yield formula_row("2.5.5-friction-m50-on", note, reduced, *(f"2.5.5-{name}" for name in inputs))
    yield undetermined_row("2.5.5-friction-reduction", "the force with vibration: that without is printed twice.")
    for amplitude in ("2.5um", "1um"):
        note = "the forces, and of the titanium surfaces the summit radius and density."
        yield undetermined_row(f"2.5.3-friction-reduction-{amplitude}", note)


def _summary() -> Iterator[Row]:
    """Yield Table 2.14 from the detailed results, and its largest reductions."""
    titanium, ceramic = (
        propagate_rounding(formulas.friction_reduction, f"{pair}-off", f"{pair}-on")
        for pair in ("2.5.2-friction-titanium", "2.5.4-friction-ceramic")
    )
    welder_reductions = welder_friction_reductions(1) + welder_friction_reductions(2)
    titanium_on_titanium = (propagate_rounding(float, f"2.5.3-friction-reduction-{size}") for size in ("2.5um", "1um"))
    for row, (reduction, note) in enumerate(
        (
            (max(reductions_of_table_2_3("friction_force")), "The largest that the forces of Table 2.3 give."),
            (max(welder_reductions), "The largest that the forces of Table 2.9 give."),
            (titanium, "Forces of section 2.5.2."),
            (max(titanium_on_titanium), "The larger of section 2.5.3."),
            (ceramic, "Forces of section 2.5.4."),
            (propagate_rounding(float, "2.5.5-friction-reduction"), "Section 2.5.5."),
        ),
        start=1,
    ):
        yield published_formula_row(f"table-2.14-friction_reduction-{row}", reduction, note)
    note = "The largest that the rates of Table 2.5 give."
    yield published_formula_row("table-2.14-wear_reduction-1", max(wear_reductions("2.5")), note)
    yield formula_row("table-2.14-wear_reduction-2", "Section 2.4.5.", float, "2.4.5-wear-reduction")
    for row in (5, 6):
        yield undetermined_row(f"table-2.14-wear_reduction-{row}", "the worn volumes, shown only as profiles.")
    for measure in ("friction", "wear"):
        cells = (propagate_rounding(float, f"table-2.14-{measure}_reduction-{row}") for row in (1, 2, 5, 6))
        yield published_formula_row(f"2.5.7-{measure}-reduction", max(cells), "The largest of Table 2.14.")


def _pairs() -> "Figure":
    """Draw the reductions of Table 2.14 as bars."""
    figure, axes = single_axes((5.4, 3.8))
    columns = table("2.14").columns
    places = np.arange(len(columns["pin"].printed))[::-1]
    for name, offset, hatch, colour in (("friction", 0.2, "", COLOURS[0]), ("wear", -0.2, "////", COLOURS[1])):
        values = 100 * columns[f"{name}_reduction"].values
        style: dict[str, Any] = {"facecolor": "white" if hatch else colour, "edgecolor": colour, "hatch": hatch}
        bars = axes.barh(places + offset, np.nan_to_num(values), height=0.38, label=f"{name}, Table 2.14", **style)
        axes.bar_label(bars, [f"{value:.0f}" if value > 0 else "no reduction" for value in values], padding=3, size=8)
    pairs = zip(columns["pin"].printed, columns["disc"].printed, strict=True)
    axes.set(xlabel="Reduction [%]", xlim=(0, 100))
    axes.set_yticks(places, labels=[f"{pin}\non {disc}" for pin, disc in pairs])
    axes.grid(False, axis="y")
    figure.legend(loc="outside lower center", ncols=2)
    return figure
