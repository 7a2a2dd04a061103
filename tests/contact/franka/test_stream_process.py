"""The stream beside the program, with an arm that obeys at once; a thread stands for the process, which takes long."""

import os
import signal
import time

import pytest
from arms import TOOL, make_obedient_arm

from coral.contact.franka.stream import Phase, StopCause
from coral.contact.franka.stream_process import StreamProcess
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.contact.worlds.franka_cfg import FrankaCfg
from coral.errors import InputError

NEVER = float("inf")  # an object that nobody ever saw is infinitely old; it must not stop the arm here
CFG = FrankaCfg(poses_port=0, bias_readings=2, watchdog_s=30.0, link_timeout_s=30.0, poses_timeout_s=NEVER)

TRIAL = sample_trial(load_task("pick-box"), 0, "pick-box")


def wait(stream, ready):
    deadline = time.monotonic() + 60.0
    while not ready(found := stream.report()):
        assert time.monotonic() < deadline, found
    return found


def test_it_starts_moves_stops_and_ends(in_threads):
    stream = StreamProcess(make_obedient_arm, "somebody", CFG, TRIAL)
    try:
        watched = wait(stream, lambda found: found.time_s > 0.01)
        assert watched.phase is Phase.WATCHING
        stream.start()
        moving = wait(stream, lambda found: found.phase is Phase.FOLLOWING)
        assert moving.state.position == pytest.approx(TOOL)
        stream.stop(StopCause.PAGE)
        assert wait(stream, lambda found: found.phase is Phase.STOPPED).cause is StopCause.PAGE
        assert stream.reason() == "page"
    finally:
        stream.close()
    assert not stream.child.process.is_alive()


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")  # it ends by SystemExit
def test_an_arm_that_cannot_be_had_is_the_users_error(in_threads):
    with pytest.raises(InputError, match="--robot: found nobody, expected the address of an arm"):
        StreamProcess(make_obedient_arm, "nobody", CFG, TRIAL)


def test_a_process_that_is_told_to_end_does_not_wait_for_the_program():
    stream = StreamProcess(make_obedient_arm, "somebody", CFG, TRIAL)
    try:
        os.kill(stream.child.process.pid, signal.SIGTERM)  # as multiprocessing does when the program ends by an error
        stream.child.process.join(30.0)
        assert not stream.child.process.is_alive()
    finally:
        stream.child.process.kill()
        stream.close()
