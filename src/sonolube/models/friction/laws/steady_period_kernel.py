"""Mean force over the steady period of a bristle law, linear in the deformation along straight slides (kernel)."""

import numpy as np

from sonolube.checks import Floats
from sonolube.execution.compilation import kernel

__all__: list[str] = []  # kernel of this room


@kernel(cache=True, no_cfunc_wrapper=True)
def steady_period_mean_force(
    stiffness: Floats, limit: Floats, slides: Floats, paths: Floats, durations: Floats
) -> Floats:
    """Mean of one component of the force over the steady period of each row of steps.

    `slides` are those along the component, `paths` their lengths within the plane, `durations` weights of the steps:
    with slides in their place the mean is the work of the component. All have shape (m, n), the result (m,).

    After every step the deformation is a linear function of that at the start of the period, and so is the time
    integral of the force. The steady period is the fixed point of the map of one period.
    """
    means = np.empty(stiffness.shape[0])
    for point in range(means.size):
        # deformation after each step: kept * (that at the start) + gained; likewise the time integral of the force
        kept, gained, log_kept, mean_kept, mean_gained = 1.0, 0.0, 0.0, 0.0, 0.0
        for step in range(stiffness.shape[1]):
            k, largest, path = stiffness[point, step], limit[point, step], paths[point, step]
            decay = k * path / largest
            if decay == 0.0:
                continue
            steady = slides[point, step] / path * largest / k
            relaxed = -np.expm1(-decay)
            weight, held = durations[point, step] * k, relaxed / decay
            mean_kept += weight * held * kept
            mean_gained += weight * (steady + held * (gained - steady))
            gained += relaxed * (steady - gained)
            log_kept -= decay
            kept = np.exp(log_kept)
        means[point] = mean_gained - mean_kept * gained / np.expm1(log_kept)
    return means
