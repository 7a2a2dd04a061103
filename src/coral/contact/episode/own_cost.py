"""A cost of the user's own: from a file, a function or another package, checked on rollouts before the episode."""

from __future__ import annotations

import dataclasses
import inspect
import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from coral.contact.control.planning_world import PlanningWorld
from coral.contact.control.quantities import task_schema_of
from coral.contact.cost.context import Context, Terms
from coral.contact.cost.stages import Stage, Strategy
from coral.contact.cost_program.errors import CostError, is_term_name
from coral.contact.cost_program.worker import CostWorker
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.plan.contact_regions import RegionsAnswer
from coral.contact.plan.cost_check import verify_cost
from coral.contact.plan.cost_plan import PlanAnswer, make_strategy
from coral.contact.plan.plan_check import OF_THE_PLACE, judge_plan
from coral.contact.plan.sampled_states import sample_states
from coral.contact.scene.trial import Trial, stated_beliefs
from coral.contact.worlds.registry import make_world
from coral.errors import InputError
from coral.foreign_file import read_text
from coral.plugins import named_plugin
from coral.validation_errors import input_error
from coral.yaml_file import load_mapping

ENDINGS = (".py", ".yaml", ".yml", ".json")
Function = Callable[[Context], Any]


def read_cost_file(path: Path) -> PlanAnswer:
    """Read a plan. Its programs are not run; `judge_plan` checks them.

    It is a `.py` file with `def state_cost(self)`, or a YAML or JSON file with `code` or `stages` (`PlanAnswer`), or
    the list of stages alone.

    Raises:
        InputError: The file cannot be read, or is no plan.
    """
    if path.suffix.lower() not in ENDINGS:
        raise InputError(str(path), "", repr(path.suffix), f"a file that ends in {', '.join(ENDINGS)}")
    text = read_text(path, "a readable file with a cost")
    try:
        if path.suffix.lower() == ".py":
            return PlanAnswer(code=text)
        # A model may say more than it was asked; what a person wrote and nobody reads is a mistake.
        return PlanAnswer.model_validate(load_mapping(text, str(path), list_key="stages"), extra="forbid")
    except ValidationError as error:
        told = input_error(str(path), error, PlanAnswer)
        if error.errors()[0]["type"] == "value_error":  # a sentence for whoever wrote the plan, a model or a person
            raise InputError(told.where, told.field, told.expected, "") from None
        raise told from None


@dataclass(frozen=True)
class OwnCost:
    """A checked cost of the user's own."""

    strategy: Strategy
    file: str
    """Name of the file in the run folder that keeps it."""
    text: str
    """Its source, "" if there is none."""


def own_cost(given: Any, trial: Trial, cfg: EpisodeCfg, where: str = "--cost") -> OwnCost:
    """Check a cost in the trial and make its strategy; nothing is written.

    The checks are those of a model's costs. Programs in files run in the confined process; functions run here.

    `given` is a file (`read_cost_file`), a function of a `Context`, a `Stage`, several stages, a `Strategy`, or the
    name of an entry point of the group `coral.costs`, a function of the task that returns one of these.

    Raises:
        InputError: It is no cost, or a check refuses it, with the reason.
    """
    trial = trial.known
    if isinstance(given, str | Path) and Path(given).suffix.lower() in ENDINGS:
        return _from_file(Path(given), trial, cfg)
    name = given if isinstance(given, str) else ""
    if isinstance(given, str):
        given = named_plugin("coral.costs", given, where, ours=[f"FILE{ending}" for ending in ENDINGS])(trial.task)
    strategy = _to_strategy(given, name, where)
    states = _sample(trial, cfg)
    for index, stage in enumerate(strategy.stages):
        for fault in verify_cost(stage.cost, states):  # type: ignore[arg-type]
            if fault.fatal and (index == 0 or fault.code not in OF_THE_PLACE):
                raise InputError(where, f"stage {stage.name!r}", fault.code, fault.reason)
        try:
            _read_tests(stage, states.first())
        except (AttributeError, KeyError, IndexError, TypeError, ValueError, CostError) as error:
            found = f"{type(error).__name__}: {error}"
            raise InputError(where, f"stage {stage.name!r}", found, "conditions and guides of the state") from None
    return OwnCost(strategy, "cost.py", _source(given))


def _from_file(path: Path, trial: Trial, cfg: EpisodeCfg) -> OwnCost:
    plan = read_cost_file(path)
    worker = CostWorker()
    schema = task_schema_of(trial.task)
    refusal = judge_plan(plan, schema, _sample(trial, cfg), worker.load).refusal
    if refusal is not None:
        raise InputError(str(path), refusal.code, refusal.reason, "")
    strategy = make_strategy(path.stem, plan, RegionsAnswer({}), schema, {}, worker.load)
    return OwnCost(strategy, f"cost{path.suffix.lower()}", read_text(path, "a readable file with a cost"))


def _to_strategy(given: Any, name: str, where: str) -> Strategy:
    if isinstance(given, Strategy):
        strategy = given
    elif isinstance(given, Stage):
        strategy = Strategy(name or given.name, (given,))
    elif isinstance(given, Sequence) and given and all(isinstance(item, Stage) for item in given):
        strategy = Strategy(name or "own stages", tuple(given))
    elif callable(given):
        named = name or getattr(given, "__name__", type(given).__name__)
        strategy = Strategy(named, (Stage(named, given),))
    else:
        raise InputError(where, "", type(given).__name__, "a file, a function of the state, stages or a strategy")
    names = [stage.name for stage in strategy.stages]
    for stage in strategy.stages:
        if names.count(stage.name) > 1:
            raise InputError(where, "stages", f"two named {stage.name!r}", "a name for each stage")
        for to, _ in stage.next:
            if to not in names:
                raise InputError(where, f"stage {stage.name!r}", f"next {to!r}", f"one of {', '.join(names)}")
    stages = tuple(dataclasses.replace(stage, cost=NumpyCost(stage.cost, stage.name)) for stage in strategy.stages)
    return dataclasses.replace(strategy, stages=stages)


def _sample(trial: Trial, cfg: EpisodeCfg) -> Context:
    """Sample rolled-out states of the trial as its judge begins it; only the hand's own world is needed for that."""
    world = make_world("hand", trial, cfg.planning.step_s)
    try:
        first = world.reset()
    finally:
        world.close()
    planner = PlanningWorld(trial, stated_beliefs(trial), first, cfg.planning)
    try:
        sizes = {name: trial.size(name) for name in trial.objects}
        return sample_states(planner, first, sizes)
    finally:
        planner.close()


def _read_tests(stage: Stage, now: Context) -> None:
    for test in (stage.until, *(test for _, test in stage.next)):
        if test is not None:
            bool(test(now))
    for guide in stage.guides:
        if np.asarray(guide.points(now)).shape[-1:] != (3,):
            raise ValueError("the points of a guide have Shape=(n, 3)")


def _source(given: Any) -> str:
    """Return the source text of a function, for the record; "" where Python does not know it."""
    parts = given.stages if isinstance(given, Strategy) else given if isinstance(given, Sequence) else [given]
    texts = []
    for part in parts:
        try:
            texts.append(inspect.getsource(part.cost if isinstance(part, Stage) else part))
        except (OSError, TypeError):
            continue
    return "\n\n".join(dict.fromkeys(texts))


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
