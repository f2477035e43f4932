"""Answer of `response --curve`: a branch of steady vibrations through its folds, with what ramps reach."""

from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.report import Drawing
from sonolube.rig import Rig
from sonolube.rig.datasets import LabelledArrays
from sonolube.rig.resolved_rig import ResolvedRig
from sonolube.rig.response_curve import (
    RigResponseCurve,
    response_curve_arrays,
    response_curve_chart,
    rig_response_curve,
)
from sonolube.tasks.answer import Answer, Block, Rows, Table, answer, si
from sonolube.tasks.parameters import Number
from sonolube.tasks.task import in_si, refuse_unused, shown
from sonolube.text.units import format_si

_ABOUT = 1 / 6  # of the drive's frequency, on both sides
_JUMP_HEADS = ["slow ramp", "jumps at", "amplitude before", "after"]


def followed_curve(
    resolved: ResolvedRig,
    *,
    along: Literal["frequency", "voltage"],
    lowest: Number | None,
    highest: Number | None,
    lowest_voltage: Number | None,
    highest_voltage: Number | None,
) -> "ResponseCurveAnswer":
    """Response curve of a rig over the range that the options of `response` give, or about its drive."""
    drive = resolved.rig.drive
    if drive is None or drive.voltage_peak_to_peak is None:
        raise InvalidInput(f"{resolved.rig.title}: drive.voltage_peak_to_peak is missing; a curve needs a drive")
    if along == "frequency":
        refuse_unused("lowest_voltage", "highest_voltage", because="along the frequency; it is for --curve voltage")
        middle = drive.frequency
        usual = middle * (1 - _ABOUT), middle * (1 + _ABOUT)
        ends = rising_range("lowest", lowest, "highest", highest, usual=usual)
    else:
        refuse_unused("lowest", "highest", because="along the voltage; give --from-voltage and --to-voltage")
        volts = drive.voltage_peak_to_peak
        usual = volts / 20, 2 * volts
        ends = rising_range("lowest_voltage", lowest_voltage, "highest_voltage", highest_voltage, usual=usual, unit="V")
    return ResponseCurveAnswer(
        rig=resolved.rig, result=rig_response_curve(resolved, along=along, lowest=ends[0], highest=ends[1])
    )


def rising_range(
    low_name: str,
    low: Number | None,
    high_name: str,
    high: Number | None,
    *,
    usual: tuple[Number, Number],
    unit: str = "Hz",
) -> tuple[float, float]:
    """Two ends of a range in SI, each the usual one where None, refused where they do not rise."""
    low, high = usual[0] if low is None else low, usual[1] if high is None else high
    first, last = in_si(low_name, low), in_si(high_name, high)
    if not 0 < first < last:
        raise InvalidInput(f"{shown(low_name)} {low} must lie above 0 {unit} and below {shown(high_name)} {high}")
    return first, last


@answer
class ResponseCurveAnswer(Answer):
    """Steady vibrations of a rig over voltage or frequency: largest amplitude, folds and jumps of slow ramps."""

    rig: Rig
    result: RigResponseCurve

    def blocks(self) -> Sequence[Block]:
        """Range, largest amplitude, least friction, folds, and the jumps of slow ramps."""
        found = self.result
        largest = int(found.vibration_amplitude.argmax())
        folds = ", ".join(self._at(float(each)) for each in found.parameter[found.folds]) or "none"
        rows = [
            ("largest amplitude", f"{self._amplitude(largest)} at {self._at(float(found.parameter[largest]))}"),
            ("folds", folds),
        ]
        if not np.isnan(found.friction_ratio).all():
            least = int(np.nanargmin(np.where(found.stable, found.friction_ratio, np.nan)))
            ratio, at = found.friction_ratio[least], self._at(float(found.parameter[least]))
            rows.insert(1, ("least friction ratio", f"{ratio:.3f} at {at}"))
        jumps = [
            (
                "up" if each.is_rising else "down",
                self._at(each.at),
                *(format_si(a, "m") for a in (each.before, each.after)),
            )
            for each in found.jumps
        ]
        ends = " to ".join(self._at(float(each)) for each in np.sort(found.parameter)[[0, -1]])
        return [
            f"{self.rig.title}, {format_si(self.rig.normal_load, 'N')}, {self._fixed()}, {ends}",
            Rows(rows),
            *([Table(_JUMP_HEADS, jumps)] if jumps else []),
        ]

    def object(self) -> dict[str, Any]:
        """Axis, folds, jumps with their amplitudes, and the largest amplitude."""
        found = self.result
        largest = int(found.vibration_amplitude.argmax())
        unit = "V" if found.along == "voltage" else "Hz"
        return {
            "rig": self.rig.title,
            "along": found.along,
            "folds": [{"value": float(each), "unit": unit} for each in found.parameter[found.folds]],
            "jumps": [
                {
                    "ramp": "up" if each.is_rising else "down",
                    "at": {"value": each.at, "unit": unit},
                    "before": {"value": each.before, "unit": "m"},
                    "after": {"value": each.after, "unit": "m"},
                }
                for each in found.jumps
            ],
            "is_complete": found.complete,
            **si({"vibration_amplitude": float(found.vibration_amplitude[largest])}),
            **si({name: float(getattr(found, name)[largest]) for name in ("voltage_peak_to_peak", "frequency")}),
        }

    def caveats(self) -> Sequence[str]:
        """What the curve leaves out."""
        found, lines = self.result, []
        if found.jumps:
            lines.append(
                "a slow ramp follows the branch to a fold and jumps there; a sudden voltage or a disturbance may reach"
                " either vibration between the jumps"
            )
        if not found.complete:
            lines.append("the branch was left before it reached an end of the range; take a shorter one")
        if not found.stable[found.rising].all() or not found.stable[found.falling].all():
            lines.append(
                "part of what a ramp passes is unstable without a fold: there the vibration does not repeat with the"
                " drive; `sonolube simulate` follows it in time"
            )
        return lines

    def figures(self) -> Mapping[str, Drawing]:
        """Amplitude and friction ratio along the branch, with jumps and backbone."""
        return {f"{self.rig.name}-response": Drawing(chart=lambda: response_curve_chart(self.rig, self.result))}

    def files(self) -> Mapping[str, LabelledArrays]:
        """Branch as netCDF, over `point`."""
        return {f"{self.rig.name}-response.nc": response_curve_arrays(self.rig, self.result)}

    def _at(self, value: float) -> str:
        return format_si(value, "V" if self.result.along == "voltage" else "Hz", digits=4)

    def _amplitude(self, place: int) -> str:
        return format_si(float(self.result.vibration_amplitude[place]), "m")

    def _fixed(self) -> str:
        """The entry of the drive that stays."""
        if self.result.along == "voltage":
            return format_si(float(self.result.frequency[0]), "Hz")
        return f"{format_si(float(self.result.voltage_peak_to_peak[0]), 'V')} peak to peak"
