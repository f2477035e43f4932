"""Friction models: the protocol of the records that turn a motion of the gap into a mean friction ratio.

A model is a frozen record of its parameters in a file of its own, and one line of the table `FRICTION_MODELS`. Keys of
rig files, their units and checks, the JSON schema, the options of commands and the dispatch in `sonolube.rig` derive
from the record; no other code names a model.
"""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, field, fields
from enum import StrEnum
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, Integers, require_positive
from sonolube.errors import InvalidInput
from sonolube.models.contact.contact_motion import ContactMotion, GapMotionBatch
from sonolube.models.contact.rough import RoughContact
from sonolube.vocabulary import quantities


class MeanGap(StrEnum):
    """Mean gap about which a prescribed sine of the gap is taken."""

    AT_REST = "at rest"
    """The separation under the dead load without vibration; the mean normal force then exceeds the load."""

    LOAD_BALANCED = "load balanced"
    """The mean at which the mean normal force equals the load."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ModelParameter:
    """Parameter of a friction model: its meaning, unit, default and range.

    Parameters
    ----------
    name : str
        Field of the record, and key of the table `friction` of a rig file.
    unit : str
        SI unit; empty for pure numbers.
    meaning : str
        Quantity in a few words, fit for an axis.
    default : float
        Value where none is given, in the unit.
    lowest : float
        Lower end of the range, in the unit.
    positive : bool
        Whether the lower end itself is excluded.
    """

    name: str
    unit: str
    meaning: str
    default: float
    lowest: float
    positive: bool

    def require(self, value: float) -> None:
        """Refuse a value outside the range.

        Raises
        ------
        InvalidInput
            Naming the parameter, the value and its unit.
        """
        if value < self.lowest or (self.positive and value == self.lowest):
            demand = "be positive" if self.positive else "not be negative" if self.lowest == 0 else "be finite"
            raise InvalidInput(f"{self.name} must {demand}, got {value!r} {self.unit}".rstrip())
        if math.isinf(value) and value != self.default:
            raise InvalidInput(f"{self.name} must be finite, got {value!r} {self.unit}".rstrip())


def parameter(
    default: float, *, lowest: float = -math.inf, positive: bool = False, unit: str | None = None, meaning: str = ""
) -> Any:
    """Declare a field of a friction model as a parameter that rig files and commands can set.

    Parameters
    ----------
    default : float
        Value where none is given, in SI.
    lowest : float
        Lower end of its range.
    positive : bool
        Whether it must be positive.
    unit : str, optional
        SI unit; that of the vocabulary's quantity of this name where absent.
    meaning : str
        Quantity in a few words; that of the vocabulary where empty.

    Returns
    -------
    dataclasses.Field
    """
    declared = {"lowest": 0.0 if positive else lowest, "positive": positive, "unit": unit, "meaning": meaning}
    return field(default=default, metadata={"parameter": declared})


class FrictionModel(ABC):
    """Mean friction under a given periodic motion of the gap, relative to friction without vibration.

    Attributes
    ----------
    name : str
        Name in `FRICTION_MODELS`, rig files and commands.
    citation : str
        Source of the model.
    mean_gap : MeanGap
        Mean gap about which a prescribed sine is taken for this model.
    rate_dependent : bool
        Whether frequency and sliding speed enter; where not, a prescribed sine of any frequency gives the same.
    needs_open_gap : bool
        Whether the model loses its meaning where the mean planes meet within the period.
    directions : frozenset of str
        Directions of vibration in which friction changes by the model: "normal", "along" and "across".
    for_soft_bodies : bool
        Whether it is of soft or floating bodies, beside which models of hard rough contacts tell nothing.
    tested : str
        How far the model was tested, as a caveat of its results; empty where comparisons with published tests say it.
    range_note : str
        Why a ratio beyond `ratio_bounds` has no meaning in the model, and advice.
    """

    __slots__ = ()

    name: ClassVar[str]
    citation: ClassVar[str]
    mean_gap: ClassVar[MeanGap] = MeanGap.LOAD_BALANCED
    rate_dependent: ClassVar[bool] = True
    needs_open_gap: ClassVar[bool] = True
    directions: ClassVar[frozenset[str]] = frozenset({"normal"})
    for_soft_bodies: ClassVar[bool] = False
    tested: ClassVar[str] = ""
    range_note: ClassVar[str] = (
        "no contact transmits more than the friction coefficient times its normal force; the parameters of the model"
        " do not hold for this motion"
    )

    def __post_init__(self) -> None:
        """Check every parameter against its range."""
        for each in self.parameters():
            each.require(getattr(self, each.name))

    @classmethod
    def parameters(cls) -> tuple[ModelParameter, ...]:
        """Parameters that rig files and commands can set, in the order of the record's fields.

        Returns
        -------
        tuple of ModelParameter
        """
        found = []
        for each in fields(cls):  # type: ignore[arg-type]
            if "parameter" not in each.metadata:
                continue
            declared, known = each.metadata["parameter"], quantities().get(each.name)
            unit, meaning = declared["unit"], declared["meaning"]
            if known is None and unit is None:
                raise InvalidInput(f"{cls.__name__}.{each.name}: no unit; give one, or add the name to vocabulary.toml")
            found.append(
                ModelParameter(
                    name=each.name,
                    unit=known.unit if unit is None and known else unit or "",
                    meaning=meaning or (known.meaning if known else each.name.replace("_", " ")),
                    default=float(each.default),  # type: ignore[arg-type]
                    lowest=declared["lowest"],
                    positive=declared["positive"],
                )
            )
        return tuple(found)

    def ratio(
        self,
        contact: RoughContact,
        motion: ContactMotion,
        *,
        sliding_speed: ArrayLike,
        friction_coefficient: ArrayLike | None = None,
    ) -> Floats:
        """Mean friction under a motion of the gap over friction without vibration. []

        Parameters
        ----------
        contact : RoughContact
        motion : ContactMotion
            One period of the gap.
        sliding_speed : array_like, any shape
            Mean sliding speed. [m/s]
        friction_coefficient : float, optional
            Coefficient of friction without vibration; models whose limit depends on it need it. []

        Returns
        -------
        ndarray, shape of `sliding_speed`

        Raises
        ------
        InvalidInput
            If a speed is not positive, the motion has no meaning for the model, or a coefficient it needs is missing.
        OutsideRange
            If the model does not hold for the motion.
        """
        v_r = require_positive(sliding_speed=sliding_speed)
        return self._ratios(contact, motion, v_r.ravel(), friction_coefficient).reshape(v_r.shape)

    @abstractmethod
    def _ratios(self, contact: RoughContact, motion: ContactMotion, v_r: Floats, mu: ArrayLike | None) -> Floats:
        """Ratio at positive speeds, shape (n,)."""

    def mechanism(self, contact: RoughContact, motion: ContactMotion) -> str:
        """What the model makes of a motion besides the ratio, in one line with its numbers; empty where nothing.

        Parameters
        ----------
        contact : RoughContact
        motion : ContactMotion

        Returns
        -------
        str
        """
        return ""

    def ratio_bounds(self, *, mean_force_ratio: Floats) -> tuple[Floats, Floats]:
        r"""Lowest and the highest friction ratio that the model can mean. []

        Parameters
        ----------
        mean_force_ratio : ndarray, any shape
            Mean normal force of the motion over the load.

        Returns
        -------
        tuple of ndarray, each broadcastable to the shape of `mean_force_ratio`

        See Also
        --------
        sonolube.models.friction.models.range_check.model_friction : Applies the bounds.

        Notes
        -----
        Coulomb's limit at every instant, :math:`|F(t)| \le \mu F_n(t)`, bounds the mean,

        .. math:: \left|\frac{F_1}{F_0}\right| \le \frac{\langle F_n \rangle}{F_N},

        which is 1 under a dead load. Negative ratios are those of a vibration that drives the slider.
        """
        return -mean_force_ratio, mean_force_ratio

    def batched_ratio(
        self,
        contact: RoughContact,
        motions: GapMotionBatch,
        *,
        sliding_speed: Floats,
        motion: Integers,
        friction_coefficient: float,
        tolerance: float = 1e-7,
    ) -> Floats:
        """Friction ratio of many pairs of motion and speed at once; NaN where `ratio` must be used. []

        Parameters
        ----------
        contact : RoughContact
        motions : GapMotionBatch
            Motions of the gap by their harmonics.
        sliding_speed : ndarray, shape (n,)
            Mean sliding speed of each point, positive. [m/s]
        motion : ndarray of int, shape (n,)
            Row of `motions` at each point.
        friction_coefficient : float
            Coefficient of friction without vibration. []
        tolerance : float
            Largest error of the batched form beside `ratio`, which larger batches may trade for speed. []

        Returns
        -------
        ndarray, shape (n,)
            All NaN unless the model has a batched form.
        """
        return np.full(sliding_speed.shape, np.nan)
