"""Virtual map tests through the analysis of friction at voltage steps: is what is returned what was recorded?"""

from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from reliability.study import Measure, Record, Study
from sonolube.facts.protocol import protocol_by_name_or_file
from sonolube.laboratory import Block, Channel, run_protocol
from sonolube.laboratory.virtual_tribometer import virtual_tribometer
from sonolube.measurement.friction_analysis import analyse_voltage_steps
from sonolube.rig import Rig, read_rig

if TYPE_CHECKING:
    import xarray as xr

_RIG = Path(__file__).parents[2] / "examples" / "rigs" / "power_map.toml"
_LOWEST, _HIGHEST = 0.8, 1.2  # of the root mean square of deviation over uncertainty
_SAME_VOLTAGE = 0.3  # V


class _Record:
    """Blocks and set voltages of one recording, in memory."""

    def __init__(self) -> None:
        self.blocks: list[Block] = []
        self.voltages: list[tuple[int, float]] = [(0, 0.0)]

    def begin(self, channels: Sequence[Channel], *, sample_rate: float) -> None:
        """Begin the only recording."""

    def append(self, block: Block) -> None:
        """Keep a block."""
        self.blocks.append(block)

    def end(self) -> None:
        """End the recording."""

    def note(self, kind: str, *, sample: int | None = None, **facts: str | float) -> None:
        """Keep the set voltages."""
        if kind == "drive":
            self.voltages.append((sample or 0, float(facts["voltage_peak_to_peak"])))

    def finish(self, outcome: str, *, reason: str = "") -> None:
        """Nothing is open."""

    def dataset(self) -> "xr.Dataset":
        """Force and set voltage over time."""
        import xarray as xr

        force = np.concatenate([block.values[:, 0] for block in self.blocks])
        number = np.arange(force.size)
        since = np.searchsorted([sample for sample, _ in self.voltages], number, side="right") - 1
        voltage = np.array([level for _, level in self.voltages])[since]
        data = {"friction_force": ("time", force), "voltage_peak_to_peak": ("time", voltage)}
        return xr.Dataset(data, {"time": number / self.blocks[0].sample_rate})


@cache
def _rig() -> Rig:
    return read_rig(_RIG)


def _trial(seed: int) -> Record:
    virtual = virtual_tribometer(_rig(), seed=seed, groove_diameter=0.028)
    record = _Record()
    result = run_protocol(protocol_by_name_or_file("map_test"), virtual.devices, record, operator=lambda prompt: True)
    if result.outcome != "completed":
        raise RuntimeError(result.reason)
    steps = analyse_voltage_steps(record.dataset())
    truth = virtual.truth()
    force = [_true_force(truth, step.voltage_peak_to_peak) for step in steps]
    return {
        "steps": len(steps),
        "force": [
            (step.friction_force - known) / step.friction_force_uncertainty
            for step, known in zip(steps, force, strict=True)
        ],
        "reduction": [
            (step.friction_reduction - (1 - known / force[0])) / (step.friction_reduction_uncertainty or np.nan)
            for step, known in zip(steps, force, strict=True)
            if step.friction_reduction is not None
        ],
    }


def _true_force(truth: "xr.Dataset", voltage: float) -> float:
    """Worn-in friction of the virtual rig at a voltage. [N]"""
    set_to = np.abs(truth["voltage_peak_to_peak"].to_numpy() - voltage) < _SAME_VOLTAGE
    sliding = truth["sliding_speed"].to_numpy() > 0
    return float(truth["friction_force"].to_numpy()[set_to & sliding][0])


def _measures(records: Sequence[Record]) -> list[Measure]:
    def spread(name: str) -> float:
        return float(np.sqrt(np.mean(np.concatenate([_numbers(record, name) for record in records]) ** 2)))

    bar = f"{_LOWEST} to {_HIGHEST}"
    found = {"friction at a step": spread("force"), "its reduction": spread("reduction")}
    missed = sum(int(str(record["steps"])) != 6 for record in records)
    return [
        Measure(label="tests whose six steps were not found", value=str(missed), bar="0", holds=not missed),
        *(
            Measure(
                label=f"root mean square of deviation over stated uncertainty, {name}",
                value=f"{value:.2f}",
                bar=bar,
                holds=_LOWEST <= value <= _HIGHEST,
            )
            for name, value in found.items()
        ),
    ]


def _sample_measures(records: Sequence[Record]) -> list[Measure]:
    """Bars for few tests, whose root mean square scatters."""
    missed, *others = _measures(records)
    wide = [0.5 < float(each.value) < 1.7 for each in others]
    return [
        missed,
        *(Measure(label=e.label, value=e.value, bar="0.5 to 1.7", holds=h) for e, h in zip(others, wide, strict=True)),
    ]


def _numbers(record: Mapping[str, Any], name: str) -> np.ndarray:
    """Numbers of a record."""
    return np.asarray(record[name], dtype=float)


STUDY = Study(
    title="Virtual tests through the analysis",
    question="The map test of the dissertation on the virtual tribometer, with wobble, run-in, ringing, noise, drift"
    " and hysteresis, through the analysis of voltage steps: is friction within its uncertainty of what was given?",
    sources=("lab/virtual_tribometer/*.py", "measurement/friction/*.py"),
    trials=100,
    sample=6,
    trial=_trial,
    measures=_measures,
    sample_measures=_sample_measures,
)
"""Virtual map tests."""
