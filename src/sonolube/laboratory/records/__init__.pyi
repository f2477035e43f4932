from .documents import RecordedChannel as RecordedChannel
from .observation import Observation as Observation, RunObserver as RunObserver, run_to_watch as run_to_watch
from .raw_blocks import (
    RawPart as RawPart,
    latest_samples as latest_samples,
    read_raw_blocks as read_raw_blocks,
    scan_raw as scan_raw,
)
from .recorded_part import drop_raw_blocks as drop_raw_blocks
from .recorder import RunRecorder as RunRecorder, new_run as new_run
from .recording_files import EXPORT_FORMATS as EXPORT_FORMATS, export_run as export_run
from .recovery import Recovery as Recovery, recover_run as recover_run
from .run import (
    Note as Note,
    Run as Run,
    RunSummary as RunSummary,
    last_verdict as last_verdict,
    read_run as read_run,
    run_folders as run_folders,
    run_summary as run_summary,
)
from .run_folder import UNRESOLVED as UNRESOLVED
