"""Own measured runs of a rig, as tests that update its prediction."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.checks import Floats, Integers
from sonolube.errors import InvalidInput
from sonolube.measurement.measured_runs import run_caveats
from sonolube.measurement.run_selection import checked_ratios, copies_caveat, setting
from sonolube.prediction.evidence import TestedRig
from sonolube.prediction.inputs import Input, RigInputs
from sonolube.validation.run_conditions import known_amplitudes, pooled_scatter

if TYPE_CHECKING:
    import xarray as xr

_MAX_RUNS: Final = 200
_USUAL_UNCERTAINTY: Final = 0.05  # of a friction ratio, where neither column nor repeats state it
_MIN_REPEATS: Final = 4  # from which the scatter of repeats is taken


@dataclass(frozen=True, kw_only=True, slots=True)
class OwnRuns:
    """Measured runs of a rig.

    Parameters
    ----------
    tested : TestedRig
        Friction ratios with their conditions.
    friction : Input or None
        Intrinsic coefficient of friction by the runs, where they have forces.
    wear_rate_ratio : ndarray, shape (w,)
        Of runs that state wear; may be empty. []
    wear_runs : ndarray of int, shape (w,)
        Places of these runs.
    caveats : tuple of str
    """

    tested: TestedRig
    friction: Input | None
    wear_rate_ratio: Floats
    wear_runs: Integers
    caveats: tuple[str, ...]


def own_runs(runs: "xr.Dataset", inputs: RigInputs, *, title: str) -> OwnRuns:
    """Measured runs of a rig with what they do not state taken from the rig."""
    count = runs.sizes["run"]
    if count > _MAX_RUNS:
        raise InvalidInput(f"{title}: {count} runs; at most {_MAX_RUNS} update a prediction: average repeats")
    ratio, copies = checked_ratios(runs, title=title), copies_caveat(runs)
    if np.any(np.isfinite(setting(runs, "vibration_direction", np.nan))):
        raise InvalidInput(f"{title}: a prediction is of vibration along the normal; leave out runs with a direction")
    amplitude, speed = _amplitudes(runs, inputs), setting(runs, "sliding_speed", inputs.sliding_speed)
    for name, values in (("vibration_amplitude", amplitude), ("sliding_speed", speed)):
        if not np.all(values > 0):
            raise InvalidInput(f"{title}: {name} of run {int(np.argmin(values > 0)) + 1} must be positive")
    at = inputs.at(vibration_amplitude=amplitude, sliding_speed=speed)
    uncertainty, caveats = _uncertainty(runs, ratio, amplitude, speed)
    caveats = (*run_caveats(runs), *copies, *caveats)
    loads = setting(runs, "normal_load", inputs.normal_load)
    if np.any(np.abs(loads / inputs.normal_load - 1) > 0.5):
        caveats += ("some runs have a load far from the rig's; the friction model does not depend on the load",)
    wear = _wear(runs)
    stated = np.flatnonzero(np.isfinite(wear))
    return OwnRuns(
        tested=TestedRig(name=title, at=at, friction_ratio=ratio, uncertainty=uncertainty),
        friction=_intrinsic(runs, loads),
        wear_rate_ratio=wear[stated],
        wear_runs=stated,
        caveats=caveats,
    )


def _amplitudes(runs: "xr.Dataset", inputs: RigInputs) -> Floats:
    """Amplitude of each run; by its voltage in proportion to the rig's, where only that is stated."""
    amplitude, voltage = (setting(runs, name, np.nan) for name in ("vibration_amplitude", "voltage_peak_to_peak"))
    own, volts = inputs.amplitude.value, inputs.voltage_peak_to_peak
    return known_amplitudes(amplitude, voltage, np.isnan(amplitude), own=own, volts=volts)


def _uncertainty(runs: "xr.Dataset", ratio: Floats, amplitude: Floats, speed: Floats) -> tuple[Floats, tuple[str, ...]]:
    """Standard uncertainty of each ratio: as stated, by the scatter of repeats, or the usual one."""
    stated = setting(runs, "friction_reduction_uncertainty", np.nan)
    if np.any(stated <= 0):
        raise InvalidInput("friction_reduction_uncertainty must be positive in every run")
    if np.all(np.isfinite(stated)):
        return stated, ()
    keys = np.round(np.log(np.stack([amplitude, speed])), 2)
    _, group, counts = np.unique(keys, axis=1, return_inverse=True, return_counts=True)
    scatter = pooled_scatter(ratio, group.ravel())
    if scatter is not None and ratio.size - counts.size + 1 >= _MIN_REPEATS:
        return np.where(np.isnan(stated), scatter, stated), ()
    return np.where(np.isnan(stated), _USUAL_UNCERTAINTY, stated), (
        f"the runs state no uncertainty and hold too few repeats; {_USUAL_UNCERTAINTY:g} is taken for each ratio",
    )


def _intrinsic(runs: "xr.Dataset", loads: Floats) -> Input | None:
    """Intrinsic coefficient of friction by the runs' own forces without vibration."""
    forces = setting(runs, "intrinsic_friction_force", np.nan)
    if np.all(np.isnan(forces)):
        return None
    logs = np.log((forces / loads)[np.isfinite(forces)])
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
    """Wear rate ratio of each run, NaN where it states none."""
    ratios = setting(runs, "wear_rate_ratio", 1 - setting(runs, "wear_reduction", np.nan))
    if np.any(ratios <= 0):
        raise InvalidInput("wear with vibration over wear without must be positive in every run")
    return ratios
