import threading
import time

from coral.reef.sea.link import LinkRefused
from coral.reef.sea.operator import OperatorWords, OrderResult, VehicleOrders


class Link:
    def __init__(self, refusal=""):
        self.done, self.refusal, self.gate = [], refusal, threading.Event()
        self.gate.set()

    def arm(self):
        self.gate.wait()
        if self.refusal:
            raise LinkRefused(self.refusal)
        self.done.append("arm")

    def hold(self):
        self.done.append("hold")

    def disarm(self):
        raise OSError("broken pipe")


def test_words_are_taken_once_in_order():
    words = OperatorWords()
    words.say("hold", "keyboard")
    words.say("resume", "page")
    assert words.take() == [("hold", "keyboard"), ("resume", "page")]
    assert words.take() == []


def test_an_order_is_carried_out_and_its_refusal_kept():
    orders = VehicleOrders(Link("Arm: Compass not calibrated"), threaded=False)
    orders.give("arm")
    assert orders.results() == [OrderResult("arm", "Arm: Compass not calibrated")]
    orders.give("hold")
    assert orders.results() == [OrderResult("hold")]


def test_any_failure_of_the_link_is_a_refusal():
    orders = VehicleOrders(Link(), threaded=False)
    orders.give("disarm")
    assert orders.results() == [OrderResult("disarm", "broken pipe")]


def test_the_caller_does_not_wait_and_a_newer_order_follows():
    link = Link()
    link.gate.clear()
    orders = VehicleOrders(link)
    orders.give("arm")
    orders.give("hold")  # returns although arming has not ended
    assert orders.pending == "hold"
    link.gate.set()
    orders.wait(5.0, time.sleep)
    orders.close()
    assert link.done[-1] == "hold"


def test_the_same_order_is_given_once_at_a_time():
    link = Link()
    link.gate.clear()
    orders = VehicleOrders(link)
    orders.give("arm")
    orders.give("arm")
    link.gate.set()
    orders.wait(5.0, time.sleep)
    orders.close()
    assert link.done == ["arm"]
