import subprocess
import sys

import pytest

from coral.cli import COMMANDS, main
from coral.completion import completion_script, completions
from coral.errors import InputError
from coral.reef.mission.variants import VARIANTS
from coral.reef.world.world import shipped_worlds


def offered(words):
    return completions(words.split(" "), COMMANDS)


@pytest.mark.parametrize(
    ("words", "found"),
    [
        ("reef en", ["envs"]),
        ("rep", ["replay", "report"]),
        ("contact run --sam", ["--samples"]),
        ("contact run pick-b", ["pick-box"]),
        ("reef run ", shipped_worlds()),
        ("reef run s1 --variant no-t", [name for name in VARIANTS if name.startswith("no-t")]),
        ("reef run s1 --preset b", ["bay"]),
        ("reef run s1 --variant full --fallback h", ["hold"]),
        ("reef run s1 --out ", []),
        ("reef run s1 --no-pre", ["--no-preflight"]),
        ("reef run s1 --cf", ["--cfg."]),
        (
            "reef run s1 --cfg.map.s",
            ["--cfg.map.sharp-pixel-m", "--cfg.map.sharp-ratio", "--cfg.map.sonar.", "--cfg.map.sight."],
        ),
        ("config reef pilot.trigger.stuck_t", ["pilot.trigger.stuck_time_s"]),
    ],
)
def test_what_is_offered_for_the_last_word(words, found):
    assert offered(words) == found


def test_bash_asks_the_command_for_its_words(tmp_path, capsys):
    assert main(["--print-completion", "bash"]) == 0
    (tmp_path / "coral.bash").write_text(capsys.readouterr().out)
    coral = tmp_path / "coral"
    coral.write_text(f'#!/bin/sh\nexec {sys.executable} -m coral.cli "$@"\n')
    coral.chmod(0o755)
    asked = (
        f"source {tmp_path}/coral.bash; COMP_WORDS=({coral} reef en); COMP_CWORD=2; "
        f'_coral {coral}; printf "%s\\n" "${{COMPREPLY[@]}}"'
    )
    done = subprocess.run(["bash", "-c", asked], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["envs"]


def test_an_unknown_shell_is_refused(capsys):
    with pytest.raises(InputError, match="one of bash, zsh, fish"):
        completion_script("ksh")
    assert main(["--print-completion"]) == 2
    assert capsys.readouterr().err.count("--print-completion: found") == 1
