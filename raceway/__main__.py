"""``raceway`` and ``python -m raceway``: Ctrl-C is answered before the commands themselves are loaded, too."""

import sys


def main() -> None:
    """Load the commands and run them."""
    try:
        from raceway.cli import main as commands
    except KeyboardInterrupt:
        sys.stderr.write("stopped by Ctrl-C\n")
        sys.exit(130)
    commands()


if __name__ == "__main__":
    main()
