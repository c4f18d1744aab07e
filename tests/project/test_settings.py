"""Where data and caches lie, by the environment."""

import os
import pathlib
import subprocess
import sys

import pytest

from urbanverse_mjx import settings
from urbanverse_mjx.datatypes import ValidationError

ROOT = pathlib.Path(__file__).parents[2]
VARIABLES = (
    "XDG_CACHE_HOME",
    *(f"URBANVERSE_{name}" for name in ("CACHE", "ASSET_ROOT", "SCENE_ROOT", "BANK", "THREADS")),
    *(f"URBANVERSE_VISION_{name}" for name in ("URL", "KEY", "MODEL")),
    "JAX_COMPILATION_CACHE_DIR",
    "JAX_COMPILATION_CACHE_MAX_SIZE",
)


@pytest.fixture(autouse=True)
def clean_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in VARIABLES:
        monkeypatch.delenv(name, raising=False)


def test_cache_follows_own_variable_then_xdg_then_home(monkeypatch: pytest.MonkeyPatch, tmp_path: pathlib.Path) -> None:
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    assert settings.cache_dir() == tmp_path / "home" / ".cache" / "urbanverse_mjx"
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    assert settings.cache_dir("banks") == tmp_path / "xdg" / "urbanverse_mjx" / "banks"
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path / "own"))
    assert settings.cache_dir("a", "b") == tmp_path / "own" / "a" / "b"
    assert not (tmp_path / "own").exists(), "naming a cache must not create it"


@pytest.mark.extended
def test_what_one_process_compiles_the_next_one_finds(tmp_path: pathlib.Path) -> None:
    """As a command does: the folder is named before JAX is imported, and a user's own setting is kept."""
    code = "from urbanverse_mjx import settings; settings.use_compilation_cache(); import jax; "
    code += "jax.config.update('jax_persistent_cache_min_compile_time_secs', 0.0); "
    code += "jax.config.update('jax_persistent_cache_min_entry_size_bytes', 0); "
    code += "hits = []; jax.monitoring.register_event_listener(lambda name, **_: hits.append(name)); "
    code += "jax.jit(lambda x: x * 3.0 + 1.0)(2.0); print(sum('cache_hits' in name for name in hits))"

    def run(**own: str) -> str:
        environment = {**os.environ, "URBANVERSE_CACHE": str(tmp_path / "own"), **own}
        command = [sys.executable, "-c", code]
        return subprocess.run(command, env=environment, cwd=ROOT, check=True, capture_output=True, text=True).stdout

    assert run() == "0\n"
    assert any((tmp_path / "own" / "jax").iterdir())
    assert int(run()) > 0
    assert run(JAX_COMPILATION_CACHE_DIR=str(tmp_path / "other")) == "0\n"
    assert any((tmp_path / "other").iterdir())


def test_a_clone_finds_the_data_beside_the_package() -> None:
    assert settings.asset_root() == ROOT / "assets_index"
    assert settings.scene_root() == ROOT / "scenes"


@pytest.mark.parametrize(
    ("root", "variable"),
    [(settings.asset_root, "URBANVERSE_ASSET_ROOT"), (settings.scene_root, "URBANVERSE_SCENE_ROOT")],
)
def test_data_roots_can_be_moved_and_a_wrong_one_is_refused(root, variable, monkeypatch, tmp_path) -> None:
    monkeypatch.setenv(variable, str(tmp_path))
    assert root() == tmp_path
    monkeypatch.setenv(variable, str(tmp_path / "nowhere"))
    with pytest.raises(ValidationError, match=f"{variable}: found .*nowhere, needed an existing folder"):
        root()


def test_an_installed_package_finds_the_data_inside(monkeypatch: pytest.MonkeyPatch, tmp_path: pathlib.Path) -> None:
    package = tmp_path / "site-packages" / "urbanverse_mjx"
    (package / "_data" / "scenes").mkdir(parents=True)
    # A folder of the same name from another package in site-packages must not be used.
    (tmp_path / "site-packages" / "scenes").mkdir()
    monkeypatch.setattr(settings, "_PACKAGE", package)
    assert settings.scene_root() == package / "_data" / "scenes"
    with pytest.raises(ValidationError, match="URBANVERSE_ASSET_ROOT"):
        settings.asset_root()


def test_the_default_bank_is_named_by_its_sources(monkeypatch: pytest.MonkeyPatch, tmp_path: pathlib.Path) -> None:
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path / "cache"))
    scenes = tmp_path / "scenes"
    (scenes / "street").mkdir(parents=True)
    (scenes / "street" / "graph.json").write_text("{}")
    monkeypatch.setenv("URBANVERSE_SCENE_ROOT", str(scenes))
    first = settings.default_bank_path()
    assert first.parent == tmp_path / "cache" / "banks"
    (scenes / "street" / "picture.png").write_text("no part of the bank")
    assert settings.default_bank_path() == first
    (scenes / "street" / "graph.json").write_text("{ }")
    changed = settings.default_bank_path()
    assert changed != first
    (scenes / "street").rename(scenes / "avenue")
    assert settings.default_bank_path() not in (first, changed)
    monkeypatch.setenv("URBANVERSE_BANK", str(tmp_path / "my.npz"))
    assert settings.default_bank_path() == tmp_path / "my.npz"


def test_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    assert settings.num_threads() >= 1
    monkeypatch.setenv("URBANVERSE_THREADS", "3")
    assert settings.num_threads() == 3
    for wrong in ("0", "-1", "two", "1.5", "²", "99999"):
        monkeypatch.setenv("URBANVERSE_THREADS", wrong)
        with pytest.raises(ValidationError, match="URBANVERSE_THREADS"):
            settings.num_threads()


def test_a_vision_endpoint_only_where_one_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("URBANVERSE_VISION_KEY", "secret")
    assert settings.vision_endpoint() is None
    monkeypatch.setenv("URBANVERSE_VISION_URL", "http://127.0.0.1:8000/v1/")
    with pytest.raises(ValidationError, match="URBANVERSE_VISION_MODEL"):
        settings.vision_endpoint()
    monkeypatch.setenv("URBANVERSE_VISION_MODEL", "a-model")
    found = settings.vision_endpoint()
    assert found == settings.VisionEndpoint("http://127.0.0.1:8000/v1", "a-model", "secret")
    assert "secret" not in repr(found)
    monkeypatch.setenv("URBANVERSE_VISION_URL", "ftp://somewhere")
    with pytest.raises(ValidationError, match="URBANVERSE_VISION_URL"):
        settings.vision_endpoint()


def test_flags_of_xla_that_the_environment_has_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XLA_FLAGS", "--xla_gpu_autotune_level=3")
    settings.set_xla_flags({"xla_gpu_autotune_level": "0", "xla_gpu_enable_triton_gemm": "false"})
    assert os.environ["XLA_FLAGS"].split() == ["--xla_gpu_autotune_level=3", "--xla_gpu_enable_triton_gemm=false"]
    monkeypatch.delenv("XLA_FLAGS")
    settings.set_xla_flags({"xla_gpu_autotune_level": "1"})
    assert os.environ["XLA_FLAGS"] == "--xla_gpu_autotune_level=1"
