"""Own measured runs of a rig, as tests that update its prediction."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.prediction.evidence import TestedRig
from sonolube.prediction.inputs import Input, RigInputs

if TYPE_CHECKING:
    import xarray as xr

_MOST_RUNS: Final = 200
_LARGEST_RATIO: Final = 2.0  # beyond it, vibration along the normal is not what changed
_SMALLEST_RATIO: Final = -0.2  # of a force whose zero is off
_USUAL_UNCERTAINTY: Final = 0.05  # of a friction ratio, where neither column nor repeats state it
_FEWEST_REPEATS: Final = 4  # from which the scatter of repeats is taken


@dataclass(frozen=True, kw_only=True, slots=True)
class OwnRuns:
    """Measured runs of a rig.

    Parameters
    ----------
    tested : TestedRig
        Friction ratios with their conditions.
    friction : Input or None
        Intrinsic coefficient of friction by the runs, where they have forces.
    wear_rate_ratio : ndarray, shape (n,)
        Of runs that state wear; may be empty. []
    caveats : tuple of str
    """

    tested: TestedRig
    friction: Input | None
    wear_rate_ratio: Floats
    caveats: tuple[str, ...]


def own_runs(runs: "xr.Dataset", inputs: RigInputs, *, title: str) -> OwnRuns:
    """Measured runs of a rig with what they do not state taken from the rig.

    Parameters
    ----------
    runs : xarray.Dataset
        Over `run`, in SI: `friction_reduction`, with `friction_reduction_uncertainty` where it is known;
        `vibration_amplitude` or `voltage_peak_to_peak`, `sliding_speed`, `normal_load`,
        where they are not the rig's; `intrinsic_friction_force`; `wear_rate_ratio` or `wear_reduction`.
    inputs : RigInputs
    title : str
        Of the rig.

    Returns
    -------
    OwnRuns

    Raises
    ------
    InvalidInput
        If a ratio is beyond what vibration does, or a speed, amplitude or uncertainty is not positive.
    """
    ratio = 1 - np.asarray(runs["friction_reduction"].to_numpy(), float)
    if ratio.size > _MOST_RUNS:
        raise InvalidInput(f"{title}: {ratio.size} runs; at most {_MOST_RUNS} update a prediction: average repeats")
    outside = (ratio < _SMALLEST_RATIO) | (ratio > _LARGEST_RATIO)
    if np.any(outside):
        raise InvalidInput(
            f"{title}: run {int(np.argmax(outside)) + 1} has a friction ratio of {ratio[np.argmax(outside)]:.3g};"
            f" vibration gives {_SMALLEST_RATIO:g} to {_LARGEST_RATIO:g}: check zero and sign of the force"
        )
    runs, copies = _without_copies(runs)
    ratio = 1 - np.asarray(runs["friction_reduction"].to_numpy(), float)
    amplitude, speed = _amplitudes(runs, inputs), _column(runs, "sliding_speed", inputs.sliding_speed)
    for name, values in (("vibration_amplitude", amplitude), ("sliding_speed", speed)):
        if not np.all(values > 0):
            raise InvalidInput(f"{title}: {name} of run {int(np.argmin(values > 0)) + 1} must be positive")
    at = inputs.at(vibration_amplitude=amplitude, sliding_speed=speed)
    uncertainty, caveats = _uncertainty(runs, ratio, amplitude, speed)
    caveats = (*copies, *caveats)
    loads = _column(runs, "normal_load", inputs.normal_load)
    if np.any(np.abs(loads / inputs.normal_load - 1) > 0.5):
        caveats += ("some runs have a load far from the rig's; closures do not depend on the load",)
    return OwnRuns(
        tested=TestedRig(name=title, at=at, friction_ratio=ratio, uncertainty=uncertainty),
        friction=_intrinsic(runs, loads),
        wear_rate_ratio=_wear(runs),
        caveats=caveats,
    )


def _amplitudes(runs: "xr.Dataset", inputs: RigInputs) -> Floats:
    """Amplitude of each run; by its voltage in proportion to the rig's, where only that is stated."""
    if "vibration_amplitude" in runs:
        return np.asarray(runs["vibration_amplitude"].to_numpy(), float)
    if "voltage_peak_to_peak" in runs:
        if inputs.voltage_peak_to_peak is None:
            raise InvalidInput(
                "the runs state voltages, but the rig has no drive.voltage_peak_to_peak to scale them by"
            )
        voltage = np.asarray(runs["voltage_peak_to_peak"].to_numpy(), float)
        return inputs.amplitude.value * voltage / inputs.voltage_peak_to_peak
    return np.full(runs.sizes["run"], inputs.amplitude.value)


