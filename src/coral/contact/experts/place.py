"""Pick and place: grasp as in picking, carry over other objects, set down, release, retreat."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from coral.contact.cost.context import Context, Terms
from coral.contact.cost.stages import Guide, Stage, Strategy
from coral.contact.experts import pick
from coral.contact.experts.terms import axis, level, near, norm
from coral.contact.scene.observation import Array
from coral.contact.scene.relative_conditions import Inserted
from coral.contact.scene.state_conditions import At, Inside, Released, Resting
from coral.contact.scene.task import Task

CARRY_M = 0.14
"""Height of the object's centre while carried: above everything on the table of pick-clutter. A task with its goal
behind a rim sets its number `carry_height`."""


def _other_motion(state: Context, task: Task) -> Array:
    """Compute the motion of other objects (m/s, summed) and the force on them: 60 N count as 1 m/s."""
    moved = [norm(state[f"{item.name}_vel"]) + norm(state[f"{item.name}_hand_force"]) / 60 for item in task.objects[1:]]
    return np.asarray(sum(moved)) if moved else np.zeros(state.shape)


def _resting_height(state: Context, name: str) -> Array:
    """Compute the height (m) of the object's centre when it stands on the goal."""
    return np.asarray(state.goal_pos[..., 2] + state[f"{name}_size"][..., 2] / 2)


def places(task: Task) -> bool:
    """Check whether the task's goals are to bring its first object to the place `goal` and leave it there."""
    first = [condition for condition in task.success.conditions if condition.object == task.objects[0].name]
    put = any(
        isinstance(condition, Inside) or (isinstance(condition, At) and condition.place == "goal")
        for condition in first
    )
    lets_go = any(isinstance(condition, Inside | Released) for condition in first)
    return "goal" in task.places and put and lets_go


def single(task: Task) -> Strategy:
    """Use one cost: reach, close; once held, up, over and down by a geometric switch; then release and retreat."""
    name = task.objects[0].name
    carry_m = task.numbers.get("carry_height", CARRY_M)

    def bumps(state: Context) -> Array:
        touched = [state[f"{name}_{item.name}_contact"] for item in task.objects[1:]]
        return np.asarray(sum(touched)) if touched else np.zeros(state.shape)

    def cost(state: Context) -> Terms:
        place, lying = state[f"{name}_pos"], _resting_height(state, name)
        distance = norm(state.ee_pos - pick.grasp_point(state, name))
        close = near(distance, 0.02)
        # Two fingers that press on the top also touch the object, but do not hold it.
        held = close * state[f"{name}_left_contact"] * state[f"{name}_right_contact"]
        aside = norm((place - state.goal_pos)[..., :2])
        over = near(np.clip(aside - 0.02, 0, None), 0.015)
        low = (1 - over) * np.clip(carry_m - place[..., 2], 0, carry_m)
        down = over * np.clip(carry_m - np.abs(place[..., 2] - lying), 0, carry_m)
        up = np.maximum(level(place[..., 2], carry_m - 0.05, carry_m - 0.01), near(aside, 0.04))
        there = over * near(place[..., 2] - lying, 0.01)
        return {
            "reach": 12.0 * distance * (1 - there),
            "square": 2.0 * pick.across(state, name),
            "open": 10.0 * (1 - close * (1 - there)) * (0.08 - state.gripper_target),
            "close": -2.0 * close * (1 - there) * (1 - state.gripper_target / 0.08),
            "hold": -1.5 * held * (1 - there),
            "raise": 50.0 * held * (low - carry_m) * (1 - there),
            "carry": 20.0 * held * up * (aside - 0.5) * (1 - there),
            "straight up": 15.0 * (1 - up) * norm((place - state[f"{name}_init_pos"])[..., :2]) * (aside > 0.06),
            "lower": -50.0 * held * down * (1 - there),
            "not too high": 20.0 * np.clip(place[..., 2] - carry_m - 0.01, 0, None),
            "there": -35.0 * there,  # more than the lost bonuses for holding it
            "retire": -20.0 * there * np.clip((state.ee_pos - place)[..., 2], 0, 0.12),
            "upright": 2.0 * (1 - axis(state[f"{name}_quat"], "z")[..., 2]),
            "not dropped": 60.0 * (1 - held) * norm(state[f"{name}_vel"]),
            "leave alone": 3.0 * _other_motion(state, task) + 6.0 * bumps(state),
        }

    def onward(now: Context) -> Array:
        """Return the next target of a closed hand: the grasp; with the object: up, over the goal, and down."""
        if not (now[f"{name}_left_contact"] * now[f"{name}_right_contact"])[0, 0]:
            return np.asarray(pick.grasp_point(now, name)[0])
        place, goal = now[f"{name}_pos"][0, 0], now.goal_pos[0, 0]
        over = np.array([*goal[:2], carry_m])
        aside = float(np.linalg.norm((place - goal)[:2]))
        up = np.array([*place[:2], carry_m])
        down = np.array([*goal[:2], _resting_height(now, name)[0, 0]])
        points = [down, over] if aside < 0.03 else [up, over] if place[2] < carry_m - 0.03 else [over]
        return np.asarray(np.stack(points) + now.ee_pos[0, 0] - place)

    return Strategy(
        "pick and place, single stage",
        (Stage("all", cost, (pick.over(name), pick.over(name, 0.1), Guide(onward, opening_m=0.0))),),
    )


