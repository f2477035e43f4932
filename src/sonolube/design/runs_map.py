"""Map of friction reduction between measured runs, by Gaussian process regression with its uncertainty."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import cho_factor, cho_solve
from scipy.optimize import minimize

from sonolube.checks import Floats, require_finite, require_non_negative
from sonolube.design.map_figures import MAP_LAYOUTS, map_layout, same_panels
from sonolube.errors import InvalidInput
from sonolube.measurement.measured_runs import run_caveats, setting, with_columns
from sonolube.rig import VOLTAGE, CommandedQuantity, Rig, own_level
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr

MIN_RUNS = 6
"""Least number of measured runs that are interpolated."""

# logarithms of the hyperparameters: both length scales, signal variance, noise variance
_BOUNDS = ((-2.5, 2.5), (-2.5, 2.5), (-7.0, 1.0), (-12.0, 0.0))
_STARTS = ((0.0, 0.0, -2.0, -6.0), (-1.0, 0.5, -2.0, -8.0), (0.5, -1.0, -3.0, -5.0))


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class GaussianProcessMap:
    """Friction reduction predicted by a Gaussian process from measured runs.

    Parameters
    ----------
    friction_reduction : ndarray, shape (...)
        Predictive mean at each point. []
    friction_reduction_uncertainty : ndarray, shape (...)
        Predictive standard deviation of the mean, without the scatter from run to run. []
    scatter : float
        Standard deviation of runs about the mean, estimated from the runs themselves.
    leave_one_out_error : float
        Root-mean-square error of the prediction of each run from all others.
    """

    friction_reduction: Floats
    friction_reduction_uncertainty: Floats
    scatter: float
    leave_one_out_error: float


def gaussian_process_map(
    *,
    runs: ArrayLike,
    friction_reduction: ArrayLike,
    points: ArrayLike,
    friction_reduction_uncertainty: ArrayLike = 0.0,
) -> GaussianProcessMap:
    r"""Friction reduction between measured runs by Gaussian process regression (ordinary kriging).

    Parameters
    ----------
    runs : array_like, shape (n, 2)
        Both coordinates of each run, such as sliding speed and power; six runs or more.
    friction_reduction : array_like, shape (n,)
        Measured friction reduction of each run. []
    points : array_like, shape (..., 2)
        Coordinates of the predictions.
    friction_reduction_uncertainty : array_like, shape () or (n,)
        Standard uncertainty of each run. []

    Returns
    -------
    GaussianProcessMap

    Raises
    ------
    InvalidInput
        If there are too few runs, shapes do not match, all runs agree in a coordinate, or a value is not finite.

    Notes
    -----
    The process has an unknown constant mean and the squared-exponential covariance

    .. math::

        k(x, x') = \sigma_f^2 \exp\Bigl(-\tfrac12 \sum_{j=1}^2 \frac{(x_j - x'_j)^2}{\ell_j^2}\Bigr)

    between coordinates in units of their standard deviation. With :math:`K = k(X, X) + \operatorname{diag}(u^2) +
    \sigma_n^2 I`, the generalised least-squares mean :math:`m = 1^T K^{-1} z / (1^T K^{-1} 1)` and
    :math:`k_* = k(X, x_*)`,

    .. math::

        \bar z_* &= m + k_*^T K^{-1} (z - m 1)

        \operatorname{Var} z_* &= \sigma_f^2 - k_*^T K^{-1} k_*
            + \frac{(1 - 1^T K^{-1} k_*)^2}{1^T K^{-1} 1}

    (equations 2.25, 2.26 and, for the mean, 2.42 of [1]_). Length scales, variance and scatter :math:`\sigma_n`
    maximise the likelihood of the runs (5.8). Far from all runs the prediction returns to their mean, with the
    uncertainty of the whole process.

    References
    ----------
    .. [1] C. E. Rasmussen, C. K. I. Williams, Gaussian Processes for Machine Learning, MIT Press (2006), equations
       2.25, 2.26, 2.42, 5.8 and 5.12.
    """
    z = require_finite(friction_reduction=friction_reduction)
    uncertainty = require_non_negative(friction_reduction_uncertainty=friction_reduction_uncertainty)
    x, x_star = (np.asarray(array, dtype=np.float64) for array in (runs, points))
    if (
        x.ndim != 2
        or x.shape[1] != 2
        or x_star.shape[-1:] != (2,)
        or z.shape != x.shape[:1]
        or uncertainty.shape not in ((), z.shape)
    ):
        raise InvalidInput(
            f"runs and points must be pairs, one reduction to a run, got shapes {x.shape}, {x_star.shape}, {z.shape}"
        )
    if not (np.isfinite(x).all() and np.isfinite(x_star).all()):
        raise InvalidInput("runs and points must be finite")
    if z.size < MIN_RUNS:
        raise InvalidInput(f"a map needs {MIN_RUNS} runs or more, got {z.size}")
    centre, width = x.mean(axis=0), x.std(axis=0)
    if not np.all(width > 0):
        raise InvalidInput("all runs agree in a coordinate: a map needs runs that differ in both")
    x, x_star = (x - centre) / width, (x_star - centre) / width
    noise = np.broadcast_to(uncertainty**2, z.shape)
    fits = [
        minimize(_negative_log_likelihood, start, args=(x, z, noise), method="L-BFGS-B", bounds=_BOUNDS)
        for start in _STARTS
    ]
    logs = min(fits, key=lambda fit: float(fit.fun)).x
    inverse = np.linalg.inv(_covariance(logs, x, noise))
    ones = np.ones(z.size)
    precision = ones @ inverse @ ones  # of the estimated mean
    mean = float(ones @ inverse @ z / precision)
    weights = inverse @ (z - mean)
    k_star = _kernel(logs, x_star.reshape(-1, 2), x)
    mean_residual = 1 - k_star @ inverse @ ones
    explained = np.einsum("ij,jk,ik->i", k_star, inverse, k_star)
    variance = np.exp(logs[2]) - explained + mean_residual**2 / precision
    reduced = inverse - np.outer(inverse @ ones, ones @ inverse) / precision
    leave_one_out = (reduced @ z) / np.diag(reduced)
    shape = x_star.shape[:-1]
    return GaussianProcessMap(
        friction_reduction=(mean + k_star @ weights).reshape(shape),
        friction_reduction_uncertainty=np.sqrt(np.maximum(variance, 0.0)).reshape(shape),
        scatter=float(np.exp(logs[3] / 2)),
        leave_one_out_error=float(np.sqrt(np.mean(leave_one_out**2))),
    )


def _kernel(logs: Floats, a: Floats, b: Floats) -> Floats:
    """Squared-exponential covariance between the points of two sets."""
    distance = (a[:, np.newaxis] - b) / np.exp(logs[:2])
    return np.asarray(np.exp(logs[2] - 0.5 * np.sum(distance**2, axis=-1)))


def _covariance(logs: Floats, x: Floats, noise: Floats) -> Floats:
    """Covariance matrix of the runs: kernel, measurement uncertainty and scatter."""
    return _kernel(logs, x, x) + np.diag(noise + np.exp(logs[3]))


def _negative_log_likelihood(logs: Floats, x: Floats, z: Floats, noise: Floats) -> float:
    """Negative log marginal likelihood of the runs but for a constant, with the mean that maximises it."""
    factor = cho_factor(_covariance(logs, x, noise), lower=True)
    ones = np.ones(z.size)
    weights = cho_solve(factor, ones)
    residual = z - (weights @ z) / (weights @ ones)
    return float(0.5 * residual @ cho_solve(factor, residual) + np.sum(np.log(np.diag(factor[0]))))


_POWER = "actuator_power"  # column of the measured power
_STAND_INS = {"power_to_supply": (_POWER, "voltage_peak_to_peak")}  # columns that give an axis
_BY_THE_RIG = ("nominal_pressure",)  # axes that a rig gives where no column does
_GRID_POINTS = 61  # of the interpolated map along each axis
_MATCH = 1e-3  # relative difference of a load or voltage below which a run belongs to a panel as it is
_UNCERTAINTY = "friction_reduction_uncertainty"


def require_mappable(runs: "xr.Dataset", *, kind: str, commanded: CommandedQuantity) -> None:
    """Raise if measured runs cannot be drawn on a kind of map."""
    across, up, panel = MAP_LAYOUTS[kind]
    panel = commanded.name if panel == VOLTAGE.name else panel
    for axis in (across, up):
        columns = _STAND_INS.get(axis, (axis,))
        if axis not in _BY_THE_RIG and not any(column in runs for column in columns):
            raise InvalidInput(f"measured runs need a column {columns[0]} for a {kind} map")
    several = panel is not None and panel in runs and np.unique(runs[panel].values).size > 1
    if several and runs.sizes["run"] >= MIN_RUNS:
        raise InvalidInput(f"measured runs at several values of {panel} make several maps: give one file to each")


def runs_on_map(runs: "xr.Dataset", rig: Rig, computed: "xr.Dataset") -> tuple["xr.Dataset", tuple[str, ...]]:
    """Measured runs with the quantities of both axes of a map, and caveats about those without a place on it.

    The runs with a place, each with the number of its `panel`, -1 for none, and `shown_friction_reduction`: as measured
    where its load or voltage is that of the panel, else moved to the nearest panel by the difference of the model
    (`is_moved`).
    """
    across, up, _ = map_layout(computed)
    is_power = MAP_LAYOUTS[computed.attrs["map"]][1] == "power_to_supply"
    if is_power:
        runs = runs.assign({_POWER: ("run", setting(runs, _POWER, _power_of_voltage(runs, rig, computed[up])))})
        runs = runs.assign({up: runs[_POWER]})
    if up == "nominal_pressure":
        pressure = setting(runs, "normal_load", rig.normal_load) / rig.contact.nominal_area
        runs = runs.assign({up: ("run", setting(runs, up, pressure))})
    placed, skipped = with_columns(runs, across, _POWER if is_power else up)
    shown, beyond = _on_panels(placed, rig, computed)
    return shown, (*run_caveats(runs), *skipped, *beyond)


def _power_of_voltage(runs: "xr.Dataset", rig: Rig, power: "xr.DataArray") -> Floats:
    """Power of a map, over load and voltage, at the voltage of each run and the load next to its own; NaN beyond it."""
    load, voltage = setting(runs, "normal_load", rig.normal_load), setting(runs, "voltage_peak_to_peak", np.nan)
    volts, watts = power["voltage_peak_to_peak"].values, power.transpose("normal_load", ...).values
    panel = np.argmin(np.abs(power["normal_load"].values - load[:, np.newaxis]), axis=1)
    found = [
        np.interp(at, volts, watts[place], left=np.nan, right=np.nan) for at, place in zip(voltage, panel, strict=True)
    ]
    return np.array(found)


def _on_panels(runs: "xr.Dataset", rig: Rig, computed: "xr.Dataset") -> tuple["xr.Dataset", tuple[str, ...]]:
    """Runs with the nearest panel and the reduction there, and caveats about those that are moved or beyond it."""
    panel = map_layout(computed)[2]
    count = runs.sizes["run"]
    place, shift = np.zeros(count, int), np.zeros(count)
    name = ""
    if panel is not None and not same_panels(computed):
        name = quantity(panel).meaning.partition(",")[0].lower()
        values, own = computed[panel].values, setting(runs, panel, _rigs_own(rig, panel))
        place = np.argmin(np.abs(values - own[:, None]), axis=1)
        matching = np.isclose(own, values[place], rtol=_MATCH)
        shift = np.where(matching, 0.0, _model(computed, runs, values[place]) - _model(computed, runs, own))
    moved, beyond = shift != 0.0, np.isnan(shift)
    shown = runs.assign(
        panel=("run", np.where(beyond, -1, place)),
        is_moved=("run", moved & ~beyond),
        shown_friction_reduction=("run", runs["friction_reduction"].values + np.nan_to_num(shift)),
    )
    caveats = []
    if (moved & ~beyond).any():
        number = f"{int((moved & ~beyond).sum())} of {count} runs"
        caveats.append(f"{number} are drawn at the {name} of the nearest panel, moved there by the model")
    if beyond.any():
        caveats.append(
            f"{int(beyond.sum())} of {count} runs are not drawn: their {name} lies beyond the panels of the map"
        )
    return shown, tuple(caveats)


def _rigs_own(rig: Rig, panel: str) -> float:
    """Load of a rig, or its voltage or amplitude, for runs that state none."""
    if panel == "normal_load":
        return rig.normal_load
    return own_level(rig)


def _model(computed: "xr.Dataset", runs: "xr.Dataset", at: Floats) -> Floats:
    """Reduction on a map at the places of runs and at values of the quantity of its panels; NaN beyond it."""
    from scipy.interpolate import RegularGridInterpolator

    across, up, panel = map_layout(computed)
    assert panel is not None
    if computed.sizes[panel] < 2:
        return np.full(at.size, np.nan)
    along = next(name for name in computed[up].dims if name != panel)
    values = computed["friction_reduction"].transpose(panel, along, computed[across].dims[0]).values
    height = computed[up].values
    if panel in computed[up].dims:
        height, values = _on_one_axis(computed[up].transpose(panel, along).values, values)
    axes = (computed[panel].values, height, computed[across].values)
    interpolated = RegularGridInterpolator(axes, values, bounds_error=False)
    return np.asarray(interpolated(np.stack([at, runs[up].values, runs[across].values], axis=1)), float)


def _on_one_axis(heights: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Vertical axis that all panels, rows of `heights`, have, and the values of each panel along it."""
    order = np.argsort(heights, axis=1)
    heights = np.take_along_axis(heights, order, axis=1)
    values = np.take_along_axis(values, order[..., np.newaxis], axis=1)
    common = np.linspace(heights[:, 0].max(), heights[:, -1].min(), heights.shape[1])
    along = [
        np.stack([np.interp(common, height, column) for column in panel.T], axis=-1)
        for height, panel in zip(heights, values, strict=True)
    ]
    return common, np.stack(along)


