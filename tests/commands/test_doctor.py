import json

import pytest

from coral import __version__
from coral.commands import doctor as module
from coral.commands.doctor import EXTRAS, KEYS, Doctor
from coral.contact.cost_program.worker import CostWorker


@pytest.fixture
def unstarted(monkeypatch):
    """No process of costs is started: these tests are of other checks."""
    monkeypatch.setattr(CostWorker, "check", lambda _: True)


def test_a_package_that_is_missing_makes_it_not_ready(unstarted, monkeypatch):
    assert Doctor()()["ok"]
    monkeypatch.setattr(module, "CORE", (*module.CORE, "no-such-package"))
    result = Doctor()()
    assert (result["ok"], result["packages"]["no-such-package"]) == (False, None)
    text = Doctor().describe(result)
    assert "MISSING  package no-such-package" in text
    assert text.endswith("not ready: run make setup")


def test_keys_are_named_and_never_shown(unstarted, monkeypatch):
    for key in KEYS:
        monkeypatch.delenv(key, raising=False)
    assert "none (the heuristic advisor needs none)" in Doctor().describe(Doctor()())
    monkeypatch.setenv("OPENAI_API_KEY", "very-secret")
    result = Doctor()()
    assert Doctor().describe(result).splitlines()[-2].endswith("environment: OPENAI_API_KEY")
    assert "very-secret" not in json.dumps(result) + Doctor().describe(result)


def test_each_extra_is_told_there_or_not(unstarted):
    result = Doctor()()
    lines = Doctor().describe(result).splitlines()
    for name, there in result["extras"].items():
        assert f"{'extra  ' if there else 'without'}  {name}: {EXTRAS[name][1]}" in lines


def test_doctor_tells_whether_system_calls_are_filtered(monkeypatch):
    monkeypatch.setattr(CostWorker, "check", lambda _: False)
    doctor = Doctor()
    assert "refuses costs" in doctor.describe(doctor())
    monkeypatch.setattr(CostWorker, "check", lambda _: True)
    assert "are filtered" in doctor.describe(doctor())


def test_the_version_in_words_and_in_json(told):
    assert told("version") == (0, f"coral {__version__}\n", "")
    assert told("version", "--json") == (0, {"version": __version__}, "")
