import dataclasses
import json

import numpy as np
import pytest
from episodes import make_trial

from coral.contact.control.planning_world import PlanningCfg
from coral.contact.cost.context import Context
from coral.contact.cost.stages import Stage, Strategy
from coral.contact.cost_program.errors import CostError
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.episode.own_cost import NumpyCost, own_cost, read_cost_file
from coral.errors import InputError

CFG = EpisodeCfg(planning=dataclasses.replace(PlanningCfg(), threads=1))
PROGRAM = "def state_cost(self):\n    return {'reach': np.linalg.norm(self.ee_pos - self.box_pos)}\n"
STATE = Context({"ee_pos": np.ones((2, 3, 3)), "time": np.zeros((2, 3))}, (2, 3))


def reach(state):
    return {"reach": np.linalg.norm(state.ee_pos - state.box_pos, axis=-1)}


def wrong(state):
    return {"reach": state.bocks_pos}


def test_a_function_becomes_one_stage_and_keeps_its_source():
    own = own_cost(reach, make_trial(), CFG)
    assert [stage.name for stage in own.strategy.stages] == ["reach"]
    assert (own.file, own.text.splitlines()[0]) == ("cost.py", "def reach(state):")


def test_stages_and_strategies_are_taken():
    stages = [Stage("go", reach, until=lambda now: bool(now.time[0, 0] > 1)), Stage("stay", reach)]
    assert len(own_cost(stages, make_trial(), CFG).strategy.stages) == 2
    assert own_cost(Strategy("mine", tuple(stages)), make_trial(), CFG).strategy.name == "mine"


def test_a_file_is_compiled_in_the_confined_process(tmp_path):
    (tmp_path / "mine.py").write_text(PROGRAM)
    own = own_cost(str(tmp_path / "mine.py"), make_trial(), CFG)
    inside = [type(cell.cell_contents).__name__ for cell in own.strategy.stages[0].cost.__closure__]  # it may wait
    assert "WorkerCost" in inside
    assert (own.strategy.name, own.file, own.text) == ("mine", "cost.py", PROGRAM)


def test_a_program_that_asks_for_files_is_refused_with_its_line(tmp_path):
    (tmp_path / "mine.py").write_text("def state_cost(self):\n    return open('/etc/passwd')\n")
    with pytest.raises(InputError, match=r"mine.py: .*line 2"):
        own_cost(tmp_path / "mine.py", make_trial(), CFG)


@pytest.mark.parametrize(
    ("stage", "said"),
    [
        ({"opening": 8}, "stages: stage 'reach': opening is 8; it lies within -0.04 and 0.08 m"),
        ({"done": "self.time >"}, "syntax: stage 'reach': `done`: not Python: invalid syntax"),
        (
            {"code": PROGRAM.replace("box_pos", "bax_pos")},
            "unknown_state: stage 'reach': line 2 (`return {'reach': np.linalg.norm(self.ee_pos - self.bax_pos)}`): "
            "the state has no 'bax_pos' (did you mean 'box_pos'?)",
        ),
    ],
)
def test_a_stage_that_cannot_work_is_told_in_one_sentence(tmp_path, stage, said):
    (tmp_path / "plan.json").write_text(json.dumps([{"name": "reach", "code": PROGRAM, **stage}]))
    with pytest.raises(InputError) as told:
        own_cost(tmp_path / "plan.json", make_trial(), CFG)
    assert str(told.value) == f"{tmp_path / 'plan.json'}: {said}"


@pytest.mark.parametrize(
    ("cost", "said"),
    [
        (wrong, "no quantity 'bocks_pos'"),
        (lambda state: {"flat": 1.0}, "constant"),
        (lambda state: state.ee_pos, "shape"),
        (3, "found int"),
        ([], "found list"),
        ("no-such-cost", "an entry point of the group coral.costs"),
        ([Stage("a", reach), Stage("a", reach)], "two named 'a'"),
        ([Stage("a", reach, next=(("b", lambda now: False),))], "next 'b'"),
        ([Stage("a", reach, until=lambda now: now.bocks)], "bocks"),
    ],
)
def test_a_cost_that_cannot_work_is_refused_before_anything_is_written(cost, said):
    with pytest.raises(InputError, match=said):
        own_cost(cost, make_trial(), CFG)


def write(folder, name, text):
    (folder / name).write_text(text)
    return folder / name


def test_a_python_file_is_one_function(tmp_path):
    assert read_cost_file(write(tmp_path, "cost.py", PROGRAM)).code == PROGRAM


def test_a_yaml_file_has_stages(tmp_path):
    body = PROGRAM.replace("\n", "\n      ")
    text = f"stages:\n  - name: reach\n    done: self.time > 1\n    code: |\n      {body}\n"
    assert read_cost_file(write(tmp_path, "plan.yaml", text)).names == ["reach"]


@pytest.mark.parametrize(
    ("name", "text"), [("plan.yaml", "- {name: a, code: c}\n"), ("p.json", '[{"name": "a", "code": "c"}]')]
)
def test_the_list_of_stages_may_stand_alone(tmp_path, name, text):
    assert read_cost_file(write(tmp_path, name, text)).names == ["a"]


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("cost.txt", PROGRAM, "a file that ends in .py"),
        ("plan.yaml", "stages: []\n", "give either `code`"),
        ("plan.json", '{"stages": [{"name": ""}]}', "stages"),
        ("empty.py", "", r"empty\.py: give either `code`"),
        (
            "p.yaml",
            "- {name: a, code: c, noice: 0.6}",
            r"stages\[0\]\.noice: found an unknown key, expected .* \(did you mean 'noise'\?\)",
        ),
        ("p.yaml", "let: {asid: '1'}\nstages: [{name: a, code: '{aside}'}]", r"p\.yaml: stage 'a' uses \{aside\} \("),
    ],
)
def test_what_is_no_plan_is_refused_with_the_files_name(tmp_path, name, text, said):
    with pytest.raises(InputError, match=said) as told:
        read_cost_file(write(tmp_path, name, text))
    assert name in str(told.value)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(InputError, match=r"absent\.py"):
        read_cost_file(tmp_path / "absent.py")


def cost_of(function):
    return NumpyCost(function)(STATE)


def test_named_terms_and_a_bare_array_are_taken():
    assert cost_of(lambda state: {"high": state.ee_pos[..., 2]})["high"].shape == (2, 3)
    assert cost_of(lambda state: state.time)["cost"].shape == (2, 3)


def test_a_number_counts_for_every_state():
    assert cost_of(lambda state: {"far": 3})["far"].shape == (1, 1)


@pytest.mark.parametrize(
    ("function", "code"),
    [
        (lambda state: state.ee_pos, "shape"),
        (lambda state: np.zeros(3), "shape"),
        (lambda state: {"reach": "far"}, "wrong_return"),
        (lambda state: {"reach\ud800": 1.0}, "wrong_return"),
        (lambda state: None, "wrong_return"),
        (lambda state: state.box_pos, "raised"),
        (lambda state: 1 / 0, "raised"),
    ],
)
def test_what_is_no_cost_is_an_error_of_the_cost(function, code):
    with pytest.raises(CostError) as told:
        cost_of(function)
    assert told.value.code == code


def test_an_exception_names_the_line_of_the_function():
    def wrong(state):
        return {"reach": state.ee_poss}

    with pytest.raises(CostError) as told:
        NumpyCost(wrong)(STATE)
    assert (told.value.line, told.value.shown) == (
        wrong.__code__.co_firstlineno + 1,
        'return {"reach": state.ee_poss}',
    )
    assert "no quantity 'ee_poss'" in told.value.text
