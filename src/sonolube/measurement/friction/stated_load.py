"""Coefficient of friction by a force and the load under it, with the uncertainties of load and zero."""

from dataclasses import dataclass
from math import hypot

from sonolube.checks import require_non_negative, require_positive
from sonolube.measurement.friction.voltage_steps import VoltageStep


@dataclass(frozen=True, kw_only=True, slots=True)
class StatedLoad:
    """Load under which friction was measured.

    Parameters
    ----------
    normal_load : float
        Force pressing the bodies together. [N]
    normal_load_uncertainty : float
        Its standard uncertainty. [N]
    force_zero_uncertainty : float
        Standard uncertainty of the zero of the friction force. [N]

    Raises
    ------
    InvalidInput
        If the load is not positive, or an uncertainty is negative.
    """

    normal_load: float
    normal_load_uncertainty: float = 0.0
    force_zero_uncertainty: float = 0.0

    def __post_init__(self) -> None:
        require_positive(normal_load=self.normal_load)
        require_non_negative(
            normal_load_uncertainty=self.normal_load_uncertainty, force_zero_uncertainty=self.force_zero_uncertainty
        )

    def coefficient(self, friction_force: float, *, uncertainty: float | None) -> tuple[float, float | None]:
        r"""Coefficient of friction of a force and its standard uncertainty, to first order.

        .. math:: \mu = \frac{F}{F_N}, \qquad u_\mu = \frac{1}{F_N}\sqrt{u_F^2 + u_z^2 + (\mu\,u_{F_N})^2}

        An unknown uncertainty of the force counts as none where load or zero have one, and else stays unknown.
        """
        value = friction_force / self.normal_load
        of_load = value * self.normal_load_uncertainty
        if uncertainty is None and not (of_load or self.force_zero_uncertainty):
            return value, None
        return value, hypot(uncertainty or 0.0, self.force_zero_uncertainty, of_load) / self.normal_load

    def reduction_uncertainty(self, step: VoltageStep) -> float | None:
        r"""Standard uncertainty of the friction reduction of a step with that of the zero, which both forces have.

        .. math:: u_P' = \sqrt{u_P^2 + (P\,u_z/F_0)^2}, \qquad F_0 = F/(1 - P)

        None of a step without a reduction, and as it is where no force is left.
        """
        uncertainty, reduction = step.friction_reduction_uncertainty, step.friction_reduction
        if uncertainty is None or reduction is None or not step.friction_force:
            return uncertainty
        intrinsic = step.friction_force / (1 - reduction)
        return hypot(uncertainty, reduction * self.force_zero_uncertainty / intrinsic)
