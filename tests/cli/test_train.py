"""A resumed run keeps the settings of its record, refuses others, and its record lists all segments."""

import dataclasses
import json
import pathlib
import subprocess
import sys
import time
from typing import Any

import jax
import pytest
from brax.training.acme import running_statistics
from ml_collections import ConfigDict

from tests.support.unicycle import UnicycleEngine, unicycle_robot
from urbanverse_mjx.cli import train as cli_train
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs import NavEnv, registry
from urbanverse_mjx.pipeline import banks
from urbanverse_mjx.training import run as training_run
from urbanverse_mjx.training import tuning
from urbanverse_mjx.training.config import default_ppo_config
from urbanverse_mjx.training.devices import Devices
from urbanverse_mjx.training.policy import PolicySpec, latest_policy
from urbanverse_mjx.training.record import RunRecord

HIT = "reward_config.scales.hit"


class Trainer:
    """Stands in for Brax's `ppo`: keeps its arguments, saves one checkpoint, and is killed in its first call."""

    def __init__(self) -> None:
        self.calls: list[dict[str, Any]] = []

    def train(self, **arguments: Any) -> None:
        self.calls.append(arguments)
        env = arguments["environment"]
        networks = arguments["network_factory"](env.observation_size, env.action_size)
        key = jax.random.PRNGKey(0)
        sizes = {name: jax.ShapeDtypeStruct(shape, "float32") for name, shape in env.observation_size.items()}
        params = (
            running_statistics.init_state(sizes),
            networks.policy_network.init(key),
            networks.value_network.init(key),
        )
        killed = len(self.calls) == 1
        arguments["policy_params_fn"](1000 if killed else arguments["num_timesteps"], None, params)
        if killed:
            raise KeyboardInterrupt


