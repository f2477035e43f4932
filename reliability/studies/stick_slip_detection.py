"""Detection of stick-slip at a voltage step, and the fall of the force in a slip, over noise and number of slips."""

from collections.abc import Sequence

import numpy as np

from reliability import friction_recordings as made
from reliability.study import Measure, Record, Study
from sonolube.measurement.friction.voltage_steps import friction_at_voltage_steps

_FALL = 0.16  # N
_RATIOS = (1 / 32, 1 / 8, 1 / 4, 1 / 2)  # standard deviation of the noise over the fall
_SAMPLES_OF_PERIOD = 50  # the fewest


def _trial(seed: int) -> Record:
    rng = np.random.default_rng([16, seed])
    ratio, coloured = _RATIOS[seed % len(_RATIOS)], bool(seed // len(_RATIOS) % 2)
    plan = made.layout(rng, published=bool(rng.random() < 0.5))
    rate = float(rng.choice([1000, 2000]))
    t = made.times(plan, rate)
    step = int(rng.integers(1, len(plan.starts)))
    room = (*plan.starts[1:], plan.end)[step] - plan.starts[step] - 0.7
    slowest = 13 / room
    frequency = float(np.exp(rng.uniform(np.log(slowest), np.log(rate / _SAMPLES_OF_PERIOD))))
    slips = int(rng.integers(10, max(11, min(60, int(0.8 * room * frequency)))))
    spare = max(0.0, room - made.burst_duration(slips, frequency))
    burst = made.Sawtooth(
        start=plan.starts[step] + 0.6 + float(rng.uniform(0, spare)),
        slips=slips,
        frequency=frequency,
        fall=_FALL,
        ringing_frequency=float(rng.choice([0.0, 200.0])),
    )
    force = made.held(plan, t, plan.levels) + made.stick_slip(rng, t, burst)
    force += made.wobble(rng, t, speed=rng.uniform(0.3, 2.5), amplitudes=(0.060, 0.024))
    share = np.sqrt(0.5) if coloured else 1.0
    force += ratio * share * _FALL * rng.standard_normal(t.size)
    if coloured:
        constant = 10 ** rng.uniform(-2, -1)
        force += made.red_noise(rng, t, deviation=ratio * share * _FALL, time_constant=constant)
    found = friction_at_voltage_steps(
        time=t, friction_force=force, voltage_peak_to_peak=made.held(plan, t, plan.voltages)
    )
    estimate = found[step].stick_slip
    lower, upper = estimate.stick_slip_amplitude_interval
    return {
        "ratio": ratio,
        "coloured": coloured,
        "slips": slips,
        "detected": estimate.detected,
        "elsewhere": any(one.stick_slip.detected for j, one in enumerate(found) if j != step),
        "found": estimate.force_drops,
        "bias": estimate.stick_slip_amplitude / _FALL - 1,
        "half_interval": (upper - lower) / 2 / _FALL,
        "covered": lower <= _FALL <= upper,
        "frequency": estimate.stick_slip_frequency / frequency,
    }


def _column(records: Sequence[Record], key: str) -> np.ndarray:
    return np.array([record[key] for record in records], dtype=float)


def _measures(records: Sequence[Record]) -> list[Measure]:
    measures = []
    for coloured, noise in ((0, "white"), (1, "white and red")):
        for ratio in _RATIOS:
            chosen = [r for r in records if r["ratio"] == ratio and r["coloured"] == bool(coloured)]
            if chosen:
                measures += _of_noise(chosen, f"{noise} noise of {ratio:.3g} of the fall")
    few = [r for r in records if r["ratio"] == 0.5 and int(str(r["slips"])) <= 15]
    if few:
        share = float(_column(few, "detected").mean())
        measures.append(Measure(label="detected of 10 to 15 slips in noise of half the fall", value=f"{share:.1%}"))
    detected = [record for record in records if record["detected"]]
    covered = float(_column(detected, "covered").mean())
    elsewhere = float(_column(records, "elsewhere").mean())
    return [
        *measures,
        Measure(
            label="coverage of the falls' 95 % intervals",
            value=f"{covered:.1%}",
            bar="at least 90 %",
            holds=covered >= 0.9,
        ),
        Measure(
            label="recordings with stick-slip found at another step",
            value=f"{elsewhere:.1%}",
            bar="below 1 %",
            holds=elsewhere < 0.01,
        ),
    ]


def _of_noise(records: Sequence[Record], noise: str) -> list[Measure]:
    share = float(_column(records, "detected").mean())
    detected = [record for record in records if record["detected"]]
    bias, half = float(np.mean(_column(detected, "bias"))), float(np.median(_column(detected, "half_interval")))
    return [
        Measure(label=f"detected in {noise}", value=f"{share:.1%}", bar="at least 95 %", holds=share >= 0.95),
        Measure(
            label=f"mean error of the fall in {noise}",
            value=f"{bias:+.2%}",
            bar=f"within the median interval, {half:.2%}",
            holds=abs(bias) <= half,
        ),
    ]


def _sample_measures(records: Sequence[Record]) -> list[Measure]:
    share = float(_column(records, "detected").mean())
    return [Measure(label="detected", value=f"{share:.1%}", bar="at least 80 %", holds=share >= 0.8)]


STUDY = Study(
    title="Detection of stick-slip at voltage steps",
    question="Ten to sixty slips of 160 mN at one step, with wobble and a ringing sensor, are detected up to a noise "
    "of half the fall, with the fall within its interval. Periods have fifty samples at least and scatter by 10 %.",
    sources=("measurement/friction/*.py",),
    trials=480,
    sample=6,
    trial=_trial,
    measures=_measures,
    sample_measures=_sample_measures,
)
