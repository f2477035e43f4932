"""Friction signals: windows, running-in, voltage steps, reduction, work loops, stick-slip, wobble and rotation."""
