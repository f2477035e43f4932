"""Recorder of a run: every block is on its way to the disk when `append` returns, every event is a document."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from sonolube.errors import InvalidInput
from sonolube.laboratory.block import Block, Channel
from sonolube.laboratory.records.documents import EXIT_STATUS, DocumentLog, read_documents
from sonolube.laboratory.records.raw_blocks import PartClock, RawPart, raw_header, scan_raw
from sonolube.laboratory.records.recording_files import record_attributes
from sonolube.laboratory.records.recovery import OpenPart, RunClock, write_missing
from sonolube.laboratory.records.run import RunSummary, run_summary
from sonolube.laboratory.records.run_folder import (
    CLOCK_NAME,
    PROTOCOL,
    PURPOSE,
    RESERVE,
    TRUTH,
    Facts,
    RunFacts,
    make_run_folder,
    raw_parts,
    raw_path,
)
from sonolube.operating_system import remove_file
from sonolube.storage.files import locked_folder

if TYPE_CHECKING:
    import xarray as xr


def new_run(
    parent: Path, *, title: str, protocol: str, files: Mapping[str, str] | None = None, facts: Facts | None = None
) -> "RunRecorder":
    """Begin the record of a run in a folder of its own.

    Parameters
    ----------
    parent : Path
        Folder of all runs; made where it is missing.
    title : str
    protocol : str
        TOML text.
    files : mapping of str to str, optional
        Further texts to keep, by name, such as those of rig.toml and devices.toml.
    facts : mapping of str to str, float, int or bool, optional
        What is known of the run, quantities in SI under their names. The fact `tags` has words between commas, by which
        the catalogue finds runs.

    Returns
    -------
    RunRecorder
        Which keeps others out until it is finished.

    Raises
    ------
    InvalidInput
        If a name or fact is not plain, or the folder cannot be written.
    """
    known = dict(facts or {})
    with ExitStack() as locks:
        clock = RunClock()
        texts = {PROTOCOL: protocol, **(files or {})}
        folder, begun = make_run_folder(parent, title=title, begun=clock.begun, texts=texts, facts=known, referenced={})
        locks.enter_context(locked_folder(folder, purpose=PURPOSE))
        return RunRecorder(folder, begun, clock, locks.pop_all())


class RunRecorder:
    """Record of a run that is at work; made by `new_run`.

    Parameters
    ----------
    folder : Path
    known : RunFacts
    clock : RunClock
    locks : ExitStack
        Released at the end.
    """

    def __init__(self, folder: Path, known: RunFacts, clock: RunClock, locks: ExitStack) -> None:
        self.folder = folder
        self._known, self._clock, self._locks = known, clock, locks
        self._log = DocumentLog(folder)
        self._log.start(known)
        self._parts: list[OpenPart] = []  # also those that were ended
        self._open: dict[str, OpenPart] = {}  # by the names of their clocks, empty for that of the run
        self._failure = ""
        self._summary: RunSummary | None = None

    def begin(self, channels: Sequence[Channel], *, sample_rate: float) -> None:
        """Begin a part of the recording; samples of all its channels follow one another.

        Parameters
        ----------
        channels : sequence of Channel
        sample_rate : float
            [Hz]

        Raises
        ------
        InvalidInput
            If a part is being recorded, the channels are no channels, or the disk is full.
        """
        self._require_running()
        if "" in self._open:
            raise InvalidInput("a part of the recording has begun already; end it first")
        self._begin(RawPart(channels=tuple(channels), sample_rate=sample_rate, begun=self._clock.now()))

    def begin_beside(
        self,
        clock: str,
        channels: Sequence[Channel],
        *,
        sample_rate: float,
        first: int,
        ago: float,
        uncertainty: float,
        offset: float | None = None,
    ) -> None:
        """Begin a part whose samples another clock times, beside the one that is being recorded.

        Parameters
        ----------
        clock : str
            Name of its acquisition.
        channels : sequence of Channel
        sample_rate : float
            [Hz]
        first : int
            Its first sample, by its own counter.
        ago : float
            Time since that sample, in s.
        uncertainty : float
            Of that time, in s.
        offset : float, optional
            Of that sample from the first of the part of the run, where virtual devices tell it in place of `ago`, in s.

        Raises
        ------
        InvalidInput
            As `begin`; if no part is being recorded beside it, or the name of the clock is no plain one.
        """
        self._require_running()
        main = self._open.get("")
        if main is None or clock in self._open or not CLOCK_NAME.fullmatch(clock):
            raise InvalidInput(f"a part of the clock {clock!r} needs one of the run, and no other of its own")
        begun = self._clock.now() - ago if offset is None else main.part.begun + offset
        offset = begun - main.part.begun
        told = PartClock(name=clock, part=main.number, offset=offset, uncertainty=uncertainty, first_sample=first)
        self._begin(RawPart(channels=tuple(channels), sample_rate=sample_rate, begun=begun, clock=told))

    def append(self, block: Block, *, clock: str = "") -> None:
        """Keep a block; it is in the hands of the operating system when this returns.

        Parameters
        ----------
        block : Block
            With samples later than those before; where some are missing between, the gap is noted.
        clock : str
            Name of its clock; empty for that of the run.

        Raises
        ------
        InvalidInput
            If the disk is full, the shape is wrong, or the sample counter goes back. What was kept before stays.
        """
        part = self._open.get(clock)
        if part is None:
            raise InvalidInput("no part of the recording has begun; begin it before blocks are appended")
        part.require_fitting(block)
        told = {"clock": clock} if clock else {}
        with self._failing():
            part.append(block, lambda first, facts: self._note("gap", first, {**facts, **told}))
        if not clock:
            self._watch_clock(block.first_sample)

    def end(self, *, clock: str = "") -> None:
        """End the part of the recording; harmless where none has begun.

        Parameters
        ----------
        clock : str
            Name of its clock; empty for that of the run.

        Raises
        ------
        InvalidInput
            If the disk is full.
        """
        part = self._open.pop(clock, None)
        if part is not None:
            with self._failing():
                part.close()
                part.describe(read_documents(self.folder))

    def note(self, kind: str, *, sample: int | None = None, **facts: str | float) -> None:
        """Keep what happened: set points, states, prompts, trips.

        Parameters
        ----------
        kind : str
        sample : int, optional
            By the counter of the acquisition.
        **facts : str or float

        Raises
        ------
        InvalidInput
            If the disk is full.
        """
        self._require_running()
        with self._failing():
            self._note(kind, sample, facts)
        self._watch_clock(sample)

    def store_truth(self, dataset: "xr.Dataset") -> Path:
        """Write the truth of a virtual rig, apart from the measured record.

        Parameters
        ----------
        dataset : xarray.Dataset

        Returns
        -------
        Path
        """
        from sonolube.rig import write_netcdf

        told = dataset.assign_attrs({**record_attributes(self._known, identifier=self._log.run), **dataset.attrs})
        for name, variable in told.variables.items():
            variable.attrs.setdefault("long_name", str(name).replace("_", " "))
        return write_netcdf(told, path=self.folder / TRUTH)

    def finish(self, outcome: str, *, reason: str = "") -> RunSummary:
        """Close the record: write the recording, then how the run ended, and let others in.

        Parameters
        ----------
        outcome : str
            completed, stopped or failed; a completed run whose record could not be written is failed.
        reason : str
            Why it ended before its protocol.

        Returns
        -------
        RunSummary
            The same at every further call.

        Raises
        ------
        InvalidInput
            If the outcome is none of these.
        """
        if self._summary is not None:
            return self._summary
        if outcome not in EXIT_STATUS:
            raise InvalidInput(f"outcome must be one of {', '.join(EXIT_STATUS)}, got {outcome!r}")
        with self._locks:
            ends = [
                partial(self.end, clock=clock) for clock in sorted(self._open, key="".__eq__)
            ]  # that of the run last
            closing: list[Callable[[], object]] = [*ends, self._write_recordings]
            for close in closing:
                with suppress(InvalidInput):  # the reason is kept, and the run failed
                    close()
            remove_file(self.folder / RESERVE)
            ended = "failed" if self._failure else outcome
            why = "; ".join(dict.fromkeys(filter(None, (reason, self._failure))))
            with suppress(InvalidInput):  # without a last document, a run counts as unfinished and can be recovered
                for part in self._parts:
                    part.describe(read_documents(self.folder))
                self._log.stop(ended, reason=why, time=self._clock.now())
                self._log.close()
        self._summary = run_summary(self.folder)
        return self._summary

    def _begin(self, part: RawPart) -> None:
        """Begin a part."""
        raw_header(part)  # refuses what is no part, which is no failure
        with self._failing():
            self._parts.append(OpenPart(self.folder, len(self._parts) + 1, part, self._log))
        self._open[part.clock_name] = self._parts[-1]

    def _write_recordings(self) -> None:
        """Write all parts as netCDF."""
        with self._failing():
            parts = ((number, scan_raw(raw_path(self.folder, number))) for number in raw_parts(self.folder))
            write_missing(self.folder, self._known, parts)

    def _note(self, kind: str, sample: int | None, facts: Mapping[str, str | float]) -> None:
        """Write an event."""
        self._log.note(kind, time=self._clock.now(), sample=sample, facts=facts)

    def _watch_clock(self, sample: int | None) -> None:
        """Note where the clock of the computer was set."""
        jump = self._clock.jump()
        if jump:
            with suppress(InvalidInput):  # the next block tells it
                self._note("clock jump", sample, {"seconds": jump})

    @contextmanager
    def _failing(self) -> Iterator[None]:
        """Remember why the record is not whole where that is raised inside a `with` block."""
        try:
            yield
        except InvalidInput as failure:
            self._failure = self._failure or str(failure)
            raise

    def _require_running(self) -> None:
        """Refuse blocks and notes after the end."""
        if self._summary is not None:
            raise InvalidInput(f"{self.folder}: the run has ended; begin another with new_run")
