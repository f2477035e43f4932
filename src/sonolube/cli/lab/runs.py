"""Command `lab runs`: recorded runs by material, load, speed, date, tag and text."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from sonolube.cli.console.answer import Answer, deliver, grid
from sonolube.cli.console.options import Json
from sonolube.errors import InvalidInput
from sonolube.laboratory.catalogue import CatalogueEntry, FoundRuns, query_from, query_runs, take_in
from sonolube.units import format_si

Texts = list[str] | None


def runs(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of runs.")] = Path("runs"),
    material: Annotated[Texts, typer.Option(metavar="NAME", help="Of pin or disc; may come again.")] = None,
    load: Annotated[str | None, typer.Option(metavar="FORCE", help="Normal load: 5N, 3N..6N, or 3N.. and up.")] = None,
    speed: Annotated[str | None, typer.Option(metavar="SPEED", help="Sliding speed, such as 10mm/s..30mm/s.")] = None,
    since: Annotated[str | None, typer.Option(metavar="DATE", help="Begun then or later, such as 2026-01-31.")] = None,
    until: Annotated[str | None, typer.Option(metavar="DATE", help="Begun before.")] = None,
    tag: Annotated[Texts, typer.Option(metavar="TAG", help="Among the tags of the run; may come again.")] = None,
    text: Annotated[Texts, typer.Option(metavar="TEXT", help="In title, facts, protocol or notes.")] = None,
    outcome: Annotated[
        str | None, typer.Option(metavar="OUTCOME", help="completed, stopped, failed, interrupted or running.")
    ] = None,
    add: Annotated[
        list[Path] | None, typer.Option(metavar="PATH", help="Take in a recording or a folder of them.")
    ] = None,
    fact: Annotated[
        Texts, typer.Option(metavar="NAME=VALUE", help="Of what is taken in, such as normal_load=5; tags=map,old.")
    ] = None,
    json: Json = False,
) -> None:
    """Runs that were recorded, with what they are found by.

    Example: sonolube lab runs runs --material brass --load 3N..6N --since 2026-01-01
    """
    if fact and not add:
        raise InvalidInput("--fact has no meaning without --add, whose recordings it describes")
    for source in add or ():
        take_in(folder, source, facts=_facts(fact or ()))
    one = {"load": load, "speed": speed, "since": since, "until": until, "outcome": outcome}
    several = {"material": material, "tag": tag, "text": text}
    given = {key: [value] for key, value in one.items() if value is not None}
    given |= {key: list(values) for key, values in several.items() if values}
    deliver(RunsFound(folder=folder, found=query_runs(folder, query_from(given))), as_json=json)


@dataclass(frozen=True, kw_only=True)
class RunsFound(Answer):
    """Runs that were found, a row each."""

    folder: Path
    found: FoundRuns

    def lines(self) -> list[str]:
        """Table of the runs."""
        entries = self.found.entries
        head = f"{len(entries)} of {self.found.of} runs in {self.folder}"
        return [head, *(grid([_HEADS, *map(_row, entries)]) if entries else [])]

    def object(self) -> dict[str, Any]:
        """Runs with all that is known of them, in SI."""
        return {"runs": [_object(entry) for entry in self.found.entries], "of": self.found.of}

    def caveats(self) -> Sequence[str]:
        """Runs that cannot be read, and what was done to the index."""
        return self.found.caveats


_HEADS = ("run", "outcome", "recorded", "pin", "disc", "load", "speed", "tags")


def _row(entry: CatalogueEntry) -> list[str]:
    """Row of a run."""
    summary = entry.summary
    load, speed = entry.normal_load, entry.sliding_speed
    return [
        summary.folder.name,
        summary.outcome,
        format_si(summary.duration, "s") if summary.samples else "-",
        entry.pin_material or "-",
        entry.disc_material or "-",
        "-" if load is None else format_si(load, "N"),
        "-" if speed is None else format_si(speed, "m/s"),
        ", ".join(entry.tags) or "-",
    ]


def _object(entry: CatalogueEntry) -> dict[str, Any]:
    """Run for JSON."""
    content = asdict(entry)
    summary: dict[str, Any] = content.pop("summary")
    content.pop("text")
    return summary | {"folder": str(entry.summary.folder), "begun": entry.summary.begun_text} | content


def _facts(texts: Sequence[str]) -> dict[str, str | float]:
    """Facts by their texts; numbers in SI as numbers."""
    found: dict[str, str | float] = {}
    for text in texts:
        name, sign, value = text.partition("=")
        if not (sign and name.strip().isidentifier()):
            raise InvalidInput(f"--fact {text} must be NAME=VALUE, such as normal_load=5")
        try:
            found[name.strip()] = float(value)
        except ValueError:
            found[name.strip()] = value.strip()
    return found
