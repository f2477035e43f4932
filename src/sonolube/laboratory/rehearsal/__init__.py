"""Rehearsal: the devices of a device map on a virtual rig, with its channels, clocks, limits and named faults."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
