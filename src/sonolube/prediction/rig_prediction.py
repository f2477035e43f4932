"""Prediction of a rig: friction, wear, heat and power under vibration, with predictive intervals."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.errors import InvalidInput, MissingProperty
from sonolube.prediction.inputs import Input, RigInputs, rig_inputs
from sonolube.prediction.own_runs import OwnRuns, own_runs
from sonolube.prediction.posterior import learned
from sonolube.prediction.predictive import RatioDraws, ratio_draws
from sonolube.prediction.scores import LEVELS, central_interval
from sonolube.prediction.tested_range import extrapolation_caveats
from sonolube.rig import Rig, thermal_solid
from sonolube.rig.datasets import labels
from sonolube.rig.labelled_arrays import LabelledArray, LabelledArrays
from sonolube.thermal import EllipticSource, contact_rise

if TYPE_CHECKING:
    import xarray as xr

_CURVE: Final = 33  # points of a curve
_KNOWN_WELL: Final = {"rms_height": 0.05, "vibration_amplitude": 0.02, "friction_coefficient": 0.03}
# spreads by a careful measurement
_NO_GAIN: Final = 0.95  # share of an interval from which on measuring an input is not worth it
_NARROWEST: Final = 1e-6  # width of an interval, where all draws are at a limit
_HOT: Final = 50.0  # K, mean rise of the contact from which metals soften or lubricants change


def predict(
    rig: Rig,
    *,
    runs: "xr.Dataset | None" = None,
    pin: str | None = None,
    disc: str | None = None,
    draws: int = 4000,
    seed: int = 0,
) -> "xr.Dataset":
    """Return what vibration does to friction and wear on a rig, with its uncertainty.

    Parameters
    ----------
    rig : Rig
    runs : xarray.Dataset, optional
        Own measured runs over `run`, as `sonolube.measurement.read_runs` returns them.
    pin, disc : str, optional
        Materials of the catalogue, for the temperature rise of the contact; by default those of the rig.
    draws : int
        Equally probable outcomes.
    seed : int

    Returns
    -------
    xarray.Dataset
        Over `draw`: friction ratio, reduction, force and coefficient, wear rate ratio and reduction, and the mean
        temperature rise of the contact where both materials are given. Over `level`: quantiles of the friction ratio
        along `curve_amplitude` and `curve_speed`. Over `input`, the least known first: spread of each uncertain input,
        and the shares of the 80 % intervals of friction ratio and friction force that would be left if it were known
        well. Attributes hold caveats, assumptions, weights of closures and the statement in words.

    Raises
    ------
    InvalidInput
        If the rig does not vibrate or slide, or the runs cannot be those of the rig.
    MissingProperty, UnknownName
        For a material without thermal properties.
    """
    return prediction_arrays(rig, runs=runs, pin=pin, disc=disc, draws=draws, seed=seed).dataset()


def prediction_arrays(
    rig: Rig,
    *,
    runs: "xr.Dataset | None" = None,
    pin: str | None = None,
    disc: str | None = None,
    draws: int = 4000,
    seed: int = 0,
) -> LabelledArrays:
    """Return what `predict` does, without xarray."""
    inputs = rig_inputs(rig)
    own = None if runs is None else own_runs(runs, inputs, title=rig.title)
    if own is not None and own.friction is not None:
        inputs = inputs.with_input(own.friction)
    found = _ratios(inputs, own, draws=draws, seed=seed)
    heating = _contact_heating(rig, pin, disc)
    drawn = _quantities(rig, inputs, own, found.friction_ratio[:, 0], heating, seed)
    amplitudes, speeds = _curve_points(inputs.amplitude.value), _curve_points(inputs.sliding_speed)
    curves = {
        "amplitude": _quantiles(inputs, own, vibration_amplitude=amplitudes),
        "speed": _quantiles(inputs, own, sliding_speed=speeds),
    }
    uncertain = sorted(inputs.uncertain, key=lambda each: -each.spread)
    shares = np.array([_shares_left(each, inputs, own, drawn, seed=seed) for each in uncertain])
    variables = {
        **{name: LabelledArray(dims=("draw",), values=values, attrs=labels(name)) for name, values in drawn.items()},
        **{
            f"friction_ratio_over_{name}": LabelledArray(dims=("level", f"curve_{name}"), values=each)
            for name, each in curves.items()
        },
        **({} if own is None else _along("run", _measured(own))),
        **_along("input", _described(uncertain)),
        **_along("input", {"interval_share_left": shares[:, 0], "force_interval_share_left": shares[:, 1]}),
    }
    coordinates = {
        "level": np.array(LEVELS),
        "curve_amplitude": amplitudes,
        "curve_speed": speeds,
        "input": np.array([each.name for each in uncertain]),
    }
    result = LabelledArrays(
        variables=variables,
        coordinates={
            name: LabelledArray(dims=(name,), values=np.asarray(values)) for name, values in coordinates.items()
        },
        attrs=_attributes(rig, inputs, own, found) | {"heat": heating if isinstance(heating, str) else ""},
    )
    return result.assign_attrs(statement="\n".join(statement(result)))


def interval(prediction: "xr.Dataset | LabelledArrays", name: str, probability: float = 0.8) -> tuple[float, float]:
    """Return the central predictive interval of a quantity.

    Parameters
    ----------
    prediction : xarray.Dataset or LabelledArrays
        By `predict`.
    name : str
        A variable over `draw`.
    probability : float
        Within the interval.

    Returns
    -------
    low, high : float
        In the unit of the quantity.
    """
    low, high = central_interval(prediction[name].to_numpy(), probability)
    return float(low), float(high)


def statement(prediction: "xr.Dataset | LabelledArrays") -> tuple[str, str, str]:
    """Return the prediction in three sentences: the outcome, what to measure, and what limits it.

    Parameters
    ----------
    prediction : xarray.Dataset or LabelledArrays

    Returns
    -------
    tuple of str
    """
    low, high = (100 * each for each in interval(prediction, "friction_reduction"))
    shares = prediction["interval_share_left"].to_numpy()
    least = int(np.nanargmin(shares))
    what, remedy = (prediction[name].to_numpy()[least] for name in ("input_label", "remedy"))
    left = f"{100 * shares[least]:.0f} % of its width"
    advice = f"The least known input is the {what}; {remedy} would narrow the interval to {left}."
    if shares[least] > _NO_GAIN:
        advice = "No input measured better would narrow the interval much; runs with vibration would."
    return (f"Friction falls by {max(low, 0):.0f} to {high:.0f} % (80 %).", advice, _limits(prediction))


def _limits(prediction: "xr.Dataset | LabelledArrays") -> str:
    """Sentence on heat and power."""
    parts = []
    if "mean_temperature_rise" in prediction:
        high = interval(prediction, "mean_temperature_rise")[1]
        parts.append(f"Heat of friction {'limits' if high > _HOT else 'does not limit'}: at most {high:.2g} K (80 %)")
    else:
        parts.append(f"Heat is not computed: {prediction.attrs['heat']}")
    power = prediction.attrs.get("actuator_power")
    unknown = "power is not known: capacitance or voltage is missing"
    parts.append(unknown if power is None else f"the amplifier supplies {power:.3g} W")
    return "; ".join(parts) + "."


def _ratios(inputs: RigInputs, own: OwnRuns | None, *, draws: int, seed: int) -> RatioDraws:
    """Draws of the friction ratio at the operating point."""
    tested = None if own is None else own.tested
    return ratio_draws(learned().friction, inputs.at(), count=draws, seed=seed, own=tested)


def _quantities(
    rig: Rig, inputs: RigInputs, own: OwnRuns | None, ratio: Floats, heating: float | str, seed: int
) -> dict[str, Floats]:
    """Draws of all quantities that follow from the friction ratio, and of wear."""
    intrinsic = _intrinsic_coefficients(inputs.friction, count=ratio.size, seed=seed)
    measured = np.empty(0) if own is None else own.wear_rate_ratio
    wear = learned().wear.wear_rate_ratios(ratio.size, measured=measured, seed=seed)
    found = {
        "friction_ratio": ratio,
        "friction_reduction": 1 - ratio,
        "friction_coefficient": ratio * intrinsic,
        "friction_force": ratio * intrinsic * rig.normal_load,
        "wear_rate_ratio": wear,
        "wear_reduction": 1 - wear,
    }
    if not isinstance(heating, str):
        found["mean_temperature_rise"] = heating * found["friction_force"] * rig.sliding_speed
    return found


def _measured(own: OwnRuns) -> dict[str, Floats]:
    """Own runs as they entered the prediction."""
    tested = own.tested
    return {
        "measured_friction_ratio": tested.friction_ratio,
        "measured_uncertainty": tested.uncertainty,
        "measured_vibration_amplitude": tested.at.conditions.vibration_amplitude,
        "measured_sliding_speed": tested.at.conditions.sliding_speed,
    }


def _described(uncertain: Sequence[Input]) -> dict[str, NDArray[Any]]:
    """Values and texts of uncertain inputs, by the names that they have in a prediction."""
    return {
        "input_value": np.array([each.value for each in uncertain]),
        "input_spread": np.array([each.spread for each in uncertain]),
        "input_label": np.array([each.label for each in uncertain]),
        "input_text": np.array([each.text for each in uncertain]),
        "reason": np.array([each.reason for each in uncertain]),
        "remedy": np.array([each.remedy for each in uncertain]),
    }


def _along(name: str, values: Mapping[str, NDArray[Any]]) -> dict[str, LabelledArray]:
    """Arrays over one axis."""
    return {each: LabelledArray(dims=(name,), values=array) for each, array in values.items()}


def _contact_heating(rig: Rig, pin: str | None, disc: str | None) -> float | str:
    """Mean temperature rise of the contact, taken as circular, for a watt of friction, in K/W; or why it is unknown."""
    named = pin is not None or disc is not None
    pin, disc = pin or rig.pin_material, disc or rig.disc_material
    if pin is None or disc is None:
        if named:
            raise InvalidInput("the temperature rise needs both materials; give pin and disc, or neither")
        return "name the materials of pin and disc"
    try:
        solids = thermal_solid(pin), thermal_solid(disc)
    except MissingProperty as missing:
        if named:
            raise
        return str(missing)
    radius = float(np.sqrt(rig.contact.nominal_area / np.pi))
    source = EllipticSource(half_length=radius, half_width=radius)
    rise = contact_rise(*solids, source, heat_rate=1.0, sliding_speed=rig.sliding_speed)
    return float(rise.mean_temperature_rise)


def _curve_points(value: float) -> Floats:
    """Points of a curve about a value, to a tenth and to three times it."""
    return value * np.geomspace(0.1, 3.0, _CURVE)


def _quantiles(inputs: RigInputs, own: OwnRuns | None, **along: Floats) -> Floats:
    """Quantiles of the friction ratio along a curve, shape (levels, points)."""
    tested = None if own is None else own.tested
    found = ratio_draws(learned().friction, inputs.at(**along), count=2000, own=tested)
    return np.quantile(found.friction_ratio, LEVELS, axis=0)


def _intrinsic_coefficients(friction: Input, *, count: int, seed: int) -> Floats:
    """Draws of the coefficient of friction without vibration."""
    return friction.value * np.exp(friction.spread * np.random.default_rng(seed + 1).standard_normal(count))


def _shares_left(
    uncertain: Input, inputs: RigInputs, own: OwnRuns | None, drawn: Mapping[str, Floats], *, seed: int
) -> tuple[float, float]:
    """Widths of the 80 % intervals of friction ratio and force if one input were known well, over those now."""
    better = inputs.with_input(replace(uncertain, spread=min(uncertain.spread, _KNOWN_WELL[uncertain.name])))
    ratio = drawn["friction_ratio"]
    if better.friction is inputs.friction:
        ratio = _ratios(better, own, draws=ratio.size, seed=seed).friction_ratio[:, 0]
    intrinsic = _intrinsic_coefficients(better.friction, count=ratio.size, seed=seed)
    return (
        _width(ratio) / max(_width(drawn["friction_ratio"]), _NARROWEST),
        _width(ratio * intrinsic) / max(_width(drawn["friction_coefficient"]), _NARROWEST),
    )


def _width(draws: Floats) -> float:
    """Width of the 80 % interval."""
    low, high = central_interval(draws, 0.8)
    return float(high - low)


def _attributes(rig: Rig, inputs: RigInputs, own: OwnRuns | None, found: RatioDraws) -> dict[str, object]:
    """Title, caveats, assumptions, weights of closures and numbers without a distribution."""
    point = inputs.point
    caveats = [*point.caveats, *extrapolation_caveats(rig, inputs)]
    if own is not None and not found.explained:
        caveats.append(
            f"no closure explains the measured runs (probability {found.surprise:.1g}); check their amplitude, load and"
            " zero of the force, or expect another mechanism; they count with a larger uncertainty"
        )
    if own is not None:
        caveats += own.caveats
    attributes: dict[str, object] = {
        "result": "prediction",
        "title": rig.title,
        "caveats": "\n".join(caveats),
        "assumptions": "\n".join(f"{key}: {reason}" for key, reason in rig.assumptions.items()),
        "closures": ", ".join(f"{name} {100 * weight:.0f} %" for name, weight in found.weights.items()),
        "vibration_amplitude": inputs.amplitude.value,
        "sliding_speed": inputs.sliding_speed,
        "runs": 0 if own is None else own.tested.friction_ratio.size,
    }
    if point.actuator_power is not None:
        attributes["actuator_power"] = point.actuator_power
    if np.isfinite(point.friction_ratio):
        attributes["friction_ratio_by_the_rigs_model"] = point.friction_ratio
        attributes["friction_model"] = point.friction_model
    return attributes
