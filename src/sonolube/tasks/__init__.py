"""Tasks: what sonolube does for its users, each one function that returns one `Answer`, on every way in."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
