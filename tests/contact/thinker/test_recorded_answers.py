from coral.contact.scene.task_file import every_task
from coral.contact.thinker.recorded_answers import recorded_answers


def test_every_shipped_task_was_answered_and_no_other():
    for task in every_task():
        found = recorded_answers(task)
        assert found is not None, task
        assert found.plan.stages
        assert all(one.mass_kg > 0 for one in found.parameters.root.values())
    assert recorded_answers("pull-cart") is None
