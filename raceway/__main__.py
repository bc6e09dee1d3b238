"""``python -m raceway``."""

from raceway.cli import main

if __name__ == "__main__":
    main()
