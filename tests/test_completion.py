import contextlib
import io
import re
import subprocess

import pytest

from coral.cli import COMMANDS, main
from coral.completion import completion_script
from coral.errors import InputError


@pytest.fixture(scope="module")
def script():
    """What the command line prints for bash."""
    with contextlib.redirect_stdout(io.StringIO()) as said:
        assert main(["--print-completion", "bash"]) == 0
    return said.getvalue()


def test_every_command_is_in_the_script(script):
    words = {word for name in COMMANDS for word in name.split()}
    assert {word for word in words if not re.search(rf"\b{re.escape(word)}\b", script)} == set()


def complete(script, tmp_path, *words):
    """What bash offers for the last word."""
    file = tmp_path / "coral.bash"
    file.write_text(script)
    asked = (
        f"source {file}; f=$(complete -p coral | sed 's/.*-F \\([^ ]*\\).*/\\1/'); "
        f"COMP_WORDS=({' '.join(words)}); COMP_CWORD={len(words) - 1}; "
        '$f coral; printf "%s\\n" "${COMPREPLY[@]}"'
    )
    done = subprocess.run(["bash", "-c", asked], capture_output=True, text=True, check=True)
    return done.stdout.split()


def test_bash_completes_a_command_of_a_group(script, tmp_path):
    assert complete(script, tmp_path, "coral", "reef", "en") == ["envs"]


def test_bash_completes_a_flag_of_a_command(script, tmp_path):
    assert complete(script, tmp_path, "coral", "contact", "run", "--sam") == ["--samples"]


def test_an_unknown_shell_is_refused():
    with pytest.raises(InputError, match="one of bash, zsh, fish"):
        completion_script("ksh", COMMANDS)


def test_the_command_line_prints_it_and_refuses_a_missing_shell(capsys):
    assert main(["--print-completion", "ksh"]) == 2
    assert main(["--print-completion"]) == 2
    assert capsys.readouterr().err.count("--print-completion: found") == 2
