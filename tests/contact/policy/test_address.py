import pytest

from coral.contact.policy.address import Address, parse_address
from coral.errors import InputError


@pytest.mark.parametrize(
    ("text", "name", "url"),
    [
        ("ws://localhost:8000", "policy", "ws://localhost:8000"),
        ("pi05=wss://gpu.example:443/serve?x=1", "pi05", "wss://gpu.example:443/serve?x=1"),
        ("ws://host:1/?a=b", None, None),
        ("a=ws://[::1]:8000", "a", "ws://[::1]:8000"),
    ],
)
def test_a_name_and_an_address_are_told_apart(text, name, url):
    if name is None:
        with pytest.raises(InputError, match="a name of small letters"):
            parse_address(text)
    else:
        assert parse_address(text) == Address(name, url)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("http://host:8000", "ws://HOST:PORT"),
        ("host:8000", "ws://HOST:PORT"),
        ("ws://", "ws://HOST:PORT"),
        ("ws://host:port", "ws://HOST:PORT"),
        ("ws://host:99999", "ws://HOST:PORT"),
        ("=ws://host:1", "a name"),
        ("Pi 0=ws://host:1", "a name"),
        ("expert=ws://host:1", "no variant"),
        ("ws://me:pw@host:1", "environment"),
        ("ws://ho st:1", "ws://HOST:PORT"),
        ("", "ws://HOST:PORT"),
    ],
)
def test_what_is_no_address_is_refused(text, said):
    with pytest.raises(InputError, match=said):
        parse_address(text, ("expert",))
