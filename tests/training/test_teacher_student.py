"""The three stages of the preset `best` as a run folder: exact when cut off, and the best of its policies is kept."""

import pathlib
import types
from typing import Any

import chex
import numpy as np
import pytest
from ml_collections import ConfigDict

from tests.support.cut_runs import killed_at
from tests.support.unicycle import unicycle_env
from tests.training.test_student import LAYERS, OVERRIDES, seeing_env
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs.navigation.ppo import ppo_config
from urbanverse_mjx.training import snapshot
from urbanverse_mjx.training.policy import PolicySpec, latest_policy, load_policy, load_student
from urbanverse_mjx.training.record import RunRecord
from urbanverse_mjx.training.run import TrainingResult
from urbanverse_mjx.training.student import Student
from urbanverse_mjx.training.teacher_student import TeacherStudent


def small_config() -> ConfigDict:
    config = ConfigDict(ppo_config("best").to_dict())
    config.update({"num_envs": 4, "unroll_length": 4, "epochs": 1, "minibatches": 2, "num_checkpoints": 3})
    config.update({"num_timesteps": 3 * 48, "shares": {"teacher": 1.0, "imitation": 1.0, "finetune": 1.0}})
    config.network.update({"layers": LAYERS, "hidden": 16, "memory": 8})
    config.teacher.update({"unroll_length": 4, "minibatches": 2, "num_updates_per_batch": 1})
    config.teacher.network.hidden = (8, 8, 8)
    config.finetune.update({"unroll_length": 4, "epochs": 1, "minibatches": 2, "critic_only": 0})
    config.finetune.update({"map_layers": ((4, 4, 4),), "critic_hidden": (8, 8, 8)})
    return config


def by_last_bias(student: Student) -> Any:
    """A stand-in for success rates: some function of the parameters that training changes."""
    del student
    return lambda params: {"validation": float(np.square(np.asarray(params["params"]["action"]["bias"])).sum())}


def training(bank: SceneBank, folder: pathlib.Path, **options: Any) -> TeacherStudent:
    env = seeing_env(bank)
    return TeacherStudent(
        "CocoNav",
        env,
        lambda: unicycle_env(bank, {**OVERRIDES, "vision": False}),
        small_config(),
        folder,
        quiet=True,
        **options,
    )


@pytest.fixture(scope="module")
def whole(
    small_bank: SceneBank, tmp_path_factory: pytest.TempPathFactory
) -> tuple[pathlib.Path, TrainingResult, list[str]]:
    """An undisturbed run: its folder, its result and what it said."""
    folder, said = tmp_path_factory.mktemp("whole") / "run", list[str]()
    return folder, training(small_bank, folder).train(False, said.append), said


@pytest.mark.extended
def test_three_stages_make_one_policy_with_a_camera(whole: Any, small_bank: SceneBank, tmp_path: pathlib.Path) -> None:
    folder, result, said = whole
    assert [line.split(":")[0] for line in said] == [f"stage {k} of 3" for k in (1, 2, 3)]
    steps = {
        path.parent.relative_to(folder): PolicySpec.load(path.parent).steps for path in folder.glob("**/policy.json")
    }
    assert len(set(steps.values())) == len(steps) == 9, "no number belongs to two policies"
    assert result.policy == latest_policy(folder) == folder / "checkpoints" / f"{3 * 48:012d}"
    assert result.steps == 3 * 48
    policy, spec = load_policy(folder)
    assert (spec.env_config["vision"], policy.first_memory().shape) == (True, (8,))
    assert PolicySpec.load(latest_policy(folder / "teacher")).env_config["vision"] is False

    with pytest.raises(ValidationError, match="found a complete run"):
        training(small_bank, folder).train(True)
    with pytest.raises(ValidationError, match="needed a new folder"):
        training(small_bank, folder).train(False)
    # The teacher is no student: other layers.
    with pytest.raises(ValidationError, match="--start-from: found layers of other shapes"):
        training(small_bank, tmp_path / "other", start_from=folder / "teacher").train(False)
    assert not (tmp_path / "other" / "teacher").exists()


