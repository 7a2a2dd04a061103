import ast
from pathlib import Path

import coral.reef
from coral.reef.mission.events import place_told


def test_no_event_names_a_field_as_its_own_step_or_time():
    """The recorders take those beside the fields: a second one of the name would end the mission."""
    sources = sorted(Path(coral.reef.__file__).parent.rglob("*.py"))
    telling = [text for path in sources if "emit(" in (text := path.read_text())]
    calls = (node for text in telling for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call))
    told = [call for call in calls if getattr(call.func, "attr", getattr(call.func, "id", "")) in ("emit", "_emit")]
    named = {word.arg for call in told for word in call.keywords}
    assert "reason" in named
    assert not named & {"step", "t", "event"}


def test_the_place_on_a_saved_map_is_told_in_words():
    place = {"landmarks": 9, "recognised": 4, "x": 0.3, "y": 0.4, "theta": 0.1}
    assert place_told(place) == "4 of 9 landmarks recognised, odometry off by 0.50 m and 6 degrees"
    assert place_told({**place, "recognised": 0}).startswith("none of 9 landmarks recognised")
