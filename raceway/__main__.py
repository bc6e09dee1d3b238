"""``raceway`` and ``python -m raceway``: a signal is answered before the commands are loaded and after they ended, too."""

import sys

from raceway.cli.interrupt import Interrupts, end, farewell, prepare


def main() -> None:
    """Load the commands, run them, end."""
    Interrupts().__enter__()
    prepare()
    code = 1
    try:
        from raceway.cli.main import main as commands

        commands()
    except SystemExit as ended:
        code = ended.code if isinstance(ended.code, int) else 0
    except KeyboardInterrupt:
        code = farewell(lambda text: sys.stderr.write(f"{text}\n"))
    end(code)


if __name__ == "__main__":
    main()
