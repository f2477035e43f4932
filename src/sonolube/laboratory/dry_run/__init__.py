"""Dry run of a protocol: its course, duration and amount of data, and the limits of drive and heat."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
