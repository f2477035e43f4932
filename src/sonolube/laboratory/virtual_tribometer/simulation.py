"""Virtual rig: what its channels read over time, as motor and drive are set between blocks."""

from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from math import ceil, pi
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
    StickSlip,
    arm_resonance,
    correlated,
    hall_pulses,
    play,
    pulled,
    resonant,
)
from sonolube.laboratory.virtual_tribometer.streams import OutputDistortion, Source, Stream
from sonolube.laboratory.virtual_tribometer.truth import FrictionDraw, Temperatures, TruthSetting, truth_dataset
from sonolube.models.dynamics.structure import electrical_admittance
from sonolube.prediction.evidence_posterior import EvidencePosterior
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
_JUMP: Final = 1.0  # s, in which other clocks are sampled while an operator works at the rig
_SPEED_NOISE: Final = 1e-3  # of the speed, of a tachometer
_VELOCITY_NOISE: Final = 1e-3  # m/s, of a vibrometer
_AMPLITUDE_NOISE: Final = 1e-8  # m, likewise
_SLACK: Final = 1e-6  # of a sample, for rounding


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
    evidence : EvidencePosterior, optional
        Posterior that friction is drawn from, in place of the shipped one.
    """

    def __init__(
        self,
        rig: Rig,
        seed: int,
        disturbances: Disturbances,
        heating: HeatingAssumptions,
        groove_diameter: float,
        real_time: bool,
        *,
        evidence: EvidencePosterior | None = None,
    ) -> None:
        streams = np.random.SeedSequence(seed).spawn(_STREAMS)
        disturbances = disturbances.drawn(np.random.default_rng(streams[_SIZES]))
        friction = FrictionDraw(rig, seed=seed, evidence=evidence)
        self._rig, self._friction, self._sizes = rig, friction, disturbances
        self._diameter, self._real_time = groove_diameter, real_time
        self._streams = streams
        phases = np.random.default_rng(streams[_PHASES])
        self._bursts = Bursts(np.random.default_rng(streams[_BURSTS]), disturbances.burst_duration)
        self._load, self._pull, self._pulled_from, self._zeroed = rig.normal_load, 0.0, 0.0, 0.0
        self._lifted_at, self._untouched = 0.0, 0.0  # m, distance at the latest change of load, and without contact
        self._wobble_phases = phases.uniform(0, 1, 2)
        self._drift = float(disturbances.drift_rate * phases.standard_normal())
        self._generator_phase = float(phases.uniform())
        self._time = 0.0
        self._began_at = 0.0  # on the wall clock
        self._main = Stream({name: Source(signal=name) for name in CHANNELS}, self._generator)
        self._beside: list[tuple[Stream, Callable[[Floats], None]]] = []
        self._due: list[tuple[float, Callable[[], None]]] = []
        self._distortion = OutputDistortion()
        self._setting: DriveSetting | None = None
        self._shown: DriveSetting | None = None  # with the factor of a distortion
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
        self._amplitude = Approach(0.0, 0.0, 0.0, disturbances.vibration_time)
        self._shows_vibration = False
        self._stick_slip = self._sticking(0.0)
        self._settings: list[TruthSetting] = []
        self._signals = self._by_name()

    def _by_name(self) -> "Mapping[str, Callable[[_Reading], Floats]]":
        """Readings of the rig by the signals of sources."""
        return {
            "friction_force": self._friction_force,
            "normal_load": self._normal_load,
            "voltage": self._voltage,
            "voltage_peak_to_peak": self._monitor,
            "current": self._current,
            "current_peak": self._current_peak,
            "current_rms": self._current_rms,
            "temperature": self._temperature,
            "gaussmeter": self._flux,
            "displacement": self._displacement,
            "rotation_speed": self._rotation_speed,
            "vibration_amplitude": self._vibration_amplitude,
            "surface_velocity": self._surface_velocity,
            "surface_displacement": self._surface_displacement,
            "rest": self._rest,
        }

    def trial(self) -> "VirtualRig":
        """Copy that may be turned and sampled, and leaves the rig and its random numbers as they are."""
        found = copy(self)
        found._main = Stream(self._main.sources, self._main.generator)
        found._bursts = Bursts(np.random.default_rng(self._streams[_BURSTS]), self._sizes.burst_duration)
        found._temperatures = copy(self._temperatures)
        found._settings, found._prepared, found._beside, found._due = [], [], [], []
        found._real_time = False
        found._signals = found._by_name()
        return found

    def _generator(self, channel: str, part: str) -> np.random.Generator:
        """Random numbers of a channel of the rig's own acquisition; `part` is empty for the noise of the sensor."""
        name = part or channel
        number = _DISPLACEMENT if name == "displacement" else _NOISES.index(name)
        return np.random.default_rng(self._streams[number])

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

    def replace_main(self, stream: Stream) -> None:
        """Sample another stream by `start` and `read`, in place of the rig's own."""
        self._main = stream
        self._shows_vibration |= stream.shows_vibration

    def start(self, names: Sequence[str], sample_rate: float) -> None:
        """Begin to sample."""
        self._begin(self._main, names, sample_rate)
        self._began_at = monotonic()

    def start_beside(
        self, stream: Stream, names: Sequence[str], sample_rate: float, take: Callable[[Floats], None]
    ) -> None:
        """Begin to sample another stream, whose samples are handed over as the time goes on."""
        self.stop_beside(stream)
        self._shows_vibration |= stream.shows_vibration
        self._begin(stream, names, sample_rate)
        self._beside.append((stream, take))

    def stop_beside(self, stream: Stream) -> None:
        """End to sample another stream."""
        self._beside = [each for each in self._beside if each[0] is not stream]

    def _begin(self, stream: Stream, names: Sequence[str], sample_rate: float) -> None:
        """Begin to sample a stream."""
        sizes = self._sizes
        feedback = {
            "friction noise": correlated(time_constant=sizes.noise_time, sample_rate=sample_rate),
            "ringing": resonant(frequency=self._arm[0], damping_ratio=self._arm[1], sample_rate=sample_rate),
        }
        stream.start(names, rate=sample_rate, time=self._time, feedback=feedback)

    def stop(self) -> None:
        """End to sample."""
        self._main.rate = 0.0

    def clock(self) -> float:
        """Time of the devices, by the samples and the prompts. [s]"""
        return self._time

    def at(self, time: float, act: Callable[[], None]) -> None:
        """Act at a time, before the first block that begins there or later; at once where that has passed. [s]"""
        if time <= self._time:
            act()
        else:
            self._due.append((time, act))

    def read(self, samples: int) -> Block:
        """Next samples."""
        stream = self._main
        if not stream.rate:
            raise DeviceError("virtual acquisition: nothing is sampled; call start first")
        self._act_if_due()
        first = stream.sample
        time = stream.next_times(samples)
        self._time = stream.epoch + stream.sample / stream.rate
        values = self._values(time, stream)
        self._catch_up()
        if self._real_time:
            sleep(max(0.0, self._began_at + self._time - stream.epoch - monotonic()))
        return Block(first_sample=first, sample_rate=stream.rate, values=values)

    def _act_if_due(self) -> None:
        """Do what was to be done by now."""
        due, self._due = self._due, []
        for time, act in due:
            self.at(time, act)

    def _catch_up(self) -> None:
        """Hand over the samples of other streams until now."""
        for stream, take in self._beside:
            count = ceil((self._time - stream.epoch) * stream.rate - _SLACK) - stream.sample
            if count > 0:
                take(self._values(stream.next_times(count), stream))

    def _pass(self, until: float) -> None:
        """Let the time go on to a later one, while others than the main stream are sampled."""
        while self._beside and self._time + _JUMP < until:
            self._time += _JUMP
            self._catch_up()
        self._time = max(self._time, until)
        self._catch_up()

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
        self._pass(since + PROMPT_DURATIONS[prompt.task])
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

    def distort(self, distortion: OutputDistortion) -> None:
        """Have the output of the drive deviate from its setting from now on."""
        self._distortion = distortion
        self._settle()

    @property
    def distortion(self) -> OutputDistortion:
        """Deviation of the output of the drive from its setting."""
        return self._distortion

    def _settle(self) -> None:
        """Set the friction of the present setting."""
        speed = self._turning.target * pi * self._diameter
        self._volume_until_now()
        self._shown, vibrating = self._distortion.applied(self._setting), self._distortion.vibrating(self._setting)
        self._level = self._friction.at(vibrating, speed, normal_load=self._load)
        self._ratio = self._ratio.towards(self._level.friction_ratio, time=self._time)
        if self._shows_vibration:
            amplitude = self._friction.amplitude(vibrating, speed, normal_load=self._load)
            self._amplitude = self._amplitude.towards(amplitude, time=self._time)
        self._stick_slip = self._sticking(speed)
        flash = self._temperatures.set(
            self._time, setting=vibrating, friction_force=self._level.friction_force, sliding_speed=speed
        )
        self._settings.append(
            TruthSetting(self._time, speed, vibrating, self._level, flash, self._load, self._stick_slip)
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

    def _values(self, time: Floats, stream: Stream) -> Floats:
        """Samples of the chosen channels of a stream at times, through their sensors."""
        wobble = self._wobble(time)
        found = []
        for name in stream.names:
            source = stream.sources[name]
            signal = self._signals[source.signal](_Reading(time, wobble, stream, name, source))
            found.append(source.reading(np.asarray(signal, dtype=np.float64)))
        return np.stack(found, axis=1)

    def _wobble(self, time: Floats) -> Floats:
        """Load over its mean by the run-out of the disc. []"""
        turned, (first, second) = self._turned(time), self._wobble_phases
        return np.asarray(
            1
            + self._sizes.wobble_1 * np.cos(2 * np.pi * (turned + first))
            + self._sizes.wobble_2 * np.cos(4 * np.pi * (turned + second))
        )

    def _friction_force(self, at: "_Reading") -> Floats:
        """Reading of the force gauge."""
        sizes, time = self._sizes, at.time
        mean = self._friction.friction_coefficient * self._load
        distance = self._distance(time)
        ratio = self._ratio.at(time)
        run_in = np.exp(-(distance - self._untouched) / sizes.run_in_distance)
        level = mean * at.wobble * ratio * (1 + sizes.run_in_share * run_in)
        noise = sizes.friction_noise * at.noise("friction noise")
        force = level * (1 + noise + sizes.ringing * at.noise("ringing"))
        if self._shown is None and self._stick_slip.occurs:
            slips = self._stick_slip.force(time - self._turning.start)
            force += np.where(self._bursts.are_on(time), slips, 0.0) if self._stick_slip.comes_in_bursts else slips
        turning = self._turning.at(time)
        drawn = sizes.holder_stiffness * (distance - self._began_to_slide)  # while the pin still sticks
        force = np.where(drawn < (1 + sizes.static_share) * level, drawn, force) * (turning / (turning + _STANDS))
        force = force + pulled(since=time - self._pulled_from, greatest=self._pull)
        reading = force + self._drift * (time - self._zeroed) + sizes.sensor_noise * at.noise()
        return at.with_play(reading, sizes.hysteresis)

    def _normal_load(self, at: "_Reading") -> Floats:
        """Load, with its wobble."""
        return np.asarray(self._load * at.wobble + self._sizes.sensor_noise * at.noise())

    def _temperature(self, at: "_Reading") -> Floats:
        """Reading of a thermocouple."""
        reading = self._temperatures.reading(at.time, contact_share=at.source.contact_share)
        return np.asarray(reading + self._sizes.temperature_noise * at.noise())

    def _rotation_speed(self, at: "_Reading") -> Floats:
        """Reading of a tachometer."""
        turning = self._turning.at(at.time)
        return np.asarray(turning * (1 + _SPEED_NOISE * at.noise()))

    def _vibration_amplitude(self, at: "_Reading") -> Floats:
        """Amplitude of the contact, zero to peak, as a vibrometer with a lock-in reads it."""
        return np.asarray(self._amplitude.at(at.time) + _AMPLITUDE_NOISE * at.noise())

    def _surface_velocity(self, at: "_Reading") -> Floats:
        """Velocity of the contact at the fundamental of the drive, as a vibrometer reads it."""
        noise = _VELOCITY_NOISE * at.noise()
        if self._shown is None:
            return noise
        angular = 2 * pi * self._shown.frequency
        return np.asarray(noise + angular * self._swing(at) * np.cos(2 * pi * self._phase(at.time, self._shown)))

    def _surface_displacement(self, at: "_Reading") -> Floats:
        """Displacement of the contact at the fundamental of the drive, as a vibrometer reads it."""
        noise = _AMPLITUDE_NOISE * at.noise()
        if self._shown is None:
            return noise
        return np.asarray(noise + self._swing(at) * np.sin(2 * pi * self._phase(at.time, self._shown)))

    def _swing(self, at: "_Reading") -> Floats:
        """Amplitude of the contact over time."""
        mean = self._distortion.mean_envelope
        return np.asarray(self._amplitude.at(at.time) * self._distortion.envelope(at.time) / mean)

    def _rest(self, at: "_Reading") -> Floats:
        """Rest value of a channel that the rig does not simulate."""
        return np.asarray(at.source.rest + at.source.noise * at.noise())

    def _displacement(self, at: "_Reading") -> Floats:
        """Deflection of the holder by the force along the sliding, with play. [m]"""
        sizes, time = self._sizes, at.time
        ratio = self._ratio.at(time)
        turning = self._turning.at(time)
        friction = self._friction.friction_coefficient * self._load * at.wobble * ratio * turning / (turning + _STANDS)
        bent = (friction + pulled(since=time - self._pulled_from, greatest=self._pull)) / sizes.deflected_stiffness
        return at.with_play(bent, sizes.deflection_play) + sizes.displacement_noise * at.noise()

    def _phase(self, time: Floats, setting: DriveSetting) -> Floats:
        """Phase of the generator, whose clock is not that of the acquisition, in periods."""
        return setting.frequency * (1 + self._sizes.clock_error) * time + self._generator_phase

    def _voltage(self, at: "_Reading") -> Floats:
        """Voltage at the actuator."""
        noise, setting = at.noise(), self._shown
        if setting is None:
            return self._sizes.voltage_noise * noise
        half = setting.voltage_peak_to_peak / 2
        wave = setting.wave(self._phase(at.time, setting)) * self._distortion.envelope(at.time)
        if self._distortion.second_share:
            wave = wave + self._distortion.second(at.time)
        return setting.voltage_offset + half * (wave + self._sizes.voltage_noise * noise)

    def _monitor(self, at: "_Reading") -> Floats:
        """Peak-to-peak voltage by the monitor of the amplifier."""
        voltage = 0.0 if self._shown is None else self._shown.voltage_peak_to_peak
        swing = voltage * (self._distortion.envelope(at.time) + self._distortion.second_share)
        return np.asarray(swing + self._sizes.voltage_noise * max(voltage, 1.0) * at.noise())

    def _current(self, at: "_Reading") -> Floats:
        """Current into the actuator: by the admittance of its structure for a sine, else into its capacitance."""
        noise = self._sizes.current_noise * at.noise()
        setting, capacitance = self._shown, self._capacitance
        if setting is None or capacitance is None:
            return noise
        time, envelope = at.time, self._distortion.envelope(at.time)
        admittance = self._admittance(setting.frequency)
        if admittance is not None and setting.waveform == "sine":
            lead = float(np.angle(admittance)) / (2 * pi)
            wave = setting.wave(self._phase(time, setting) + lead) * envelope
            return np.asarray(noise + abs(admittance) * setting.voltage_peak_to_peak / 2 * wave)
        step = 1 / (400 * setting.frequency)
        before, after = (setting.wave(self._phase(time + shift, setting)) for shift in (-step / 2, step / 2))
        return noise + capacitance * setting.voltage_peak_to_peak / 2 * (after - before) / step * envelope

    def _current_peak(self, at: "_Reading") -> Floats:
        """Peak of the current, as a peak meter reads it."""
        return self._current_level(at, lambda wave: float(np.abs(wave).max()))

    def _current_rms(self, at: "_Reading") -> Floats:
        """Root mean square of the current, as an rms meter reads it."""
        return self._current_level(at, lambda wave: float(np.sqrt(np.mean(wave**2))))

    def _current_level(self, at: "_Reading", level: Callable[[Floats], float]) -> Floats:
        """Level of the current by one period of it."""
        noise = self._sizes.current_noise * at.noise()
        setting, capacitance = self._shown, self._capacitance
        if setting is None or capacitance is None:
            return noise
        admittance = self._admittance(setting.frequency)
        phase = (np.arange(_PERIOD) + 0.5) / _PERIOD
        if admittance is not None and setting.waveform == "sine":
            wave = abs(admittance) * np.sin(2 * pi * phase)
        else:
            step = 1 / 400
            slope = (setting.wave(phase + step / 2) - setting.wave(phase - step / 2)) / step
            wave = capacitance * setting.frequency * slope
        found = level(wave) * setting.voltage_peak_to_peak / 2
        return np.asarray(noise + found * self._distortion.envelope(at.time))

    def _admittance(self, frequency: float) -> complex | None:
        """Admittance of the actuator in its structure; None where the rig has no stack in one. [S]"""
        if self._rig.stack is None or self._rig.structure is None:
            return None
        if frequency not in self._admittances:
            found = electrical_admittance(self._rig.structure, frequency=np.array([frequency]))
            self._admittances[frequency] = complex(found[0])
        return self._admittances[frequency]

    def _flux(self, at: "_Reading") -> Floats:
        """Reading of the Hall probe."""
        pulses = hall_pulses(revolutions=self._turned(at.time), magnets=self._sizes.magnets)
        return np.asarray(_PULSE * (pulses + self._sizes.flux_noise * at.noise()))


_PERIOD: Final = 4000  # points of one period, of which a level is taken


@dataclass(frozen=True, slots=True)
class _Reading:
    """Times at which a channel of a stream is read, and the load over its mean there."""

    time: Floats
    wobble: Floats
    stream: Stream
    name: str
    source: Source

    def noise(self, part: str = "") -> Floats:
        """Next noise of unit variance; that of the sensor, or another part."""
        return self.stream.noise(self.name, part, self.time.size)

    def with_play(self, values: Floats, half_width: float) -> Floats:
        """Values behind the play of the sensor."""
        if half_width > 0:
            values = play(values, half_width, self.stream.played.get(self.name, 0.0))
            self.stream.played[self.name] = float(values[-1])
        return np.asarray(values)
