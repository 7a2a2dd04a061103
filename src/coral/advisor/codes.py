"""Why an attempt gave no answer: the codes of attempts.jsonl that no verifier gave."""

from __future__ import annotations

CODES = {
    "empty": "The reply was empty.",
    "not-json": "The reply holds no JSON object.",
    "missing-field": "A field is missing in the answer.",
    "wrong-type": "A field has the wrong type.",
    "out-of-range": "A field is out of its range, or none of the choices.",
    "invalid": "The answer does not fit its format otherwise, or it held a key of this environment.",
    "cut-off": "The reply broke off; if it happens often, raise `max_output_tokens` or let the model think less.",
    "refusal": "The model declined.",
    "too-large": "The reply had more bytes than are read.",
    "too-long": "The reply had more characters than are read.",
    "bad-reply": "The reply did not follow the API.",
    "not-yours": "`answer.json` at the desk belongs to another user.",
    "timeout": "No reply in time.",
    "connection": "The server was not reached, or the connection broke.",
    "http-STATUS": "The server answered with an error; 408, 409, 425, 429 and 500 or more are tried again.",
    "key-refused": "The key was refused; not tried again.",
    "no-such-model": "There is no such model; not tried again.",
    "budget": "The budget of the run is used up; not tried again.",
    "deadline": "The time for the whole decision was up.",
    "wall-timeout": "The simulated world waited ten minutes.",
    "client-error": "The client library failed.",
    "advisor-error": "The advisor's own program failed.",
    "no-rule": "The rules have none for this question.",
    "not-recorded": "The recording has no answer to this question.",
    "silence": "A simulated or recorded silence.",
    "desk": "The inbox cannot be written.",
    "closed": "The run ended.",
}
"""Meaning of each code."""
