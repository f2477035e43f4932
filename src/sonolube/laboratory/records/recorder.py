"""Recorder of a run: every block is on its way to the disk when `append` returns, every event is a document."""

from collections.abc import Mapping, Sequence
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from sonolube.errors import InvalidInput
from sonolube.files import locked_folder
from sonolube.growing_files import AppendedFile
from sonolube.laboratory.block import Block, Channel
from sonolube.laboratory.records.documents import EXIT_STATUS, DocumentLog, read_documents
from sonolube.laboratory.records.raw_blocks import raw_header, raw_record
from sonolube.laboratory.records.recorded_part import recorded_part
from sonolube.laboratory.records.recording_files import write_netcdf_recording
from sonolube.laboratory.records.run import RunSummary, run_summary
from sonolube.laboratory.records.run_clock import RunClock
from sonolube.laboratory.records.run_folder import (
    PROTOCOL,
    PURPOSE,
    RESERVE,
    TRUTH,
    Facts,
    RunFacts,
    keep_digests,
    make_run_folder,
    raw_parts,
    raw_path,
    recording_path,
)
from sonolube.operating_system import remove_file

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
        self._part = self._blocks = 0
        self._file: AppendedFile | None = None
        self._channels: tuple[Channel, ...] = ()
        self._rate = 0.0
        self._samples = 0
        self._next: int | None = None
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
        if self._file is not None:
            raise InvalidInput("a part of the recording has begun already; end it first")
        now = self._clock.now()
        header = raw_header(channels, sample_rate=sample_rate, begun=now)
        self._part += 1
        file = AppendedFile(raw_path(self.folder, self._part))
        try:
            file.append(header)
            self._log.part(self._part, channels, sample_rate=sample_rate, time=now)
        except InvalidInput as failure:
            self._fail(failure)
            with suppress(InvalidInput):
                file.close()
            raise
        self._file, self._channels, self._rate = file, tuple(channels), sample_rate
        self._blocks, self._samples, self._next = 0, 0, None

    def append(self, block: Block) -> None:
        """Keep a block; it is in the hands of the operating system when this returns.

        Parameters
        ----------
        block : Block
            With samples later than those before; where some are missing between, the gap is noted.

        Raises
        ------
        InvalidInput
            If the disk is full, the shape is wrong, or the sample counter goes back. What was kept before stays.
        """
        if self._file is None:
            raise InvalidInput("no part of the recording has begun; begin it before blocks are appended")
        if block.values.ndim != 2 or block.values.shape[1] != len(self._channels) or not block.samples:
            raise InvalidInput(
                f"block has the shape {block.values.shape}, but {len(self._channels)} channels are recorded"
            )
        if block.first_sample < (self._next or 0):
            raise InvalidInput(f"block begins at sample {block.first_sample}, but {self._next} was expected")
        try:
            if self._next is not None and block.first_sample > self._next:
                self._note("gap", self._next, {"missing": block.first_sample - self._next})
            self._file.append(raw_record(block, sequence=self._blocks))
        except InvalidInput as failure:
            self._fail(failure)
            raise
        self._blocks += 1
        self._samples += block.samples
        self._next = block.next_sample
        self._watch_clock(block.first_sample)

    def end(self) -> None:
        """End the part of the recording; harmless where none has begun.

        Raises
        ------
        InvalidInput
            If the disk is full.
        """
        if self._file is None:
            return
        file, self._file = self._file, None
        try:
            file.close()
            self._describe_part()
        except InvalidInput as failure:
            self._fail(failure)
            raise

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
        try:
            self._note(kind, sample, facts)
        except InvalidInput as failure:
            self._fail(failure)
            raise
        self._watch_clock(sample)

    def store_truth(self, dataset: "xr.Dataset") -> Path:
        """Keep what a virtual rig was made of, apart from what was measured.

        Parameters
        ----------
        dataset : xarray.Dataset

        Returns
        -------
        Path
        """
        from sonolube.rig import write_netcdf

        return write_netcdf(dataset, path=self.folder / TRUTH)

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
            for close in (self.end, self._write_recordings):
                with suppress(InvalidInput):  # the reason is kept, and the run failed
                    close()
            remove_file(self.folder / RESERVE)
            ended = "failed" if self._failure else outcome
            why = "; ".join(dict.fromkeys(filter(None, (reason, self._failure))))
            with suppress(InvalidInput):  # without a last document, a run counts as unfinished and can be recovered
                self._describe_part()
                self._log.stop(ended, reason=why, time=self._clock.now())
                self._log.close()
        self._summary = run_summary(self.folder)
        return self._summary

    def _describe_part(self) -> None:
        """Write how many samples the latest part has, unless that is written."""
        earlier = read_documents(self.folder)
        self._log.end_part(earlier, self._part, samples=self._samples, sample_rate=self._rate)

    def _write_recordings(self) -> None:
        """Write all parts as netCDF."""
        documents = read_documents(self.folder)
        try:
            for number in raw_parts(self.folder):
                part = recorded_part(self.folder, number, documents, facts=self._known.facts)
                if part.raw.samples:
                    write_netcdf_recording(part, self._known, recording_path(self.folder, number))
            self._known = keep_digests(self.folder, self._known, raw_parts(self.folder))
        except InvalidInput as failure:
            self._fail(failure)
            raise

    def _note(self, kind: str, sample: int | None, facts: Mapping[str, str | float]) -> None:
        """Write an event."""
        self._log.note(kind, time=self._clock.now(), sample=sample, facts=facts)

    def _watch_clock(self, sample: int | None) -> None:
        """Note where the clock of the computer was set."""
        jump = self._clock.jump()
        if jump:
            with suppress(InvalidInput):  # the next block tells it
                self._note("clock jump", sample, {"seconds": jump})

    def _fail(self, failure: InvalidInput) -> None:
        """Remember why the record is not whole."""
        self._failure = self._failure or str(failure)

    def _require_running(self) -> None:
        """Refuse what comes after the end."""
        if self._summary is not None:
            raise InvalidInput(f"{self.folder}: the run has ended; begin another with new_run")
