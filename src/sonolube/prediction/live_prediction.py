"""Prediction of a rig that follows changes of its operating point: friction, wear, heat and power with intervals."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.prediction.applicability import Applicability, applicability
from sonolube.prediction.contact_heating import contact_heating
from sonolube.prediction.inputs import Input, RigInputs, rig_inputs
from sonolube.prediction.own_runs import OwnRuns, own_runs
from sonolube.prediction.posterior import learned
from sonolube.prediction.predictive import RigPrediction, rig_prediction
from sonolube.prediction.remaining_width import KNOWN_WELL, Measure, expected_width, measures, own_logarithms, width
from sonolube.prediction.scores import LEVELS
from sonolube.prediction.statement import attributes, statement
from sonolube.prediction.wear import vibration_weight
from sonolube.prediction.wear_statement import pair_of
from sonolube.rig import Rig
from sonolube.rig.datasets import labels
from sonolube.rig.labelled_arrays import LabelledArray, LabelledArrays

if TYPE_CHECKING:
    import xarray as xr

_CURVE: Final = 33  # points of a curve
_FEWEST, _MOST = 100, 200_000  # draws


class LivePrediction:
    """Prediction of one rig, kept so that changes of its operating point are answered at once.

    Parameters
    ----------
    rig : Rig
    runs : xarray.Dataset, optional
        Own measured runs over `run`, as `sonolube.measurement.read_runs` returns them.
    pin, disc : str, optional
        Materials of the catalogue, for the temperature rise of the contact; by default those of the rig.
    lubricant : bool
        Whether the contact is lubricated.
    draws : int
        Equally probable outcomes, 100 to 200,000.
    seed : int

    Raises
    ------
    InvalidInput
        If the number of draws is out of range, or as `at` does.
    """

    def __init__(
        self,
        rig: Rig,
        *,
        runs: "xr.Dataset | None" = None,
        pin: str | None = None,
        disc: str | None = None,
        lubricant: bool = False,
        draws: int = 4000,
        seed: int = 0,
    ) -> None:
        if not _FEWEST <= draws <= _MOST:
            raise InvalidInput(f"draws must lie between {_FEWEST} and {_MOST}, got {draws}")
        self._runs, self._materials, self._lubricant = runs, (pin, disc), lubricant
        self._draws, self._seed = draws, seed
        self._known: dict[bytes, RigPrediction] = {}
        self.first: LabelledArrays = self.at(rig)

    def at(self, rig: Rig) -> LabelledArrays:
        """Prediction of the rig with other entries.

        Parameters
        ----------
        rig : Rig
            As `Rig.replace` returns it.

        Returns
        -------
        LabelledArrays
            As `predict` describes, equal to it.

        Raises
        ------
        InvalidInput
            If the rig does not vibrate or slide, is none that can be predicted, or the runs cannot be those of the rig.
        MissingProperty, UnknownName
            For a material without thermal properties.
        """
        limits = applicability(rig, lubricant=self._lubricant)
        if limits.refusal:
            raise InvalidInput(f"{rig.title}: {limits.refusal}")
        inputs = rig_inputs(rig)
        own = None if self._runs is None else own_runs(self._runs, inputs, title=rig.title)
        if own is not None and own.friction is not None:
            inputs = inputs.with_input(own.friction)
        heating = contact_heating(rig, *self._materials)
        return self._arrays(rig, inputs, own, limits, heating)

    def _arrays(
        self, rig: Rig, inputs: RigInputs, own: OwnRuns | None, limits: Applicability, heating: float | str
    ) -> LabelledArrays:
        """Labelled arrays of all that is predicted."""
        found = self._prediction(inputs, own)
        amplitudes, speeds = _curve_points(inputs.amplitude.value), _curve_points(inputs.sliding_speed)
        curves = {
            "amplitude": self._ratios(found, limits, inputs, vibration_amplitude=amplitudes),
            "speed": self._ratios(found, limits, inputs, sliding_speed=speeds),
        }
        ratio = curves["amplitude"][:, _CURVE // 2]
        drawn = self._quantities(rig, inputs, own, ratio, heating)
        uncertain = sorted(inputs.uncertain, key=lambda each: -each.spread)
        better = () if limits.any_ratio else measures(found, inputs, ratio=ratio, seed=self._seed)
        logs = own_logarithms(found, seed=self._seed)
        shares = np.array([self._shares_left(each, logs, drawn) for each in uncertain])
        variables = {
            **{name: LabelledArray(dims=("draw",), values=values, attrs=labels(name)) for name, values in drawn.items()},
            **{
                f"friction_ratio_over_{name}": LabelledArray(
                    dims=("level", f"curve_{name}"), values=np.quantile(each, LEVELS, axis=0)
                )
                for name, each in curves.items()
            },
            **({} if own is None else _along("run", _measured(own, found))),
            **_along("input", _described(uncertain)),
            **_along("input", {"interval_share_left": shares[:, 0], "force_interval_share_left": shares[:, 1]}),
            **_along("measure", _measures(better)),
        }
        coordinates = {
            "level": np.array(LEVELS),
            "curve_amplitude": amplitudes,
            "curve_speed": speeds,
            "input": np.array([each.name for each in uncertain]),
        }
        known = attributes(rig, inputs, own, found, limits)
        result = LabelledArrays(
            variables=variables,
            coordinates={
                name: LabelledArray(dims=(name,), values=np.asarray(values)) for name, values in coordinates.items()
            },
            attrs=known | {"heat": heating if isinstance(heating, str) else ""},
        )
        return result.assign_attrs(statement="\n".join(statement(result)))

    def _prediction(self, inputs: RigInputs, own: OwnRuns | None) -> RigPrediction:
        """Distribution of the friction ratio, kept while the rig's spreads and runs stay as they are."""
        at, tested = inputs.at(), None if own is None else own.tested
        parts = [np.array([np.nan if at.decay_length_spread is None else at.decay_length_spread, at.amplitude_spread])]
        if tested is not None:
            seen = tested.at.conditions
            parts += [seen.vibration_amplitude, seen.sliding_speed, seen.frequency, seen.decay_length]
            parts += [tested.friction_ratio, tested.uncertainty]
        key = np.concatenate(parts).tobytes()
        if key not in self._known:
            found = rig_prediction(learned().friction, at, count=self._draws, seed=self._seed, own=tested)
            self._known = {key: found}
        return self._known[key]

    def _ratios(
        self, found: RigPrediction, limits: Applicability, inputs: RigInputs, **along: Floats
    ) -> Floats:
        """Draws of the friction ratio along a curve, shape (draws, points)."""
        if limits.any_ratio:
            points = next(iter(along.values())).size
            return np.broadcast_to((np.arange(self._draws)[:, None] + 0.5) / self._draws, (self._draws, points))
        return found.ratios(inputs.at(**along).conditions)

    def _quantities(
        self, rig: Rig, inputs: RigInputs, own: OwnRuns | None, ratio: Floats, heating: float | str
    ) -> dict[str, Floats]:
        """Draws of all quantities that follow from the friction ratio, and of wear."""
        force = ratio * self._intrinsic(inputs.friction)
        measured = None if own is None or not own.wear_rate_ratio.size else own.wear_rate_ratio
        wear = learned().wear.wear_rate_ratios(
            ratio.size,
            measured=measured,
            weight=vibration_weight(ratio, seed=self._seed),
            pair=pair_of(rig),
            seed=self._seed,
        )
        found = {
            "friction_ratio": ratio,
            "friction_reduction": 1 - ratio,
            "friction_coefficient": force,
            "friction_force": force * rig.normal_load,
            "wear_rate_ratio": wear,
            "wear_reduction": 1 - wear,
        }
        if not isinstance(heating, str):
            found["mean_temperature_rise"] = heating * found["friction_force"] * rig.sliding_speed
        return found

    def _intrinsic(self, friction: Input) -> Floats:
        """Draws of the coefficient of friction without vibration."""
        normals = np.random.default_rng(self._seed + 1).standard_normal(self._draws)
        return np.asarray(friction.value * np.exp(friction.spread * normals))

    def _shares_left(
        self, uncertain: Input, logs: OwnLogarithms, drawn: Mapping[str, Floats]
    ) -> tuple[float, float]:
        """Shares of the 80 % intervals of friction ratio and force that are left if one input were known well."""
        ratio, coefficient = drawn["friction_ratio"], drawn["friction_coefficient"]
        noise = KNOWN_WELL[uncertain.name]
        if uncertain.spread <= noise:
            return 1.0, 1.0
        if uncertain.name == "friction_coefficient":
            known = np.log(coefficient / np.where(ratio > 0, ratio, np.nan)) if False else None
        return 1.0, 1.0


def _curve_points(value: float) -> Floats:
    """Points of a curve about a value, which is the one in the middle, to a sixth and to six times it."""
    return np.asarray(value * np.geomspace(1 / 6, 6.0, _CURVE))
