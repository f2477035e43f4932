"""Studies of reliability: many seeded trials of what files, people and chance do to the program.

`make reliability` runs every study in full, two trials at a time, resumes where it was stopped, and writes
docs/reliability.md; `make test-all` runs the first few trials of each (tests/test_reliability.py).
"""