@pytest.mark.extended
def test_a_teacher_trained_alone_is_the_first_stage_of_the_run(
    whole: Any, small_bank: SceneBank, tmp_path: pathlib.Path
) -> None:
    alone = training(small_bank, tmp_path / "run").train_teacher()
    assert alone == latest_policy(tmp_path / "run")
    assert not (tmp_path / "run" / "imitation").exists()
    said = list[str]()
    result = training(small_bank, tmp_path / "run").train(True, said.append)
    assert [line.split(":")[0] for line in said] == ["stage 2 of 3", "stage 3 of 3"]
    assert result.policy is not None
    chex.assert_trees_all_equal(load_student(result.policy), load_student(whole[1].policy))
    assert [part["from_steps"] for part in RunRecord.load(tmp_path / "run").segments] == [0, 48]


def test_minibatches_of_every_stage_are_checked_before_the_teacher_is_trained(
    small_bank: SceneBank, tmp_path: pathlib.Path
) -> None:
    for section in ("teacher", "finetune"):
        run = training(small_bank, tmp_path / "run")
        run.config[section].minibatches = 3
        with pytest.raises(ValidationError, match="found 4, needed a multiple of 1 device x 6 minibatches"):
            run.train(False)
        assert not (tmp_path / "run").exists()


def test_each_stage_has_its_share_of_the_steps(tmp_path: pathlib.Path) -> None:
    config = ConfigDict(ppo_config("best").to_dict())
    config.num_timesteps, config.seed = 6_800_000, 7
    run = TeacherStudent("CocoNav", None, lambda: None, config, tmp_path)
    assert [run.steps(stage) for stage in ("teacher", "imitation", "finetune")] == [1_200_000, 2_600_000, 3_000_000]
    teacher = run.teacher_config()
    assert (teacher.num_timesteps, teacher.num_envs, teacher.seed) == (1_200_000, 4096, 7)
    assert teacher.minibatch == 4096 * 32 // 8


def test_a_stage_counts_on_from_the_steps_before_and_is_validated_if_that_is_asked_for(tmp_path: pathlib.Path) -> None:
    config = ConfigDict(ppo_config("best").to_dict())
    config.num_timesteps, config.num_checkpoints = 6_800_000, 5
    learner = types.SimpleNamespace(student="student", steps_per_iteration=1000)
    judged = []

    def validator(student: Any) -> Any:
        judged.append(student)
        return lambda params: {"validation": 1.0}

    for given in (None, validator):
        run = TeacherStudent("CocoNav", None, lambda: None, config, tmp_path, quiet=True, validator=given)
        stage = run._stage(learner, lambda: "first", tmp_path / "stage", "imitation", 1_200_000)
        assert (stage.iterations, stage.num_checkpoints, stage.steps_before) == (2600, 5, 1_200_000)
        assert (stage.learner, stage.begin(), stage.folder, stage.quiet) == (learner, "first", tmp_path / "stage", True)
        assert (stage.validate is None) == (given is None)
    assert judged == ["student"]
    assert stage.validate is not None
    assert stage.validate({}) == {"validation": 1.0}


@pytest.mark.slow
def test_a_run_that_was_cut_in_two_stages_ends_with_the_bytes_of_one_that_was_not(
    small_bank: SceneBank, tmp_path: pathlib.Path
) -> None:
    whole, cut = (training(small_bank, tmp_path / name, validator=by_last_bias) for name in ("whole", "cut"))
    whole.train(False)
    with killed_at(2, snapshot, "save_state"):
        cut.train(False)
    assert not (tmp_path / "cut" / "state.npz").exists(), "in the second stage"
    teacher = latest_policy(tmp_path / "cut" / "teacher")
    written = (teacher / "policy.json").stat().st_mtime_ns
    with killed_at(3, snapshot, "save_state"):
        cut.train(True)
    assert (tmp_path / "cut" / "state.npz").exists(), "in the third"
    cut.train(True)
    assert (teacher / "policy.json").stat().st_mtime_ns == written, "a complete teacher is kept"
    for name in ("state.npz", "imitation/state.npz", "validation.json", "imitation/validation.json", "complete.json"):
        assert (tmp_path / "cut" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes(), name
    assert len(RunRecord.load(tmp_path / "cut").segments) == 3


def test_only_a_resumed_training_starts_from_what_its_record_says(tmp_path: pathlib.Path) -> None:
    given = pathlib.Path("given")
    asked: Any = types.SimpleNamespace(start_from=given, folder=tmp_path)
    assert TeacherStudent._start_from(asked, resume=False) == given
    for said in ("recorded", None):
        record = types.SimpleNamespace(segments=[{"start_from": "first"}, {"start_from": said}])
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(RunRecord, "load", lambda folder, record=record: record)
            found = TeacherStudent._start_from(asked, resume=True)
        assert found == (None if said is None else pathlib.Path(said))
