"""Stick-slip that is found where there is none: noise of several colours, wobble and voltage steps."""

from collections.abc import Sequence

import numpy as np

from reliability import friction_recordings as made
from reliability.study import Measure, Record, Study
from sonolube.measurement.friction.voltage_steps import friction_at_voltage_steps

_KINDS = ("white", "red", "white and red", "uneven", "hum and resonance", "random walk", "1/f")


def _noise(kind: str, rng: np.random.Generator, plan: made.Layout, t: made.Samples) -> made.Samples:
    white = 0.01 * rng.standard_normal(t.size)
    red = made.red_noise(
        rng, t, deviation=0.01 * 10 ** rng.uniform(-1, 0.5), time_constant=10 ** rng.uniform(-2.5, -0.3)
    )
    if kind == "white":
        return white
    if kind == "red":
        return red
    if kind == "random walk":
        return np.asarray(0.1 * white + 0.03 * np.sqrt(t[1] - t[0]) * np.cumsum(rng.standard_normal(t.size)))
    if kind == "1/f":
        spectrum = rng.standard_normal((2, t.size // 2 + 1)).T @ (1, 1j)
        spectrum[1:] /= np.sqrt(np.arange(1, spectrum.size))
        flicker = np.fft.irfft(spectrum, t.size)
        return np.asarray(0.01 * flicker / np.std(flicker))
    if kind == "uneven":
        return (white + red) * made.held(plan, t, tuple(rng.uniform(0.3, 2, len(plan.levels))))
    if kind == "hum and resonance":
        from scipy.signal import lfilter

        pole = np.exp((-0.02 + 1j) * 2 * np.pi * 200 * (t[1] - t[0]))
        ringing = lfilter([1.0], [1.0, -2 * pole.real, abs(pole) ** 2], rng.standard_normal(t.size))
        hum = rng.uniform(0.005, 0.05) * np.sin(2 * np.pi * 50 * t)
        return np.asarray(white + 0.01 * ringing / np.std(ringing) + hum)
    return white + red


def _trial(seed: int) -> Record:
    rng = np.random.default_rng([17, seed])
    kind = _KINDS[seed % len(_KINDS)]
    plan = made.layout(rng, published=bool(rng.random() < 0.5))
    t = made.times(plan, float(rng.choice([1000, 2000])))
    force = made.held(plan, t, plan.levels) + rng.uniform(0, 0.08) * np.exp(-(t - made.MOTOR_ON) / rng.uniform(0.5, 3))
    speed = float(rng.uniform(0.2, 3))
    orders = np.arange(1, int(rng.integers(2, 7)))
    amplitudes = rng.uniform(0, 0.06, orders.size) / orders
    force += made.wobble(rng, t, speed=speed, amplitudes=tuple(amplitudes))
    force[t < made.MOTOR_ON] = 0.0
    force += _noise(kind, rng, plan, t)
    steps = friction_at_voltage_steps(
        time=t,
        friction_force=force,
        voltage_peak_to_peak=made.held(plan, t, plan.voltages),
        revolutions=speed * t if rng.random() < 0.5 else None,
    )
    return {"kind": kind, "alarm": any(step.stick_slip.detected for step in steps)}


def _measures(records: Sequence[Record]) -> list[Measure]:
    alarms = [record for record in records if record["alarm"]]
    share = len(alarms) / len(records)
    kinds = ", ".join(f"{sum(record['kind'] == kind for record in alarms)} {kind}" for kind in _KINDS)
    return [
        Measure(
            label="recordings with stick-slip found",
            value=f"{share:.2%} ({kinds})",
            bar="below 1 %",
            holds=share < 0.01,
        )
    ]


STUDY = Study(
    title="False alarms of stick-slip",
    question="In recordings with wobble of one to five harmonics, run-in, voltage steps and noise, white, red, uneven "
    "between steps, with hum and a resonance, of a random walk or 1/f, no stick-slip is found.",
    sources=("measurement/friction/*.py",),
    trials=1000,
    sample=5,
    trial=_trial,
    measures=_measures,
)
