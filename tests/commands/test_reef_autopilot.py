import pytest


def test_it_serves_a_reef_and_tells_what_went_wrong(told):
    words = ("--listen", "udp:127.0.0.1:0", "--time-limit-s", 0.01, "--fault", "0:leak", "--json")
    code, result, said = told("reef", "autopilot", "s1", *words)
    assert code == 0
    assert "listens at mavlink:udp:127.0.0.1:" in said
    assert result["address"] in said
    assert (result["collisions"], result["armed"], result["mode"]) == (0, False, "MANUAL")
    assert result["pose"][:2] == pytest.approx([4.4, 5.278], abs=0.01)


def test_its_end_is_told_in_a_line(told):
    code, text, _ = told("reef", "autopilot", "--listen", "tcp:127.0.0.1:0", "--time-limit-s", 0.01)
    assert code == 0
    assert "0 collisions, ended in MANUAL" in text


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (("s9",), "world"),
        (("--listen", "serial:x:1"), "--listen"),
        (("--listen", "udp:127.0.0.1:x"), "--listen"),
        (("--listen", "udp:127.0.0.1:99999"), "port"),
        (("--fault", "5:leek"), "did you mean 'leak'?"),
        (("--parameters", "missing.yaml"), "missing.yaml"),
    ],
)
def test_what_cannot_be_is_one_line(refused, words, says):
    assert says in refused("reef", "autopilot", *words)


@pytest.mark.parametrize("content", ["FS_LEEK_ENABLE: 2", "FS_LEAK_ENABLE: surface"])
def test_unknown_parameters_are_one_line(refused, tmp_path, content):
    path = tmp_path / "parameters.yaml"
    path.write_text(content)
    assert "FS_LEAK_ENABLE" in refused("reef", "autopilot", "--parameters", path)
