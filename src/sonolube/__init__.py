"""sonolube: an open workbench for ultrasonic lubrication.

`import sonolube as sl` offers the main tasks by name, each loaded when it is first used: a rig from a file
(`sl.read_rig`), the effect of vibration on it (`sl.predict`, `sl.simulate`, `sl.sweep`, `sl.map`), instrument files
(`sl.measure`), the dissertation's data (`sl.published`), and the figure of each result (`sl.plot`). The rooms, such as
`sonolube.models.contact` or `sonolube.models.friction`, hold the models themselves.
"""

import lazy_loader as _lazy_loader

__version__ = "0.1.0"

__getattr__, __dir__, __all__ = _lazy_loader.attach_stub(__name__, __file__)
