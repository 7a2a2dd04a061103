"""What the exit code of a command says."""

from __future__ import annotations

from typing import Final


class ExitCode:
    """Exit codes of every command."""

    DONE: Final = 0
    """Done: the run has a result, be it a failure (`no-strategy`, refused plans); also when the time limit or the
    operator ended it."""
    FAILED: Final = 1
    """A well-specified run could not begin or continue, as a task that nobody recorded answers for or a full disk; one
    line says why. Also a check whose answer is no: `coral reef sail --check`, `coral advisor probe`."""
    BAD_INPUT: Final = 2
    """Bad usage or input, or a model that cannot be used: one line names the file or flag, the field, what was found
    and what was expected."""
    INTERRUPTED: Final = 130
    """Ctrl-C when no run was active."""
    SIGNALLED: Final = 128
    """Plus the number of the signal that ended the command: 143 for SIGTERM, 129 for SIGHUP. The run first ends in
    order, with its metrics and its report."""
