"""Virtual rig: what its channels read over time, as motor and drive are set between blocks."""

from collections.abc import Mapping, Sequence
from math import pi
from time import monotonic, sleep
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.checks import Floats
from sonolube.facts.protocol import PROMPT_DURATIONS, Prompt
from sonolube.laboratory.block import Block, Channel, quantity_of
from sonolube.laboratory.devices import DeviceError, DriveSetting
from sonolube.laboratory.heating_assumptions import HeatingAssumptions
from sonolube.laboratory.virtual_tribometer.disturbances import Disturbances
from sonolube.laboratory.virtual_tribometer.signals import (
    Approach,
    Bursts,
    ColouredNoise,
    StickSlip,
    arm_resonance,
    correlated,
    hall_pulses,
    play,
    pulled,
    resonant,
)
from sonolube.laboratory.virtual_tribometer.truth import FrictionDraw, Temperatures, TruthSetting, truth_dataset
from sonolube.models.dynamics.structure import electrical_admittance
from sonolube.rig import Rig
from sonolube.rig.driven_rig import actuator_capacitance

if TYPE_CHECKING:
    import xarray as xr

VOLTAGE_MAXIMUM: Final = 200.0
"""Of the amplifier. [V]"""

_PULSE: Final = 0.01  # T, height of the pulses of the Hall probe
CHANNELS: Final = (
    *("friction_force", "normal_load", "voltage", "voltage_peak_to_peak", "current", "temperature", "gaussmeter"),
    "displacement",
)
_NOISES: Final = (*CHANNELS[:7], "friction noise", "ringing", "displacement")
_STREAMS: Final = 13  # of random numbers of a virtual rig
_PHASES: Final = 9  # number of a stream, as those that follow; those of the noises are before them and after
_SIZES: Final = 10
_BURSTS: Final = 11
_DISPLACEMENT: Final = 12
_GAUGE_RANGE: Final = 60.0  # N, that the gauge has at least
_DISPLACEMENT_RANGE: Final = 1e-3  # m
_STANDS: Final = 1e-9  # 1/s


