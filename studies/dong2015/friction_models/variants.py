"""Variants of the friction models: friction ratios of the published tests, and figures of them."""

from collections.abc import Iterator
from functools import cache
from textwrap import wrap
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from dong2015.plots import draw_measured, line_style, report_figure, single_axes
from sonolube.checks import Floats
from sonolube.figure import COLOURS, MARKERS, ReportFigure, subplots
from sonolube.models import friction
from sonolube.models.contact import load_balanced_motion, sinusoidal_motion
from sonolube.validation.assessment import (
    FITTED_SETS,
    SETS_WITHOUT_POWER_MAP,
    Assessment,
    Fit,
    assess_variant,
    fit_variant,
    prediction_errors,
    profile_likelihood_interval,
)
from sonolube.validation.friction_model_variants import FRICTION_MODEL_VARIANTS
from sonolube.validation.model_variant import RIGS, ModelVariant
from sonolube.validation.published_tests import NORMAL_VIBRATION_SETS, FrictionTest, friction_tests

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DEFAULT: Final = "asperity-stick-slip-fitted"
"""Variant of the default friction model: the least cross-validation error of all."""

REPORTED: Final = ("dong-2015-full-period", DEFAULT, "asperity-stick-slip-in-plane", "bristle-with-holder-per-rig")
"""Variants in the rows of the report; its figures show all."""

Predictions = dict[str, tuple[float, str]]
"""Friction ratios of a test, each with the note on its computation, by the name of the model."""


def variant_predictions(test: FrictionTest) -> Predictions:
    """Friction ratios of a test by the reported variants that reach it."""
    predictions: Predictions = {}
    for fit in reported_fits():
        ratio = fit.predict(test) if fit.variant.name in REPORTED else None
        if ratio is not None:
            fitted = parameters_text(fit, test.set_name) or "no parameter applies to this rig"
            sets = f"; fitted on sets {', '.join(fit.sets)}: {fitted}" if fit.sets else "; nothing fitted"
            note = f"{capitalised(fit.variant.description)}{sets}. {ratio_text(ratio, test.friction_ratio)}"
            predictions[fit.variant.name] = (ratio, note)
    return predictions


@cache
def reported_fits() -> tuple[Fit, ...]:
    """Every variant fitted without Table 4.2, or with it if a parameter applies to its rig alone."""
    return tuple(fit_variant(variant, _fitted_sets(variant)) for variant in FRICTION_MODEL_VARIANTS)


def is_fitted_to(test: FrictionTest) -> bool:
    """Whether the default model is fitted to the set of a test."""
    return any(fit.variant.name == DEFAULT and test.set_name in fit.sets for fit in reported_fits())


def parameters_text(fit: Fit, sets: str) -> str:
    """Fitted parameters that apply to sets as text."""
    return ", ".join(
        f"{parameter.name} {value:.3g} {parameter.unit}".rstrip()
        for parameter, value in zip(fit.variant.parameters, fit.values, strict=True)
        if parameter.applies_to(sets)
    )


def ratio_text(computed: float, measured: float) -> str:
    """Computed and a measured friction ratio as a sentence."""
    return f"Ratio {computed:.3f}, measured {measured:.3f}."


def capitalised(text: str) -> str:
    """Text with a capital first letter."""
    return text[0].upper() + text[1:]


def _fitted_sets(variant: ModelVariant) -> str:
    """Letters of the sets that a variant is fitted to for the report."""
    of_power_map = any(parameter.applicable_sets == RIGS["power map"] for parameter in variant.parameters)
    return FITTED_SETS if of_power_map else SETS_WITHOUT_POWER_MAP


_HIGHEST: Final = 1.3  # ratios above it are drawn at the edge
_COLUMNS: Final = 4  # of panels
_TITLE_WIDTH: Final = 22  # characters of a line above a panel
_LARGEST_ERROR: Final = 0.5  # limit of the colour scale


def variant_figures() -> Iterator[ReportFigure]:
    """Figures of the variants of the friction models."""
    yield report_figure("friction-models-against-speed", _against_speed)
    yield report_figure(
        "friction-models-predicted-against-measured",
        _predicted_against_measured,
        sets="; ".join(f"{letter}: {content}" for letter, content in NORMAL_VIBRATION_SETS.items()),
        highest=_HIGHEST,
    )
    yield report_figure("friction-models-errors-by-test", _errors_by_test, default=_default_model_text())


def _default_model_text() -> str:
    """Parameter of the default friction model with its interval as text."""
    variant = next(one for one in FRICTION_MODEL_VARIANTS if one.name == DEFAULT)
    fit = fit_variant(variant, SETS_WITHOUT_POWER_MAP)
    low, high = profile_likelihood_interval(fit, 0)
    return (
        f"The default is {DEFAULT}: fitted to the sets without Table 4.2 its memory length is "
        f"{1e6 * fit.values[0]:.2f} um, {1e6 * low:.2f} to {1e6 * high:.2f} um with 95 %."
    )


