"""Choice among the channels of a file by group, label and length."""

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from sonolube.errors import InvalidInput, suggestion
from sonolube.measurement.recordings.mapping import Selection

TIME_LABELS = frozenset({"time", "t", "x_value", "timestamp", "elapsed_time"})
"""Names of columns that hold the time of a recording."""

_UNIT_OF_LABEL = re.compile(r"(?:\[([^\[\]]*)\]|\(([^()]*)\))(?: #\d+)?\Z")
_MAX_LISTED = 16


@dataclass(frozen=True, slots=True)
class ChannelEntry:
    """One channel of a file before its values are read.

    Parameters
    ----------
    label : str
        Unique in the file.
    group : str
        Group that holds it; empty where the file has no groups.
    samples : int
        Number of its values.
    """

    label: str
    group: str
    samples: int

    @property
    def name(self) -> str:
        """Label without the group."""
        inside = self.group and self.label.startswith(self.group) and len(self.label) > len(self.group) + 1
        return self.label[len(self.group) + 1 :] if inside else self.label


def name_and_unit(label: str) -> tuple[str, str | None]:
    """Name of a channel from the label of its column, and the unit in brackets behind it."""
    text, unit = label.strip(), None
    if match := _UNIT_OF_LABEL.search(text):
        text, unit = text[: match.start()], match[1] if match[1] is not None else match[2]
    return re.sub(r"\W+", "_", text.strip().lower()).strip("_") or "channel", unit


def chosen_channels(entries: Sequence[ChannelEntry], selection: Selection, path: Path) -> list[tuple[int, str]]:
    """Channels that a selection chooses, with their labels among themselves.

    Index among the entries, and label: that of the entry, or its name where that is unique among the chosen ones.
    Columns of the time are kept where they have the length of the chosen channels and their group.
    """
    if not (selection.group or selection.channels):
        return [(index, entry.label) for index, entry in enumerate(entries)]
    indices = _of_group(entries, selection.group, path) if selection.group else list(range(len(entries)))
    if selection.channels:
        named = [_index_of(entries, indices, name, path) for name in dict.fromkeys(selection.channels)]
        bases = {(entries[index].group, entries[index].samples) for index in named}
        along = [index for index in indices if (entries[index].group, entries[index].samples) in bases]
        times = [index for index in along if name_and_unit(entries[index].name)[0] in TIME_LABELS]
        indices = sorted({*times, *named})
    names = [entries[index].name for index in indices]
    counts = Counter(names)
    return [
        (index, entries[index].label if counts[name] > 1 else name) for index, name in zip(indices, names, strict=True)
    ]


def require_common_length(entries: Sequence[ChannelEntry], path: Path) -> int:
    """Number of samples that all channels have; refuse channels of different lengths, listing them."""
    if len({entry.samples for entry in entries}) > 1:
        raise InvalidInput(
            f"{path}: channels have different numbers of samples ({listed_channels(entries)});"
            " choose with --group or --channel, or with a mapping"
        )
    return entries[0].samples if entries else 0


def listed_channels(entries: Sequence[ChannelEntry]) -> str:
    """Channels with their numbers of samples by group, for a message of one line."""
    groups: dict[str, list[str]] = {}
    first_of_each = {(entry.group, entry.samples): entry for entry in reversed(entries)}
    listed = entries if len(entries) <= _MAX_LISTED else list(reversed(first_of_each.values()))[:_MAX_LISTED]
    for entry in listed:
        groups.setdefault(entry.group, []).append(f"{entry.name} {entry.samples}")
    named = len(groups) > 1
    text = "; ".join((f"{group}: " if named else "") + ", ".join(names) for group, names in groups.items())
    more = len(entries) - len(listed)
    return " ".join(text.split()) + (f" and {more} more" if more > 0 else "")


def _of_group(entries: Sequence[ChannelEntry], group: str, path: Path) -> list[int]:
    """Indices of the channels in a group; refuse an unknown one, listing all."""
    found = [index for index, entry in enumerate(entries) if entry.group == group]
    if not found:
        paths = (entry.group or re.sub(r"(?:^|[/.])[^/.]*$", "", entry.label) for entry in entries)
        groups = [known for known in dict.fromkeys(paths) if known]
        if not groups:
            raise InvalidInput(f"{path}: has no groups of channels, so that none is {group!r}")
        hint = suggestion(group, groups) or "it has " + ", ".join(groups[:_MAX_LISTED])
        raise InvalidInput(f"{path}: has no group {group!r}; {hint}")
    return found


def _index_of(entries: Sequence[ChannelEntry], indices: Sequence[int], name: str, path: Path) -> int:
    """Index of the channel of a name, by label first; refuse an unknown or ambiguous one."""
    found = [index for index in indices if entries[index].label == name] or [
        index for index in indices if name in (entries[index].name, f"{entries[index].group}/{entries[index].name}")
    ]
    if len(found) == 1:
        return found[0]
    among = [entries[index] for index in indices]
    if found:
        groups = " and ".join(entries[index].group or "the file" for index in found[:_MAX_LISTED])
        raise InvalidInput(f"{path}: {name!r} is in {groups}; choose one with --group")
    hint = suggestion(name, [entry.name for entry in among]) or "it has " + listed_channels(among)
    raise InvalidInput(f"{path}: has no channel {name!r}; {hint}")
