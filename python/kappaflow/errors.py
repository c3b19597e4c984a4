"""The errors of kappaflow, in the words of its command line: one line that says what was found and what is allowed."""


class Error(Exception):
    """Base of all of them. `exit_code` is that of the command line."""

    exit_code = 1


class InvalidInput(Error, ValueError):
    """What was given is wrong: a scene (with file, line and column), an array, an option."""

    exit_code = 2


class SolverFailure(Error, ArithmeticError):
    """The simulation cannot go on: not finite, exploding, not converging. Names time, step and particle."""

    exit_code = 3


class TopologyError(Error, RuntimeError):
    """A mesh is not what an operation needs: not closed, not manifold. Names a place."""

    exit_code = 4


class IoError(Error, OSError):
    """A file cannot be read or written."""

    exit_code = 5
