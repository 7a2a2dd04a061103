import hashlib
import math
from types import SimpleNamespace

from coral.advisor.question import AdvisorUnavailable, BadAnswer, Picture, Usage, trait


def test_a_picture_is_known_by_its_content_alone():
    one, other = Picture(name="map", png=b"a", caption="x"), Picture(name="depth", png=b"a")
    assert one.digest == other.digest == hashlib.sha256(b"a").hexdigest()
    assert Picture(name="map", png=b"b").digest != one.digest


def test_a_bad_answer_took_a_request_and_an_absent_one_did_not():
    bad, absent = BadAnswer("not-json", "no JSON", raw="hello"), AdvisorUnavailable("silence", "nobody")
    assert (bad.rejection.code, bad.rejection.reason, bad.raw) == ("not-json", "no JSON", "hello")
    assert (bad.usage.requests, absent.usage.requests) == (1, 0)
    assert BadAnswer("x", "y", usage=Usage(requests=3)).usage.requests == 3


def test_an_absence_may_be_mended_unless_it_is_final():
    assert not AdvisorUnavailable("timeout", "late").final
    gone = AdvisorUnavailable("budget", "used up", final=True, latency_s=math.inf)
    assert (gone.final, gone.latency_s, str(gone)) == (True, math.inf, "used up")


def test_a_wrapper_has_the_traits_of_what_it_wraps_unless_it_has_its_own():
    inside = SimpleNamespace(source="recording", latency="2")
    outside = SimpleNamespace(inner=SimpleNamespace(inner=inside, latency="3"))
    assert [trait(outside, name, "none") for name in ("source", "latency", "aclose")] == ["recording", "3", "none"]
