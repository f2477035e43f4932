"""Quantities of a recording by its channels: voltage, speed and rest, what was set, and the impedance in a sweep."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.friction.sliding import Mask, at_rest
from sonolube.measurement.friction.voltage_steps import voltage_envelope
from sonolube.measurement.impedance.spectrum import ImpedanceSpectrum
from sonolube.measurement.recordings.reader import read_recording, recording_format
from sonolube.measurement.time_series import constant_stretches

if TYPE_CHECKING:
    import xarray as xr

_MEASURED: Final = ("relative_velocity", "sliding_speed", "rotation_speed")
_SET: Final = ("sliding_speed_set", "motor_on")

_MOVES: Final = 0.05  # of the highest speed
_CHANGES: Final = 0.1  # of the highest speed


def recorded_voltage(recording: "xr.Dataset") -> Floats | None:
    """Peak-to-peak voltage of a recording, from the alternating voltage where it is not recorded; None without both.

    [V]
    """
    if "voltage_peak_to_peak" in recording:
        return _values(recording, "voltage_peak_to_peak")
    if "stack_voltage" not in recording:
        return None
    return voltage_envelope(time=_values(recording, "time"), stack_voltage=_values(recording, "stack_voltage"))


def speed_channel(recording: "xr.Dataset") -> str | None:
    """Name of the channel of the speed: one that was measured, else one that was set; None without any."""
    names = (name for name in (*_MEASURED, *_SET) if name in recording)
    return next((name for name in names if np.isfinite(_values(recording, name)).any()), None)


def recorded_speed(recording: "xr.Dataset") -> Floats | None:
    """Speed of a recording: one that was measured, else the one that was set, 0 where the motor was off.

    In m/s; 1/s of a rotational speed, 1 of a motor that is on. None where no channel tells it.
    """
    name = speed_channel(recording)
    if name is None:
        return None
    speed = _values(recording, name)
    if name in _SET and "motor_on" in recording:
        return np.asarray(np.where(_values(recording, "motor_on") > 0, speed, 0.0))
    return speed


def speed_of_one_direction(recording: "xr.Dataset") -> Floats | None:
    """Speed of a recording by which its steps are separated; None for one that reciprocates, or where it is unknown.

    As `recorded_speed`.
    """
    speed = recorded_speed(recording)
    if speed is None:
        return None
    low, high = np.nanpercentile(speed, [5, 95])
    return None if low * high < 0 else speed


def speed_changes(recording: "xr.Dataset") -> bool:
    """Whether a recording has several sliding speeds, by over a tenth; false where the speed is not known."""
    speed = recorded_speed(recording)
    if speed is None:
        return False
    size = np.abs(speed[np.isfinite(speed)])
    low, high = np.percentile(size[size > _MOVES * size.max()], [5, 95]) if size.any() else (0.0, 0.0)
    return bool(high - low > _CHANGES * high)


def recorded_rest(recording: "xr.Dataset") -> Mask:
    """Whether the surfaces rest at each sample of a recording with `friction_force`, as `at_rest`; shape (samples,)."""
    return at_rest(
        time=_values(recording, "time"),
        friction_force=_values(recording, "friction_force"),
        voltage_peak_to_peak=recorded_voltage(recording),
        sliding_speed=recorded_speed(recording),
    )


def _values(recording: "xr.Dataset", name: str) -> Floats:
    """Values of a channel."""
    values: Floats = recording[name].to_numpy()
    return values


_SETTINGS: Final = ("motor_on", "sliding_speed_set", "normal_load_set", "lubricant_set", "recording_part")


@dataclass(frozen=True, kw_only=True, slots=True)
class SetConditions:
    """Stretch of a recording at one speed, load and lubricant.

    Parameters
    ----------
    samples : slice
    slides : bool
        Whether the motor is on.
    sliding_speed : float
        NaN where it is not known. [m/s]
    normal_load : float
        NaN where it is not known. [N]
    lubricant : int
        Its number; 0 for none.
    levels : tuple of (slice, float, float)
        Samples of each drive setting, its voltage in V, peak to peak, and its frequency in Hz, both 0 for off.
    """

    samples: slice
    slides: bool
    sliding_speed: float
    normal_load: float
    lubricant: int
    levels: tuple[tuple[slice, float, float], ...]


def set_conditions(recording: "xr.Dataset") -> tuple[SetConditions, ...]:
    """Stretches of a recording at constant conditions, in the order of time.

    Empty where the recording has no set points of the motor.
    """
    if "motor_on" not in recording:
        return ()
    columns = [_column(recording, name) for name in _SETTINGS]
    drive = [_column(recording, name) for name in ("voltage_peak_to_peak_set", "frequency_set")]
    found = []
    for begin, end in constant_stretches(*columns):
        levels = tuple(
            (slice(begin + first, begin + last), float(drive[0][begin + first]), float(drive[1][begin + first]))
            for first, last in constant_stretches(*(column[begin:end] for column in drive))
        )
        motor, speed, load, lubricant, _ = (float(column[begin]) for column in columns)
        found.append(
            SetConditions(
                samples=slice(begin, end),
                slides=motor > 0,
                sliding_speed=speed,
                normal_load=load,
                lubricant=0 if np.isnan(lubricant) else round(lubricant),
                levels=levels,
            )
        )
    return tuple(found)


def _column(recording: "xr.Dataset", name: str) -> Floats:
    """Values of a channel; zeros for a drive that was not used, NaN for others that are missing."""
    if name in recording:
        values: Floats = recording[name].to_numpy()
        return values
    missing = 0.0 if name in ("voltage_peak_to_peak_set", "frequency_set") else np.nan
    return np.full(recording["time"].size, missing)


_NEEDED: Final = ("stack_voltage", "stack_current", "frequency_set")
_SETTLING: Final = 0.1  # of a step, left out at its begin
_SAMPLES_PER_PERIOD: Final = 2.5  # fewer do not tell amplitude and phase
_FEWEST: Final = 32  # samples of a step
_MOST: Final = 1 << 16  # samples of a step that are fitted


def swept_impedance(path: Path) -> ImpedanceSpectrum | None:
    """Impedance spectrum of a recording of a sweep.

    None where the file is no recording with these channels.

    At each frequency voltage and current are fitted by a sine, a cosine and a constant, least squares; the impedance is
    the ratio of the amplitudes as complex numbers. The clock of a generator deviates by parts in 1e5 from that of the
    acquisition, which turns both phases alike and leaves the ratio.
    """
    if path.suffix.lower() != ".nc":
        return None
    recording = read_recording(path)
    if not all(name in recording for name in _NEEDED):
        return None
    time, frequency = recording["time"].to_numpy(), recording["frequency_set"].to_numpy()
    found: dict[float, complex] = {}
    for begin, end in constant_stretches(frequency):
        hertz = float(frequency[begin])
        piece = slice(begin + round(_SETTLING * (end - begin)), min(end, begin + _MOST))
        if hertz > 0 and piece.stop - piece.start >= _FEWEST:
            _require_resolved(path, recording, hertz)
            voltage, current = (
                _amplitude(recording[name].to_numpy()[piece], time[piece], hertz)
                for name in ("stack_voltage", "stack_current")
            )
            found[hertz] = voltage / current
    if not found:
        raise InvalidInput(f"{path}: its drive holds no frequency for {_FEWEST} samples")
    frequencies = sorted(found)
    return ImpedanceSpectrum(
        frequency=np.array(frequencies),
        impedance=np.array([found[each] for each in frequencies]),
        file_name=path.name,
        file_format=f"{recording_format(path).name}, a sweep",
        sha256=str(recording.attrs.get("sha256", "")),
        caveats=tuple(str(recording.attrs.get("caveats", "")).splitlines()),
    )


def _require_resolved(path: Path, recording: "xr.Dataset", frequency: float) -> None:
    """Refuse a recording with too few samples a period."""
    rate = float(recording.attrs.get("sample_rate", 0.0))
    if rate < _SAMPLES_PER_PERIOD * frequency:
        raise InvalidInput(
            f"{path}: {rate:g} Hz do not resolve a drive at {frequency:g} Hz; record at {_SAMPLES_PER_PERIOD:g} times"
            " its frequency or more"
        )


def _amplitude(values: Floats, time: Floats, frequency: float) -> complex:
    """Complex amplitude of a sine in values."""
    angle = 2 * np.pi * frequency * time
    columns = np.stack([np.cos(angle), np.sin(angle), np.ones_like(angle)], axis=1)
    cosine, sine, _ = np.linalg.lstsq(columns, values, rcond=None)[0]
    return complex(cosine, -sine)
