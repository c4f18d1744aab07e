"""A policy that was cut off or changed is never used; a run goes back to the policy before it."""

import hashlib
import json
import pathlib
import shutil

import jax
import numpy as np
import pytest
from ml_collections import ConfigDict

from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.training import run
from urbanverse_mjx.training.policy import PolicySpec, latest_policy, load_params, save_policy
from urbanverse_mjx.training.policy_files import SEAL, content_sha256
from urbanverse_mjx.training.record import RunRecord

SHIPPED = pathlib.Path(__file__).parents[2] / "benchmarks" / "policies" / "go2_best"


def spec(steps: int) -> PolicySpec:
    return PolicySpec(
        environment="CocoNav", env_config={"limit": 0.1, "sizes": (1, 2)}, ppo_config={"seed": 0, "rates": {"a": 1e-4}},
        observations={"goal": [2]}, action_size=2, scene_ids=["street"], bank_hashes={}, steps=steps, versions={},
    )  # fmt: skip


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    """A run folder with policies of 100 and 200 steps."""
    from brax.training.acme import running_statistics, specs

    folder = tmp_path_factory.mktemp("run")
    normaliser = running_statistics.init_state(specs.Array((2,), np.dtype("float32")))
    for steps in (100, 200):
        layer = {"params": {"out": {"kernel": np.full((64, 64), float(steps), np.float32)}}}
        save_policy(folder / "checkpoints", (normaliser, layer, layer), spec(steps))
    return folder


@pytest.fixture
def folder(written: pathlib.Path, tmp_path: pathlib.Path) -> pathlib.Path:
    return shutil.copytree(written, tmp_path / "run")


def _files(policy: pathlib.Path) -> list[pathlib.Path]:
    return sorted(path for path in policy.rglob("*") if path.is_file())


