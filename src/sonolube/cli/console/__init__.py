"""Shared parts of commands: answers and their delivery, options, progress, ranges and sizes."""
