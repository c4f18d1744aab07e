"""Small functions, locks that agree, and no path of a developer's machine."""

import json
import pathlib
import re
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).parents[2]


def function(arguments: str = "", body: str = "") -> str:
    return f"def planted({arguments}):\n{body}    return None\n"


#: Rule -> code that breaks it: too many paths, branches, arguments or statements.
LARGE = {
    "C901": function("a", "".join(f"    assert a != {k} or a == {k + 1}\n    for b in a: a = b\n" for k in range(12))),
    "PLR0912": function("a", "".join(f"    if a == {k}: a = 0\n" for k in range(13))),
    "PLR0913": function(", ".join(f"a{k}" for k in range(11))),
    "PLR0915": function("a", "    a += 1\n" * 51),
}


@pytest.mark.parametrize("rule", LARGE)
@pytest.mark.parametrize("folder", ["urbanverse_mjx/scene", "urbanverse_mjx/simulation", "benchmarks", "tests/scene"])
def test_large_functions_are_refused(rule: str, folder: str) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "ruff", "check", "--output-format=json", f"--stdin-filename={folder}/planted.py", "-"],
        input=LARGE[rule],
        capture_output=True,
        text=True,
        check=False,
        cwd=ROOT,
    )
    assert rule in {found["code"] for found in json.loads(done.stdout)}


def tracked() -> list[pathlib.Path]:
    done = subprocess.run(["git", "ls-files", "-z"], capture_output=True, text=True, check=False, cwd=ROOT)
    if done.returncode:
        pytest.skip("not a git checkout")
    return [ROOT / name for name in done.stdout.split("\0") if name and (ROOT / name).is_file()]


def test_no_path_of_a_machine_is_tracked() -> None:
    # Written in pieces, so that this file does not find itself.
    places = re.compile("|".join(["/" + "home/[a-z]", "/" + "root/", "/" + "Users/[a-z]", "/" + "work/[a-z]"]))
    found = []
    for path in tracked():
        if path.suffix in (".py", ".md", ".toml", ".json", ".csv", ".xml", ".lock", "") and path.stat().st_size < 10**6:
            text = path.read_text(encoding="utf-8", errors="ignore")
            found += [f"{path.name}: {match.group()}" for match in places.finditer(text)]
    assert not found


def test_locks_hold_hashes_and_no_address() -> None:
    locks = sorted(ROOT.glob("requirements*.lock"))
    assert len(locks) == 6
    for lock in locks:
        text = lock.read_text(encoding="utf-8")
        assert "://" not in text
        assert "index-url" not in text
        entries = re.split(r"\n(?=[a-z0-9])", text.strip())
        assert len(entries) > (3 if lock.name == "requirements-newer.lock" else 15)
        assert all("==" in entry and "--hash=sha256:" in entry for entry in entries)


def test_the_locks_agree_with_each_other() -> None:
    versions: dict[str, set[str]] = {}
    for lock in ROOT.glob("requirements*.lock"):
        if lock.name == "requirements-newer.lock":  # what it names is newer than in the others: that is its use
            continue
        for name, version in re.findall(r"^([a-z0-9-]+)==([^\s\\;]+)", lock.read_text(encoding="utf-8"), re.MULTILINE):
            # PyTorch's CUDA lies in a folder of its own, which JAX does not use.
            if not (lock.name == "requirements-torch.lock" and name.startswith(("nvidia-", "cuda-"))):
                versions.setdefault(name, set()).add(version)
    assert not {name: found for name, found in versions.items() if len(found) > 1}


def test_the_repository_stays_small() -> None:
    files = tracked()
    assert sum(path.stat().st_size for path in files) < 40 * 10**6
    # On a disk, in blocks of 4 KiB.
    assert sum(-(-path.stat().st_size // 4096) * 4096 for path in files) < 40 * 2**20
    assert all(path.stat().st_size <= 2 * 2**20 for path in files if path.suffix == ".mp4")
    assert sum(path.stat().st_size for path in files if path.suffix in (".mp4", ".gif")) <= 6 * 10**6