def cut(path: pathlib.Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def flip(path: pathlib.Path) -> None:
    body = bytearray(path.read_bytes())
    body[len(body) // 2] ^= 4
    path.write_bytes(body)


def test_whole_policies_load_and_the_newest_is_taken(folder: pathlib.Path, capsys) -> None:
    newest = latest_policy(folder)
    assert newest.name == f"{200:012d}"
    assert load_params(newest)[1]["params"]["out"]["kernel"][0, 0] == 200.0
    assert PolicySpec.load(newest).steps == 200
    assert not capsys.readouterr().err


def test_a_policy_has_one_content_wherever_it_lies(written: pathlib.Path, folder: pathlib.Path) -> None:
    older, newer = (written / "checkpoints" / f"{steps:012d}" for steps in (100, 200))
    assert content_sha256(older) != content_sha256(newer)
    copy = folder / "checkpoints" / newer.name
    (copy / "notes.txt").write_text("not a part of it")
    assert content_sha256(copy) == content_sha256(newer)


def test_every_file_of_an_older_policy_is_its_content(folder: pathlib.Path) -> None:
    """Without checksums in its `policy.json`, which is the same after each change."""
    policy = folder / "checkpoints" / f"{200:012d}"
    body = json.loads((policy / "policy.json").read_text())
    (policy / "policy.json").write_text(json.dumps({name: x for name, x in body.items() if name not in SEAL}))
    found = {content_sha256(policy)}
    others = [path for path in _files(policy) if path.name != "policy.json" and path.stat().st_size]
    for path in others:
        flip(path)
        found.add(content_sha256(policy))
    assert len(others) > 1
    assert len(found) == 1 + len(others)


@pytest.mark.parametrize("damage", [cut, flip, pathlib.Path.unlink])
def test_every_damaged_file_is_noticed_and_the_policy_before_is_taken(folder: pathlib.Path, capsys, damage) -> None:
    newest = folder / "checkpoints" / f"{200:012d}"
    for path in _files(newest):
        if damage is pathlib.Path.unlink and path.name == "policy.json":
            continue  # without it a checkpoint was never finished
        if not path.stat().st_size:
            continue
        whole = path.read_bytes()
        damage(path)
        found = latest_policy(folder)
        assert found.name == f"{100:012d}", path
        said = capsys.readouterr().err
        assert said.count("\n") == 1
        assert str(path) in said
        assert "taking the one before it" in said
        assert load_params(found)[1]["params"]["out"]["kernel"][0, 0] == 100.0
        with pytest.raises(ValidationError) as caught:
            latest_policy(newest)
        assert str(path) in str(caught.value)
        path.write_bytes(whole)
    assert latest_policy(folder) == newest


def test_a_resumed_run_goes_on_from_the_checkpoint_before_a_damaged_one(
    folder: pathlib.Path, monkeypatch: pytest.MonkeyPatch, capsys
) -> None:
    monkeypatch.setattr(run, "check_scenes", lambda trained, env: None)
    assert run._start_of(folder, True, None)[0] == 200
    cut(max(_files(folder / "checkpoints" / f"{200:012d}"), key=lambda path: path.stat().st_size))
    steps, params = run._start_of(folder, True, None)
    assert steps == 100
    assert params[1]["params"]["out"]["kernel"][0, 0] == 100.0
    assert "taking the one before it" in capsys.readouterr().err


def test_where_all_are_damaged_the_run_is_refused(folder: pathlib.Path) -> None:
    for policy in (folder / "checkpoints").iterdir():
        cut(policy / "policy.json")
    with pytest.raises(ValidationError, match="2 policies, all of them damaged"):
        latest_policy(folder)


def test_an_edited_number_in_policy_json_is_noticed(folder: pathlib.Path) -> None:
    path = folder / "checkpoints" / f"{200:012d}" / "policy.json"
    body = json.loads(path.read_text())
    path.write_text(json.dumps(body))
    assert latest_policy(path.parent) == path.parent, "blanks are no content"
    body["env_config"]["limit"] = 0.2
    path.write_text(json.dumps(body))
    with pytest.raises(ValidationError, match="checksum"):
        latest_policy(path.parent)


def test_policies_from_before_checksums_load_and_damage_is_one_sentence(folder: pathlib.Path) -> None:
    newest = folder / "checkpoints" / f"{200:012d}"
    body = json.loads((newest / "policy.json").read_text())
    (newest / "policy.json").write_text(json.dumps({k: x for k, x in body.items() if k not in ("files", "checksum")}))
    assert ConfigDict(PolicySpec.load(newest).env_config).limit == 0.1
    assert jax.tree.leaves(load_params(latest_policy(newest)))
    cut(max(_files(newest), key=lambda path: path.stat().st_size))
    with pytest.raises(ValidationError, match="parameters that cannot be read") as caught:
        load_params(latest_policy(newest))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("damage", [cut, flip])
def test_policies_with_longer_checksums_are_compared_too(tmp_path: pathlib.Path, damage) -> None:
    """Policies were sealed by the SHA-256 of each file before."""
    policy = shutil.copytree(SHIPPED, tmp_path / "policy")
    body = json.loads((policy / "policy.json").read_text())
    files = {name: hashlib.sha256((policy / name).read_bytes()).hexdigest() for name in body["files"]}
    body |= {"files": files}
    del body["checksum"]
    body["checksum"] = hashlib.sha256(json.dumps(body, sort_keys=True).encode()).hexdigest()
    (policy / "policy.json").write_text(json.dumps(body))
    assert latest_policy(policy) == policy
    damage(policy / max(files, key=lambda name: (policy / name).stat().st_size))
    with pytest.raises(ValidationError, match="does not match its checksum"):
        latest_policy(policy)


@pytest.mark.parametrize(
    ("field", "wrong"),
    [
        *[(name, x) for name in ("env_config", "ppo_config", "observations", "versions") for x in (None, 3, [], "a")],
        *[("observations", {"goal": x}) for x in (None, 2, ["a"], [0], [-1], [1.5], [10**9], [1] * 9)],
        *[("action_size", x) for x in (None, "2", 0, 2.5, True, 10**12)],
        *[("steps", -1), ("environment", 3), ("scene_ids", "street"), ("scene_ids", [3])],
    ],
)
def test_a_policy_json_with_other_types_is_one_sentence(folder: pathlib.Path, field: str, wrong: object) -> None:
    """Also without checksums, as older policies and those written by hand are."""
    newest = folder / "checkpoints" / f"{200:012d}"
    body = json.loads((newest / "policy.json").read_text()) | {field: wrong}
    (newest / "policy.json").write_text(json.dumps({k: x for k, x in body.items() if k not in ("files", "checksum")}))
    with pytest.raises(ValidationError, match=rf"policy\.json: {field}") as caught:
        PolicySpec.load(latest_policy(newest))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("field", "wrong"),
    [("env", None), ("ppo", None), ("ppo", [1, 2]), ("segments", 3), ("segments", ["a"]), ("environment", 5)],
)
def test_a_run_record_with_other_types_is_one_sentence(tmp_path: pathlib.Path, field: str, wrong: object) -> None:
    whole = {"environment": "CocoNav", "env": {"a": 1}, "ppo": {"num_timesteps": 9}, "segments": [{"from_steps": 0}]}
    (tmp_path / "config.json").write_text(json.dumps({**whole, field: wrong}))
    with pytest.raises(ValidationError, match=rf"run record\.{field}"):
        RunRecord.load(tmp_path)
