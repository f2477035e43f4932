"""What can go wrong, each with one clear line for the user."""

from collections.abc import Iterable
from difflib import get_close_matches


class SonolubeError(Exception):
    """Anything sonolube refuses or cannot do; its text is one line that names the cause and the remedy."""


class InvalidInput(SonolubeError, ValueError):
    """A value that has no meaning where it was given."""


class OutsideRange(InvalidInput):
    """A meaningful value at which the model asked for does not hold."""


class MissingProperty(SonolubeError, LookupError):
    """A property for which no source is known, and so no value is given."""


class NoGroove(SonolubeError):
    """A scan in which nothing stands out as a wear groove or scar; what was seen instead is in its text."""


class UnknownName(SonolubeError, LookupError):
    """A name that stands in none of the tables."""

    @classmethod
    def among(cls, known: Iterable[str], *, kind: str, name: str) -> "UnknownName":
        """Say which name is unknown and which known one comes closest.

        Parameters
        ----------
        known : iterable of str
            The names that would have been accepted.
        kind : str
            What the name should have named, such as "material".
        name : str
            The name as given.

        Returns
        -------
        UnknownName
        """
        names = sorted(known)
        return cls(f"unknown {kind} {name!r}; {suggestion(name, names) or 'known: ' + ', '.join(names)}")


class ModelRangeWarning(UserWarning):
    """A result stands, but outside the range in which its model was shown to hold."""


class InconsistentCoupling(ModelRangeWarning):
    """A stated coupling factor disagrees with the one that stroke, stiffness and capacitance imply."""


class GpuUnused(UserWarning):
    """A GPU was asked for, but the processor computed; the answers are the same, only later."""


def suggestion(name: str, known: Iterable[str]) -> str:
    """Return "did you mean ...?" where a known name comes close, else an empty text."""
    close = get_close_matches(name.lower(), list(known), n=1, cutoff=0.6)
    return f"did you mean {close[0]}?" if close else ""
