"""One recording from the files of a test that was recorded in parts."""

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from sonolube import __version__
from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.joining import begun_at, time_shifts

if TYPE_CHECKING:
    import xarray as xr

_GAP = 1.5  # sample intervals between parts beyond which samples are missing between them
_MAX_LISTED = 12


def join_recordings(recordings: Sequence["xr.Dataset"]) -> "xr.Dataset":
    """Recordings of consecutive parts of one test as one recording.

    Parameters
    ----------
    recordings : sequence of xarray.Dataset
        As `read_recording` returns them, in the order of the test.

    Returns
    -------
    xarray.Dataset
        The channels that all parts have, along the time of the first. Where the times of a part do not continue those
        of the one before, it begins at the difference of the stated starts, or, where no starts are stated or they
        overlap, one sample interval after the one before, which is a caveat. A sample without values stands in each
        gap, so that nothing is integrated across it. The attribute `part_starts` holds the first time of each part.

    Raises
    ------
    InvalidInput
        If there are no recordings, one has no time, no channel is in all, or a channel differs in its unit.

    See Also
    --------
    sonolube.measurement.recordings.reader.read_recording : a file.
    """
    import xarray as xr

    if not recordings:
        raise InvalidInput("there are no recordings to join")
    for part in recordings:
        if "time" not in part.coords:
            raise InvalidInput(f"{_name(part)} has no time along which it could be joined with others")
    names = [str(name) for name in recordings[0].data_vars if all(name in part for part in recordings)]
    if not names:
        raise InvalidInput(f"{_name(recordings[0])} has no channel in common with the files after it")
    for name in names:
        units = {str(part[name].attrs.get("units")) for part in recordings}
        if len(units) > 1:
            raise InvalidInput(f"channel {name!r} is in {' and '.join(sorted(units))} in the files to join")
    times = [part["time"].to_numpy() for part in recordings]
    shifts, assumed = time_shifts(times, [begun_at(str(part.attrs.get("begun", ""))) for part in recordings])
    placed = [time + shift for time, shift in zip(times, shifts, strict=True)]
    interval = float(np.median(np.concatenate([np.diff(time) for time in times if time.size > 1] or [np.ones(1)])))
    gaps = [after[0] - before[-1] > _GAP * interval for before, after in pairwise(placed)]
    middles = [(before[-1] + after[0]) / 2 for before, after in pairwise(placed)]
    channels = {
        name: (
            "time",
            _with_gaps([part[name].to_numpy() for part in recordings], gaps, None),
            recordings[0][name].attrs,
        )
        for name in names
    }
    return xr.Dataset(
        channels,
        coords={"time": ("time", _with_gaps(placed, gaps, middles), recordings[0]["time"].attrs)},
        attrs={
            "title": f"{len(recordings)} files as one test",
            "source": f"sonolube {__version__}",
            "file_name": f"{_name(recordings[0])} to {_name(recordings[-1])}",
            "file_format": str(recordings[0].attrs.get("file_format", "")),
            "sample_rate": 1 / interval,
            "dropped_samples": sum(int(part.attrs.get("dropped_samples", 0)) for part in recordings),
            "part_starts": [float(time[0]) for time in placed],
            "caveats": "\n".join(_caveats(recordings, names, assumed=assumed)),
        },
    )


def _caveats(recordings: Sequence["xr.Dataset"], names: Sequence[str], *, assumed: bool) -> list[str]:
    """Caveats of the parts, each once, and those of their joining."""
    caveats = [line for part in recordings for line in str(part.attrs.get("caveats", "")).splitlines()]
    left_out = {str(name) for part in recordings for name in part.data_vars} - set(names)
    if left_out:
        caveats.append(f"channels that not all files have were left out: {', '.join(sorted(left_out)[:_MAX_LISTED])}")
    if assumed:
        caveats.append(
            "the times restart in the files and their starts are not stated: each was placed one sample interval after"
            " the one before"
        )
    return list(dict.fromkeys(caveats))


def _with_gaps(parts: Sequence[Floats], gaps: Sequence[bool], between: Sequence[float] | None) -> Floats:
    """Parts one after the other, with one value in each gap: that given for it, or NaN."""
    pieces = [parts[0]]
    for index, part in enumerate(parts[1:]):
        if gaps[index]:
            pieces.append(np.array([np.nan if between is None else between[index]]))
        pieces.append(part)
    return np.concatenate(pieces)


def _name(recording: "xr.Dataset") -> str:
    """Name of the file of a recording, for messages."""
    return str(recording.attrs.get("file_name", "the recording"))
