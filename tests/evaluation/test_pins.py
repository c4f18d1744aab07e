"""Frozen benchmarks notice a changed scene or robot, and name the part; nothing that makes no difference is noticed."""

import dataclasses
import json
import pathlib

import numpy as np
import pytest

from benchmarks.freeze import version_of
from tests.support.box_bank import box_bank
from urbanverse_mjx import settings
from urbanverse_mjx.datatypes import SceneBank, ValidationError, bank_join
from urbanverse_mjx.evaluation.frozen import CONDITIONS, Protocol, freeze
from urbanverse_mjx.evaluation.pins import PARTS, changed_part, robot_pin, scene_pins
from urbanverse_mjx.pipeline.benchmarking import pinned_robots
from urbanverse_mjx.robots import make_coco

LISTS = sorted(path.stem for path in settings.protocol_root().glob("*.json"))
#: Conditions of version 1.
BEFORE = {"vision_config.light": "direct", "friction": "uniform"}
#: Hash of the episodes of each list.
PUBLISHED = {
    "autobench": "f010d0533118a36fb88e2c013911a0b3582a1ca068635796f62bbc390ac2f67e",
    "autobench_v2": "65d7818751b65582b63747b6658ef12dfc6100ff053bc5c17bd99a2800d2b1e9",
    "craftbench": "34b5f5a25ad9efe41e8c67eb333cdf3722a919ee7f5e3272e5c4f2150be85d15",
    "craftbench_v2": "3d06897952d3d8d421628ae86b8772751869bbfa9b2807508e3fe9f74b991414",
    "shipped": "de1f337c92360c13c9a013bd0e1cceb478998df05c8a33461fd1c7dbda6c9561",
    "validation": "f8c9c282fcd5a4f1243b462ed1eaa89a009e7fa13bb80bd8e3186f0eb4647a53",
}


@pytest.fixture(scope="module")
def pinned(small_bank: SceneBank) -> tuple[SceneBank, Protocol]:
    """The box streets with a hash each, and a frozen list of theirs with pins."""
    hashes = {name: f"{i}" * 64 for i, name in enumerate(small_bank.scene_ids)}
    bank = dataclasses.replace(small_bank, meta={**small_bank.meta, "hashes": hashes})
    return bank, freeze("boxes", bank, 8, seed=0).pinned(bank, {"CocoNav": make_coco()})


def changed(bank: SceneBank, name: str, amount: float, scene: int = 1) -> SceneBank:
    """A bank in which one value of an array that a scene uses is larger."""
    values = getattr(bank, name).copy()
    row = {
        "hull_vertices": (bank.inst_hull[scene, 0], 0, 0),
        "inst_position": (scene, 0, 2),
        "inst_rotation": (scene, 0, 0, 0),
        "inst_friction": (scene, 0),
        "prism_friction": (scene, 0),
        "prism_material_friction": (scene, 0),
        "map_kind": (scene, *np.argwhere(bank.map_kind[scene])[50]),
        "map_origin": (scene, 0),
        "sky_radiance": (bank.scene_sky[scene],),
        "sky_sun_irradiance": (bank.scene_sky[scene], 0),
        "scene_sky_yaw": (scene,),
        "material_rgba": (slice(None), 0),
    }[name]
    values[row] += np.asarray(amount).astype(values.dtype)
    return dataclasses.replace(bank, **{name: values})


@pytest.mark.parametrize(
    ("name", "amount", "part"),
    [
        ("hull_vertices", 0.005, "physics"),
        ("inst_position", 0.005, "physics"),
        ("inst_rotation", -0.05, "physics"),
        ("inst_friction", 0.1, "physics"),
        ("prism_friction", -0.1, "physics"),
        ("prism_material_friction", -0.1, "physics"),
        ("map_kind", 1, "map"),
        ("map_origin", 0.05, "map"),
        ("sky_radiance", 0.05, "light"),
        ("sky_sun_irradiance", 0.3, "light"),
        ("scene_sky_yaw", 0.2, "light"),
        ("material_rgba", -0.2, "surfaces"),
    ],
)
def test_a_changed_scene_is_refused_by_its_part(
    pinned: tuple[SceneBank, Protocol], name: str, amount: float, part: str
) -> None:
    bank, protocol = pinned
    protocol.on(bank)
    with pytest.raises(ValidationError, match=f"found other {part} than version 1 of benchmark 'boxes'"):
        protocol.on(changed(bank, name, amount))


@pytest.mark.parametrize(("hull", "position"), [("inst_hull", "inst_position"), ("prism_hull", "prism_position")])
def test_a_body_with_the_first_hull_of_the_bank_counts(
    pinned: tuple[SceneBank, Protocol], hull: str, position: str
) -> None:
    hulls = getattr(pinned[0], hull).copy()
    hulls[1, 0] = 0
    bank = dataclasses.replace(pinned[0], **{hull: hulls})
    protocol = freeze("boxes", bank, 8, seed=0).pinned(bank, {"CocoNav": make_coco()})
    places = getattr(bank, position).copy()
    places[1, 0, 2] += 0.05
    with pytest.raises(ValidationError, match="found other physics"):
        protocol.on(dataclasses.replace(bank, **{position: places}))