class VirtualRig:
    """State of the virtual rig between blocks.

    Parameters
    ----------
    rig : Rig
    seed : int
    disturbances : Disturbances
        Of tests with the rig; those of this test are drawn about them.
    heating : HeatingAssumptions
    groove_diameter : float
        Of the circle under the pin. [m]
    real_time : bool
    """

    def __init__(
        self,
        rig: Rig,
        seed: int,
        disturbances: Disturbances,
        heating: HeatingAssumptions,
        groove_diameter: float,
        real_time: bool,
    ) -> None:
        streams = np.random.SeedSequence(seed).spawn(_STREAMS)
        disturbances = disturbances.drawn(np.random.default_rng(streams[_SIZES]))
        friction = FrictionDraw(rig, seed=seed)
        self._rig, self._friction, self._sizes = rig, friction, disturbances
        self._diameter, self._real_time = groove_diameter, real_time
        self._streams = streams
        phases = np.random.default_rng(streams[_PHASES])
        self._bursts = Bursts(np.random.default_rng(streams[_BURSTS]), disturbances.burst_duration)
        self._load, self._pull, self._pulled_from, self._zeroed = rig.normal_load, 0.0, 0.0, 0.0
        self._lifted_at, self._untouched = 0.0, 0.0  # m, distance at the latest change of load, and without contact
        self._bent = 0.0  # m, of the holder by its play
        self._wobble_phases = phases.uniform(0, 1, 2)
        self._drift = float(disturbances.drift_rate * phases.standard_normal())
        self._generator_phase = float(phases.uniform())
        self._time, self._epoch, self._rate, self._sample = 0.0, 0.0, 0.0, 0
        self._began_at = 0.0  # on the wall clock
        self._names: tuple[str, ...] = ()
        self._setting: DriveSetting | None = None
        self._level = friction.at(None, 0.0)
        self._turning = Approach(0.0, 0.0, 0.0, disturbances.motor_time)
        self._revolutions, self._began_to_slide, self._volume = 0.0, 0.0, 0.0
        self._ratio = Approach(0.0, 1.0, 1.0, disturbances.vibration_time)
        self._temperatures = Temperatures(rig, heating, disturbances)
        self._capacitance = actuator_capacitance(rig)
        self._prepared: list[tuple[DriveSetting | None, float]] = []
        self._admittances: dict[float, complex] = {}
        held = None if rig.structure is None else arm_resonance(rig.structure)
        self._arm = held or (disturbances.natural_frequency, disturbances.holder_damping_ratio)
        self._stick_slip = self._sticking(0.0)
        self._gauge = 0.0
        self._noises: dict[str, ColouredNoise] = {}
        self._settings: list[TruthSetting] = []

    def truth(self) -> "xr.Dataset":
        """Truth of the recording, as `VirtualTribometer.truth`."""
        actuator, pin = self._temperatures.rises(self._time)
        single = {
            "friction_coefficient": (self._friction.friction_coefficient, "1"),
            "force_drift_rate": (self._drift, "N/s"),
            "arm_frequency": (self._arm[0], "Hz"),
            "arm_damping_ratio": (self._arm[1], "1"),
            "wear_volume": (self._worn(self._time), "m3"),
            "sliding_distance": (float(self._distance(np.asarray(self._time))), "m"),
            "actuator_temperature_rise": (actuator, "K"),
            "pin_temperature_rise": (pin, "K"),
        }
        title = f"Truth of {self._rig.title}"
        return truth_dataset(
            self._settings, end_time=self._time, bursts=self._bursts, sizes=self._sizes, single=single, title=title
        )

    def start(self, names: Sequence[str], sample_rate: float) -> None:
        """Begin to sample."""
        self._names, self._rate, self._sample, self._epoch = tuple(names), sample_rate, 0, self._time
        self._began_at = monotonic()
        sizes = self._sizes
        feedback = {
            "friction noise": correlated(time_constant=sizes.noise_time, sample_rate=sample_rate),
            "ringing": resonant(frequency=self._arm[0], damping_ratio=self._arm[1], sample_rate=sample_rate),
        }
        streams = [*self._streams[: len(_NOISES) - 1], self._streams[_DISPLACEMENT]]
        for kind, stream in zip(_NOISES, streams, strict=True):
            former = self._noises.get(kind)
            source = np.random.default_rng(stream) if former is None else former.generator
            self._noises[kind] = ColouredNoise(source, feedback.get(kind, (0.0, 0.0)))

    def stop(self) -> None:
        """End to sample."""
        self._rate = 0.0

    def clock(self) -> float:
        """Time of the devices, by the samples and the prompts. [s]"""
        return self._time

    def read(self, samples: int) -> Block:
        """Next samples."""
        if not self._rate:
            raise DeviceError("virtual acquisition: nothing is sampled; call start first")
        first = self._sample
        time = self._epoch + (first + np.arange(samples)) / self._rate
        self._sample = first + samples
        self._time = self._epoch + self._sample / self._rate
        values = self._values(time)
        if self._real_time:
            sleep(max(0.0, self._began_at + self._time - self._epoch - monotonic()))
        return Block(first_sample=first, sample_rate=self._rate, values=values)

    @property
    def channels(self) -> Mapping[str, Channel]:
        """Channels of the acquisition."""
        force = max(5 * self._rig.normal_load, _GAUGE_RANGE)
        ranges = {
            "friction_force": (-force, force),
            "normal_load": (-force, force),
            "voltage": (-2 * VOLTAGE_MAXIMUM, 2 * VOLTAGE_MAXIMUM),
            "voltage_peak_to_peak": (-1.0, 4 * VOLTAGE_MAXIMUM),
            "current": (-100.0, 100.0),
            "temperature": (173.0, 773.0),
            "gaussmeter": (-0.3, 0.3),
            "displacement": (-_DISPLACEMENT_RANGE, _DISPLACEMENT_RANGE),
        }
        return {
            name: Channel(name=name, quantity=quantity_of(name), lowest=low, highest=high)
            for name, (low, high) in ranges.items()
        }

    def turn(self, rotation_speed: float) -> None:
        """Set the motor."""
        if self._turning.target == 0 and rotation_speed > 0:
            self._began_to_slide = float(self._distance(np.asarray(self._time)))
        self._volume = self._worn(self._time)
        self._revolutions = float(self._turned(np.asarray(self._time)))
        self._turning = self._turning.towards(rotation_speed, time=self._time)
        self._settle()

    def prepare(self, setting: DriveSetting | None, rotation_speed: float) -> None:
        """Work out the friction at a setting of drive and motor, which takes seconds for some rigs."""
        import scipy.signal  # noqa: F401  for which the first block would wait

        speed = rotation_speed * pi * self._diameter
        self._prepared.append((setting, speed))
        self._friction.at(setting, speed, normal_load=self._load)

    def attend(self, prompt: Prompt) -> None:
        """Pass the time of a prompt: the rig cools, the gauge is set to zero, load and pull change as it says."""
        self._volume_until_now()
        since = self._settings[-1].start_time if self._settings else self._time  # switched off then, and watched
        self._time = max(self._time, since + PROMPT_DURATIONS[prompt.task])
        if prompt.normal_load is not None:
            self._hang(prompt.normal_load)
        self._pull, self._pulled_from = prompt.applied_force or 0.0, self._time
        self._zeroed = self._time
        self._settle()

    def _hang(self, load: float) -> None:
        """Set another load; while it is 0 the track does not run in."""
        turned = float(self._distance(np.asarray(self._time)))
        if self._load == 0:
            self._untouched += turned - self._lifted_at
        self._load, self._lifted_at = load, turned
        for setting, speed in self._prepared:  # while the motor rests
            self._friction.at(setting, speed, normal_load=load)

    def drive(self, setting: DriveSetting | None) -> None:
        """Set the drive, None for off."""
        self._setting = setting
        self._settle()

    def _settle(self) -> None:
        """Set the friction of the present setting."""
        speed = self._turning.target * pi * self._diameter
        self._volume_until_now()
        self._level = self._friction.at(self._setting, speed, normal_load=self._load)
        self._ratio = self._ratio.towards(self._level.friction_ratio, time=self._time)
        self._stick_slip = self._sticking(speed)
        flash = self._temperatures.set(
            self._time, setting=self._setting, friction_force=self._level.friction_force, sliding_speed=speed
        )
        self._settings.append(
            TruthSetting(self._time, speed, self._setting, self._level, flash, self._load, self._stick_slip)
        )

    def _sticking(self, sliding_speed: float) -> StickSlip:
        """Stick-slip without vibration at a speed."""
        sizes = self._sizes
        mean = self._friction.friction_coefficient * self._load
        return StickSlip(
            excess_force=sizes.static_share * mean,
            stiffness=sizes.holder_stiffness,
            mass=sizes.holder_mass,
            damping_ratio=sizes.holder_damping_ratio,
            sliding_speed=sliding_speed,
        )

    def _volume_until_now(self) -> None:
        """Add the wear of the setting that ends, and begin anew from here."""
        self._volume = self._worn(self._time)
        self._revolutions = float(self._turned(np.asarray(self._time)))
        self._turning = self._turning.towards(self._turning.target, time=self._time)

    def _worn(self, time: float) -> float:
        """Wear volume until a time. [m3]"""
        slid = float(self._turned(np.asarray(time)) - self._revolutions) * pi * self._diameter
        return self._volume + self._level.wear_rate * slid

    def _turned(self, time: Floats) -> Floats:
        """Revolutions of the disc until times. []"""
        return np.asarray(self._revolutions + self._turning.integral(time))

    def _distance(self, time: Floats) -> Floats:
        """Sliding distance until times. [m]"""
        return self._turned(time) * pi * self._diameter

    def _values(self, time: Floats) -> Floats:
        """Samples of all channels at times."""
        wobble, sizes = self._wobble(time), self._sizes
        of_name = {
            "friction_force": lambda: self._friction_force(time, wobble),
            "normal_load": lambda: self._load * wobble + self._white("normal_load", sizes.sensor_noise, time),
            "voltage": lambda: self._voltage(time),
            "voltage_peak_to_peak": lambda: self._monitor(time),
            "current": lambda: self._current(time),
            "temperature": lambda: (
                self._temperatures.reading(time) + self._white("temperature", sizes.temperature_noise, time)
            ),
            "gaussmeter": lambda: self._flux(time),
            "displacement": lambda: self._displacement(time, wobble),
        }
        return np.stack([of_name[name]() for name in self._names], axis=1)

    def _white(self, name: str, deviation: float, time: Floats) -> Floats:
        """White noise of a channel."""
        return deviation * self._noises[name].next(time.size)

    def _wobble(self, time: Floats) -> Floats:
        """Load over its mean by the run-out of the disc. []"""
        turned, (first, second) = self._turned(time), self._wobble_phases
        return np.asarray(
            1
            + self._sizes.wobble_1 * np.cos(2 * np.pi * (turned + first))
            + self._sizes.wobble_2 * np.cos(4 * np.pi * (turned + second))
        )

    def _friction_force(self, time: Floats, wobble: Floats) -> Floats:
        """Reading of the force gauge."""
        sizes = self._sizes
        mean = self._friction.friction_coefficient * self._load
        distance = self._distance(time)
        ratio = self._ratio.at(time)
        run_in = np.exp(-(distance - self._untouched) / sizes.run_in_distance)
        level = mean * wobble * ratio * (1 + sizes.run_in_share * run_in)
        noise = sizes.friction_noise * self._noises["friction noise"].next(time.size)
        force = level * (1 + noise + sizes.ringing * self._noises["ringing"].next(time.size))
        if self._setting is None and self._stick_slip.occurs:
            slips = self._stick_slip.force(time - self._turning.start)
            force += np.where(self._bursts.are_on(time), slips, 0.0) if self._stick_slip.comes_in_bursts else slips
        turning = self._turning.at(time)
        drawn = sizes.holder_stiffness * (distance - self._began_to_slide)  # while the pin still sticks
        force = np.where(drawn < (1 + sizes.static_share) * level, drawn, force) * (turning / (turning + _STANDS))
        force = force + pulled(since=time - self._pulled_from, greatest=self._pull)
        reading = force + self._drift * (time - self._zeroed) + self._white("friction_force", sizes.sensor_noise, time)
        if sizes.hysteresis > 0:
            reading = play(reading, sizes.hysteresis, self._gauge)
            self._gauge = float(reading[-1])
        return np.asarray(reading)

    def _displacement(self, time: Floats, wobble: Floats) -> Floats:
        """Deflection of the holder by the force along the sliding, with play. [m]"""
        sizes = self._sizes
        ratio = self._ratio.at(time)
        turning = self._turning.at(time)
        friction = self._friction.friction_coefficient * self._load * wobble * ratio * turning / (turning + _STANDS)
        bent = (friction + pulled(since=time - self._pulled_from, greatest=self._pull)) / sizes.deflected_stiffness
        if sizes.deflection_play > 0:
            bent = play(bent, sizes.deflection_play, self._bent)
            self._bent = float(bent[-1])
        return np.asarray(bent + self._white("displacement", sizes.displacement_noise, time))

    def _phase(self, time: Floats, setting: DriveSetting) -> Floats:
        """Phase of the generator, whose clock is not that of the acquisition, in periods."""
        return setting.frequency * (1 + self._sizes.clock_error) * time + self._generator_phase

    def _voltage(self, time: Floats) -> Floats:
        """Voltage at the actuator."""
        noise = self._white("voltage", 1.0, time)
        setting = self._setting
        if setting is None:
            return self._sizes.voltage_noise * noise
        half = setting.voltage_peak_to_peak / 2
        wave = setting.wave(self._phase(time, setting))
        return setting.voltage_offset + half * (wave + self._sizes.voltage_noise * noise)

    def _monitor(self, time: Floats) -> Floats:
        """Peak-to-peak voltage by the monitor of the amplifier."""
        voltage = 0.0 if self._setting is None else self._setting.voltage_peak_to_peak
        return voltage + self._sizes.voltage_noise * max(voltage, 1.0) * self._white("voltage_peak_to_peak", 1.0, time)

    def _current(self, time: Floats) -> Floats:
        """Current into the actuator: by the admittance of its structure for a sine, else into its capacitance."""
        noise = self._white("current", self._sizes.current_noise, time)
        setting, capacitance = self._setting, self._capacitance
        if setting is None or capacitance is None:
            return noise
        admittance = self._admittance(setting.frequency)
        if admittance is not None and setting.waveform == "sine":
            lead = float(np.angle(admittance)) / (2 * pi)
            wave = setting.wave(self._phase(time, setting) + lead)
            return np.asarray(noise + abs(admittance) * setting.voltage_peak_to_peak / 2 * wave)
        step = 1 / (400 * setting.frequency)
        before, after = (setting.wave(self._phase(time + shift, setting)) for shift in (-step / 2, step / 2))
        return noise + capacitance * setting.voltage_peak_to_peak / 2 * (after - before) / step

    def _admittance(self, frequency: float) -> complex | None:
        """Admittance of the actuator in its structure; None where the rig has no stack in one. [S]"""
        if self._rig.stack is None or self._rig.structure is None:
            return None
        if frequency not in self._admittances:
            found = electrical_admittance(self._rig.structure, frequency=np.array([frequency]))
            self._admittances[frequency] = complex(found[0])
        return self._admittances[frequency]

    def _flux(self, time: Floats) -> Floats:
        """Reading of the Hall probe."""
        pulses = hall_pulses(revolutions=self._turned(time), magnets=self._sizes.magnets)
        return _PULSE * (pulses + self._white("gaussmeter", self._sizes.flux_noise, time))
