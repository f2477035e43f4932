"""Section 4.5, the collar: rows and figures of its stack, modes, impedance, friction and work."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from scipy.constants import epsilon_0

from dong2015.chapter4.collar import (
    LOAD_AT_ENDS,
    PULL_SPEED,
    ROD_LENGTH,
    coarse_frequency,
    mode_frequency,
    mode_frequency_range,
    mode_near,
    pulled_rod,
    response_model,
)
from dong2015.hardware.collar import (
    FINAL_COLLAR,
    FIRST_COLLAR,
    NOMINAL_COLLAR,
    THIN_HEXAGON_COLLAR,
    THIN_RING_COLLAR,
    Collar,
)
from dong2015.hardware.collar_analysis import METAL_LOSS, BoreMotion
from dong2015.hardware.collar_tuning import HIGHEST_FREQUENCY, LOWEST_FREQUENCY, main_resonance, resonances_in_range
from dong2015.plots import axes_row, line_style, report_figure, single_axes
from dong2015.row import (
    Row,
    RowKind,
    at_least,
    default_model_row,
    not_computed_row,
    published_formula_row,
    undetermined_row,
)
from sonolube.errors import MissingPackage
from sonolube.facts.published import ComputedValue, published_value, si_value
from sonolube.figure import COLOURS, LINES, ReportFigure
from sonolube.models.fem import ReducedModel, cad_kernel, harmonic_response

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_BY_FINITE_ELEMENTS: Final = (
    "4.5.2-breathing-mode-first",
    "4.5.2-torsional-mode-first",
    "4.5.2-breathing-mode-revised",
    "4.5.2-torsional-mode-revised",
    "4.5.3-mode-closed-top",
    "4.5.3-mode-open-top",
    "4.5.3-pairs-closed-top",
    "4.5.3-pairs-open-top",
    "4.5.3-clamping",
    "4.5.4-reduction",
    "4.5.4-work-reduction",
)
_MESH_ERROR: Final = 0.003  # relative, against elements of higher order
_ASSUMED: Final = "walls of the outer ring, thickness of the inner one and bolts are assumed"
_ASSUMED_DIMENSIONS: Final = ("ring_thickness", "bolt_diameter", "pillar_width")  # base and top follow from others
_PULLED: Final = (
    f"multi-scale model with the computed structure at its resonance, 28 V; assumed: rod of {ROD_LENGTH:g} m, load from"
    f" its weight in the middle to {LOAD_AT_ENDS:g} times that at the ends, a steady {1e3 * PULL_SPEED:g} mm/s,"
    " roughness of Table 3.2, losses of metal 0.005"
)


def finite_elements_missing() -> str:
    """Message on a package that finite elements lack; empty if none is missing."""
    try:
        cad_kernel()
    except MissingPackage as failure:
        return str(failure)
    return ""


def collar_rows() -> Iterator[Row]:
    """Yield the rows of section 4.5; those by finite elements are not computed if a package is missing."""
    yield from _stack()
    if missing := finite_elements_missing():
        yield from (not_computed_row(name, missing, kind=RowKind.DEFAULT_MODEL) for name in _BY_FINITE_ELEMENTS)
        return
    yield from _first_design()
    yield from _revised_designs()
    yield from _final_design()
    yield from _pairs()
    yield _clamping()
    yield from _pulled_rod_rows()


def _stack() -> Iterator[Row]:
    """Yield coupling factor and capacitance of the stack, Table 4.7."""
    stiffness, length, outer, inner = (
        si_value(f"table-4.7-{name}-1") for name in ("stack_stiffness", "length", "outer_diameter", "inner_diameter")
    )
    charge_constant = si_value("table-4.7-charge_constant_33-1")
    relative_permittivity = si_value("table-4.7-relative_permittivity-1")
    area = float(np.pi / 4 * (outer**2 - inner**2))
    modulus, permittivity = stiffness * length / area, relative_permittivity * float(epsilon_0)
    needed = si_value("table-4.7-coupling_factor-1") ** 2 * permittivity / charge_constant**2
    note = (
        f"d33 sqrt(E/eps) with E = k_p L/A = {modulus * 1e-9:.3g} GPa, as of ceramic alone; the printed factor"
        f" needs {needed * 1e-9:.3g} GPa; end pieces and glue, which soften a stack, would account for the difference"
    )
    yield published_formula_row(
        "table-4.7-coupling_factor-1", charge_constant * float(np.sqrt(modulus / permittivity)), note
    )
    layers = np.sqrt(si_value("table-4.7-capacitance-1") / (permittivity * area / length))
    missing = f"number of layers; C = N^2 eps A/L, ceramic over the whole length, would take {layers:.1f} of them"
    yield undetermined_row("table-4.7-capacitance-1", missing)


def _first_design() -> Iterator[Row]:
    """Yield the modes of the first design."""
    oval = _on_mesh(mode_frequency(FIRST_COLLAR, BoreMotion.OVAL))
    mean_radius = (FIRST_COLLAR.ring_width + FIRST_COLLAR.bore_diameter) / 4
    radial = float(np.sqrt(200e9 / 8000.0)) / (2 * np.pi * mean_radius)
    note = (
        "Mode in which the bore becomes oval along the stacks, hexagon and hexagonal hole across flats; "
        f"{_ASSUMED}. Proper breathing, uniform widening of the bore, lies near {radial * 1e-3:.0f} kHz by the theory "
        "of thin rings, and the 27 kHz of the revised designs would take a ring of 59 mm: D's breathing is taken for "
        "the oval mode (erratum N16)"
    )
    possible = mode_frequency_range(FIRST_COLLAR, BoreMotion.OVAL, assumed=_ASSUMED_DIMENSIONS)
    yield default_model_row(at_least("4.5.2-breathing-mode-first", oval), oval, note, possible=possible)
    yield default_model_row(
        "4.5.2-torsional-mode-first",
        _on_mesh(mode_frequency(FIRST_COLLAR, BoreMotion.DIAGONAL_OVAL)),
        "Mode odd about the stacks with the largest motion of the inner ring: its hole becomes oval along the "
        f"diagonals and its sides rotate; {_ASSUMED}. In a symmetric collar no voltage excites it: its presence in the "
        "impedance requires stacks or bolts that differ",
        possible=mode_frequency_range(FIRST_COLLAR, BoreMotion.DIAGONAL_OVAL, assumed=_ASSUMED_DIMENSIONS),
    )


def _revised_designs() -> Iterator[Row]:
    """Yield the modes of the revised designs: of the hexagon, with those of the ring beside them."""
    for mode, kind in (("breathing", BoreMotion.OVAL), ("torsional", BoreMotion.DIAGONAL_OVAL)):
        hexagon, ring = (
            (
                _on_mesh(mode_frequency(collar, kind)),
                f"The {kind} mode of a {shape} of 1 in across flats with a hole of 0.75 in, sizes that D does not"
                f" print; {_ASSUMED}",
            )
            for shape, collar in (("hexagon", THIN_HEXAGON_COLLAR), ("ring", THIN_RING_COLLAR))
        )
        yield default_model_row(
            f"4.5.2-{mode}-mode-revised",
            *hexagon,
            possible=mode_frequency_range(THIN_HEXAGON_COLLAR, kind, assumed=(*_ASSUMED_DIMENSIONS, "ring_width")),
            alternatives={"ring": ring},
        )


def _final_design() -> Iterator[Row]:
    """Yield the resonances of the final design, tuned, with those of round inches beside them."""
    for statement_id, open_top in (("4.5.3-mode-closed-top", False), ("4.5.3-mode-open-top", True)):
        tuned, guess = (
            _resonance(collar, open_top=open_top, origin=origin)
            for collar, origin in (
                (FINAL_COLLAR, "no assumed dimension off its nominal one by more than 9 %"),
                (NOMINAL_COLLAR, "round inches for what D does not print, nothing fitted"),
            )
        )
        yield default_model_row(
            statement_id,
            *tuned,
            fitted="the dimensions that are not printed, with the other frequency",
            alternatives={"dimensions in round inches": guess},
        )


def _resonance(collar: Collar, *, open_top: bool, origin: str) -> tuple[ComputedValue, str]:
    """Main resonance of a collar in Hz, with its note."""
    found = main_resonance(response_model(collar, open_top=open_top))
    note = f"Resonance of the largest k_eff, {found.coupling_factor:.2f}, between 15 and 40 kHz; {origin}"
    return _on_mesh(found.series_frequency), note


def _pulled_rod_rows() -> Iterator[Row]:
    """Yield the reductions of friction and of its work on a rod pulled through the collar."""
    rod = pulled_rod()
    ratios = rod.ratio_at_pull_speed
    slowest, fastest = (1e3 * speed for speed in rod.sliding_speed[[0, -1]])
    over_speeds = f"Possible: from {slowest:g} to {fastest:g} mm/s, for the speed is only drawn"
    note = f"At the ends and in the middle of the rod; {_PULLED}. {over_speeds}"
    limits = published_value("4.5.4-reduction").limits()
    for limit, ratio, place in zip(limits, (ratios.max(), ratios.min()), (np.max, np.min), strict=True):
        over_rod = 1 - place(rod.friction_ratio, axis=1)
        yield default_model_row(limit, 1 - float(ratio), note, possible=(float(over_rod.min()), float(over_rod.max())))
    work = rod.work_reduction
    exact = float(np.interp(-si_value("4.5.4-work-reduction"), -work, rod.sliding_speed))
    note = f"{_PULLED}. At {1e3 * exact:.0f} mm/s it would be the printed number. {over_speeds}"
    yield default_model_row(
        "4.5.4-work-reduction",
        float(np.interp(PULL_SPEED, rod.sliding_speed, work)),
        note,
        possible=(float(work.min()), float(work.max())),
    )


def _on_mesh(frequency: float) -> ComputedValue:
    """Natural frequency with the interval of the discretisation error. [Hz]"""
    return ComputedValue(value=frequency, low=frequency * (1 - _MESH_ERROR), high=frequency)


def _pairs() -> Iterator[Row]:
    """Yield the pairs of resonance and antiresonance with closed and with open top."""
    least = float(np.sqrt(METAL_LOSS))
    for top, is_open in (("closed", False), ("open", True)):
        found = resonances_in_range(response_model(FINAL_COLLAR, open_top=is_open), least_coupling=least)
        places = ", ".join(f"{one.series_frequency * 1e-3:.1f}" for one in found)
        note = (
            f"Resonances from {LOWEST_FREQUENCY * 1e-3:g} to {HIGHEST_FREQUENCY * 1e-3:g} kHz whose coupling factor"
            f" exceeds {least:.2f}, where the pair stands out at the assumed losses: {places} kHz; {_ASSUMED}"
        )
        yield default_model_row(f"4.5.3-pairs-{top}-top", float(len(found)), note)


def _clamping() -> Row:
    """Amplitude of the ring with free over that with clamped base, each at its own resonance."""
    free, clamped = (amplitude_per_volt("crown", clamped=clamped) for clamped in (False, True))
    note = (
        f"Top open; {1e6 * free:.3f} and {1e6 * clamped:.3f} um a volt: the sign is that of D, but"
        f" {clamped / free - 1:.0%} more are hardly significant: the mode is that of the ring, and the base is heavy"
    )
    return default_model_row("4.5.3-clamping", free / clamped, note)


def amplitude_per_volt(output: str, *, clamped: bool) -> float:
    """Amplitude of the flat of the inner ring, or of the base, at the main resonance, top open. [m/V]"""
    model = response_model(FINAL_COLLAR, clamped=clamped, open_top=True)
    at_resonance = harmonic_response(model, frequency=main_resonance(model).series_frequency)
    return float(np.abs(at_resonance.displacement_per_volt[model.outputs.index(output), 0]))


_SIZES: Final = "Dimensions that D does not print are assumed and fitted to 25 and 24.4 kHz."
_POINTS: Final = 2001
_DRAWN: Final = 0.06  # largest displacement of a drawn mode, of the size of the collar


def collar_figures() -> Iterator[ReportFigure]:
    """Figures of section 4.5; none if a package of the finite elements is missing."""
    if finite_elements_missing():
        return
    yield report_figure("figures-4-51-4-53-collar-impedance", _impedances, sizes=_SIZES)
    yield report_figure("figures-4-48-4-54-collar-modes", _modes, sizes=_SIZES)
    yield report_figure("figure-4-55-collar-amplitudes", _amplitudes, sizes=_SIZES)
    yield report_figure("figure-4-57-collar-pull", _pulled_rod, sizes=_SIZES, load=LOAD_AT_ENDS)


def _impedances() -> "Figure":
    """Draw the impedance with free and clamped base, and with closed and open top."""
    figure, (left, right) = axes_row(2, (7.8, 3.6), sharey=True)
    free = response_model(FINAL_COLLAR)
    for axes, cases in (
        (left, {"base free": free, "base clamped": response_model(FINAL_COLLAR, clamped=True)}),
        (right, {"top closed": free, "top open": response_model(FINAL_COLLAR, open_top=True)}),
    ):
        for index, (label, model) in enumerate(cases.items()):
            _impedance(axes, model, label, index)
        axes.set(xlabel="Frequency [kHz]", xlim=(LOWEST_FREQUENCY * 1e-3, HIGHEST_FREQUENCY * 1e-3))
        axes.set(ylabel="Magnitude of the impedance [Ω]")
        axes.legend()
    return figure


def _impedance(axes: "Axes", model: ReducedModel, label: str, index: int) -> None:
    """Draw the magnitude of the impedance of a model over frequency."""
    frequency = np.linspace(LOWEST_FREQUENCY, HIGHEST_FREQUENCY, _POINTS)
    admittance = harmonic_response(model, frequency=frequency).admittance
    axes.semilogy(1e-3 * frequency, 1 / np.abs(admittance), **line_style(index), label=label)


def _modes() -> "Figure":
    """Draw the main mode of the first design, and of the final one with closed and open top."""
    figure, panels = axes_row(3, (8.4, 3.6))
    closed, opened = (si_value(f"4.5.3-mode-{top}-top") for top in ("closed", "open"))
    cases = (
        ("first design", FIRST_COLLAR, coarse_frequency(FIRST_COLLAR, BoreMotion.OVAL), False),
        ("final, top closed", FINAL_COLLAR, closed, False),
        ("final, top open", FINAL_COLLAR, opened, True),
    )
    for axes, (title, collar, near, is_open) in zip(panels, cases, strict=True):
        frequency, places, shape = mode_near(collar, frequency=near, open_top=is_open)
        moved = 1e3 * (places + _DRAWN * np.ptp(places) * shape / np.abs(shape).max())
        size = np.linalg.norm(shape, axis=1)
        axes.plot(*(1e3 * places.T), ".", color="0.8", ms=1.5, zorder=1, label="nodes at rest")
        x, y = moved.T
        points = axes.scatter(x, y, c=size / size.max(), s=3, cmap="viridis", vmin=0, vmax=1, zorder=2)
        axes.set(xlabel="Across the stacks [mm]", ylabel="Along the stacks [mm]", aspect="equal")
        axes.set_title(f"{title}\n{1e-3 * frequency:.1f} kHz", fontsize=9)
        axes.grid(visible=False)
    figure.colorbar(points, ax=panels, label="Displacement over its largest [1]", shrink=0.8)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", markerscale=3)
    return figure


def _amplitudes() -> "Figure":
    """Draw the amplitudes of inner ring and base over voltage, with free and clamped base."""
    figure, axes = single_axes()
    swing = np.array([0.0, si_value("4.5.4-voltage")])
    for index, (label, clamped) in enumerate((("unclamped", False), ("clamped", True))):
        for line, (part, output) in enumerate((("inner ring", "crown"), ("base", "base"))):
            per_volt = amplitude_per_volt(output, clamped=clamped)
            style: dict[str, Any] = {"linestyle": LINES[line], "color": COLOURS[index]}
            axes.plot(swing, 1e6 * per_volt * swing / 2, **style, label=f"{part}, {label}")
    axes.set(xlabel="Drive voltage, peak to peak [V]", ylabel="Amplitude [µm]", xlim=(0, swing[1]), ylim=(0, None))
    axes.legend(loc="upper left")
    return figure


def _pulled_rod() -> "Figure":
    """Draw the friction along a pulled rod, and the reductions of friction and work over its speed."""
    figure, (left, right) = axes_row(2, (7.8, 3.6))
    rod = pulled_rod()
    intrinsic = rod.normal_load / rod.normal_load.min()
    left.plot(rod.relative_position, intrinsic, **line_style(0), label="without vibration")
    reduced = intrinsic * rod.ratio_at_pull_speed
    left.plot(rod.relative_position, reduced, **line_style(1), label=f"with, {1e3 * PULL_SPEED:g} mm/s")
    left.set(xlabel="Position on the rod over its length [1]", xlim=(0, 1))
    left.set(ylabel="Friction over that in the middle [1]", ylim=(0, 1.35 * intrinsic.max()))
    left.legend(loc="upper right")
    speed = 1e3 * rod.sliding_speed
    right.plot(speed, 100 * rod.work_reduction, **line_style(0), label="work of friction")
    ends, middle = (100 * (1 - ratio) for ratio in (rod.friction_ratio.max(axis=1), rod.friction_ratio.min(axis=1)))
    right.fill_between(speed, ends, middle, color="0.85", label="friction, ends to middle")
    published = 100 * si_value("4.5.4-work-reduction")
    right.axhline(published, color="0.3", linestyle=":", label="work in D 4.5.4, speed not printed")
    right.set(xlabel="Speed of the rod [mm/s]", ylabel="Reduction [%]", xlim=(speed[0], speed[-1]), ylim=(0, 110))
    right.legend(loc="upper right")
    return figure