def test_lists_of_uniform_ground_do_not_pin_its_materials(pinned: tuple[SceneBank, Protocol]) -> None:
    """As those of version 1, whose scenes are compiled with the materials' friction beside the ground's."""
    bank, protocol = pinned
    other = changed(bank, "prism_material_friction", -0.1)
    uniform = dataclasses.replace(protocol, conditions={**protocol.conditions, "friction": "uniform"})
    before = dataclasses.replace(
        uniform, scenes=tuple(dataclasses.replace(s, pins=scene_pins(bank, i)) for i, s in enumerate(uniform.scenes))
    )
    assert len(before.on(other).scenes) == bank.num_scenes


def test_last_digits_make_no_difference(pinned: tuple[SceneBank, Protocol]) -> None:
    """What another processor rounds otherwise: the values lie where a millimetre begins to count last."""
    bank, _ = pinned
    rng = np.random.default_rng(0)
    other = {
        name: (array * (1.0 + rng.uniform(-1e-6, 1e-6, array.shape))).astype(array.dtype)
        for name, array in bank.arrays().items()
        if name in ("inst_rotation", "sky_radiance", "sky_sun_direction", "sky_sun_irradiance", "material_rgba")
    }
    noisy = dataclasses.replace(bank, **other)
    for scene in range(bank.num_scenes):
        assert changed_part(scene_pins(bank, scene), scene_pins(noisy, scene)) is None


def test_pins_are_those_of_the_scene_whatever_else_its_bank_holds(small_bank: SceneBank) -> None:
    other = box_bank(2, seed=5)
    renamed = dataclasses.replace(other, meta={**other.meta, "scene_ids": ["other_a", "other_b"]})
    both = bank_join.join([renamed, small_bank])
    for scene, name in enumerate(small_bank.scene_ids):
        assert scene_pins(both, both.scene_ids.index(name)) == scene_pins(small_bank, scene)


def test_the_shipped_streets_are_those_that_were_frozen(bank: SceneBank) -> None:
    protocol = Protocol.load(settings.protocol_root() / "shipped.json")
    assert len(protocol.on(bank).scenes) == len(protocol.scenes) == 6


@pytest.mark.parametrize("name", LISTS)
def test_every_list_pins_its_scenes_and_the_robots_of_today(name: str) -> None:
    protocol = Protocol.load(settings.protocol_root() / f"{name}.json")
    assert protocol.name == name
    assert protocol.version == version_of(name)
    assert protocol.conditions == (CONDITIONS if protocol.version > 1 else BEFORE)
    assert all(set(scene.pins) == set(PARTS) for scene in protocol.scenes)
    assert protocol.robots == {env: robot_pin(robot) for env, robot in pinned_robots().items()}


@pytest.mark.parametrize("name", LISTS)
def test_a_list_is_what_was_published(name: str) -> None:
    """A list and its hash could be written anew together; scores under this name would no longer compare."""
    assert Protocol.load(settings.protocol_root() / f"{name}.json").content_hash() == PUBLISHED[name]


@pytest.mark.parametrize(("name", "version"), [("craftbench", 1), ("craftbench_v2", 2), ("v2", 1), ("mine_v12", 12)])
def test_a_name_may_end_in_a_version(name: str, version: int) -> None:
    assert version_of(name) == version


def test_a_changed_robot_is_refused(pinned: tuple[SceneBank, Protocol]) -> None:
    _, protocol = pinned
    robot = make_coco()
    protocol.check_robot("CocoNav", dataclasses.replace(robot, mjcf=robot.mjcf.replace("\n", "\n  ")))
    protocol.check_robot("MyNav", dataclasses.replace(robot, max_speed=9.0))
    heavy = robot.mjcf.replace('mass="50"', 'mass="50.1"', 1)
    assert heavy != robot.mjcf
    for other in (dataclasses.replace(robot, mjcf=heavy), dataclasses.replace(robot, max_speed=robot.max_speed + 0.1)):
        with pytest.raises(ValidationError, match="CocoNav: found another robot 'coco_differential' than version 1"):
            protocol.check_robot("CocoNav", other)


def test_pins_come_back_from_the_file_and_lists_without_them_are_read(
    pinned: tuple[SceneBank, Protocol], tmp_path: pathlib.Path
) -> None:
    bank, protocol = pinned
    path = tmp_path / "boxes.json"
    protocol.save(path)
    assert Protocol.load(path) == protocol
    plain = freeze("boxes", bank, 8, seed=0)
    assert plain.content_hash() == protocol.content_hash()
    body = json.loads(path.read_text(encoding="utf-8"))
    body["schema"] = "urbanverse.protocol/1"
    for name in ("version", "robots"):
        del body[name]
    for scene in body["scenes"]:
        del scene["pins"]
    path.write_text(json.dumps(body), encoding="utf-8")
    assert Protocol.load(path) == plain
    assert plain.on(changed(bank, "inst_friction", 0.1)).protocol == plain


@pytest.mark.parametrize("wrong", [{"map": 3}, {"light": [1.0]}, {"surfaces": ["a", 0, 0, 0]}, {"sound": "x"}])
def test_wrong_pins_are_one_sentence(
    pinned: tuple[SceneBank, Protocol], tmp_path: pathlib.Path, wrong: dict[str, object]
) -> None:
    _, protocol = pinned
    body = protocol.to_json()
    body["scenes"][0]["pins"] |= wrong
    (tmp_path / "boxes.json").write_text(json.dumps(body), encoding="utf-8")
    with pytest.raises(ValidationError, match="pins"):
        Protocol.load(tmp_path / "boxes.json")
