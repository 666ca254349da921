"""How the board test ends when it does not pass."""


class Failed(Exception):
    """What went wrong and what to do, in one line."""


class Unavailable(Exception):
    """Why there is no board to test on, in one line."""
