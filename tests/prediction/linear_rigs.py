"""Rigs whose friction ratios are normally distributed: oracles in closed form."""

import numpy as np

from sonolube.prediction.evidence import Closure, Conditions, TestedRig, UncertainConditions

LINEAR = Closure(
    name="linear",
    citation="friction ratio that is the logarithm of its parameter",
    parameter="exponential",
    unit="",
    median=float(np.exp(0.4)),
    spread=1.0,
    ratio=lambda logs, at: np.broadcast_arrays(np.asarray(logs), at.vibration_amplitude, at.decay_length)[0],
    effect=lambda logs, at: np.ones(np.broadcast_shapes(np.shape(logs), at.vibration_amplitude.shape)),
    bounds=lambda at: (0.0, np.inf),
)
"""With it, all ratios are normally distributed."""


def conditions(amplitudes: list[float], speeds: list[float]) -> Conditions:
    a, v = np.array(amplitudes), np.array(speeds)
    return Conditions(
        vibration_amplitude=a, frequency=np.full(a.size, 2e4), sliding_speed=v, decay_length=np.full(a.size, 1e-6)
    )


def measured_rig(ratios: list[float], at: Conditions, *, name: str = "rig") -> TestedRig:
    known = UncertainConditions(conditions=at, decay_length_spread=None, amplitude_spread=0.1)
    return TestedRig(name=name, at=known, friction_ratio=np.array(ratios), uncertainty=np.full(len(ratios), 0.05))
