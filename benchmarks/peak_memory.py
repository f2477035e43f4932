"""Peak memory of this process alone."""

import re
import resource
from pathlib import Path


def peak_memory() -> int:
    """Return the largest resident memory of this process in bytes.

    On Linux by VmHWM of the kernel: `ru_maxrss` survives `exec`, and so charges a process with the peak of the one that
    started it.
    """
    status = Path("/proc/self/status")
    if status.is_file() and (found := re.search(r"VmHWM:\s+(\d+) kB", status.read_text(encoding="ascii"))):
        return 1024 * int(found[1])
    return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
