"""Summaries of a propagated uncertainty: band over swept keys, ranking of entries by Sobol indices, contact loss."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube.checks import Floats
from sonolube.design.sobol import SobolIndices, sobol_indices
from sonolube.design.statistics import IntervalEstimate

if TYPE_CHECKING:
    import xarray as xr

BAND = (0.05, 0.5, 0.95)
"""Probabilities of the quantiles that bound and halve a band."""

_SHARES = ("first_order", "total_order", "first_order_interval", "total_order_interval")
_MIN_SHARE = 0.005  # of the variance, which is printed as 0 %


@dataclass(frozen=True, kw_only=True, slots=True)
class BandPlace:
    """Median and 90 % interval of an outcome at one place of a swept band.

    Parameters
    ----------
    at : dict of str to float or str
        Value of each swept key, SI.
    median, lower, upper : float
        Quantiles of the outcome at 50, 5 and 95 %, SI.
    """

    at: dict[str, Any]
    median: float
    lower: float
    upper: float


@dataclass(frozen=True, kw_only=True, slots=True)
class Band:
    """Width of the 90 % interval of an outcome over swept keys.

    Parameters
    ----------
    mean_width : float or None
        Mean width, SI; None where no sample has a result.
    narrowest, widest : BandPlace or None
    """

    mean_width: float | None
    narrowest: BandPlace | None
    widest: BandPlace | None


@dataclass(frozen=True, kw_only=True, slots=True)
class RankedEntry:
    """Contribution of one uncertain entry to the variance of an outcome.

    Parameters
    ----------
    key : str
        Of the rig file.
    first, total : IntervalEstimate
        First-order and total Sobol index with their 95 % intervals.
    deviation_if_known : float
        Standard deviation of the outcome that would remain were the entry known, SI.
    matters : bool
        Whether the outcome depends on the entry beyond doubt: the interval of the total index is above zero.
    """

    key: str
    first: IntervalEstimate
    total: IntervalEstimate
    deviation_if_known: float
    matters: bool


def outcome_indices(propagated: "xr.Dataset") -> SobolIndices:
    """Sobol indices of the outcome of a propagation that was made for them.

    Estimates and intervals cut off at 0 and 1, between which all indices lie.
    """
    found = sobol_indices(propagated[propagated.attrs["outcome"]].values, seed=propagated.attrs["seed"])
    return replace(found, **{name: np.clip(getattr(found, name), 0.0, 1.0) for name in _SHARES})


def ranked_entries(propagated: "xr.Dataset") -> list[RankedEntry]:
    r"""Uncertain entries by falling first-order Sobol index, then by falling total index.

    With the standard deviation :math:`\sigma` of the outcome and the first-order index :math:`S_i` of an entry, the
    deviation that remains were the entry known is :math:`\sigma \sqrt{1 - S_i}`.
    """
    indices = outcome_indices(propagated)
    rows = [
        RankedEntry(
            key=key,
            first=IntervalEstimate(value=first, lower=first_ends[0], upper=first_ends[1]),
            total=IntervalEstimate(value=total, lower=total_ends[0], upper=total_ends[1]),
            deviation_if_known=indices.standard_deviation * float(np.sqrt(1 - first)),
            matters=total_ends[0] > _MIN_SHARE,
        )
        for key, first, first_ends, total, total_ends in zip(
            propagated.attrs["uncertain"],
            indices.first_order.tolist(),
            indices.first_order_interval.tolist(),
            indices.total_order.tolist(),
            indices.total_order_interval.tolist(),
            strict=True,
        )
    ]
    return sorted(rows, key=lambda row: (-row.first.value, -row.total.value))


def contact_loss_probability(propagated: "xr.Dataset") -> float | None:
    """Fraction of the points with a vibration that lose contact for part of the time. []

    None where contact loss was not computed.
    """
    if "contact_loss_fraction" not in propagated:
        return None
    lost = propagated["contact_loss_fraction"].values
    known = np.isfinite(lost)
    return float(np.mean(lost[known] > 0)) if known.any() else None


def outcome_quantiles(propagated: "xr.Dataset", probabilities: Sequence[float]) -> Floats:
    """Quantiles of an outcome over the samples.

    One row per probability; NaN where no sample has a result.
    """
    samples = propagated[propagated.attrs["outcome"]].values
    valid = np.isfinite(samples).any(axis=0)
    quantiles = np.full((len(probabilities), *samples.shape[1:]), np.nan)
    quantiles[:, valid] = np.nanquantile(samples[:, valid], probabilities, axis=0)
    return quantiles


def outcome_band(propagated: "xr.Dataset") -> Band:
    """Median and 90 % interval of an outcome where the interval is narrowest and widest, and its mean width."""
    outcome = propagated[propagated.attrs["outcome"]]
    low, median, high = outcome_quantiles(propagated, BAND)
    if np.isnan(median).all():
        return Band(mean_width=None, narrowest=None, widest=None)
    width = high - low

    def place(flat: int) -> BandPlace:
        index = np.unravel_index(flat, width.shape)
        at = {
            str(propagated[name].attrs["key"]): propagated[name].values[own].item()
            for name, own in zip(outcome.dims[1:], index, strict=True)
        }
        return BandPlace(at=at, median=float(median[index]), lower=float(low[index]), upper=float(high[index]))

    return Band(
        mean_width=float(np.nanmean(width)),
        narrowest=place(int(np.nanargmin(width))),
        widest=place(int(np.nanargmax(width))),
    )
