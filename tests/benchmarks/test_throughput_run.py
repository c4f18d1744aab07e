"""The speedometer itself: tiny runs of everything it measures, on three box streets."""

import json
import pathlib
from typing import Any

import mujoco
import numpy as np
import pytest
from PIL import Image

from benchmarks import throughput
from benchmarks.lib import baselines, street_model
from benchmarks.lib.cases import Case
from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.envs import registry
from urbanverse_mjx.robots import make_coco
from urbanverse_mjx.simulation.parity import c_mujoco

TINY = ["--impl", "jax", "--num-envs", "4", "--steps", "3", "--repeats", "2", "--json"]


@pytest.fixture(scope="module")
def bank_file(small_bank: SceneBank, tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    path = tmp_path_factory.mktemp("bank") / "bank.npz"
    small_bank.save(path)
    return path


def run(capsys: pytest.CaptureFixture[str], *options: str) -> list[dict[str, Any]]:
    assert throughput.main([*TINY, *options]) == 0
    return [json.loads(line) for line in capsys.readouterr().out.splitlines()]


@pytest.mark.slow
def test_the_parts_of_a_step_add_up(
    bank_file: pathlib.Path, tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """With frames: one line, kept in the file as well, and a proof sheet of the four envs."""
    rows, proof = tmp_path / "rows.jsonl", tmp_path / "proof.png"
    options = ["--measure", "step,parts,refit,active", "--pixels", "8x12", "--bank", str(bank_file)]
    (result,) = run(capsys, *options, "--append", str(rows), "--proof", str(proof))
    assert [json.loads(line) for line in rows.read_text().splitlines()] == [result]
    assert Image.open(proof).size == (2 * 13 - 1, 2 * 9 - 1)
    assert (result["num_envs"], result["pixels"], result["impl"]) == (4, [8, 12], "jax")
    seconds, share = result["seconds_per_step"], result["share"]
    assert min(seconds[name] for name in ("physics", "render", "reset")) > 0
    together = sum(seconds[name] for name in ("physics", "render", "reset", "rest"))
    assert together == pytest.approx(seconds["total"], rel=1e-2)
    assert sum(share.values()) == pytest.approx(1.0, abs=4e-3)
    assert result["env_steps_per_s"] > 0
    assert result["parts"]["frames_per_s"] == pytest.approx(4 / seconds["render"], rel=1e-2)
    assert result["parts"]["physics_steps_per_s"] == pytest.approx(4 * 20 / seconds["physics"], rel=1e-2)
    assert result["refit"]["seconds_per_step"] > 0
    assert all(value > 0 for value in result["compile_s"].values())
    assert result["memory"]["peak_rss_mib"] > 100
    physics = result["physics_active"]
    ratio = physics["no_slots_physics_steps_per_s"] / physics["physics_steps_per_s"]
    assert physics["cost_ratio_to_no_slots"] == pytest.approx(ratio, rel=1e-2)
    # Robots that stand with hulls in reach and drive at the nearest are in contact for part of the time.
    assert physics["hulls_in_reach_at_start"] >= 1
    assert physics["share_of_envs_in_contact"] > 0


@pytest.mark.slow
def test_scenes_hulls_and_substeps_are_what_was_asked_for(
    bank_file: pathlib.Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Without frames, the policy alone."""
    options = ["--pixels", "none", "--bank", str(bank_file), "--measure", "policy", "--substeps", "40"]
    (found,) = run(capsys, *options, "--scenes", "1", "--hulls", "5")
    assert (found["scenes"], found["hulls"], found["physics_steps_per_env_step"]) == (1, 5, 40)
    assert found["pixels"] is None
    assert "env_steps_per_s" not in found
    assert found["policy"]["inference_s"] > 0
    assert found["policy"]["env_steps_per_s_with_policy"] > 0


@pytest.mark.slow
def test_learning_is_measured_through_the_products_training(
    bank_file: pathlib.Path, capsys: pytest.CaptureFixture[str]
) -> None:
    options = ["--pixels", "8x12", "--bank", str(bank_file), "--measure", "learn", "--iterations", "3"]
    sizes = {"unroll_length": 4, "minibatch": 8, "num_updates_per_batch": 1, "network.layers": [[4, 4, 4]]}
    settings = [part for key, value in sizes.items() for part in ("--ppo-set", f"{key}={json.dumps(value)}")]
    (result,) = run(capsys, *options, *settings)
    learn = result["learn"]
    assert (learn["steps"], learn["unroll_length"], learn["minibatch"]) == (48, 4, 8)
    assert learn["env_steps_per_s"] > 0
    assert 0 < learn["compile_s"] < learn["seconds"]


@pytest.mark.slow
def test_learning_in_stages_is_measured_stage_by_stage(
    bank_file: pathlib.Path, capsys: pytest.CaptureFixture[str]
) -> None:
    options = ["--preset", "best", "--pixels", "8x12", "--bank", str(bank_file), "--measure", "learn"]
    small = {"layers": [[4, 4, 4]], "memory": 4, "hidden": 8, "bfloat16": False}
    sizes = {"unroll_length": 4, "minibatches": 2, "finetune.minibatches": 2, "finetune.unroll_length": 4}
    sizes |= {f"network.{key}": value for key, value in small.items()}
    settings = [part for key, value in sizes.items() for part in ("--ppo-set", f"{key}={json.dumps(value)}")]
    (result,) = run(capsys, *options, *settings)
    learn = result["learn"]
    assert learn["compile_s"] > 0
    for stage in ("imitation", "finetune"):
        assert learn[stage]["steps"] == 4 * result["num_envs"]
        assert learn[stage]["env_steps_per_s"] > 0


@pytest.mark.extended
def test_what_fails_is_a_row_and_the_next_goes_on(bank_file: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    options = ["--pixels", "none", "--bank", str(bank_file), "--measure", "", "--scenes", "9,1"]
    assert throughput.main([*TINY, *options]) == 1
    captured = capsys.readouterr()
    first, second = (json.loads(line) for line in captured.out.splitlines())
    assert "needed 1 to 3" in first["error"]
    assert "error: --scenes: found 9" in captured.err
    assert "error" not in second
    assert (second["scenes"], second["pixels"]) == (1, None)


@pytest.fixture(scope="module")
def drive(small_bank: SceneBank) -> baselines.Drive:
    case = Case(impl="jax", num_envs=3, pixels="none", steps=4, repeats=1)
    env = registry.load("CocoNav", config_overrides=case.config_overrides(0.2), bank=small_bank)
    return baselines.make_drive(env, case)


def test_the_street_model_is_the_street(small_bank: SceneBank) -> None:
    """Every hull stands where the bank has it, and the robot's options are the ones it is simulated with."""
    model = street_model.street_model(small_bank, 1, make_coco(), 0.01, seen=True)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    ours = [g for g in range(model.ngeom) if model.geom_bodyid[g] == 0 and model.geom_contype[g]]
    rows = np.flatnonzero(small_bank.inst_hull[1] >= 0)
    prisms = np.flatnonzero(small_bank.prism_hull[1] >= 0)
    assert len(ours) == len(rows) + len(prisms)
    for geom, row in zip(ours, rows, strict=False):
        mesh = model.geom_dataid[geom]
        first, number = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
        corners = model.mesh_vert[first : first + number] @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]
        hull = small_bank.inst_hull[1, row]
        expected = small_bank.hull_vertices[hull, : small_bank.hull_num_vertices[hull]]
        expected = expected @ small_bank.inst_rotation[1, row].T + small_bank.inst_position[1, row]
        apart = np.linalg.norm(corners[:, None] - expected[None], axis=-1)
        assert apart.min(0).max() < 1e-4
        assert model.geom_friction[geom, 0] == pytest.approx(small_bank.inst_friction[1, row])
    assert model.opt.integrator == mujoco.mjtIntegrator.mjINT_EULER
    assert model.opt.timestep == 0.01
    seen = [g for g in range(model.ngeom) if model.geom_group[g] == 2 and model.geom_bodyid[g] == 0]
    assert len(seen) == (small_bank.slot_mesh[1] >= 0).sum()


def test_a_robot_drives_alike_in_the_street_model_and_in_the_compiled_scene(small_bank: SceneBank) -> None:
    """Against the scene's own MJCF, in C MuJoCo, over two seconds with hits: the same to a millimetre."""
    from tests.support.box_bank import box_scenes
    from urbanverse_mjx.scene.mjcf import scene_spec

    robot = make_coco()
    drives = c_mujoco.aimed_drives(small_bank, robot, 6, 10, 0.2, seed=0)
    expected = [c_mujoco.reference_model(scene_spec(s), robot) for s in box_scenes(3, seed=0)]
    models = [street_model.street_model(small_bank, i, robot, 0.01) for i in range(3)]
    for i, scene in enumerate(drives.scene):
        ends = []
        for model in (expected[scene], models[scene]):
            data = mujoco.MjData(model)
            data.qpos[:] = drives.qpos[i]
            for ctrl in drives.ctrl:
                data.ctrl[:] = ctrl[i]
                mujoco.mj_step(model, data, 20)
            ends.append(data.qpos.copy())
        assert np.abs(ends[0] - ends[1]).max() < 1e-3


def test_c_mujoco_rolls_out_on_all_cores(drive: baselines.Drive) -> None:
    row = baselines.c_mujoco(drive, repeats=1)
    assert row["physics_steps_per_s"] > 0
    assert "3 envs on" in row["does"]
    assert "frames_per_s" not in row


@pytest.mark.slow
def test_mujoco_warp_runs_without_jax(drive: baselines.Drive) -> None:
    row = baselines.direct_warp(drive, repeats=1)
    assert row["physics_steps_per_s"] > 0
    assert row["hulls"] == (drive.bank.inst_hull[0] >= 0).sum()


@pytest.mark.slow
def test_stock_mjx_runs_in_its_cut_scene(drive: baselines.Drive, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(baselines, "MJX_HULLS", 4)
    row = baselines.stock_mjx(drive, repeats=1)
    assert row["physics_steps_per_s"] > 0
    assert "cut to 4 hulls" in row["does"]
