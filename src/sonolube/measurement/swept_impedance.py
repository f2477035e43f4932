"""Impedance spectrum of a recording of voltage and current while the frequency of the drive is swept by steps."""

from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.impedance.spectrum import ImpedanceSpectrum
from sonolube.measurement.recordings.formats import recording_format
from sonolube.measurement.recordings.reader import read_recording
from sonolube.measurement.time_series import constant_stretches

if TYPE_CHECKING:
    import xarray as xr

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