def _without_copies(runs: "xr.Dataset") -> tuple["xr.Dataset", tuple[str, ...]]:
    """Runs without those that equal an earlier one in every digit, and a caveat about them."""
    rows = np.column_stack([np.asarray(runs[name].to_numpy(), float) for name in runs.data_vars])
    first = np.sort(np.unique(rows, axis=0, return_index=True)[1])
    copies = len(rows) - first.size
    if not copies:
        return runs, ()
    return runs.isel(run=first), (
        f"{copies} of {len(rows)} runs equal another in every digit; they count as copies, not as repeats",
    )


def _column(runs: "xr.Dataset", name: str, otherwise: float) -> Floats:
    """Column of the runs, or one value for all."""
    if name in runs:
        return np.asarray(runs[name].to_numpy(), float)
    return np.full(runs.sizes["run"], otherwise)


def _uncertainty(runs: "xr.Dataset", ratio: Floats, amplitude: Floats, speed: Floats) -> tuple[Floats, tuple[str, ...]]:
    """Standard uncertainty of each ratio: as stated, by the scatter of repeats, or the usual one."""
    if "friction_reduction_uncertainty" in runs:
        stated = np.asarray(runs["friction_reduction_uncertainty"].to_numpy(), float)
        if not np.all(stated > 0):
            raise InvalidInput("friction_reduction_uncertainty must be positive in every run")
        return stated, ()
    keys = np.round(np.log(np.stack([amplitude, speed])), 2)
    _, group, counts = np.unique(keys, axis=1, return_inverse=True, return_counts=True)
    free = ratio.size - counts.size
    if free + 1 >= _FEWEST_REPEATS:
        means = np.bincount(group.ravel(), weights=ratio) / counts
        scatter = float(np.sqrt(np.sum((ratio - means[group.ravel()]) ** 2) / free))
        return np.full(ratio.size, scatter), ()
    return np.full(ratio.size, _USUAL_UNCERTAINTY), (
        f"the runs state no uncertainty and hold too few repeats; {_USUAL_UNCERTAINTY:g} is taken for each ratio",
    )


def _intrinsic(runs: "xr.Dataset", loads: Floats) -> Input | None:
    """Intrinsic coefficient of friction by the runs' own forces without vibration."""
    if "intrinsic_friction_force" not in runs:
        return None
    logs = np.log(np.asarray(runs["intrinsic_friction_force"].to_numpy(), float) / loads)
    spread = float(np.std(logs, ddof=1) / np.sqrt(logs.size)) if logs.size > 1 else _USUAL_UNCERTAINTY
    return Input(
        name="friction_coefficient",
        label="dry friction",
        value=float(np.exp(np.mean(logs))),
        spread=max(spread, 0.02),
        reason="forces of the runs without vibration",
        remedy="more runs without vibration",
    )


def _wear(runs: "xr.Dataset") -> Floats:
    """Wear rate ratios of the runs that state wear."""
    if "wear_rate_ratio" in runs:
        ratios = np.asarray(runs["wear_rate_ratio"].to_numpy(), float)
    elif "wear_reduction" in runs:
        ratios = 1 - np.asarray(runs["wear_reduction"].to_numpy(), float)
    else:
        return np.empty(0)
    if not np.all(ratios > 0):
        raise InvalidInput("wear with vibration over wear without must be positive in every run")
    return ratios
