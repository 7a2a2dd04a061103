"""All success conditions that a task file may name, and the order of events among them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal, Union

from pydantic import Field, SerializeAsAny, ValidatorFunctionWrapHandler, WrapValidator

from coral.contact.scene import history_conditions, relative_conditions, state_conditions
from coral.contact.scene.condition import BaseCondition, Monitor, TaskLike, TrialLike
from coral.contact.scene.observation import Truth
from coral.plugins import find_plugins, load_plugin

_MODULES = (state_conditions, relative_conditions, history_conditions)
_SINGLE = tuple(one for one in BaseCondition.__subclasses__() if one.__module__ in [part.__name__ for part in _MODULES])


def _with_plugins(kinds: tuple[type[BaseCondition], ...]) -> Any:
    """Return the type of a condition of these kinds, or of one that another package adds."""
    names = {kind.model_fields["kind"].default for kind in kinds}

    def own_kinds_first(given: Any, handler: ValidatorFunctionWrapHandler) -> Any:
        """Take conditions of other packages: an object as it is, a mapping whose kind an entry point names."""
        if isinstance(given, BaseCondition):
            return given
        kind = given.get("kind") if isinstance(given, dict) else None
        if not isinstance(kind, str) or kind in names:
            return handler(given)
        point = find_plugins("coral.conditions").get(kind)
        return handler(given) if point is None else load_plugin(point, "success.conditions").model_validate(given)

    either: Any = Union[kinds]  # noqa: UP007
    # Annotated: subclasses of other packages are written with all of their fields.
    return Annotated[either, Field(discriminator="kind"), WrapValidator(own_kinds_first), SerializeAsAny()]  # type: ignore[type-arg]


if TYPE_CHECKING:
    SingleCondition = BaseCondition
else:
    SingleCondition = _with_plugins(_SINGLE)


class EventSequence(BaseCondition):
    """Events happened in this order: the conditions of each, a list, held together, for `for_s`, after the last."""

    # Each condition names its own object; `object` is the one that the sequence is about. All are watched from the
    # start, so that those with a history know all of it.
    kind: Literal["sequence"] = "sequence"
    events: tuple[Annotated[tuple[SingleCondition, ...], Field(min_length=1, max_length=6)], ...] = Field(
        min_length=2, max_length=8
    )
    for_s: float = Field(default=0.1, ge=0, le=10, strict=True)

    def _check_more(self, task: TaskLike, where: str, field: str) -> None:
        for k, event in enumerate(self.events):
            for index, condition in enumerate(event):
                condition.check(task, where, f"{field}.events[{k}][{index}]")

    @property
    def reads_contacts(self) -> bool:
        """See `BaseCondition.reads_contacts`."""
        return any(condition.reads_contacts for event in self.events for condition in event)

    def _test(self, trial: TrialLike) -> Monitor:
        monitors = [[condition.monitor(trial) for condition in event] for event in self.events]
        reached, since = 0, None

        def holds(truth: Truth) -> bool:
            nonlocal reached, since
            said = [[monitor(truth) for monitor in event] for event in monitors]  # all of them: some keep a history
            held = [all(event) for event in said]
            if reached < len(held):
                since = (truth.time_s if since is None else since) if held[reached] else None
                if since is not None and truth.time_s - since >= self.for_s - 1e-9:
                    reached, since = reached + 1, None
            return reached == len(held)

        return holds


if TYPE_CHECKING:
    Condition = BaseCondition
else:
    Condition = _with_plugins((*_SINGLE, EventSequence))

__all__ = ["Condition", "EventSequence", "SingleCondition"]