def _against_speed() -> "Figure":
    """Draw the friction ratio against sliding speed by each friction model, with that of Table 2.3."""
    figure, axes = single_axes((6.6, 3.8))
    speeds = np.geomspace(2e-3, 0.4, 120)
    for index, (label, ratios) in enumerate(_curves(speeds)):
        axes.plot(1e3 * speeds, ratios, **line_style(index), label=label, lw=1.2 + index // 7)
    draw_measured(axes, friction_tests("A"), lambda test: 1e3 * test.sliding_speed, "measured, Table 2.3")
    axes.set(xscale="log", ylim=(0, 2), xlim=(2, 400))
    axes.set(xlabel="Sliding speed [mm/s]", ylabel="Friction with over without vibration [-]")
    axes.set_xticks([2, 5, 10, 20, 50, 100, 200], labels=["2", "5", "10", "20", "50", "100", "200"])
    axes.minorticks_off()
    figure.legend(loc="outside right upper")
    return figure


def _curves(speeds: Floats) -> Iterator[tuple[str, Floats]]:
    """Yield the friction ratio over the sliding speed by each friction model, with its label."""
    test = friction_tests("A")[0]
    contact, mu = test.contact, np.mean([one.friction_coefficient for one in friction_tests("A")])
    unbalanced = sinusoidal_motion(
        contact, normal_load=test.normal_load, vibration_amplitude=test.vibration_amplitude, frequency=test.frequency
    )
    balanced = load_balanced_motion(contact, unbalanced)
    fits = {fit.variant.name: fit for fit in reported_fits()}
    fraction, memory = fits["kinematic-fitted"].values[0], fits[DEFAULT].values[0]
    mindlin = float(friction.mindlin_memory_length(contact, friction_coefficient=mu, normal_load=test.normal_load))
    for label, model, motion in (
        ("cube, full period", friction.Dong2015FullPeriod(), unbalanced),
        ("cube, separating half period", friction.Dong2015HalfPeriod(), unbalanced),
        ("cube, load balanced", friction.Dong2015LoadBalanced(), unbalanced),
        ("kinematic", friction.Kinematic(), balanced),
        (
            f"kinematic, {fraction:.2f} of the\namplitude (fitted)",
            friction.Kinematic(amplitude_fraction=fraction),
            balanced,
        ),
        (
            f"asperity stick-slip, D_c = {1e6 * mindlin:.2f} µm\n(Mindlin, µ = {mu:.2f})",
            friction.AsperityStickSlip(memory_length=mindlin),
            balanced,
        ),
        (
            f"asperity stick-slip, D_c = {1e6 * memory:.2f} µm\n(fitted)",
            friction.AsperityStickSlip(memory_length=memory),
            balanced,
        ),
        ("bristle with rigid holder", friction.BristleWithHolder(), balanced),
    ):
        yield label, model.ratio(contact, motion, sliding_speed=speeds, friction_coefficient=mu)


def _predicted_against_measured() -> "Figure":
    """Draw predicted against measured ratios, one panel for each variant."""
    fits = reported_fits()
    rows = -(-len(fits) // _COLUMNS)
    figure, panels = subplots(rows, _COLUMNS, figsize=(6.85, 2.05 * rows + 0.5), sharex=True, sharey=True)
    for axes, fit in zip(panels.flat, fits, strict=False):
        _panel(axes, fit)
        axes.xaxis.set_tick_params(labelbottom=True)
    for axes in panels.flat[len(fits) :]:
        axes.set_visible(False)
    for axes in panels.flat[len(fits) - _COLUMNS : len(fits)]:
        axes.set_xlabel("Measured ratio [-]")
    for axes in panels[:, 0]:
        axes.set_ylabel("Predicted ratio [-]")
    handles, labels = panels.flat[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=-(-len(handles) // 2))
    return figure


def _panel(axes: "Axes", fit: Fit) -> None:
    """Draw the predictions of one variant against the measured ratios."""
    line = np.array([0.0, 1.1])
    axes.fill_between(line, line - 0.1, line + 0.1, color="0.9", zorder=0, label="within 0.1")
    axes.plot(line, line, color="0.5", lw=0.8, zorder=1, label="as measured")
    axes.plot([], [], "^", color="0.3", mfc="white", ms=5, label=f"above {_HIGHEST:g}")
    for index, letter in enumerate(NORMAL_VIBRATION_SETS):
        predicted = [(test, fit.predict(test)) for test in friction_tests(letter)]
        in_range = [(test, ratio) for test, ratio in predicted if ratio is not None]
        inside = [(test, ratio) for test, ratio in in_range if ratio <= _HIGHEST]
        colour, marker = COLOURS[index % 7], MARKERS[index % 7]
        measured, ratios = [test.friction_ratio for test, _ in inside], [ratio for _, ratio in inside]
        style: dict[str, Any] = {"color": colour, "mfc": colour if index < 7 else "white", "ms": 4.5, "elinewidth": 0.7}
        scatter = [test.uncertainty or 0.0 for test, _ in inside]
        axes.errorbar(measured, ratios, xerr=scatter, fmt=marker, **style, label=f"set {letter}")
        beyond = [test.friction_ratio for test, ratio in in_range if ratio > _HIGHEST]
        axes.plot(beyond, [_HIGHEST - 0.04] * len(beyond), "^", color=colour, mfc="white", ms=5)
    errors = prediction_errors(fit, friction_tests(SETS_WITHOUT_POWER_MAP))
    text = f"rms {errors.rms:.2g}" + (f", {len(errors.out_of_range)} out of range" if errors.out_of_range else "")
    axes.set(xlim=(0, 1.1), ylim=(-0.1, _HIGHEST))
    name = "\n".join(wrap(fit.variant.name.replace("-", " "), _TITLE_WIDTH))
    axes.set_title(f"{name}\n{text}", fontsize=7.5)


def _errors_by_test() -> "Figure":
    """Draw the errors of every variant in every test as a matrix, with error statistics and criteria."""
    tests, names = friction_tests(FITTED_SETS), [variant.name.replace("-", " ") for variant in FRICTION_MODEL_VARIANTS]
    assessments = [assess_variant(variant, FITTED_SETS) for variant in FRICTION_MODEL_VARIANTS]
    predicted = [[assessment.fit.predict(test) for test in tests] for assessment in assessments]
    errors = np.array(predicted, dtype=np.float64) - [test.friction_ratio for test in tests]
    figure, (axes, below) = subplots(2, 1, figsize=(6.85, 1.9 + 0.4 * len(names)))
    image = axes.imshow(errors, cmap="RdBu_r", vmin=-_LARGEST_ERROR, vmax=_LARGEST_ERROR, aspect="auto")
    for (row, column), error in np.ndenumerate(errors):
        if np.isfinite(error):
            shade = "white" if abs(error) > 0.7 * _LARGEST_ERROR else "black"
            text = f"{100 * error:+.0f}" if error < 1 else "> 99"
            axes.text(column, row, text, ha="center", va="center", fontsize=7, color=shade)
    axes.set_yticks(range(len(names)), labels=names)
    axes.set_xticks(range(len(tests)), labels=[f"{test.label}\n{test.friction_ratio:.2f}" for test in tests])
    axes.xaxis.tick_top()
    axes.tick_params(length=0, labelsize=8)
    axes.grid(visible=False)
    axes.set_xlabel("Test and its measured friction ratio [-]")
    axes.xaxis.set_label_position("top")
    _draw_statistics(below, assessments)
    below.set_yticks(range(len(names)), labels=names)
    below.set_ylim(axes.get_ylim())
    label = "Predicted minus measured friction ratio [-]"
    figure.colorbar(image, ax=axes, label=label, location="right", fraction=0.03, pad=0.02, extend="both")
    return figure


def _rms_text(rms: float) -> str:
    """Error of friction ratios to three decimals; one beyond ten says no more than that."""
    return f"{rms:.3f}" if rms <= 10 else "> 10"


def _draw_statistics(axes: "Axes", assessments: list[Assessment]) -> None:
    """Draw error statistics and information criteria as a table, one row for each variant."""
    heads = ("k", "rms", "median", "rms\nCV", "median\nCV", "AICc", "BIC")
    for row, assessment in enumerate(assessments):
        fit, cross_validation = assessment.fit_errors, assessment.cross_validation_errors
        criteria = assessment.information
        texts = (
            str(len(assessment.fit.values)),
            _rms_text(fit.rms),
            f"{100 * fit.median_relative:.0f} %",
            _rms_text(cross_validation.rms),
            f"{100 * cross_validation.median_relative:.0f} %",
            f"{criteria.aicc:.0f}" if criteria else "",
            f"{criteria.bic:.0f}" if criteria else "",
        )
        for column, text in enumerate(texts):
            axes.text(column, row, text, ha="center", va="center", fontsize=8)
    axes.set_xlim(-0.5, len(heads) - 0.5)
    axes.set_xticks(range(len(heads)), labels=heads)
    axes.xaxis.tick_top()
    axes.tick_params(length=0, labelsize=8)
    axes.spines[:].set_visible(False)
    axes.grid(visible=False)
