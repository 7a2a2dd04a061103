from coral import __version__


def test_the_version_in_words_and_in_json(told):
    assert told("version") == (0, f"coral {__version__}\n", "")
    assert told("version", "--json") == (0, {"version": __version__}, "")
