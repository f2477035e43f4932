"""Drivers tried against faults: each call of a device hangs, is late, raises, dies or lies, and the run must end off.

A driver is tried in runs of the program `sonolube lab run`. The device map of such a run names the driver `tried` of
this room, whose device makes the calls to that of the driver, notes them in a log and has the fault. The verdict of the
run is held against the log, or against the instrument that a module pretends.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