def fsm(task: Task) -> Strategy:
    """Reach, close, raise, carry, lower, release, retreat; return to reaching if the object is lost."""
    name = task.objects[0].name
    carry_m = task.numbers.get("carry_height", CARRY_M)
    wells = [one for one in task.success.conditions if isinstance(one, Inserted) and one.object == name and one.place]
    aside_m = 0.012 if wells else 0.02  # into a well, where a rim would stop it on the way, more exactly
    below = [one.thing for one in task.success.conditions if isinstance(one, Resting) and one.object == name]
    picking = pick.fsm(task)
    approach = picking.stages[:-1]  # all but the lift

    def with_care(stage: Stage) -> Stage:
        def cost(state: Context) -> Terms:
            return {**stage.cost(state), "leave others alone": 3.0 * _other_motion(state, task)}

        return replace(stage, cost=cost)

    def holding(state: Context) -> Terms:
        return {
            "hold": 20.0 * state.gripper_target + 6.0 * norm(state.ee_pos - pick.grasp_point(state, name)),
            "upright": 2.0 * (1 + axis(state.ee_quat, "z")[..., 2]),
            "not tilted": 2.0 * (1 - axis(state[f"{name}_quat"], "z")[..., 2]),
            "calm": 0.1 * norm(state.ee_vel),
            "leave others alone": 3.0 * _other_motion(state, task),
        }

    def aside(state: Context) -> Array:
        return norm((state[f"{name}_pos"] - state.goal_pos)[..., :2])

    def raise_(state: Context) -> Terms:
        return {**holding(state), "carry": 10.0 * np.abs(state[f"{name}_pos"][..., 2] - carry_m)}

    def carry(state: Context) -> Terms:
        height = np.abs(state[f"{name}_pos"][..., 2] - carry_m)
        return {**holding(state), "carry": 10.0 * (aside(state) + height)}

    def lower(state: Context) -> Terms:
        height = np.abs(state[f"{name}_pos"][..., 2] - _resting_height(state, name))
        return {**holding(state), "carry": 10.0 * (aside(state) + height), "gently": 1.0 * norm(state[f"{name}_vel"])}

    def release(state: Context) -> Terms:
        return {
            "open": 20.0 * (0.08 - state.gripper_target),
            "stay": 6.0 * norm(state.ee_vel),
            "leave alone": 5.0 * norm(state[f"{name}_vel"]),
        }

    def retire(state: Context) -> Terms:
        above = state[f"{name}_pos"][..., 2] + state[f"{name}_size"][..., 2] / 2 + 0.1
        return {
            "up": 10.0 * np.abs(state.ee_pos[..., 2] - above),
            "straight": 10.0 * norm((state.ee_pos - state[f"{name}_pos"])[..., :2]),
            "open": 20.0 * (0.08 - state.gripper_target),
            "leave alone": 5.0 * norm(state[f"{name}_vel"]) + 3.0 * _other_motion(state, task),
        }

    def lost(now: Context) -> bool:
        return bool(norm(now.ee_pos - pick.grasp_point(now, name))[0, 0] > 0.05)

    def landed(now: Context) -> bool:
        if wells:
            deep = [now[f"{well.place}_pos"] - now[f"{name}_{well.point}_pos"] for well in wells]
            return all(way[0, 0, 2] > well.depth_m + 0.002 for way, well in zip(deep, wells, strict=True))
        return any(now[f"{name}_{thing}_contact"][0, 0] > 0 for thing in {*task.things, *below})

    def guide(goal: str) -> Guide:
        def points(now: Context) -> Array:
            offset = now.ee_pos[0] - now[f"{name}_pos"][0]
            end = now[f"{name}_pos"][0].copy()
            end[:, 2] = carry_m
            if goal != "up":
                end[:, :2] = now.goal_pos[0, 0, :2]
            if goal == "down":
                end[:, 2] = _resting_height(now, name)[0, 0]
            return np.asarray(end + offset)

        return Guide(points, opening_m=0.0)

    back = (approach[0].name, lost)
    return Strategy(
        "pick and place, stages",
        (
            *map(with_care, approach),
            Stage(
                "raise",
                raise_,
                (guide("up"),),
                sigma=0.7,
                next=(back,),
                until=lambda now: bool(now[f"{name}_pos"][0, 0, 2] > carry_m - 0.03),
            ),
            Stage(
                "carry",
                carry,
                (guide("over"),),
                sigma=0.7,
                next=(back,),
                until=lambda now: bool(aside(now)[0, 0] < aside_m),
            ),
            Stage("lower", lower, (guide("down"),), sigma=0.7, next=(back,), until=landed),
            Stage(
                "release",
                release,
                (Guide(lambda now: now.ee_pos[0], opening_m=0.08),),
                sigma=0.5,
                until=lambda now: bool(now.gripper_opening[0, 0] > 0.07),
            ),
            Stage("retire", retire, (Guide(lambda now: now.ee_pos[0] + [0, 0, 0.1], opening_m=0.08),), sigma=0.7),
        ),
    )
