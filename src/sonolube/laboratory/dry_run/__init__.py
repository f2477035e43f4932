"""Dry run of a protocol: what it will do, how long, how much it records, and what drive and heat stand against it."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
