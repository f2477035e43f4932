"""Switch-off process: it alone has motor, drive and guard of a run, and outlives the run's program.

The program of the run has proxies of these devices, which send its calls over. Each side beats for the other. Where the
program dies or falls silent, the process switches off and has the last word. Where a call to an output does not return,
the process begins anew without that call, connects and switches off. Where it dies, the program starts another.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