def runs_map(runs: "xr.Dataset", *, kind: str) -> "xr.Dataset | None":
    """Friction reduction between measured runs over the axes of a map, with its uncertainty.

    Over both axes of the map, with the scatter of the runs and their leave-one-out error as attributes; None for fewer
    than `MIN_RUNS` runs.

    See Also
    --------
    measured_map
    """
    import xarray as xr

    if runs.sizes["run"] < MIN_RUNS:
        return None
    across, up, _ = MAP_LAYOUTS[kind]
    x, y = (np.linspace(float(runs[axis].min()), float(runs[axis].max()), _GRID_POINTS) for axis in (across, up))
    interpolated = gaussian_process_map(
        runs=np.stack([runs[across].values, runs[up].values], axis=1),
        friction_reduction=runs["friction_reduction"].values,
        friction_reduction_uncertainty=runs[_UNCERTAINTY].values if _UNCERTAINTY in runs else 0.0,
        points=np.stack(np.meshgrid(x, y), axis=-1),
    )
    return xr.Dataset(
        {
            "friction_reduction": ((up, across), interpolated.friction_reduction, {"units": "1"}),
            _UNCERTAINTY: ((up, across), interpolated.friction_reduction_uncertainty, {"units": "1"}),
        },
        coords={across: (across, x, {"units": quantity(across).unit}), up: (up, y, {"units": quantity(up).unit})},
        attrs={
            "title": f"Friction reduction between {runs.sizes['run']} measured runs",
            "map": kind,
            "scatter": interpolated.scatter,
            "leave_one_out_error": interpolated.leave_one_out_error,
        },
    )
