"""Prediction of a rig that follows changes of its operating point: friction, wear, heat and power with intervals."""

from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.models.dynamics import Structure
from sonolube.prediction.applicability import Applicability, applicability, contact_heating, spot_heating
from sonolube.prediction.bodies import pair_of
from sonolube.prediction.evidence import Conditions
from sonolube.prediction.evidence_posterior import EvidencePosterior, population_of, read_evidence_posterior
from sonolube.prediction.further_measurements import (
    KNOWN_WELL,
    Measure,
    Probe,
    Target,
    measures,
    own_logarithms,
    probe_sentences,
    stiffness_probes,
    told_probes,
)
from sonolube.prediction.hierarchy import LEVELS, sorted_quantiles
from sonolube.prediction.inputs import Input, OwnRuns, RigInputs, decay_length_of, intrinsic_draws, own_runs, rig_inputs
from sonolube.prediction.posterior import Posterior, learned
from sonolube.prediction.predictive import DRAWS, Laboratory, RigPrediction, laboratory, rig_prediction
from sonolube.prediction.rig_statement import heat_words, prediction_attributes, statement, wear_sentence
from sonolube.prediction.wear import vibration_weight
from sonolube.prediction.within_plane import NO_HEAT
from sonolube.rig import Rig
from sonolube.rig.datasets import LabelledArray, LabelledArrays, labels
from sonolube.rig.vibration_direction import NORMAL, VibrationDirection

if TYPE_CHECKING:
    import xarray as xr

Heating: TypeAlias = "tuple[float | str, float | str]"
"""Rises of the nominal face and of a real spot for a watt of friction, in K/W, each or why it is unknown."""

_CURVE: Final = 33  # points of a curve, the operating point in the middle
_FARTHEST: Final = 6.0  # point of a curve over the operating point
_FEWEST, _MOST = 100, 200_000  # draws
_NOT_IN_THE_RATIO: Final = "friction_coefficient", "interval_share_left"
_WITHIN_80: Final = 1.2816  # standard deviations


