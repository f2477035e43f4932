"""Study I of the dissertation on the virtual tribometer: how much of what was measured lies within the scatter?"""

from collections.abc import Sequence
from functools import cache
from math import pi
from pathlib import Path

import numpy as np

from reliability.study import Measure, Record, Study
from sonolube.checks import Floats
from sonolube.facts.published import si_value
from sonolube.laboratory import DriveSetting, connect_devices
from sonolube.laboratory.virtual_tribometer import virtual_tribometer
from sonolube.measurement.friction.voltage_steps import friction_at_voltage_steps
from sonolube.prediction.evidence import published_rigs
from sonolube.prediction.hierarchy import central_interval
from sonolube.prediction.posterior import published_population
from sonolube.prediction.predictive import ratio_draws
from sonolube.rig import Rig, read_rig

_RIG = Path(__file__).parents[2] / "examples" / "rigs" / "tribometer.toml"
_GROOVE = 0.0582  # m, from 292.5 m in 1600 turns
_DRIVE = DriveSetting(voltage_peak_to_peak=28.0, voltage_offset=14.0, frequency=22e3)
_RATE = 400  # Hz
_RUN_IN, _MEASURED = 20, 40  # s, the second without and again with vibration
_PROBABILITY = 0.8
_FORCES = [[f"table-2.3-friction_force-{row}" for row in rows] for rows in ((1, 3, 5), (2, 4, 6))]


@cache
def _rig() -> Rig:
    return read_rig(_RIG)


def _trial(seed: int) -> Record:
    """One specimen at the three speeds: friction without and with vibration, and its reduction."""
    devices = virtual_tribometer(_rig(), seed=seed, groove_diameter=_GROOVE).devices
    connect_devices(devices)
    without, with_vibration, reduction = [], [], []
    for number in (1, 3, 5):
        speed = si_value(f"table-2.3-sliding_speed-{number}")
        devices.acquisition.start(["friction_force"], sample_rate=_RATE)
        devices.motor.turn(speed / (pi * _GROOVE))
        devices.acquisition.read(_RUN_IN * _RATE)
        still = devices.acquisition.read(_MEASURED * _RATE).values[:, 0]
        devices.drive.drive(_DRIVE)
        vibrating = devices.acquisition.read(_MEASURED * _RATE).values[:, 0]
        devices.drive.off()
        devices.acquisition.stop()
        force = np.concatenate([still, vibrating])
        first, second = friction_at_voltage_steps(
            time=np.arange(force.size) / _RATE,
            friction_force=force,
            voltage_peak_to_peak=np.repeat([0.0, _DRIVE.voltage_peak_to_peak], still.size),
        )
        without.append(first.friction_force)
        with_vibration.append(second.friction_force)
        reduction.append(second.friction_reduction)
    return {"without": without, "with": with_vibration, "reduction": reduction}


def _measures(records: Sequence[Record]) -> list[Measure]:
    off, on = (np.array([si_value(name) for name in names]) for names in _FORCES)
    published = {"without": off, "with": on, "reduction": 1 - on / off}
    titles = {"without": "friction without vibration", "with": "friction with vibration", "reduction": "reduction"}
    return [
        *(
            _share(titles[name], published[name], np.array([record[name] for record in records], dtype=float))
            for name in titles
        ),
        _share("reduction, predicted from other rigs only", published["reduction"], _reductions_unseen()),
    ]


def _share(title: str, measured: Floats, draws: Floats) -> Measure:
    """Values of three speeds within the band of draws, with the bands."""
    low, high = central_interval(draws, _PROBABILITY)
    bands = ", ".join(
        f"{value:.2f} in {one:.2f} to {other:.2f}" for value, one, other in zip(measured, low, high, strict=True)
    )
    inside = int(np.sum((low <= measured) & (measured <= high)))
    return Measure(label=f"{title} within the 80 % band at three speeds", value=f"{inside} of 3 ({bands})")


def _reductions_unseen() -> Floats:
    """Draws of the reduction from a population that was learned without these tests."""
    index, rig = next((index, rig) for index, rig in enumerate(published_rigs()) if rig.name == "A")
    posterior = published_population().posterior(without=(index,))
    return np.asarray(1 - ratio_draws(posterior, rig.at, count=1000))


STUDY = Study(
    title="Study I on the virtual tribometer",
    question="Friction of 200 virtual specimens at the three speeds of Study I, recorded and analysed, beside D"
    " Table 2.3. The rig file has one coefficient of friction, that of the lowest speed, and the population was learned"
    " from these tests too; the last row is without them.",
    sources=("laboratory/virtual_tribometer/*.py", "prediction/*.py", "prediction/*.toml", "prediction/learned.json"),
    trials=200,
    sample=2,
    trial=_trial,
    measures=_measures,
)
"""Virtual Study I."""
