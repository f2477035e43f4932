"""Closed loop: friction held at a reference on devices by the controller that `sonolube control` designs."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