class Session:
    """`urbanverse train` on a kinematic engine and with `Trainer`, in a folder of its own."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, bank: SceneBank, folder: pathlib.Path):
        self.trainer, self.bank, self.folder = Trainer(), bank, folder
        self.loaded: list[str] = []
        monkeypatch.setattr(training_run, "load_ppo", lambda: self.trainer)
        monkeypatch.setattr(registry, "load", self.load)
        monkeypatch.setattr(banks, "ensure_default_bank", lambda **_: self.bank)

    def load(self, name: str, config: ConfigDict, bank: SceneBank) -> NavEnv:
        self.loaded.append(name)
        robot = unicycle_robot()
        return NavEnv(config, bank, robot, UnicycleEngine(robot, config.ctrl_dt), None)

    def train(self, *argv: str) -> None:
        cli_train.main([*argv, "--logdir", str(self.folder), "--num-episodes", "0", "--quiet"])

    def killed(self, *argv: str) -> pathlib.Path:
        """The folder of a run that was killed after 1,000 steps."""
        preset = [] if "--preset" in argv else ["--preset", "cpu"]
        with pytest.raises(KeyboardInterrupt):
            self.train(*argv, *preset)
        (folder,) = self.folder.iterdir()
        return folder


@pytest.fixture
def session(monkeypatch: pytest.MonkeyPatch, small_bank: SceneBank, tmp_path: pathlib.Path) -> Session:
    return Session(monkeypatch, small_bank, tmp_path)


def test_it_goes_on_with_the_seed_and_the_overrides_of_its_first_segment(session: Session) -> None:
    overrides = json.dumps({HIT: -77.0})
    folder = session.killed("--seed", "3", "--playground-config-overrides", overrides, "--num-envs", "32")
    first = RunRecord.load(folder)
    session.train("--resume", str(folder))
    call = session.trainer.calls[1]
    assert call["environment"].config.reward_config.scales.hit == -77.0
    assert (call["num_envs"], call["seed"]) == (32, 3 + 1000), (
        "another seed than the segment before, from that of the run"
    )
    total = default_ppo_config("cpu").num_timesteps
    assert call["num_timesteps"] == total - 1000
    again = RunRecord.load(folder)
    assert (again.environment, again.env, again.ppo) == (first.environment, first.env, first.ppo)
    assert again.ppo["seed"] == 3
    assert [s["from_steps"] for s in again.segments] == [0, 1000]
    assert again.segments[0] == first.segments[0]
    assert {"begun", "versions", "devices"} <= again.segments[1].keys()
    policy = PolicySpec.load(latest_policy(folder))
    assert (policy.steps, policy.env_config["reward_config"]["scales"]["hit"], policy.ppo_config["seed"]) == (
        total,
        -77.0,
        3,
    )


def test_an_interrupted_run_says_how_it_is_continued(
    session: Session, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    run = ["--preset", "cpu", "--num-episodes", "0", "--logdir", str(session.folder)]
    with pytest.raises(KeyboardInterrupt):
        cli_train.main(run)
    (folder,) = session.folder.iterdir()
    assert f"continue from the newest checkpoint: urbanverse train --resume {folder}\n" in capsys.readouterr().err

    def stopped(**_: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(session.trainer, "train", stopped)
    with pytest.raises(KeyboardInterrupt):
        cli_train.main([*run, "--suffix", "early"])
    assert "no checkpoint was written yet" in capsys.readouterr().err


def test_a_go2nav_run_stays_one(session: Session) -> None:
    folder = session.killed("--env-name", "Go2Nav", "--preset", "fast")
    session.train("--resume", str(folder))
    assert session.loaded == ["Go2Nav", "Go2Nav"]
    assert RunRecord.load(folder).environment == PolicySpec.load(latest_policy(folder)).environment == "Go2Nav"
    assert session.trainer.calls[1]["learning_rate"] == default_ppo_config("fast").learning_rate


@pytest.mark.parametrize(
    ("option", "value", "said"),
    [
        ("--env-name", "CocoNav", "environment 'CocoNav' where the run has 'Go2Nav'"),
        ("--preset", "cpu", "preset 'cpu' where the run has 'fast'"),
        ("--seed", "0", "ppo.seed 0 where the run has 3"),
        ("--num-envs", "64", "ppo.num_envs 64 where the run has 32"),
        ("--playground-config-overrides", json.dumps({HIT: -5.0}), f"env.{HIT} -5.0 where the run has -77.0"),
        ("--ppo-overrides", '{"learning_rate": 0.5}', "ppo.learning_rate 0.5 where the run has 0.0003"),
        ("--start-from", "elsewhere", "needed one of them"),
    ],
)
def test_what_differs_is_refused_and_nothing_changes(session: Session, option: str, value: str, said: str) -> None:
    own = ["--env-name", "Go2Nav", "--preset", "fast", "--seed", "3", "--num-envs", "32"]
    own += ["--playground-config-overrides", json.dumps({HIT: -77.0}), "--ppo-overrides", '{"minibatch": 1024}']
    folder = session.killed(*own)
    before = (folder / "config.json").read_bytes()
    with pytest.raises(ValidationError, match="--start-from") as error:
        session.train("--resume", str(folder), option, value)
    assert said in str(error.value)
    assert (folder / "config.json").read_bytes() == before
    assert len(session.trainer.calls) == 1
    # Options equal to the run's are accepted, and so is a longer training.
    session.train("--resume", str(folder), *own, "--num-timesteps", "30000000")
    assert session.trainer.calls[1]["num_timesteps"] == 30_000_000 - 1000
    record = RunRecord.load(folder)
    assert (record.ppo["num_timesteps"], record.segments[0]["num_timesteps"]) == (30_000_000, 20_971_520)


def test_other_scenes_are_refused(session: Session) -> None:
    folder = session.killed()
    ids = session.bank.scene_ids
    meta = {**session.bank.meta, "hashes": {**session.bank.meta.get("hashes", {}), ids[0]: "another layout"}}
    session.bank = dataclasses.replace(session.bank, meta=meta)
    with pytest.raises(ValidationError, match=f"scenes are not those of the run .first '{ids[0]}' of 1 "):
        session.train("--resume", str(folder))


def test_a_run_recorded_without_segments_goes_on(session: Session) -> None:
    folder = session.killed("--seed", "3")
    body = json.loads((folder / "config.json").read_text())
    del body["segments"]
    (folder / "config.json").write_text(json.dumps(body))
    session.train("--resume", str(folder))
    total = default_ppo_config("cpu").num_timesteps
    first, second = RunRecord.load(folder).segments
    assert first == {"from_steps": 0, "num_timesteps": total}
    assert (second["from_steps"], session.trainer.calls[1]["seed"]) == (1000, 1003)


def test_a_folder_that_is_no_run_stays_as_it_was(session: Session, tmp_path: pathlib.Path) -> None:
    with pytest.raises(ValidationError, match=r"found no config\.json"):
        session.train("--resume", str(tmp_path / "nowhere"))
    assert list(tmp_path.iterdir()) == []


def test_an_override_of_the_preset_picks_the_config_that_the_others_change(session: Session) -> None:
    session.killed("--playground-config-overrides", json.dumps({"preset": "paper", HIT: -7.0}))
    config = session.trainer.calls[0]["environment"].config
    assert (config.preset, config.reward_config.scales.hit, config.reward_config.scales.arrived) == (
        "paper",
        -7.0,
        2000.0,
    )
    assert config.vision_config.height == 135


def test_trainings_of_one_second_have_folders_of_their_own(session: Session, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(time, "strftime", lambda form: "20260101-000000")
    first = session.killed("--seed", "3")
    session.train("--preset", "cpu", "--seed", "4")
    assert [p.name for p in sorted(session.folder.iterdir())] == [first.name, f"{first.name}-2"]
    seeds = [RunRecord.load(folder).ppo["seed"] for folder in sorted(session.folder.iterdir())]
    assert seeds == [3, 4]


def test_a_run_that_another_process_is_at_is_refused(session: Session) -> None:
    folder = session.killed()
    code = (
        "import pathlib, sys; from urbanverse_mjx.training.run_folder import at_work\n"
        "with at_work(pathlib.Path(sys.argv[1])): print('in', flush=True); sys.stdin.read()"
    )
    other = subprocess.Popen(
        [sys.executable, "-c", code, str(folder)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert other.stdout is not None
    assert other.stdout.readline() == "in\n"
    before = (folder / "config.json").read_bytes()
    with pytest.raises(ValidationError, match=f"process {other.pid} at work"):
        session.train("--resume", str(folder))
    assert (folder / "config.json").read_bytes() == before
    assert len(session.trainer.calls) == 1
    other.kill()
    other.wait()
    half = folder / "checkpoints" / "000000002000.orbax-checkpoint-tmp-17"
    half.mkdir()
    (half / "_METADATA").touch()
    session.train("--resume", str(folder))
    assert not half.exists(), "what a killed process left half written"


def test_a_bank_without_test_streets_is_refused_before_the_training(session: Session) -> None:
    """`scene library urbanverse160` and `scene join` make such banks; the evaluation at the end would fail."""
    meta = {**session.bank.meta, "splits": ["train", "validation", "validation"][: session.bank.num_scenes]}
    session.bank = dataclasses.replace(session.bank, meta=meta)
    asked = ["--preset", "cpu", "--logdir", str(session.folder), "--quiet"]
    with pytest.raises(ValidationError, match="scenes of the split train, validation alone, needed some of the split"):
        cli_train.main([*asked, "--num-episodes", "4"])
    assert session.trainer.calls == []
    assert list(session.folder.iterdir()) == []
    session.killed()
    assert len(session.trainer.calls) == 1, "without an evaluation it is trained"


def test_episodes_drawn_by_success_rates_are_refused_on_several_devices_before_the_training(
    session: Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn = ("--playground-config-overrides", '{"schedule.learnable": 0.5}')
    monkeypatch.setattr(Devices, "every", staticmethod(lambda: Devices(tuple(jax.devices()[:1]) * 2)))
    for asked in (["--preset", "cpu"], ["--preset", "tune", "--start-from", "policy"]):
        with pytest.raises(ValidationError, match="found it together with 2 devices, needed one device"):
            session.train(*asked, *drawn)
    assert session.trainer.calls == []
    assert list(session.folder.iterdir()) == []


def test_a_run_that_fails_before_it_begins_leaves_no_folder(session: Session) -> None:
    with pytest.raises(ValidationError, match="no such file"):
        session.train("--preset", "cpu", "--bank", str(session.folder / "nowhere.npz"))
    assert list(session.folder.iterdir()) == []


def test_tune_goes_on_from_a_policy_on_all_scenes_of_the_bank(
    session: Session, monkeypatch: pytest.MonkeyPatch, tmp_path: pathlib.Path
) -> None:
    with pytest.raises(ValidationError, match="preset 'tune': found no --start-from, needed the policy that goes on"):
        session.train("--preset", "tune")
    assert list(session.folder.iterdir()) == []
    calls: list[tuple[Any, ...]] = []

    def tune(*given: Any) -> training_run.TrainingResult:
        calls.append(given)
        return training_run.TrainingResult(None, 9, 1.0, 2.0)

    monkeypatch.setattr(tuning, "tune", tune)
    session.train("--preset", "tune", "--start-from", "policy", "--num-envs", "64", "--seed", "7")
    ((name, env, config, folder, start, resume, quiet, validator),) = calls
    assert (name, start, resume, quiet) == ("CocoNav", pathlib.Path("policy"), False, True)
    assert len(env.scenes) == session.bank.num_scenes
    assert (config.num_envs, config.seed, config.finetune.imitation) == (64, 7, 0.0)
    assert folder.parent == session.folder
    assert validator is None, "the bank has no split 'validation'"
    with pytest.raises(ValidationError, match="'tune', which imitates nothing"):
        session.train("--preset", "tune", "--demonstrations", str(tmp_path))
    with pytest.raises(ValidationError, match="preset 'quick': found --start-from"):
        session.train("--preset", "quick", "--start-from", "policy")
