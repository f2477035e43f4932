"""Truth behind a virtual test: friction drawn once from the prediction of the rig, temperatures, and a dataset."""

from bisect import bisect
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import asdict, astuple, dataclass, replace
from math import pi, sqrt
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.laboratory.devices import DriveSetting
from sonolube.laboratory.heating_assumptions import HeatingAssumptions, capacitive_load
from sonolube.laboratory.virtual_tribometer.disturbances import DISTURBANCE_UNITS, Disturbances
from sonolube.laboratory.virtual_tribometer.signals import Approach, Bursts, Lagged, StickSlip
from sonolube.models.thermal import EllipticSource, ThermalSolid, contact_rise
from sonolube.models.wear import cube_wear_rate
from sonolube.prediction.evidence_posterior import EvidencePosterior, population_of
from sonolube.prediction.inputs import rig_inputs
from sonolube.prediction.predictive import ratio_draws
from sonolube.rig import Rig, simulate, steady_vibration, thermal_solid
from sonolube.rig.driven_rig import actuator_capacitance

if TYPE_CHECKING:
    import xarray as xr

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
    evidence : EvidencePosterior, optional
        Posterior by own published tests too, in place of the shipped one.

    Raises
    ------
    InvalidInput
        If the rig has no drive, does not slide or does not vibrate.

    Notes
    -----
    Coefficient of friction and friction ratio are one draw of those that `sonolube predict` gives for the rig: from
    the posterior of the population in its direction of vibration, with the spreads of the rig's inputs. The wear rate
    is that of the rig's wear model without scatter, the same as without vibration where the model gives none, as within
    the plane. A controller asks for hundreds of voltages: levels are computed until two voltages are within 2 % of the
    rig's own, and interpolated between these.
    """

    def __init__(self, rig: Rig, *, seed: int, evidence: EvidencePosterior | None = None) -> None:
        self._inputs = rig_inputs(rig, takes_plane=True)
        self._rig, self._seed = rig, seed
        self._population = population_of(rig.direction, evidence)
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

    def amplitude(self, setting: DriveSetting | None, sliding_speed: float, *, normal_load: float) -> float:
        """Vibration amplitude, zero to peak; at rest or without load that at speed and load of the rig. [m]"""
        if setting is None:
            return 0.0
        speed, load = sliding_speed or self._rig.sliding_speed, normal_load or self._rig.normal_load
        return self.at(setting, speed, normal_load=load).vibration_amplitude

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
        draws = ratio_draws(self._population, at, count=_DRAWS, seed=self._seed)
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
        return replace(self._rig, drive=replace(drive, **asdict(setting)), sliding_speed=sliding_speed)


_AT_ONCE = 1e-6  # s, in which the flash rise follows the heat


class Temperatures:
    """Temperatures over time, as heat is set between blocks.

    Parameters
    ----------
    rig : Rig
        Without materials of pin and disc, only the actuator warms.
    assumed : HeatingAssumptions
    sizes : Disturbances
        Place and lag of the thermocouple.

    Notes
    -----
    Actuator and pin have one temperature each, so that both approach a steady one exponentially; the flash rise of the
    contact follows its heat at once. Heat of friction is the mean force of the present setting times the speed.
    """

    def __init__(self, rig: Rig, assumed: HeatingAssumptions, sizes: Disturbances) -> None:
        self._rig, self._assumed, self._share = rig, assumed, sizes.contact_share
        self._capacitance = actuator_capacitance(rig) or 0.0
        self._bodies = _bodies(rig, assumed)
        lag = sizes.thermocouple_time
        times = (
            assumed.actuator_heat_capacity / assumed.actuator_conductance,
            assumed.pin_heat_capacity / assumed.pin_conductance,
            _AT_ONCE,
        )
        self._actuator, self._pin, self._flash = (
            Lagged(Approach(0.0, 0.0, 0.0, time * (1 + 1e-6 * (time == lag))), 0.0, lag) for time in times
        )

    def set(self, time: float, *, setting: DriveSetting | None, friction_force: float, sliding_speed: float) -> float:
        """Steady flash rise of a setting, whose heat counts from a time on; NaN where it is unknown. [K]"""
        assumed, heat = self._assumed, friction_force * sliding_speed
        power = 0.0 if setting is None else capacitive_load(setting, capacitance=self._capacitance).apparent_power
        partition, flash = self._contact(heat, sliding_speed)
        self._actuator = self._actuator.towards(assumed.loss_factor * power / assumed.actuator_conductance, time=time)
        self._pin = self._pin.towards(partition * heat / assumed.pin_conductance, time=time)
        self._flash = self._flash.towards(0.0 if np.isnan(flash) else flash, time=time)
        return flash

    def reading(self, time: Floats, *, contact_share: float | None = None) -> Floats:
        """Temperature that the thermocouple reads, or one at another place. [K]"""
        share = self._share if contact_share is None else contact_share
        rise = (1 - share) * self._actuator.at(time)
        if share:
            rise = rise + share * (self._pin.at(time) + self._flash.at(time))
        return np.asarray(self._assumed.ambient_temperature + rise)

    def rises(self, time: float) -> tuple[float, float]:
        """Rise of actuator and of pin at a time, without lag. [K]"""
        at = np.asarray(time)
        return float(self._actuator.source.at(at)), float(self._pin.source.at(at))

    def _contact(self, heat: float, sliding_speed: float) -> tuple[float, float]:
        """Share of heat into the pin, and mean flash rise of the contact."""
        if self._bodies is None:
            return 0.0, float("nan")
        radius = sqrt(self._rig.contact.nominal_area / pi)
        source = EllipticSource(half_length=radius, half_width=radius)
        found = contact_rise(*self._bodies, source, heat_rate=heat, sliding_speed=sliding_speed)
        return float(found.heat_partition), float(found.mean_temperature_rise)


def _bodies(rig: Rig, assumed: HeatingAssumptions) -> tuple[ThermalSolid, ThermalSolid] | None:
    """Pin and disc; None where a material or one of its properties is unknown."""
    pin, disc = assumed.pin_material or rig.pin_material, assumed.disc_material or rig.disc_material
    if pin is None or disc is None:
        return None
    try:
        return thermal_solid(pin), thermal_solid(disc)
    except SonolubeError:
        return None


@dataclass(frozen=True, slots=True)
class TruthSetting:
    """Setting of motor and drive with what it gives.

    Parameters
    ----------
    start_time : float
        [s]
    sliding_speed : float
        [m/s]
    drive : DriveSetting or None
        None for off.
    level : FrictionLevel
    flash_temperature_rise : float
        Mean of the contact, steady, in K; NaN where materials are unknown.
    normal_load : float
        [N]
    stick_slip : StickSlip
        Of sliding without vibration at this speed and load.
    """

    start_time: float
    sliding_speed: float
    drive: DriveSetting | None
    level: FrictionLevel
    flash_temperature_rise: float
    normal_load: float
    stick_slip: StickSlip

    @property
    def sticks(self) -> bool:
        """Whether there is stick-slip."""
        return self.drive is None and self.stick_slip.occurs

    def sticking_share(self, bursts: Bursts, end_time: float) -> float:
        """Share of the time with stick-slip, where this setting lasts to a time. []"""
        if not (self.sticks and self.stick_slip.comes_in_bursts):
            return float(self.sticks)
        return bursts.share(self.start_time, end_time)


def truth_dataset(
    settings: Sequence[TruthSetting],
    *,
    end_time: float,
    bursts: Bursts,
    sizes: Disturbances,
    single: Mapping[str, tuple[float, str]],
    title: str,
) -> "xr.Dataset":
    """True values behind a virtual test.

    Values of each setting over `setting`, and the others as numbers, each with its unit.
    """
    import xarray as xr

    ends = [*(each.start_time for each in settings), end_time][1:]
    shares = [each.sticking_share(bursts, end) for each, end in zip(settings, ends, strict=True)]
    columns = {
        "start_time": ([each.start_time for each in settings], "s"),
        "sliding_speed": ([each.sliding_speed for each in settings], "m/s"),
        "voltage_peak_to_peak": ([each.drive.voltage_peak_to_peak if each.drive else 0.0 for each in settings], "V"),
        "voltage_offset": ([each.drive.voltage_offset if each.drive else 0.0 for each in settings], "V"),
        "frequency": ([each.drive.frequency if each.drive else 0.0 for each in settings], "Hz"),
        "vibration_amplitude": ([each.level.vibration_amplitude for each in settings], "m"),
        "friction_force": ([each.level.friction_force for each in settings], "N"),
        "friction_ratio": ([each.level.friction_ratio for each in settings], "1"),
        "wear_rate": ([each.level.wear_rate for each in settings], "m2"),
        "flash_temperature_rise": ([each.flash_temperature_rise for each in settings], "K"),
        "normal_load": ([each.normal_load for each in settings], "N"),
        "stick_slip_frequency": ([1 / each.stick_slip.period if each.sticks else 0.0 for each in settings], "Hz"),
        "stick_slip_fall": ([each.stick_slip.fall if each.sticks else 0.0 for each in settings], "N"),
        "stick_slip_fraction": (shares, "1"),
    }
    numbers = {**single, **{name: (getattr(sizes, name), unit) for name, unit in DISTURBANCE_UNITS.items()}}
    return xr.Dataset(
        {
            **{name: ("setting", values, {"units": unit}) for name, (values, unit) in columns.items()},
            **{name: ((), value, {"units": unit}) for name, (value, unit) in numbers.items()},
        },
        attrs={"title": title},
    )
