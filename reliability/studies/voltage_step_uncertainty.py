"""Uncertainty of mean friction and reduction at voltage steps, with wobble, bursts of stick-slip, run-in and drift."""

from collections.abc import Sequence

import numpy as np
from numpy.random import Generator

from reliability import friction_recordings as made
from reliability.study import Measure, Record, Study
from sonolube.measurement.friction.voltage_steps import friction_at_voltage_steps

_SETTLING = 0.5  # s


def _bursts(rng: Generator, plan: made.Layout, t: made.Samples) -> made.Samples:
    force = np.zeros(t.size)
    ends = (*plan.starts[1:], plan.end)
    for step in rng.choice(len(plan.starts), int(rng.integers(0, 4)), replace=False):
        room = ends[step] - plan.starts[step] - _SETTLING - 1.0
        frequency = float(rng.uniform(6, 20))
        slips = int(rng.integers(8, max(9, room * frequency * 0.8)))
        spare = max(0.0, room + 0.4 - made.burst_duration(slips, frequency))
        burst = made.Sawtooth(
            start=plan.starts[step] + _SETTLING + 0.55 + float(rng.uniform(0, spare)),
            slips=slips,
            frequency=frequency,
            fall=float(rng.uniform(0.05, 0.2)),
            ringing_frequency=float(rng.choice([0.0, 200.0])),
        )
        force += made.stick_slip(rng, t, burst)
    return force


def _trial(seed: int) -> Record:
    rng = np.random.default_rng([15, seed])
    plan = made.layout(rng, published=seed % 2 == 0)
    t = made.times(plan, float(rng.choice([1000, 1250, 2000])))
    speed = float(rng.choice([1 / 1.34, rng.uniform(0.15, 2.5)]))
    known = bool(rng.random() < 0.5)
    slope = float(rng.uniform(-0.3e-3, 0.3e-3)) * float(rng.random() < 0.5)
    run_in = float(rng.uniform(0, 0.08)) * float(rng.random() < 0.3)
    force = made.held(plan, t, plan.levels) + slope * t
    force += run_in * np.exp(-(t - made.MOTOR_ON) / rng.uniform(0.8, 2.5))
    force += made.wobble(rng, t, speed=speed, amplitudes=(0.060, 0.024)) + _bursts(rng, plan, t)
    force[t < made.MOTOR_ON] = 0.0
    force += rng.uniform(0.002, 0.010) * rng.standard_normal(t.size)
    if rng.random() < 0.6:
        force += made.red_noise(rng, t, deviation=rng.uniform(0.001, 0.010), time_constant=10 ** rng.uniform(-2, -1))
    steps = friction_at_voltage_steps(
        time=t,
        friction_force=force,
        voltage_peak_to_peak=made.held(plan, t, plan.voltages),
        revolutions=np.round(speed, 3) * t if known else None,
    )
    ends = np.array([*plan.starts[1:], plan.end])
    starts = np.array([made.MOTOR_ON, *plan.starts[1:]]) + _SETTLING
    true = np.array(plan.levels) + slope * (starts + ends - 0.05) / 2
    reduction = 1 - true[1:] / true[0]
    found = np.array([(step.friction_force, step.friction_force_uncertainty) for step in steps]).T
    reduced = np.array([(s.friction_reduction, s.friction_reduction_uncertainty) for s in steps[1:]], dtype=float).T
    return {
        "steps": len(steps) == len(true),
        "z": [round(float(z), 3) for z in (found[0] - true) / found[1]],
        "z_reduction": [round(float(z), 3) for z in (reduced[0] - reduction) / reduced[1]],
        "uncertainty_mN": [round(1e3 * float(u), 4) for u in found[1]],
    }


def _score(records: Sequence[Record], key: str) -> np.ndarray:
    return np.concatenate([np.asarray(record[key], dtype=float) for record in records])


def _within(label: str, value: float, lower: float, upper: float) -> Measure:
    return Measure(
        label=label, value=f"{value:.3f}", bar=f"{lower:g} to {upper:g}", holds=bool(lower <= value <= upper)
    )


def _measures(records: Sequence[Record]) -> list[Measure]:
    mean, reduction = _score(records, "z"), _score(records, "z_reduction")
    median = float(np.median(_score(records, "uncertainty_mN")))
    return [
        _within("error over standard error of the means, root mean square", float(np.sqrt(np.mean(mean**2))), 0.8, 1.2),
        _within("the same of the reductions", float(np.sqrt(np.mean(reduction**2))), 0.8, 1.2),
        _within("coverage of the means' 95 % intervals", float(np.mean(np.abs(mean) < 1.96)), 0.92, 0.98),
        _within("coverage of the reductions' 95 % intervals", float(np.mean(np.abs(reduction) < 1.96)), 0.92, 0.98),
        Measure(label="median standard error of a mean (mN)", value=f"{median:.3g}"),
    ]


def _sample_measures(records: Sequence[Record]) -> list[Measure]:
    score = _score(records, "z")
    return [_within("error over standard error, root mean square", float(np.sqrt(np.mean(score**2))), 0.3, 2.0)]


STUDY = Study(
    title="Uncertainty of friction at voltage steps",
    question="Mean friction and reduction at the steps of a voltage err by as much as their standard errors state, "
    "under a wobble of 60 and 24 mN at a known or unknown speed, bursts of stick-slip, run-in, drift and noise.",
    sources=("measurement/friction/*.py", "measurement/statistics/autocorrelation.py"),
    trials=200,
    sample=5,
    trial=_trial,
    measures=_measures,
    sample_measures=_sample_measures,
)
