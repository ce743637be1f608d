"""The program `pipeline`: where it is, and how it is run."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from pathlib import Path
from typing import Any, Sequence

from .errors import PipelineError

INSTALL = (
    "build it in a copy of the repository with `cargo install --path .`, and put it on the path, "
    "or name it with program=... or the environment variable PIPELINE"
)


def find_program(program: str | os.PathLike[str] | None = None) -> Path:
    """The program: the argument, else `PIPELINE` of the environment, else `pipeline` on the path.

    Raises `PipelineError` where there is none, with how to install it.
    """
    named = program or os.environ.get("PIPELINE")
    found = shutil.which(os.fspath(named or "pipeline"))
    if found is None:
        where = f"{named} is no program that can be run" if named else "no program `pipeline` on the path"
        raise PipelineError(f"{where}: {INSTALL}")
    return Path(found).resolve()


def call(program: Path, arguments: Sequence[str], folder: Path, accept: Sequence[int] = (0,)) -> tuple[str, str]:
    """Runs the program in a folder: its output, and what it said beside it. Another exit code than those accepted raises `PipelineError`."""
    try:
        done = subprocess.run([program, *arguments], cwd=folder, capture_output=True, encoding="utf-8", check=False)
    except OSError as error:
        raise PipelineError(f"{program} cannot be started: {error}") from error
    if done.returncode not in accept:
        said = done.stderr.strip() or done.stdout.strip() or f"exit code {done.returncode}"
        raise PipelineError("\n".join([*_left_out(done.stdout), said]), done.returncode)
    return done.stdout, done.stderr


def _left_out(out: str) -> list[str]:
    """What a run that was refused says with `--json` of what it left out, in words."""
    try:
        outcome = json.loads(out)
    except ValueError:
        return []
    logs = [f"log {log['log']} of session {log['session']}: {log['reason']}" for log in outcome.get("rejected_logs", [])]
    sessions = [f"session {session['session']}: {session['reason']}" for session in outcome.get("rejected_sessions", [])]
    return [f"left out: {words}" for words in [*logs, *sessions]]


def call_json(program: Path, arguments: Sequence[str], folder: Path, accept: Sequence[int] = (0,)) -> tuple[Any, str]:
    """The same with `--json`: the value, and what it said beside it."""
    out, said = call(program, [*arguments, "--json"], folder, accept)
    return json.loads(out), said
