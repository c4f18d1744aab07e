"""`urbanverse <command>`: runs the command's module and converts errors to one sentence and an exit status.

Only the standard library is imported before a command is chosen, so `--help` is instant and `doctor` runs in a
broken environment. Exit status: 0 done, 1 the command found a problem or a bug was hit, 2 wrong use or wrong input
(one sentence on stderr), 130 interrupted: work was lost or is unfinished. Ctrl-C is the normal end of a page that
serves, so `view` and `record --teleop` handle it themselves and end with 0.
"""

import difflib
import gc
import importlib
import io
import os
import pathlib
import sys
from collections.abc import Sequence
from typing import TextIO

from .. import __version__, settings
from ..pipeline.errors import refusal
from .compilation_cache import replace_damaged_entries
from .packages import MAKERS, ON_A_ROBOT, missing

#: Command -> (module below `urbanverse_mjx.cli`, one line for --help).
COMMANDS = {
    "train": ("train", "train a policy and evaluate it on held-out streets"),
    "evaluate": ("evaluate", "run a trained or scripted policy over fixed episodes and write a report"),
    "benchmark": ("benchmark", "score a policy on a frozen benchmark"),
    "view": ("view", "show streets and policies in a web page"),
    "play": ("play", "drive one episode and write it as a video"),
    "record": ("record", "record episodes of a policy as a dataset for LeRobot"),
    "dataset": ("dataset", "say what a recorded dataset holds, and whether it is sound"),
    "export-policy": ("export_policy", "write a trained policy without its critic, to be driven alone"),
    "export-onnx": ("export_onnx", "write a trained policy as an ONNX file, with how it is driven in its metadata"),
    "deploy": ("deploy", "drive a robot with a policy's ONNX file, over ROS 2 or ZeroMQ; replay its log"),
    "simulate-robot": ("simulate_robot", "play an environment as the robot of `deploy`"),
    "export-gait": ("export_gait", "write a trained gait as one small file"),
    "gen": ("gen", "digital cousins of a video: scene graph, assets, compiled scenes, report"),
    "scene": ("scene", "materialise and compile scene graphs, pack scenes into a bank"),
    "capture": ("capture", "film a street into a recording with its ground truth, and as a video"),
    "assets": ("assets", "show, search, match, import and export assets"),
    "study": ("study", "make and analyse a user study of scenes; compare layouts without people"),
    "robot": ("robot", "read a robot's description; how well spheres fit its collision shapes"),
    "schema": ("schema", "print the JSON Schema of scene graphs, layouts or messages to a robot"),
    "list-envs": ("list_envs", "list the registered environments and their presets"),
    "doctor": ("doctor", "say what this machine has and how to fix what is missing"),
}
#: Commands that need only a bank, not the libraries that make one.
ON_A_BANK = frozenset({"train", "evaluate", "benchmark", "export-policy", "export-gait", "list-envs", "simulate-robot"})
#: Commands that run no policy, and so neither Brax nor the MJX that it imports: MuJoCo 4 has no mujoco-mjx.
WITHOUT_MJX = frozenset({"assets", "gen", "list-envs", "robot", "scene", "schema", "study"})


def usage() -> str:
    """The text of --help."""
    lines = [f"  {name:<14} {line}" for name, (_, line) in COMMANDS.items()]
    return "\n".join(
        [
            "usage: urbanverse [--version] [--help] <command> ...",
            "",
            "commands:",
            *lines,
            "",
            "`urbanverse <command> --help` explains one command.",
        ]
    )


def main(argv: Sequence[str] | None = None) -> int:
    """Runs one command line (`sys.argv` by default) and returns the exit status."""
    cache = None
    for stream in (sys.stdout, sys.stderr):
        _print_any_text(stream)
    if argv is None:
        # Must run before JAX is imported.
        cache = settings.use_compilation_cache()
        # Imports and tracing make millions of long-lived objects; with the default thresholds, garbage collection takes
        # a tenth of a command's start-up time.
        gc.set_threshold(100_000, 20, 20)
    try:
        status = _choose(list(sys.argv[1:] if argv is None else argv), cache)
        sys.stdout.flush()
        return status
    except OSError as error:
        # The pipe's reader has exited, or the device of standard output is full; this prevents another error when
        # Python flushes at exit.
        sentence = "" if isinstance(error, BrokenPipeError) else refusal(error)
        if sentence is None:
            raise
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return _refuse(f"standard output: {sentence}") if sentence else 1


def _print_any_text(stream: TextIO) -> None:
    """Prints characters that the terminal's encoding does not have as escapes, in place of an error in the middle of a
    command: names of streets, and the bars of progress."""
    if isinstance(stream, io.TextIOWrapper) and stream.errors == "strict":
        stream.reconfigure(errors="backslashreplace")


def _choose(argv: list[str], cache: pathlib.Path | None) -> int:
    if not argv or argv[0] in ("-h", "--help", "help"):
        print(usage())
        return 0 if argv else 2
    if argv[0] in ("-V", "--version"):
        print(f"urbanverse {__version__}")
        return 0
    if argv[0] not in COMMANDS:
        near = difflib.get_close_matches(argv[0], COMMANDS, n=3, cutoff=0.5)
        hint = f"did you mean {' or '.join(near)}?" if near else "known are " + ", ".join(COMMANDS) + "."
        return _refuse(f"unknown command {argv[0]!r}; {hint}")
    return _run(argv[0], argv[1:], cache)


def _run(name: str, argv: list[str], cache: pathlib.Path | None) -> int:
    absent = [] if name == "doctor" else [p for p in missing() if _needs(name, p)]
    if absent:
        needed = "them; run `make setup`, or `urbanverse doctor` for the command of each"
        return _refuse(f"found no package {', '.join(absent)}, needed {needed}.")
    if cache is not None and name != "doctor":
        replace_damaged_entries(cache)
    try:
        command = importlib.import_module(f"urbanverse_mjx.cli.{COMMANDS[name][0]}")
        return int(command.main(argv) or 0)
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return 130
    except Exception as error:
        sentence = refusal(error)
        if sentence is None:
            raise
        return _refuse(sentence)


def _needs(name: str, package: str) -> bool:
    """Whether a command needs a package of the default installation."""
    if name == "deploy":
        return package in ON_A_ROBOT
    return not (name in ON_A_BANK and package in MAKERS) and not (name in WITHOUT_MJX and package == "mujoco-mjx")


def _refuse(sentence: str) -> int:
    print(f"error: {sentence}", file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(main())
