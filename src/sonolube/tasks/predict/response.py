"""Task `response`: linear response of a rig, amplitude per volt and electrical impedance over frequency."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any

from sonolube import rig as rigs
from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.models.dynamics import modes
from sonolube.report import Drawing
from sonolube.rig.datasets import LabelledArrays
from sonolube.rig.figures import response_chart
from sonolube.rig.resolved_rig import resolved_rig
from sonolube.rig.result_datasets import response_arrays
from sonolube.tasks.answer import Answer, Block, Rows, answer, si
from sonolube.tasks.parameters import Number, Quantity, RestingRig, rig_of
from sonolube.tasks.task import in_si, shown, task
from sonolube.text.units import format_si


@task
def response(
    rig: RestingRig,
    *,
    lowest: Annotated[Number, Quantity("Lowest frequency.", "Hz", option="--from")] = "1kHz",
    highest: Annotated[Number, Quantity("Highest frequency.", "Hz", option="--to")] = "100kHz",
) -> "ResponseAnswer":
    """Linear response: tip amplitude per volt and electrical impedance over frequency.

    Example: sonolube response examples/rigs/tribometer.toml --from 15kHz --to 35kHz

    Examples
    --------
    >>> import sonolube as sl
    >>> from sonolube.text.units import format_si
    >>> answer = sl.response("examples/rigs/tribometer.toml", lowest="15kHz", highest="35kHz")
    >>> format_si(float(answer["amplitude_per_volt"].idxmax()), "Hz")  # the resonance
    '22 kHz'
    """
    low, high = in_si("lowest", lowest), in_si("highest", highest)
    if not 0 < low < high:
        raise InvalidInput(f"{shown('lowest')} {lowest} must lie above 0 Hz and below {shown('highest')} {highest}")
    known = rig_of(rig)
    resolved = resolved_rig(known)
    result = rigs.frequency_response(resolved, frequency=rigs.frequency_grid(resolved, lowest=low, highest=high))
    natural = modes(rigs.structure_in_contact(resolved))
    return ResponseAnswer(rig=known, result=result, natural_frequency=natural.natural_frequency[~natural.rigid])


@answer
class ResponseAnswer(Answer):
    """Linear response of a rig: natural frequencies and the largest amplitude per volt."""

    rig: rigs.Rig
    result: rigs.FrequencyResponse
    natural_frequency: Floats

    def blocks(self) -> Sequence[Block]:
        """Natural frequencies and the largest amplitude per volt."""
        frequency, amplitude = self._largest()
        found = ", ".join(format_si(f, "Hz", digits=4) for f in self.natural_frequency.tolist()) or "none"
        at = format_si(frequency, "Hz", digits=4)
        largest = f"{format_si(amplitude, 'm')} per volt peak to peak at {at}"
        return [
            f"{self.rig.title}, {format_si(self.rig.normal_load, 'N')}, small motions",
            Rows([("natural frequencies", found), ("largest amplitude", largest)]),
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
        """Response over frequency."""
        return {f"{self.rig.name}-response": Drawing(chart=lambda: response_chart(self.rig, self.result))}

    def files(self) -> Mapping[str, LabelledArrays]:
        """Response over frequency as netCDF."""
        return {f"{self.rig.name}-response.nc": response_arrays(self.rig, self.result)}

    def _largest(self) -> tuple[float, float]:
        """Frequency and value of the largest amplitude per volt."""
        best = int(self.result.amplitude_per_volt.argmax())
        return float(self.result.frequency[best]), float(self.result.amplitude_per_volt[best])
