import json

import pytest
from pydantic_ai import exceptions as wrong

from coral.advisor.failures import diagnose
from coral.advisor.wire import ReplyTooLarge


def caused(error, cause):
    error.__cause__ = cause
    return error


def http(status, body="no"):
    return wrong.ModelHTTPError(status, "m", body)


@pytest.mark.parametrize(
    ("error", "code", "retry", "final"),
    [
        (http(401), "key-refused", False, True),
        (http(404), "no-such-model", False, True),
        (http(400), "http-400", False, True),
        (http(429), "http-429", True, False),
        (http(500), "http-500", True, False),
        (wrong.ModelAPIError("m", "refused"), "connection", True, False),
        (wrong.UserError("no such mode"), "client-error", False, True),
        (TypeError("odd reply"), "client-error", False, False),
        (wrong.UnexpectedModelBehavior("odd"), "bad-reply", False, None),
        (caused(ValueError("x"), json.JSONDecodeError("x", "", 0)), "bad-reply", False, None),
        (caused(wrong.ModelAPIError("m", "x"), ReplyTooLarge("x")), "too-large", False, None),
    ],
)
def test_whose_fault_it_is_and_whether_to_try_again(error, code, retry, final):
    failure = diagnose(error, "local:m", 1000)
    assert (failure.code, failure.retry) == (code, retry)
    assert getattr(failure.error, "final", None) is final


def test_the_bound_is_told_to_a_model_that_wrote_too_much():
    failure = diagnose(caused(ValueError("x"), ReplyTooLarge("x")), "local:m", 1234)
    assert "1234 bytes" in failure.error.rejection.reason


@pytest.mark.parametrize("error", [http(500, "key sk-abcdef123456"), ValueError("key sk-abcdef123456")])
def test_no_key_stands_in_a_reason(error):
    reason = diagnose(error, "local:m", 1000).error.reason
    assert "***" in reason
    assert "abcdef123456" not in reason
