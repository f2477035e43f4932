"""sonolube: an open workbench for ultrasonic lubrication.

Import the room that is needed, such as `sonolube.contact` or `sonolube.friction`; importing the house itself
loads nothing.
"""

__version__ = "0.1.0"
