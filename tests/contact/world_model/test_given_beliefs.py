import pytest

from coral.contact.scene.trial import PhysicalParameters
from coral.contact.tasks import load_task
from coral.contact.world_model.given_beliefs import parse_beliefs
from coral.errors import InputError


def test_masses_and_frictions_are_read_object_by_object():
    task = load_task("pick-clutter")
    first, second = (item.name for item in task.objects[:2])
    assert parse_beliefs(f"{first}=2,0.9; {second} = 0.2 , 0.4;", task) == {
        first: PhysicalParameters(2.0, 0.9),
        second: PhysicalParameters(0.2, 0.4),
    }


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("board", "NAME=MASS,FRICTION"),
        ("board=2", "NAME=MASS,FRICTION"),
        ("board=2,x", "NAME=MASS,FRICTION"),
        ("", "NAME=MASS,FRICTION"),
        ("bord=2,0.9", "did you mean 'board'?"),
        ("board=2,0.9;board=1,1", "twice"),
        ("board=nan,0.9", "board, mass (kg)"),
        ("board=2,7", "board, friction"),
        ("board=inf,1", "0.005 to 20"),
    ],
)
def test_what_cannot_be_believed_is_refused_in_a_line(text, said):
    with pytest.raises(InputError) as caught:
        parse_beliefs(text, load_task("push-pick-board"))
    assert said in str(caught.value)
    assert "--believe" in str(caught.value)
