import pytest

from coral.contact.plan.cost_file import read_cost_file
from coral.errors import InputError

PROGRAM = "def state_cost(self):\n    return {'reach': np.linalg.norm(self.ee_pos - self.box_pos)}\n"


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