class LivePrediction:
    """Prediction of one rig, kept so that changes of its operating point are answered at once.

    Parameters
    ----------
    rig : Rig
    runs : xarray.Dataset, optional
        Own measured runs over `run`, as `sonolube.measurement.measured_runs.read_runs` returns them.
    laboratory_runs : sequence of (Rig, xarray.Dataset)
        Other rigs of the same laboratory with runs of each, which tell of the decay length and its scatter.
    evidence : EvidencePosterior, str or Path, optional
        Posterior that was learned with own published tests, or its file, in place of the shipped one.
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
        If the number of draws is out of range, or as `at` does, also for a rig of the laboratory.

    Examples
    --------
    >>> import numpy as np
    >>> import sonolube as sl
    >>> rig = sl.read_rig("examples/rigs/tribometer.toml")
    >>> prediction = sl.LivePrediction(rig)
    >>> weaker = prediction.at(rig.replace("drive.voltage_peak_to_peak", "14 V"))
    >>> [round(float(np.median(each["friction_ratio"].values)), 1) for each in (prediction.first, weaker)]
    [0.3, 0.6]
    """

    def __init__(
        self,
        rig: Rig,
        *,
        runs: "xr.Dataset | None" = None,
        laboratory_runs: "Sequence[tuple[Rig, xr.Dataset]]" = (),
        evidence: EvidencePosterior | str | Path | None = None,
        pin: str | None = None,
        disc: str | None = None,
        lubricant: bool = False,
        draws: int = DRAWS,
        seed: int = 0,
    ) -> None:
        if not _FEWEST <= draws <= _MOST:
            raise InvalidInput(f"draws must lie between {_FEWEST} and {_MOST}, got {draws}")
        self._runs, self._materials, self._lubricant = runs, (pin, disc), lubricant
        self._draws, self._seed = draws, seed
        self._kept: tuple[tuple[VibrationDirection, bytes], RigPrediction] | None = None
        self._evidence = read_evidence_posterior(evidence) if isinstance(evidence, str | Path) else evidence
        self._population = population_of(NORMAL, self._evidence)
        self._laboratory = _laboratory(self._population, laboratory_runs, seed=seed) if laboratory_runs else None
        self._posterior = self._population if self._laboratory is None else self._laboratory.posterior
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
        limits = applicability(rig, lubricant=self._lubricant, evidence=self._evidence)
        if limits.refusal:
            raise InvalidInput(limits.refusal)
        inputs = rig_inputs(rig, takes_plane=True)
        if self._laboratory is not None and not inputs.direction.is_normal:
            raise InvalidInput(
                f"{rig.title}: other rigs tell of the decay length alone, without effect here; leave them out"
            )
        known_from = _known_from(self._evidence, self._laboratory)
        if known_from and not inputs.measured_length:
            inputs = inputs.with_input(decay_length_of(self._posterior, known_from=known_from))
        own = None if self._runs is None else own_runs(self._runs, inputs, title=rig.title)
        if own is not None and own.friction is not None:
            inputs = inputs.with_input(own.friction)
        heating = self._heating(rig)
        return self._arrays(rig, inputs, own, limits, heating)

    def _heating(self, rig: Rig) -> Heating:
        """Rises of the contact of a rig for a watt of friction."""
        face, spot = (of(rig, *self._materials) for of in (contact_heating, spot_heating))
        return (face, spot) if rig.direction.is_normal else (NO_HEAT, NO_HEAT)

    def _arrays(
        self, rig: Rig, inputs: RigInputs, own: OwnRuns | None, limits: Applicability, heating: Heating
    ) -> LabelledArrays:
        """Labelled arrays of all that is predicted."""
        found = self._prediction(inputs, own)
        amplitudes, speeds = _curve_points(inputs.amplitude.value), _curve_points(inputs.sliding_speed)
        unknown = limits.any_ratio and own is None
        curves = {
            "amplitude": self._ratios(found, inputs, unknown=unknown, vibration_amplitude=amplitudes),
            "speed": self._ratios(found, inputs, unknown=unknown, sliding_speed=speeds),
        }
        ratio = curves["amplitude"][:, _CURVE // 2]
        intrinsic = intrinsic_draws(inputs.friction, count=self._draws, seed=self._seed)
        drawn = _frictional(ratio, intrinsic, rig, heating)
        wear_is_known = inputs.direction.is_normal and not (limits.any_ratio and not _states_wear(own))
        if wear_is_known:
            drawn |= self._wear(rig, found, own, inputs)
        uncertain = sorted(inputs.uncertain, key=lambda each: -each.spread)
        logs = own_logarithms(found, intrinsic=intrinsic, seed=self._seed)
        probes = () if inputs.measured_length else _told_probes(rig, inputs, self._population)
        better = () if unknown else measures(found, inputs, ratio=ratio, probes=probes, seed=self._seed)
        variables = {
            **{
                name: LabelledArray(dims=("draw",), values=values, attrs=labels(name)) for name, values in drawn.items()
            },
            **{
                f"friction_ratio_over_{name}": LabelledArray(
                    dims=("level", f"curve_{name}"), values=sorted_quantiles(np.sort(each, axis=0), LEVELS)
                )
                for name, each in curves.items()
            },
            **({} if own is None else _along("run", _measured(own, found, inputs))),
            **_along("input", _described(uncertain) | _shares_left(uncertain, logs, drawn)),
            **_along("measure", _measures(better)),
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
            attrs=prediction_attributes(rig, inputs, own, found, limits, self._laboratory, self._evidence)
            | {
                "stiffness_probes": "" if inputs.measured_length else "\n".join(probe_sentences(probes)),
                "heat": heat_words(rig, *self._materials, drawn, heating),
                "wear": wear_sentence(
                    rig,
                    ratios=drawn.get("wear_rate_ratio"),
                    contradicted=_contradicted(found),
                    is_lubricated=limits.any_ratio,
                ),
            },
        )
        return result.assign_attrs(statement="\n".join(statement(result)))

    def _prediction(self, inputs: RigInputs, own: OwnRuns | None) -> RigPrediction:
        """Distribution of the friction ratio, kept while the rig's spreads and its runs stay as they are."""
        at, tested = inputs.at(), None if own is None else own.tested
        parts = [np.array([np.nan if at.decay_length_spread is None else at.decay_length_spread, at.amplitude_spread])]
        if tested is not None:
            seen = tested.at.conditions
            parts += [seen.vibration_amplitude, seen.sliding_speed, seen.frequency, seen.decay_length]
            parts += [tested.friction_ratio, tested.uncertainty]
        key = inputs.direction, np.concatenate(parts).tobytes()
        if self._kept is None or self._kept[0] != key:
            is_normal = inputs.direction.is_normal
            posterior = self._posterior if is_normal else population_of(inputs.direction, self._evidence)
            found = rig_prediction(posterior, at, count=self._draws, seed=self._seed, own=tested)
            self._kept = key, found
        return self._kept[1]

    def _ratios(self, found: RigPrediction, inputs: RigInputs, *, unknown: bool, **along: Floats) -> Floats:
        """Draws of the friction ratio along a curve, shape (draws, points)."""
        if not unknown:
            return found.ratios(inputs.at(**along).conditions)
        even = (np.random.default_rng(self._seed).permutation(self._draws) + 0.5) / self._draws
        return np.broadcast_to(even[:, None], (self._draws, _CURVE))

    def _wear(self, rig: Rig, found: RigPrediction, own: OwnRuns | None, inputs: RigInputs) -> dict[str, Floats]:
        """Draws of the wear rate ratio and reduction, by the reduction that the friction model itself gives."""
        count = self._draws
        measured, tested_weight = np.empty(0), np.ones(count)
        weight = self._weight(found, inputs.at().conditions)[:, 0]
        if _contradicted(found):  # of which friction does not tell
            weight = np.random.default_rng(self._seed + 2).random(count)
        if own is not None and own.wear_rate_ratio.size:
            measured = own.wear_rate_ratio
            tested_weight = self._weight(found, own.tested.at.conditions.taken(own.wear_runs)).mean(axis=1)
        wear = learned().wear.wear_rate_ratios(
            count, measured=measured, weight=weight, measured_weight=tested_weight, pair=pair_of(rig), seed=self._seed
        )
        return {"wear_rate_ratio": wear, "wear_reduction": 1 - wear}

    def _weight(self, found: RigPrediction, at: Conditions) -> Floats:
        """Draws of the share of the effect of the published wear tests at conditions, shape (draws, m).

        By the mean of the friction model: its discrepancy is an error of that model, and no friction that wear follows.
        """
        means = found.draws.means(at)
        rows = np.arange(self._draws) % len(means)
        return vibration_weight(friction_ratio=means[rows], seed=self._seed)


def predict(
    rig: Rig,
    *,
    runs: "xr.Dataset | None" = None,
    laboratory_runs: "Sequence[tuple[Rig, xr.Dataset]]" = (),
    evidence: EvidencePosterior | str | Path | None = None,
    pin: str | None = None,
    disc: str | None = None,
    lubricant: bool = False,
    draws: int = DRAWS,
    seed: int = 0,
) -> "xr.Dataset":
    """Friction and wear of a rig under vibration, with predictive intervals.

    Parameters
    ----------
    rig : Rig
    runs, laboratory_runs, evidence, pin, disc, lubricant, draws, seed
        As of `LivePrediction`.

    Returns
    -------
    xarray.Dataset
        Over `draw`: friction ratio, reduction, force and coefficient, wear rate ratio and reduction where the contact
        is dry, and the mean temperature rise of the contact and that of a real spot where both materials are given.
        Over `level`: quantiles of the friction ratio along `curve_amplitude` and `curve_speed`, with the operating
        point in their middle. Over `input`, the least known first: spread of each uncertain input, and the shares of
        the 80 % intervals of friction ratio and friction force that would be left if it were known well. Over
        `measure`: measurements that would narrow the interval, and what each would leave of it. Attributes hold
        caveats, assumptions, and the statement in words. Neither wear nor temperature rise is predicted of a
        vibration within the plane.

    Raises
    ------
    InvalidInput
        If the rig does not vibrate or slide or is none that can be predicted, the runs cannot be those of the rig, or
        the number of draws is out of range.
    MissingProperty, UnknownName
        For a material without thermal properties.
    """
    live = LivePrediction(
        rig,
        runs=runs,
        laboratory_runs=laboratory_runs,
        evidence=evidence,
        pin=pin,
        disc=disc,
        lubricant=lubricant,
        draws=draws,
        seed=seed,
    )
    return live.first.dataset()


def _told_probes(rig: Rig, inputs: RigInputs, population: Posterior) -> tuple[Probe, ...]:
    """Resonances that may show the contact stiffness, at decay lengths of the population."""
    found = () if rig.structure is None else _probes(rig.structure, rig.normal_load, population)
    return told_probes(found, frequency=inputs.frequency)


@lru_cache(maxsize=16)
def _probes(structure: Structure, normal_load: float, population: Posterior) -> tuple[Probe, ...]:
    """Probes of a structure under a load, which stay while drive and speed change."""
    middle, spread = population.decay_length()
    lengths = middle * np.exp(spread * np.array([-_WITHIN_80, 0.0, _WITHIN_80]))
    return stiffness_probes(structure, normal_load=normal_load, decay_length=lengths)


def _known_from(evidence: EvidencePosterior | None, of_rigs: Laboratory | None) -> str:
    """Tests that the population is known from, in words; empty where it is the shipped one."""
    tests = "" if evidence is None else evidence.known_from
    if of_rigs is None:
        return tests
    return f"{tests}, {of_rigs.rigs_in_words}" if tests else of_rigs.known_from


def _laboratory(population: Posterior, rigs_with_runs: "Sequence[tuple[Rig, xr.Dataset]]", *, seed: int) -> Laboratory:
    """Population of a laboratory from the runs of its rigs."""
    tested = [own_runs(runs, rig_inputs(rig), title=rig.title).tested for rig, runs in rigs_with_runs]
    return laboratory(population, tested, seed=seed)


def _frictional(ratio: Floats, intrinsic: Floats, rig: Rig, heating: Heating) -> dict[str, Floats]:
    """Draws of all quantities that follow from the friction ratio."""
    found = {
        "friction_ratio": ratio,
        "friction_reduction": 1 - ratio,
        "friction_coefficient": ratio * intrinsic,
        "friction_force": ratio * intrinsic * rig.normal_load,
    }
    for name, rise in zip(("mean_temperature_rise", "spot_temperature_rise"), heating, strict=True):
        if not isinstance(rise, str):
            found[name] = rise * found["friction_force"] * rig.sliding_speed
    return found


def _shares_left(
    uncertain: Sequence[Input], logs: Mapping[str, Floats], drawn: Mapping[str, Floats]
) -> dict[str, NDArray[Any]]:
    """Shares of the 80 % intervals of friction ratio and force that are left if one input were known well."""
    found = {}
    for share, target in (
        ("interval_share_left", Target(drawn["friction_ratio"])),
        ("force_interval_share_left", Target(drawn["friction_coefficient"])),
    ):
        found[share] = np.array(
            [
                1.0
                if each.spread <= KNOWN_WELL[each.name] or (each.name, share) == _NOT_IN_THE_RATIO
                else target.share_left(observed=logs[each.name], noise=KNOWN_WELL[each.name])
                for each in uncertain
            ]
        )
    return found


def _measured(own: OwnRuns, found: RigPrediction, inputs: RigInputs) -> dict[str, Floats]:
    """Own runs as they entered the prediction, moved to the operating point, and what was predicted before them."""
    tested = own.tested
    assert found.check is not None
    at = tested.at.conditions
    predicted = np.median(found.ratios(at), axis=0)
    moved = {
        name: tested.friction_ratio + np.median(found.ratios(inputs.at(**along).conditions), axis=0) - predicted
        for name, along in (
            ("amplitude", {"vibration_amplitude": at.vibration_amplitude}),
            ("speed", {"sliding_speed": at.sliding_speed}),
        )
    }
    return {
        **{f"measured_ratio_moved_over_{name}": np.maximum(values, 0.0) for name, values in moved.items()},
        "measured_friction_ratio": tested.friction_ratio,
        "measured_uncertainty": tested.uncertainty,
        "measured_vibration_amplitude": tested.at.conditions.vibration_amplitude,
        "measured_sliding_speed": tested.at.conditions.sliding_speed,
        "predicted_low": found.check.lows,
        "predicted_high": found.check.highs,
    }


def _described(uncertain: Sequence[Input]) -> dict[str, NDArray[Any]]:
    """Values and texts of uncertain inputs, by the names that they have in a prediction."""
    columns = {"input_value": "value", "input_spread": "spread", "input_label": "label", "input_text": "text"}
    columns |= {"reason": "reason", "remedy": "remedy"}
    return {name: np.array([getattr(each, field) for each in uncertain]) for name, field in columns.items()}


def _measures(better: Sequence[Measure]) -> dict[str, NDArray[Any]]:
    """Measurements that would narrow the interval, in words, and what each leaves of it."""
    return {
        "measure_key": np.array([each.key for each in better], dtype=str),
        "measure_label": np.array([each.label for each in better], dtype=str),
        "measure_share_left": np.array([each.share_left for each in better]),
    }


def _along(name: str, values: Mapping[str, NDArray[Any]]) -> dict[str, LabelledArray]:
    """Arrays over one axis."""
    return {each: LabelledArray(dims=(name,), values=array) for each, array in values.items()}


def _states_wear(own: OwnRuns | None) -> bool:
    """Whether own runs state wear."""
    return own is not None and bool(own.wear_rate_ratio.size)


def _contradicted(found: RigPrediction) -> bool:
    """Whether own runs contradict the prediction before them."""
    return found.check is not None and found.check.contradicted


def _curve_points(value: float) -> Floats:
    """Points of a curve about a value, which is the middle one."""
    points = value * np.geomspace(1 / _FARTHEST, _FARTHEST, _CURVE)
    points[_CURVE // 2] = value
    return np.asarray(points)
