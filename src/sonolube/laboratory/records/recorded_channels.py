"""Channels of a run with their quantities, units and clocks."""

from dataclasses import dataclass

from sonolube.laboratory.block import CHANNEL_QUANTITIES
from sonolube.laboratory.records.documents import ReadDocuments, part_clocks, part_name


@dataclass(frozen=True, kw_only=True, slots=True)
class RecordedChannel:
    """Channel of a run.

    Parameters
    ----------
    name : str
        As protocols call it.
    quantity : str
        Of the vocabulary, or a free one.
    unit : str
        Of SI; empty for pure numbers.
    clock : str
        Name of its clock; empty for that of the run.
    """

    name: str
    quantity: str
    unit: str
    clock: str

    @property
    def described(self) -> str:
        """Name, with quantity, unit and clock where the name does not tell them."""
        told = [] if CHANNEL_QUANTITIES.get(self.name) == self.quantity else [self.quantity, self.unit or "1"]
        told += [f"clock {self.clock}"] if self.clock else []
        return f"{self.name} ({', '.join(told)})" if told else self.name


def recorded_channels(documents: ReadDocuments) -> dict[str, RecordedChannel]:
    """Channels of all parts of a recording by name, as they were begun.

    Parameters
    ----------
    documents : ReadDocuments
        Of the run.

    Returns
    -------
    dict of str to RecordedChannel
    """
    clocks = {part_name(part): clock for part, clock in part_clocks(documents).items()}
    found: dict[str, RecordedChannel] = {}
    for each in documents.of("descriptor"):
        stream = str(each.get("name"))
        for name, key in each["data_keys"].items() if stream.startswith(part_name(0)[:-1]) else ():
            told = key if isinstance(key, dict) else {}
            found[str(name)] = RecordedChannel(
                name=str(name),
                quantity=str(told.get("source", name)),
                unit=str(told.get("units") or ""),
                clock=clocks.get(stream, ""),
            )
    return found
