import errno
import os
import threading

from coral.reef.sea.background import BackgroundWork


def test_work_is_done_in_order_off_the_callers_thread():
    done, threads = [], set()

    def piece(k):
        done.append(k)
        threads.add(threading.get_ident())

    work = BackgroundWork()
    for k in range(100):
        assert work.offer(lambda k=k: piece(k))
    assert work.close()
    assert done == list(range(100))
    assert threading.get_ident() not in threads


def test_a_full_disk_stops_the_work_and_says_so():
    done, work = [], BackgroundWork(threaded=False)

    def full():
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "events.jsonl")

    work.offer(full)
    work.offer(lambda: done.append(1))
    work.drain()
    assert done == []
    assert "No space left" in work.failure
    assert "events.jsonl" in work.failure
    assert not work.offer(lambda: done.append(2))


def test_a_full_queue_drops_and_counts():
    work = BackgroundWork(2, threaded=False)
    assert [work.offer(lambda: None) for _ in range(4)] == [True, True, False, False]
    assert work.dropped == 2


def test_a_caller_never_waits_for_work_that_hangs():
    gate, work = threading.Event(), BackgroundWork(1)
    work.offer(gate.wait)
    taken = [work.offer(lambda: None) for _ in range(5)]  # returns although the first piece has not ended
    assert not all(taken)
    gate.set()
    assert work.close()


def test_at_the_end_all_that_waits_is_waited_for_while_it_goes_on():
    class Busy:
        """A thread that does one piece while it is waited for."""

        left = 3

        def is_alive(self):
            return self.left > 0

        def join(self, timeout_s):
            self.left, work.done = self.left - 1, work.done + 1

    work = BackgroundWork(threaded=False)
    work._thread = Busy()
    assert work.close()


def test_a_piece_that_hangs_at_the_end_is_given_up():
    gate, work = threading.Event(), BackgroundWork()
    work.offer(gate.wait)
    assert not work.close(timeout_s=0.01)
    gate.set()
