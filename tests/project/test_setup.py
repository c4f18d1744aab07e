"""`.ci/setup` chooses an interpreter that works, or names in one sentence what to install."""

import os
import pathlib
import shutil
import subprocess
import sys
import venv

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


#: Stands in for pip: puts MuJoCo 4 into the folder that it is given, and fails where a file says so.
PIP = """
import pathlib, sys
asked = sys.argv[1:]
assert asked[:2] == ["install", "--no-deps"], asked
assert asked[-3:] == ["--require-hashes", "-r", "requirements-newer.lock"], asked
folder = pathlib.Path(asked[asked.index("--target") + 1])
(folder / "mujoco").mkdir()
(folder / "mujoco" / "__init__.py").write_text(
    "__path__ = __import__('pkgutil').extend_path(__path__, __name__)\\nversion = 4"
)
(folder / "mujoco-4.0.0.dist-info").mkdir()
(folder / "mujoco-4.0.0.dist-info" / "METADATA").write_text("Name: mujoco\\nVersion: 4.0.0")
sys.exit(pathlib.Path("fails").exists())
"""
ASK = """
import importlib.metadata, importlib.util, mujoco, mujoco_warp_pbr
print(mujoco.version, importlib.metadata.version("mujoco"), importlib.metadata.version("mujoco-warp-pbr"))
print(importlib.util.find_spec("mujoco.mjx"), [d.name for d in importlib.metadata.distributions()].count("mujoco-mjx"))
"""


@pytest.mark.parametrize("fails", [False, True])
def test_newer_engines_take_the_place_of_the_older_ones_alone(fails: bool, clone: pathlib.Path) -> None:
    """In an environment of their own that has all other packages. Neither the older MuJoCo is found there, though the
    newer one looks for parts of itself in every folder on the path, nor mujoco-mjx. Nothing is left of a failure."""
    (clone / "bin" / "ln").symlink_to(str(shutil.which("ln")))
    venv.create(clone / ".venv", symlinks=True)
    packages = next((clone / ".venv" / "lib").glob("python3*/site-packages"))
    texts = {
        "pip/__main__.py": PIP,
        "mujoco/__init__.py": "version = 3",
        "mujoco/mjx/__init__.py": "",
        "mujoco_warp_pbr/__init__.py": "",
        **{
            f"{name.replace('-', '_')}-{version}.dist-info/METADATA": f"Name: {name}\nVersion: {version}"
            for name, version in (("mujoco", "3.17.0"), ("mujoco-mjx", "3.17.0"), ("mujoco-warp-pbr", "0.2.0"))
        },
    }
    for name, text in texts.items():
        (packages / name).parent.mkdir(exist_ok=True)
        (packages / name).write_text(text)
    (clone / ".venv" / "newer" / "old").mkdir(parents=True)
    if fails:
        (clone / "fails").touch()
    done = setup(clone, "newer")
    assert done.returncode == int(fails), done.stdout + done.stderr
    assert (clone / ".venv" / "newer").exists() is not fails
    assert (clone / ".venv" / ".stamp-newer").exists() is not fails
    assert (packages / "mujoco" / "__init__.py").read_text() == "version = 3"
    if not fails:
        assert not (clone / ".venv" / "newer" / "old").exists()
        ask = [str(clone / ".venv" / "newer" / "bin" / "python"), "-c", ASK]
        answer = subprocess.run(ask, capture_output=True, text=True, check=True).stdout
        assert answer.split() == ["4", "4.0.0", "0.2.0", "None", "0"]
