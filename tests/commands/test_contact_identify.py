import pytest

from coral.cli import main
from coral.commands import contact_identify
from coral.contact.episode.identification_episode import Found


@pytest.fixture
def begun(monkeypatch):
    """The configuration that an episode was begun with; its corrections are made up."""
    heard = []

    def probed(trial, name, truth, first, cfg, *_):
        heard.append(cfg)
        event = {
            "t": 4.0,
            "accepted": True,
            "after": [0.11, 0.45],
            "errors": [6.0, 0.5],
            "text": "board: mass 2 to 0.11",
        }
        return Found((event,), "success", 9.0)

    monkeypatch.setattr(contact_identify, "probe_episode", probed)
    return heard


def test_the_command_tells_and_draws_each_correction_of_an_episode(begun, tmp_path, capsys):
    figure = tmp_path / "board.png"
    words = ["contact", "identify", "--quiet", "--samples", "80", "--figure", str(figure)]
    assert main(words) == 0
    said = capsys.readouterr().out
    assert "1. accepted  at 4.0 s, board: mass 2 to 0.11" in said
    assert "remaining error: mass +10 %, friction -10 % of 0.1 kg and 0.5" in said
    assert figure.stat().st_size > 1000
    assert (begun[0].think.correct_every_s, begun[0].think.identify.by, begun[0].poses) == (2.0, "balance", "tracked")
    assert begun[0].controller.mppi.samples == 80


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--every", "0"], "--every"),
        (["--samples", "0"], "--samples"),
        (["--mass", "nan"], "--mass"),
        (["--seed", "-1"], "--seed"),
    ],
)
def test_bad_input_is_refused_in_a_line(words, said, begun, capsys):
    assert main(["contact", "identify", "--quiet", *words]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1
    assert not begun
