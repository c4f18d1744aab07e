"""Settings against the tables of docs/decisions that give each number and its source.

Whoever changes a default by mistake leaves the table as it was, and whoever changes it on purpose changes both.
"""

import json
import pathlib
import re
from typing import Any

import pytest

from urbanverse_mjx.envs import default_config, joystick_config, registry

DECISIONS = pathlib.Path(__file__).parents[2] / "docs" / "decisions"
_NUMBER = re.compile(r"(?<![\w.])-?\d+(?:,\d{3})*(?:\.\d+)?(?:e-?\d+)?")


def cells(page: str, row: str, column: int) -> str:
    """A cell of the first row of a table that begins with these words."""
    for line in (DECISIONS / page).read_text(encoding="utf-8").splitlines():
        parts = [part.strip() for part in line.split("|")[1:-1]]
        if parts and parts[0] == row:
            return parts[column]
    raise AssertionError(f"{page}: found no row {row!r}")


def numbers(text: str) -> list[float]:
    """Numbers in a text; `a-b` is a range of two, and 0.7-1.3 holds no negative one."""
    apart = re.sub(r"(?<=\d)-(?=\d)", " ", text)
    apart = re.sub(r"(\de) (\d)", r"\1-\2", apart)  # an exponent
    return [float(x.replace(",", "")) for x in _NUMBER.findall(apart)]


def test_numbers_of_cells_are_read() -> None:
    assert numbers("x 0.5-1.5, -1e-4 and -2.5e-7") == [0.5, 1.5, -1e-4, -2.5e-7]
    assert numbers("±1.0, 10 %, 8,192 envs, 3-8 s, Σ Δ²") == [1.0, 10.0, 8192.0, 3.0, 8.0]


def flat(values: Any) -> list[float]:
    return [float(x) for value in values for x in (value if isinstance(value, list | tuple) else (value,))]


#: Row of the table in go2.md -> the settings whose numbers it begins with; those in another unit or form follow below.
GAIT = {
    "action": ["action_scale"],
    "tracking rewards": ["scales.track_linear", "scales.track_angular"],
    "vertical speed, roll and pitch rate, tilt": ["scales.vertical_speed", "scales.roll_pitch_rate", "scales.tilt"],
    "torque, joint acceleration": ["scales.torque", "scales.acceleration"],
    "action rate": ["scales.action_rate"],
    "pose": ["scales.pose"],
    "standing still": ["scales.stand_still"],
    "foot clearance": ["scales.foot_clearance"],
    "foot slip": ["scales.foot_slip"],
    "air time": ["scales.air_time"],
    "joint speed": ["scales.joint_speed"],
    "contact of parts other than feet": ["scales.touch"],
    "trunk height": ["scales.trunk_height"],
    "friction, mass, stiffness": ["friction_scale", "mass_scale", "strength"],
    "encoders": ["joint_bias"],
    "pushes": ["push_speed", "push_turn", "push_every"],
}


@pytest.mark.parametrize(("row", "names"), GAIT.items())
def test_the_gait_is_trained_with_what_its_table_says(row: str, names: list[str]) -> None:
    config = joystick_config("fast")
    places = (config.reward_config, config.randomization, config)
    values = [next(place for place in places if name.split(".")[0] in place) for name in names]
    found = flat(
        place.to_dict()["scales"][n.split(".")[1]] if "." in n else place[n]
        for n, place in zip(names, values, strict=True)
    )
    assert numbers(cells("go2.md", row, 1))[: len(found)] == pytest.approx(found)


