"""`.ci/setup` chooses an interpreter that works, or names in one sentence what to install."""

import os
import pathlib
import shutil
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).parents[2]
TOOLS = ("bash", "awk", "cat", "cut", "dirname", "head", "rm", "tail", "touch")


@pytest.fixture
def clone(tmp_path: pathlib.Path) -> pathlib.Path:
    """A folder with the script, and a PATH folder `bin` with the tools it uses but no Python and no uv."""
    (tmp_path / ".ci").mkdir()
    shutil.copy2(ROOT / ".ci" / "setup", tmp_path / ".ci" / "setup")
    (tmp_path / "bin").mkdir()
    for tool in TOOLS:
        found = shutil.which(tool)
        assert found, tool
        (tmp_path / "bin" / tool).symlink_to(found)
    return tmp_path


def script(path: pathlib.Path, body: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!{shutil.which('bash')}\n{body}\n")
    path.chmod(0o755)


def setup(clone: pathlib.Path, what: str = "main") -> subprocess.CompletedProcess[str]:
    environment = {"PATH": str(clone / "bin"), "HOME": str(clone), "PYENV_ROOT": str(clone / "pyenv")}
    return subprocess.run(
        [str(clone / ".ci" / "setup"), what],
        capture_output=True,
        text=True,
        check=False,
        env=environment,
        timeout=120,
    )


def test_without_any_python_it_ends_with_one_sentence(clone: pathlib.Path) -> None:
    done = setup(clone)
    assert done.returncode == 1
    assert done.stderr == ""
    (line,) = done.stdout.splitlines()
    assert line.startswith("setup: no Python 3.12 or newer")
    assert "install uv, or Python 3.12 with its venv module" in line
    assert not (clone / ".venv").exists()


def test_shims_that_fail_and_old_pythons_are_passed_over(clone: pathlib.Path) -> None:
    script(clone / "bin" / "python3.12", "echo 'pyenv: python3.12: command not found' >&2; exit 127")
    old = 'if [ "$1" = -c ]; then exit 1; fi; echo "Python 3.8.18"'  # what `sys.version_info < (3, 12)` makes of it
    script(clone / "bin" / "python3", old)
    script(clone / "pyenv" / "versions" / "3.8.18" / "bin" / "python", old)
    good = clone / "pyenv" / "versions" / "3.12.1" / "bin" / "python"
    script(good, f'echo "$@" >>"{clone}/calls"; [ "$1" = -m ] && exit 5; [ "$1" = -c ]')
    done = setup(clone)
    # The valid interpreter is called to make the environment; it refuses here, so that no package is downloaded.
    assert done.returncode == 5
    assert (clone / "calls").read_text().splitlines()[-1] == "-m venv .venv"


def test_uv_is_preferred_and_a_failing_installation_shows_its_log(clone: pathlib.Path) -> None:
    script(
        clone / "bin" / "uv",
        f"""echo "$@" >>"{clone}/calls"
case "$1" in
  venv) mkdir -p .venv/bin; ln -s "{os.path.realpath(sys.executable)}" .venv/bin/python ;;
  --version) echo "uv 0.0.0" ;;
  pip) echo "no such wheel" >&2; exit 2 ;;
esac""",
    )
    for tool in ("mkdir", "ln"):
        (clone / "bin" / tool).symlink_to(str(shutil.which(tool)))
    done = setup(clone)
    assert done.returncode == 1
    assert "with uv 0.0.0" in done.stdout
    assert "no such wheel" in done.stdout
    assert "the whole log is in .venv/setup.log" in done.stdout
    calls = (clone / "calls").read_text()
    assert "pip install --python .venv/bin/python --no-deps --require-hashes -r requirements.lock" in calls
    assert not (clone / ".venv" / ".stamp-main").exists()


def with_free_disk(clone: pathlib.Path, kilobytes: int) -> None:
    script(clone / "bin" / "df", f'echo Filesystem; echo "disk 9 9 {kilobytes} 9% /"')
    (clone / "bin" / "mkdir").symlink_to(str(shutil.which("mkdir")))


@pytest.mark.parametrize("status", [0, 1])
def test_pytorch_is_put_beside_the_other_packages(status: int, clone: pathlib.Path) -> None:
    """Into a folder that only its own tests have on their path; nothing unpacked is left, nor an old version, nor half
    an installation."""
    with_free_disk(clone, 12_000_000)
    pip = f'echo "$TMPDIR" "$@" >>"{clone}/calls" && mkdir .venv/torch && exit {status}'
    body = f'[ "$1" = -m ] && {pip}; [ "$1" = -c ]'
    script(clone / ".venv" / "bin" / "python", body)
    (clone / ".venv" / "torch" / "old").mkdir(parents=True)
    done = setup(clone, "torch")
    assert done.returncode == status
    (call,) = (clone / "calls").read_text().splitlines()
    assert call.startswith(f"{clone}/.venv/unpacked -m pip install --no-deps ")
    assert call.endswith("--target .venv/torch --require-hashes -r requirements-torch.lock")
    assert not (clone / ".venv" / "torch" / "old").exists()
    assert not (clone / ".venv" / "unpacked").exists()
    assert (clone / ".venv" / "torch").exists() is (status == 0)
    assert (clone / ".venv" / ".stamp-torch").exists() is (status == 0)


def test_pytorch_is_not_begun_on_a_disk_that_it_would_fill(clone: pathlib.Path) -> None:
    with_free_disk(clone, 11_900_000)
    script(clone / ".venv" / "bin" / "python", f'[ "$1" = -m ] && echo "$@" >>"{clone}/calls"; [ "$1" = -c ]')
    done = setup(clone, "torch")
    assert done.returncode == 1
    assert "found 11 GB free on the disk, needed 12 to install PyTorch" in done.stderr
    assert not (clone / "calls").exists()
