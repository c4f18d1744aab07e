"""The `urbanverse` command: its help, its errors and its exit status."""

import errno
import importlib
import io
import os
import pathlib
import subprocess
import sys
import types

import pytest

import urbanverse_mjx
from urbanverse_mjx.cli import main as cli
from urbanverse_mjx.cli import packages
from urbanverse_mjx.datatypes import ValidationError


def run(*argv: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "urbanverse_mjx.cli.main", *argv]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_help_lists_every_command_with_a_line() -> None:
    done = run("--help")
    assert done.returncode == 0
    for name, (_, line) in cli.COMMANDS.items():
        assert f"  {name:<14} {line}" in done.stdout


def test_environments_are_listed_with_what_their_robots_do(capsys: pytest.CaptureFixture[str]) -> None:
    from urbanverse_mjx.cli import list_envs
    from urbanverse_mjx.envs import registry

    assert list_envs.main([]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == len(registry.all_envs())
    (line,) = [x for x in lines if x.startswith("CocoSocialNav  ")]
    assert "dense crowd" in line
    assert line.endswith("(presets: paper, urbansim_v0_1, fast, best, tune, cpu, quick)")
    assert all(registry.about(x.split()[0]) in x for x in lines)


def test_no_command_prints_the_usage_and_fails() -> None:
    done = run()
    assert done.returncode == 2
    assert done.stdout.startswith("usage: urbanverse")


def test_version() -> None:
    done = run("--version")
    assert (done.returncode, done.stdout) == (0, f"urbanverse {urbanverse_mjx.__version__}\n")


@pytest.mark.parametrize(("typed", "meant"), [("trian", "train"), ("sceen", "scene"), ("listenvs", "list-envs")])
def test_unknown_command_suggests_the_nearest(typed: str, meant: str) -> None:
    done = run(typed)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.startswith(f"error: unknown command {typed!r}; did you mean {meant}")


def test_a_command_like_nothing_lists_what_is_known() -> None:
    assert "known are train, " in run("xyzzy").stderr


@pytest.fixture
def command(monkeypatch: pytest.MonkeyPatch):
    """Installs a command whose body is the given function."""

    def put(body) -> None:
        module = types.ModuleType("urbanverse_mjx.cli.probe")
        module.main = body  # pyright: ignore[reportAttributeAccessIssue]
        monkeypatch.setitem(sys.modules, module.__name__, module)
        monkeypatch.setitem(cli.COMMANDS, "probe", ("probe", "for this test"))

    return put


def test_what_is_not_installed_is_named_before_the_command_begins(command, monkeypatch, capsys) -> None:
    command(lambda argv: pytest.fail("the command ran"))
    monkeypatch.setattr(packages, "declared", lambda: ["numpy>=2.0", "no-such-package==1.0", "no_other>=2 ; extra"])
    assert cli.main(["probe"]) == 2
    said = capsys.readouterr().err
    assert said.startswith("error: found no package no-such-package, no_other, needed them; run `make setup`")
    assert said.count("\n") == 1


def test_a_machine_with_a_bank_trains_without_what_makes_scenes(command, monkeypatch) -> None:
    ran = []
    command(lambda argv: ran.append(argv))
    monkeypatch.setattr(cli, "missing", lambda: ["coacd", "usd-core"])
    assert cli.main(["probe"]) == 2
    monkeypatch.setattr(cli, "ON_A_BANK", frozenset({"probe"}))
    assert cli.main(["probe"]) == 0
    assert ran == [[]]
    monkeypatch.setattr(cli, "missing", lambda: ["coacd", "jax"])
    assert cli.main(["probe"]) == 2
    assert cli.ON_A_BANK != set(cli.COMMANDS)


def test_commands_that_run_no_policy_need_no_mjx(command, monkeypatch) -> None:
    command(lambda argv: None)
    monkeypatch.setattr(cli, "missing", lambda: ["mujoco-mjx"])
    assert cli.main(["probe"]) == 2
    monkeypatch.setattr(cli, "WITHOUT_MJX", frozenset({"probe"}))
    assert cli.main(["probe"]) == 0
    monkeypatch.setattr(cli, "missing", lambda: ["mujoco-mjx", "jax"])
    assert cli.main(["probe"]) == 2


def test_what_is_declared_is_what_the_project_file_lists_and_is_installed() -> None:
    names = list(map(packages.name_of, packages.declared()))
    assert {"coacd", "opencv-python-headless", "mujoco", "jax"} <= set(names)
    assert "ray" not in names
    assert packages.missing() == []


def raiser(error: BaseException, module: str):
    """A function that raises `error` as if its code stood in `module`."""
    space = {"__name__": module, "error": error}
    exec("def body(argv):\n    raise error", space)
    return space["body"]


@pytest.mark.parametrize(
    ("error", "module", "status", "said"),
    [
        (ValidationError("graph.size: found -1, needed more."), "elsewhere", 2, "error: graph.size: found -1"),
        (ValueError("two\nlines"), "urbanverse_mjx.scene.compile", 2, "error: two lines\n"),
        (FileNotFoundError(2, "No such file or directory", "a.json"), "elsewhere", 2, "error: a.json: No such file"),
        (ModuleNotFoundError("no", name="coacd"), "urbanverse_mjx.assets", 2, "error: the package 'coacd' is not"),
        (
            OSError(errno.ENOSPC, "-", "/a.npz"),
            "numpy.lib",
            2,
            "error: /a.npz: found the error 'No space left on device'",
        ),
        (OSError(errno.ENOSPC, "-"), "zipfile", 2, "error: found the error 'No space left on device'; free space"),
        (OSError(errno.EDQUOT, "-", "/a.npz"), "zipfile", 2, "error: /a.npz: found the error 'Disk quota exceeded'"),
        (OSError(errno.EROFS, "-", "/a"), "tempfile", 2, "error: /a: found the error 'Read-only file system'; write"),
        (OSError(errno.EMFILE, "-", "/a"), "pathlib", 2, "error: /a: found the error 'Too many open files'; raise"),
        (KeyboardInterrupt(), "urbanverse_mjx.training", 130, "interrupted"),
    ],
)
def test_errors_become_one_sentence_and_a_status(error, module, status, said, command, capsys) -> None:
    command(raiser(error, module))
    assert cli.main(["probe"]) == status
    captured = capsys.readouterr()
    assert captured.err.startswith(said)
    assert captured.err.count("\n") == 1
    assert captured.out == ""


@pytest.mark.parametrize(
    "error", [ValueError("in a library"), ModuleNotFoundError("no", name="urbanverse_mjx.gone"), KeyError("bug")]
)
def test_bugs_keep_their_traceback(error: Exception, command) -> None:
    command(raiser(error, "numpy.core"))
    with pytest.raises(type(error)):
        cli.main(["probe"])


def test_the_command_gets_its_arguments_and_its_status_is_returned(command) -> None:
    seen = []
    command(lambda argv: seen.append(argv) or 7)
    assert cli.main(["probe", "--a", "b"]) == 7
    assert seen == [["--a", "b"]]


def test_a_reader_that_goes_away_is_no_traceback() -> None:
    code = (
        "import sys; from urbanverse_mjx.cli import main as m; m.usage = lambda: 'x' * 10**6; sys.exit(m.main(['-h']))"
    )
    line = f'"{sys.executable}" -c "{code}" | head -c 10'
    done = subprocess.run(["bash", "-c", line], capture_output=True, text=True, check=False)
    assert done.stdout == "x" * 10
    assert "Traceback" not in done.stderr


def test_text_that_the_terminal_does_not_have_is_escaped(command, monkeypatch: pytest.MonkeyPatch) -> None:
    """A street of a city with an umlaut, and the bars of progress, on a terminal of plain ASCII."""
    command(lambda _: print("Zürich ━") or print("Łódź", file=sys.stderr))
    written = {}
    for name in ("stdout", "stderr"):
        written[name] = io.BytesIO()
        monkeypatch.setattr(sys, name, io.TextIOWrapper(written[name], encoding="ascii"))
    assert cli.main(["probe"]) == 0
    sys.stderr.flush()
    assert written["stdout"].getvalue() == b"Z\\xfcrich \\u2501\n"
    assert written["stderr"].getvalue() == b"\\u0141\\xf3d\\u017a\n"


@pytest.mark.skipif(os.name == "nt", reason="a folder in use cannot be removed")
@pytest.mark.parametrize("path", ["a/b.json", None])
def test_a_working_folder_that_was_removed_is_named(
    path: str | None, command, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, capsys
) -> None:
    (tmp_path / "gone").mkdir()
    monkeypatch.chdir(tmp_path / "gone")
    (tmp_path / "gone").rmdir()
    command(lambda _: os.getcwd() if path is None else pathlib.Path(path).read_text())
    assert cli.main(["probe"]) == 2
    assert capsys.readouterr().err.startswith("error: the working folder: found that it was removed, needed")


@pytest.mark.skipif(not pathlib.Path("/dev/full").exists(), reason="no device that is always full")
@pytest.mark.parametrize("size", [10, 10**6])
def test_output_that_finds_no_room_is_one_sentence(size: int) -> None:
    code = "import sys; from urbanverse_mjx.cli import main as m; m.usage = lambda: 'x' * int(sys.argv[1]); "
    command = [sys.executable, "-c", code + "sys.exit(m.main(['-h']))", str(size)]
    with open("/dev/full", "w") as full:
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 2
    assert (
        done.stderr == "error: standard output: found the error 'No space left on device'; free space on that disk.\n"
    )


def test_every_command_has_its_module() -> None:
    for module, line in cli.COMMANDS.values():
        assert callable(importlib.import_module(f"urbanverse_mjx.cli.{module}").main)
        assert line