def test_the_gaits_settings_in_other_units_are_those_of_its_table() -> None:
    config = joystick_config("fast")
    assert numbers(cells("go2.md", "control, physics", 1)) == pytest.approx([1 / config.ctrl_dt, 1000 * config.sim_dt])
    command = config.command
    speeds = [command.linear_x[1], command.linear_y[1], command.angular[1]]
    shares = [100 * command.stand_share, 100 * command.forward_share]
    assert numbers(cells("go2.md", "commands", 1)) == pytest.approx([*speeds, *shares, *command.hold])
    for name in ("linear_x", "linear_y", "angular", "forward_angular"):
        assert command[name][0] == -command[name][1], name
    fall = config.reward_config.scales.fall * config.ctrl_dt
    assert numbers(cells("go2.md", "fall", 1)) == pytest.approx([fall])
    assert numbers(cells("go2.md", "episode", 1)) == pytest.approx([config.episode_length * config.ctrl_dt])
    tracking = numbers(cells("go2.md", "tracking rewards", 1))
    assert tracking[-1] == pytest.approx(config.reward_config.tracking_width)
    assert numbers(cells("go2.md", "trunk height", 1))[1] == pytest.approx(config.reward_config.trunk_height)
    # "-2.0 Σ max(0, 0.1 m - height) · speed"
    assert numbers(cells("go2.md", "foot clearance", 1))[2] == pytest.approx(config.reward_config.foot_clearance)


def test_the_gaits_training_is_that_of_its_page() -> None:
    page = " ".join((DECISIONS / "go2.md").read_text(encoding="utf-8").split())
    text = page.partition("PPO by Brax: ")[2].partition(": the settings of projects")[0]
    ppo = registry.get_ppo_config("Go2Joystick", "fast")
    minibatches = ppo.num_envs * ppo.unroll_length / ppo.minibatch
    expected = [ppo.num_envs, ppo.unroll_length, ppo.num_updates_per_batch, minibatches]
    expected += [ppo.learning_rate, ppo.max_learning_rate, ppo.desired_kl]
    expected += [ppo.discounting, ppo.gae_lambda, ppo.clipping_epsilon, ppo.entropy_cost]
    assert numbers(text) == pytest.approx(expected)
    networks = re.search(r"Actor 225-([\d-]+)-12 .*?critic ([\d-]+) on", page)
    assert networks is not None
    assert [tuple(int(x) for x in text.split("-")) for text in networks.groups()] == [
        ppo.network.actor_hidden,
        ppo.network.critic_hidden,
    ]


def test_social_streets_hold_twice_as_many_pedestrians_as_others() -> None:
    social, others = (registry.get_default_config(name).crowd for name in ("CocoSocialNav", "CocoNav"))
    assert social.slots.pedestrian == 2 * others.slots.pedestrian > 0
    assert set(social.filled.values()) == {1.0}


@pytest.mark.parametrize(("column", "preset"), [(1, "paper"), (2, "urbansim_v0_1"), (3, "cpu")])
def test_navigation_has_what_the_table_of_its_presets_says(column: int, preset: str) -> None:
    config = default_config(preset)
    scales = config.reward_config.scales

    def row(name: str) -> list[float]:
        text = cells("presets.md", name, column)
        return numbers(cells("presets.md", name, 1) if text == "as `paper`" else text)

    control = [1 / config.ctrl_dt, config.episode_length, config.episode_length * config.ctrl_dt]
    assert row("control, episode") == pytest.approx(control)
    assert row("physics step") == pytest.approx([1000 * config.sim_dt])
    size = re.search(r"(\d+)x(\d+)", cells("presets.md", "image", column))
    assert size is not None
    assert (int(size[1]), int(size[2])) == (config.vision_config.height, config.vision_config.width)
    assert row("arrived, hit") == pytest.approx([scales.arrived, scales.hit])
    assert row("position (5 m), position (1 m)") == pytest.approx([scales.position, scales.position_fine])
    assert row("velocity")[0] == pytest.approx(scales.velocity_cosine + scales.velocity_dot)
    assert row("progress towards the goal")[0] == pytest.approx(scales.progress)
    assert row("a hull nearer than 1 m (ours)")[-1] == pytest.approx(scales.near_object)
    assert row("success radius")[0] == pytest.approx(config.success_radius)
    off = row("off the traversable area")
    assert (off[-1] if off else 0.0) == pytest.approx(scales.off_traversable)
    assert config.terminate_off_traversable == ("ends" in cells("presets.md", "off the traversable area", column))
    assert config.reward_config.multiply_by_dt == ("times the step" in cells("presets.md", "arrived, hit", column))
    random = config.randomization
    varied = row("randomised per episode")
    if varied:
        assert varied == pytest.approx([*random.friction_scale, *random.mass_scale, 100 * random.appearance])
    else:
        assert (*random.friction_scale, *random.mass_scale, random.appearance) == (1.0, 1.0, 1.0, 1.0, 0.0)


