"""A NumPy function of the user's own as a cost; its exceptions and wrong shapes become errors that name the line."""

from __future__ import annotations

import inspect
import traceback
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from coral.contact.cost.context import Context, Terms
from coral.contact.cost_program.errors import CostError, is_term_name

Function = Callable[[Context], Any]


class NumpyCost:
    """A function of batched states. It satisfies `coral.contact.cost.context.Cost`.

    The function takes a `Context`, whose quantities have Shape=(K, H) or (K, H, n), and returns the cost of every
    state: one array that broadcasts to Shape=(K, H), or a mapping of named terms, which are added up.
    """

    def __init__(self, function: Function, name: str = "") -> None:
        self._function = function
        self.name = name or getattr(function, "__name__", type(function).__name__)

    def __call__(self, state: Context) -> Terms:
        """Compute the terms of every state.

        Raises:
            CostError: The function raised an exception, or did not return one number per state.
        """
        try:
            returned = self._function(state)
        except CostError:
            raise
        except Exception as error:
            raise self._raised(error) from error
        terms = returned if isinstance(returned, Mapping) else {"cost": returned}
        return {name: self._term(name, value, state.shape) for name, value in terms.items()}

    def _term(self, name: Any, value: Any, shape: tuple[int, int]) -> Any:
        if not is_term_name(name):
            raise CostError("wrong_return", f"{self.name}: {name!r} is no name of a term")
        term = np.asarray(value)
        if term.dtype.kind not in "biuf":
            raise CostError("wrong_return", f"{self.name}: the term {name!r} is {type(value).__name__}, not a number")
        term = term.astype(np.float64)
        if term.ndim == 0:
            return term.reshape(1, 1)
        if term.ndim != 2 or any(n not in (1, m) for n, m in zip(term.shape, shape, strict=True)):
            found = f"has shape {term.shape} for a batch of {shape}; it must be one number per state"
            raise CostError("shape", f"{self.name}: the term {name!r} {found}")
        return term

    def _raised(self, error: Exception) -> CostError:
        """Describe an exception, with the line of the function's file that raised it."""
        try:
            file = inspect.getsourcefile(self._function)
        except TypeError:
            file = None
        frames = [frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename == file]
        line, shown = (frames[-1].lineno or 0, frames[-1].line or "") if frames else (0, "")
        missing = isinstance(error, AttributeError | KeyError)
        what = f"the state has no quantity {str(error)!r}" if missing else f"{type(error).__name__}: {error}"
        return CostError("raised", f"{self.name}: {what}", line, shown)
