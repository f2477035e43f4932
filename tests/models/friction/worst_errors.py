"""Search for the largest difference of two functions of amplitude and speed."""

from collections.abc import Callable

import numpy as np

from sonolube.checks import Floats

Ratio = Callable[[Floats, Floats], Floats]


def worst_error(one: Ratio, other: Ratio, *, decades: tuple[float, float], count: int = 6000) -> float:
    """Largest difference over decades of amplitude and all speeds up to the critical one.

    At random points, dense at slow sliding, below the critical speed and about the inverse root of the amplitude, then
    about the worst of them, ever closer.
    """
    rng = np.random.default_rng(0)
    part = count // 4
    beta = 10 ** rng.uniform(*decades, count)
    v = np.concatenate(
        [
            rng.random(part),
            10 ** rng.uniform(-12, 0, part),
            1 - 10 ** rng.uniform(-8, 0, part),
            10 ** rng.uniform(-2, 1, count - 3 * part) / np.sqrt(beta[3 * part :]),
        ]
    )
    worst = 0.0
    for width in (0.03, 0.01, 0.003):
        v = np.clip(v, 1e-15, 1 - 1e-12)
        error = np.abs(one(beta, v) - other(beta, v))
        worst = max(worst, float(error.max()))
        about = np.repeat(np.argsort(error)[-20:], 50)
        beta = np.clip(beta[about] * np.exp(width * rng.normal(size=1000)), 10 ** decades[0], 10 ** decades[1])
        v = np.where(
            rng.random(1000) < 0.5,
            v[about] * np.exp(width * rng.normal(size=1000)),
            1 - (1 - v[about]) * np.exp(width * rng.normal(size=1000)),
        )
    return worst