def leaves(tree: dict[str, Any], above: str = "") -> dict[str, Any]:
    """Values by dotted name, as JSON has them."""
    found: dict[str, Any] = {}
    for name, value in json.loads(json.dumps(tree)).items():
        found |= leaves(value, f"{above}{name}.") if isinstance(value, dict) else {above + name: value}
    return found


#: What the commands of benchmarks/all_policies.sh change, or what those settings meant before.
COMMANDED = {
    *("friction", "impl", "scenes", "observations.privileged_map", "observations.proprio", "vision_config.height"),
    *("vision_config.width", "vision_config.light", "vision_config.shading", "randomization.friction_scale"),
    *(f"randomization.{n}" for n in ("appearance", "blur", "exposure", "latency", "pixel_noise", "white_balance")),
    *(f"randomization.camera_{n}" for n in ("angle", "fovy", "position")),
}


@pytest.mark.parametrize(("policy", "fields"), [("coco_best", 60), ("go2_best", 60), ("coco_paper", 40)])
def test_settings_are_those_with_which_the_shipped_policies_were_trained(policy: str, fields: int) -> None:
    folder = pathlib.Path(__file__).parents[2] / "benchmarks" / "policies" / policy
    record = json.loads((folder / "policy.json").read_text(encoding="utf-8"))
    environment, preset = record["environment"], record["env_config"]["preset"]
    theirs = leaves(record["env_config"])
    ours = leaves(registry.get_default_config(environment, preset).to_dict())
    names = (theirs.keys() & ours.keys()) - (COMMANDED if preset == "fast" else set())
    assert len(names) >= fields
    assert {n: ours[n] for n in names} == {n: theirs[n] for n in names}
    if preset == "paper":
        theirs, ours = leaves(record["ppo_config"]), leaves(registry.get_ppo_config(environment, preset).to_dict())
        changed = {"num_envs", "num_timesteps", "num_checkpoints"}
        assert {n: x for n, x in ours.items() if n not in changed} == {
            n: x for n, x in theirs.items() if n not in changed
        }


