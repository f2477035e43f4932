"""The command `sonolube` where its script is not on the path: ``python -m sonolube``."""

from sonolube.cli import main

if __name__ == "__main__":
    main()
