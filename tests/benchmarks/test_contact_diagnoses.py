import importlib.util
from pathlib import Path

spec = importlib.util.spec_from_file_location(
    "contact_diagnoses", Path(__file__).parents[2] / "benchmarks" / "contact_diagnoses.py"
)
diagnoses = importlib.util.module_from_spec(spec)
spec.loader.exec_module(diagnoses)


def answered(kind, *faults, verdict="accepted"):
    return {"event": "verdict", "kind": kind, "verdict": verdict, "faults": list(faults)}


def test_a_diagnosis_is_held_against_the_mistakes_in_force():
    found = diagnoses.stuck_with(
        [
            answered("cost-function", "sloppy-goal-off"),
            answered("contact-regions", "sloppy-wrong-face", verdict="rejected"),
            {"event": "stuck", "diagnosis": "settled"},
            answered("cost-repair"),
            answered("parameter-repair", "sloppy-parameters"),
            {"event": "stuck", "diagnosis": "settled"},
        ]
    )
    assert found == [("settled", ("goal-off",)), ("settled", ("parameters",))]
    assert [diagnoses.named(one) for one in found] == [True, False]
