"""Friction of one virtual rig: a draw from the prediction of the rig, the same for all settings of a test."""

from bisect import bisect
from collections import defaultdict
from dataclasses import astuple, dataclass, replace
from typing import Final

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.laboratory.devices import DriveSetting
from sonolube.models.wear import cube_wear_rate
from sonolube.prediction import learned
from sonolube.prediction.inputs import rig_inputs
from sonolube.prediction.predictive import ratio_draws
from sonolube.rig import Rig, simulate, steady_vibration

_DRAWS: Final = 64  # of which one is taken
_MIN_RATIO: Final = 0.01  # no contact slides free of friction, whatever tail of the population is drawn
_CLOSE: Final = 0.02  # of the rig's voltage, between two known ones of which a level is interpolated


@dataclass(frozen=True, slots=True)
class FrictionLevel:
    """Mean friction and wear at one setting of drive and motor.

    Parameters
    ----------
    friction_force : float
        Worn in. [N]
    friction_ratio : float
        Over that without vibration. []
    vibration_amplitude : float
        Zero to peak; NaN at rest, where it is not computed. [m]
    wear_rate : float
        Volume per sliding distance. [m2]
    """

    friction_force: float
    friction_ratio: float
    vibration_amplitude: float
    wear_rate: float


class FrictionDraw:
    """Friction of one specimen of a rig, drawn once.

    Parameters
    ----------
    rig : Rig
        With a drive.
    seed : int

    Raises
    ------
    InvalidInput
        If the rig has no drive, does not slide or does not vibrate.

    Notes
    -----
    Coefficient of friction and friction ratio are one draw of those that `sonolube predict` gives for the rig: from
    the posterior of the population, with the spreads of the rig's inputs. The wear rate is that of the rig's wear model
    without scatter, the same as without vibration where the model gives none. A controller asks for hundreds of
    voltages: levels are computed until two voltages are within 2 % of the rig's own, and interpolated between these.
    """

    def __init__(self, rig: Rig, *, seed: int) -> None:
        self._inputs = rig_inputs(rig)
        self._rig, self._seed = rig, seed
        rng = np.random.default_rng(seed)
        friction = self._inputs.friction
        self.friction_coefficient = float(friction.value * np.exp(friction.spread * rng.standard_normal()))
        self._row = int(rng.integers(_DRAWS))
        self._known: dict[object, dict[float, FrictionLevel]] = defaultdict(dict)
        steady_vibration(rig)  # refuses a rig of which no wear under vibration is known

    def at(
        self, setting: DriveSetting | None, sliding_speed: float, *, normal_load: float | None = None
    ) -> FrictionLevel:
        """Level at a setting of the drive, a sliding speed and a load.

        Parameters
        ----------
        setting : DriveSetting or None
            None for off.
        sliding_speed : float
            [m/s]
        normal_load : float or None
            That of the rig by default. [N]

        Returns
        -------
        FrictionLevel
        """
        load = self._rig.normal_load if normal_load is None else normal_load
        if setting is None or not sliding_speed > 0 or not load:
            return FrictionLevel(
                friction_force=self.friction_coefficient * load,
                friction_ratio=1.0,
                vibration_amplitude=0.0 if setting is None else float("nan"),
                wear_rate=self._unvibrated_wear(load),
            )
        known = self._known[setting.frequency, setting.waveform, sliding_speed, load]
        voltage = setting.voltage_peak_to_peak
        if voltage not in known:
            known[voltage] = self._between(known, voltage) or self._computed(setting, sliding_speed, load)
        return known[voltage]

    def _between(self, known: dict[float, FrictionLevel], voltage: float) -> FrictionLevel | None:
        """Level between two known voltages that are close; None without them."""
        voltages = sorted(known)
        place = bisect(voltages, voltage)
        if not 0 < place < len(voltages):
            return None
        low, high = voltages[place - 1], voltages[place]
        if high - low > _CLOSE * (self._inputs.voltage_peak_to_peak or 0.0):
            return None
        share = (voltage - low) / (high - low)
        ends = zip(astuple(known[low]), astuple(known[high]), strict=True)
        return FrictionLevel(*((1 - share) * one + share * other for one, other in ends))

    def _unvibrated_wear(self, load: float) -> float:
        """Wear rate without vibration under a load. [m2]"""
        return float(cube_wear_rate(self._rig.contact, normal_load=load)) if load else 0.0

    def _computed(self, setting: DriveSetting, sliding_speed: float, load: float) -> FrictionLevel:
        """Level with vibration, by the models of the rig."""
        without = self.friction_coefficient * load
        found = simulate(replace(self._set(setting, sliding_speed), normal_load=load))
        amplitude, worn = found.friction.vibration_amplitude, found.wear.wear_rate
        inputs = replace(self._inputs, frequency=setting.frequency)  # the others are those of the rig at any drive
        at = inputs.at(vibration_amplitude=amplitude, sliding_speed=sliding_speed)
        draws = ratio_draws(learned().friction, at, count=_DRAWS, seed=self._seed)
        ratio = max(float(draws[self._row, 0]), _MIN_RATIO)
        return FrictionLevel(
            friction_force=ratio * without,
            friction_ratio=ratio,
            vibration_amplitude=amplitude,
            wear_rate=float(worn) if np.isfinite(worn) else self._unvibrated_wear(load),
        )

    def _set(self, setting: DriveSetting, sliding_speed: float) -> Rig:
        """Rig under a setting."""
        drive = self._rig.drive
        if drive is None:
            raise InvalidInput(f"{self._rig.title}: a virtual tribometer needs a drive; give the table drive")
        changed = replace(
            drive,
            voltage_peak_to_peak=setting.voltage_peak_to_peak,
            voltage_offset=setting.voltage_offset,
            frequency=setting.frequency,
            waveform=setting.waveform,
        )
        return replace(self._rig, drive=changed, sliding_speed=sliding_speed)
