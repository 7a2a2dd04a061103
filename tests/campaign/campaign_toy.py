"""Episodes for the tests, in a module of its own so that spawned workers can import them."""

import os
import signal
import sys
import time
from pathlib import Path


def toy(spec, folder):
    """Leave a mark outside of the campaign each time it runs; the world says what happens then."""
    marks = Path(spec.advisor)
    with open(marks / f"{spec.key}.mark", "a") as mark:
        mark.write("ran\n")
    folder.mkdir(parents=True)
    (folder / "log.txt").write_text(f"{spec.seed}\n")
    if spec.world == "raises":
        raise ValueError("the reef is\nclosed")
    if spec.world == "exits":
        os._exit(3)
    if spec.world == "exits-once" and times(marks, spec) == 1:
        os._exit(3)
    if spec.world == "last-to-exit" and times(marks, spec) == 1:
        while not list(folder.parents[1].glob("episodes/w_*.json")):  # the other worker is idle from then on
            time.sleep(0.01)
        os._exit(3)
    if spec.world == "killed":
        os.kill(os.getpid(), signal.SIGKILL)
    if spec.world == "nan":
        return {"score": float("nan")}
    return {"score": spec.seed * 10, "threads": os.environ.get("OPENBLAS_NUM_THREADS")}


def times(marks, spec):
    """How often an episode has been started."""
    path = Path(marks) / f"{spec.key}.mark"
    return len(path.read_text().splitlines()) if path.exists() else 0


def until_told(spec, folder):
    """Wait until a file appears, as a long mission would go on."""
    marks = Path(spec.advisor)
    folder.mkdir(parents=True)
    (folder / "half.txt").write_text("unfinished")
    with open(marks / f"{spec.key}.mark", "a") as mark:
        mark.write(f"{os.getpid()}\n")
    while spec.seed and not (marks / "go").exists():
        time.sleep(0.01)
    return {"score": spec.seed}


def on_a_node(spec, folder):
    """Long enough that a node which is killed is in the middle of some."""
    folder.mkdir(parents=True)
    (folder / "log.txt").write_text(f"{spec.seed}\n")
    time.sleep(0.5 if spec.world == "slow" else 0.05)
    return {"score": spec.seed}


def main(out, marks):
    """A campaign of its own process, for the tests that kill one."""
    from coral.campaign.campaign import run_campaign
    from coral.campaign.local import LocalExecutor
    from coral.campaign.spec import grid
    from coral.campaign.store import Store

    store = Store(Path(out))
    specs = grid("toy", variants=["a"], worlds=["w"], seeds=[0, 1, 2], advisors=[marks])
    with store.lock():
        store.open(specs, {"code": "1"})
        run_campaign(store, specs, until_told, LocalExecutor(2), mix=True)


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parent))
    import campaign_toy

    campaign_toy.main(*sys.argv[1:])
