"""Command `response`: linear response of a rig, amplitude per volt and electrical impedance over frequency."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any

from sonolube.checks import Floats
from sonolube.cli.console.answer import Answer, aligned, deliver, si
from sonolube.cli.console.options import OUT, Changes, Json, Out, RigPath, TypedNumber, si_option
from sonolube.cli.console.outputs import OutputFolder
from sonolube.errors import InvalidInput
from sonolube.models.dynamics import modes
from sonolube.report import Drawing
from sonolube.rig import FrequencyResponse, Rig, frequency_grid, frequency_response, read_rig, structure_in_contact
from sonolube.rig.figures import response_figure
from sonolube.rig.labelled_arrays import LabelledArrays
from sonolube.rig.result_datasets import response_arrays
from sonolube.units import format_si


def response(
    rig: RigPath,
    lowest: Annotated[float, si_option("Hz", "Lowest frequency.", "--from")] = TypedNumber("1kHz", "Hz"),
    highest: Annotated[float, si_option("Hz", "Highest frequency.", "--to")] = TypedNumber("100kHz", "Hz"),
    changes: Changes = None,
    out: Annotated[Out, OutputFolder("{rig}-response.*")] = OUT,
    json: Json = False,
) -> None:
    """Linear response: tip amplitude per volt and electrical impedance over frequency.

    Example: sonolube response examples/rigs/tribometer.toml --from 15kHz --to 35kHz
    """
    if not 0 < lowest < highest:
        raise InvalidInput(f"--from {lowest} must lie above 0 Hz and below --to {highest}")
    known = read_rig(rig, changes=changes or ())
    result = frequency_response(known, frequency=frequency_grid(known, lowest=lowest, highest=highest))
    natural = modes(structure_in_contact(known))
    answer = ResponseAnswer(
        rig=known,
        result=result,
        natural_frequency=natural.natural_frequency[~natural.rigid],
        name=f"{rig.stem}-response",
    )
    deliver(answer, folder=out, as_json=json)


@dataclass(frozen=True, kw_only=True)
class ResponseAnswer(Answer):
    """Linear response of a rig: natural frequencies and the largest amplitude per volt."""

    rig: Rig
    result: FrequencyResponse
    natural_frequency: Floats
    name: str

    def lines(self) -> list[str]:
        """Natural frequencies and the largest amplitude per volt."""
        frequency, amplitude = self._largest()
        found = ", ".join(format_si(f, "Hz", digits=4) for f in self.natural_frequency.tolist()) or "none"
        at = format_si(frequency, "Hz", digits=4)
        largest = f"{format_si(amplitude, 'm')} per volt peak to peak at {at}"
        return [
            f"{self.rig.title}, {format_si(self.rig.normal_load, 'N')}, small motions",
            *aligned([("natural frequencies", found), ("largest amplitude", largest)]),
        ]

    def object(self) -> dict[str, Any]:
        """Natural frequencies, and frequency and value of the largest amplitude per volt."""
        frequency, amplitude = self._largest()
        return {
            "rig": self.rig.title,
            "resonances": [{"value": f, "unit": "Hz"} for f in self.natural_frequency.tolist()],
            **si({"frequency": frequency, "amplitude_per_volt": amplitude}),
        }

    def figures(self) -> Mapping[str, Drawing]:
        """FrequencyResponse over frequency."""
        return {self.name: Drawing(draw=lambda: response_figure(self.rig, self.result))}

    def files(self) -> Mapping[str, LabelledArrays]:
        """FrequencyResponse over frequency as netCDF."""
        return {f"{self.name}.nc": response_arrays(self.rig, self.result)}

    def _largest(self) -> tuple[float, float]:
        """Frequency and value of the largest amplitude per volt."""
        best = int(self.result.amplitude_per_volt.argmax())
        return float(self.result.frequency[best]), float(self.result.amplitude_per_volt[best])