_ENCOUNTERS = ("head_on", "cross", "obstruct", "overtaken", "talk", "queue")
#: Task -> its section `task`, terms of reward beside those of `fast`, people and vehicles (pedestrians, wheelchairs,
#: scooters, cyclists, cars), and other settings. Pages of docs/tasks and sources in `tasks/config.py` say why.
TASKS: dict[str, tuple[dict[str, Any], dict[str, float], tuple[int, ...] | None, dict[str, Any]]] = {
    "SocialNav": (
        {"horizon": 3.0, "jerk_limit": 25.0},
        {"personal_space": -0.1, "time_to_collision": -0.1, "jerk": -0.02},
        (22, 1, 1, 0, 0),
        {"crowd.reach": 12.0, "success_radius": 1.0, "scenario": "dynamic", "movable.bodies": 0}
        | {f"crowd.encounters.{n}": x for n, x in zip(_ENCOUNTERS, (0.9, 0.8, 0.6, 0.6, 0.6, 0.5), strict=True)},
    ),
    "FollowPerson": (
        {
            "band": [1.5, 3.0],
            "start_distance": 2.2,
            "speed": [0.8, 1.34],
            "sight": 15.0,
            "lost_distance": 10.0,
            "lost_time": 8.0,
            "success_share": 0.5,
        },
        {
            "arrived": 0.0,
            "progress": 0.0,
            "hit": -10.0,
            "off_traversable": -10.0,
            "band": 0.05,
            "in_sight": 0.02,
            "kept": 0.05,
            "lost": -10.0,
        },
        (13, 1, 0, 1, 1),
        {"crowd.reach": 20.0, "success_radius": 0.0, "scenario": "dynamic", "movable.bodies": 0}
        | {f"crowd.encounters.{n}": 0.0 for n in _ENCOUNTERS},
    ),
    "FollowRoute": (
        {"length": 200.0, "cycle": 60.0, "walk": 20.0, "needs_crosswalk": True},
        {"progress": 0.0, "hit": -10.0, "off_traversable": -10.0, "route": 1.0, "violation": -40.0},
        (9, 1, 0, 1, 4),
        {"goal_mode": "waypoint", "goal_observation_limit": 0.0, "episode_length": 1800, "movable.bodies": 0}
        | {"scenario": "dynamic"},
    ),
    "ObjectGoal": (
        {"path_length": [8.0, 35.0], "success_distance": 1.0, "stop_time": 1.0},
        {"at_object": 0.1, "stopped": -5.0},
        None,
        {"scenario": "static", "success_radius": 0.0, "reward_config.multiply_by_dt": False},
    ),
    "Deliver": (
        {"posts": 8, "height": [0.9, 1.2], "distance": [2.0, 6.0], "force": 5.0, "hold_time": 0.2},
        {"near_object": 0.0, "reach": 2.0, "press": 0.2},
        None,
        {"robot": "coco_arm", "ctrl_dt": 0.1, "episode_length": 300, "scenario": "static", "success_radius": 0.0},
    ),
    "DropOff": (
        {"posts": 8, "height": [0.5, 0.85], "distance": [2.0, 6.0], "release_time": 0.4, "lie_time": 0.5},
        {"near_object": 0.0, "carry": 2.0, "open": 4.0, "spilt": -0.1, "dropped": -5.0},
        None,
        {"robot": "coco_parcel", "ctrl_dt": 0.1, "episode_length": 300, "scenario": "static", "success_radius": 0.0},
    ),
    "MultiRobot": (
        {"robots": 4, "route_length": [8.0, 30.0], "arrival_distance": 1.0, "deliveries": 1},
        {"arrived": 0.0, "progress": 0.0, "approach": 1.0, "delivered": 10.0},
        None,
        {"scenario": "static", "success_radius": 0.0, "randomization.clutter": 0, "ctrl_dt": 0.2},
    ),
}


@pytest.mark.parametrize("task", TASKS)
def test_tasks_have_their_settings(task: str) -> None:
    section, terms, people, others = TASKS[task]
    config = registry.get_default_config(f"Coco{task}")
    found = leaves(config.to_dict())
    assert {
        n.removeprefix("task."): x for n, x in found.items() if n.startswith("task.") and n != "task.name"
    } == section
    fast = default_config("fast").reward_config.scales.to_dict()
    assert config.reward_config.scales.to_dict() == {**fast, **terms}
    if people is None:
        assert config.crowd.slots == default_config("paper").crowd.slots
    else:
        kinds = ("pedestrian", "wheelchair", "scooter", "cyclist", "car")
        assert [config.crowd.slots[kind] for kind in kinds] == list(people)
    assert {n: found[n] for n in others} == others
    # Everything else is the preset's.
    own = ("task.", "reward_config.scales.", "crowd.slots.", "crowd.filled.")
    preset = leaves(default_config("paper").to_dict())
    changed = {n for n, x in found.items() if n in preset and not n.startswith(own) and x != preset[n]}
    assert changed <= {*others}
