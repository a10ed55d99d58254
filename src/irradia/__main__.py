"""``python -m irradia`` is the command ``irradia``."""

from irradia.cli import main

if __name__ == "__main__":
    main()
