"""A scene as USD: no validator finds anything, and bodies, colliders and light are where the scene has them."""

import dataclasses
import pathlib

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom, UsdLux, UsdPhysics, UsdShade, UsdValidation

from tests.support.box_bank import box_scene, box_skies
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.geometry import rotations
from urbanverse_mjx.scene import export_usd
from urbanverse_mjx.scene.usd import hdr_bytes

SKY = box_skies()["clear"]
SCENE = box_scene(0)


@pytest.fixture(scope="module")
def stage(tmp_path_factory: pytest.TempPathFactory) -> Usd.Stage:
    return Usd.Stage.Open(str(export_usd(SCENE, SKY, tmp_path_factory.mktemp("usd") / "scene")))


def test_it_is_written_into_no_folder_with_other_files_and_keeps_those_beside_it(tmp_path: pathlib.Path) -> None:
    (tmp_path / "diary.txt").write_text("mine")
    with pytest.raises(ValidationError, match="a folder with other files"):
        export_usd(SCENE, SKY, tmp_path)
    assert [p.name for p in tmp_path.iterdir()] == ["diary.txt"]
    export_usd(SCENE, SKY, tmp_path / "scene")
    (tmp_path / "diary.txt").rename(tmp_path / "scene" / "diary.txt")
    export_usd(SCENE, SKY, tmp_path / "scene")
    assert (tmp_path / "scene" / "diary.txt").read_text() == "mine"


def test_no_validator_of_usd_finds_anything(stage: Usd.Stage) -> None:
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    assert len(validators) > 20
    found = UsdValidation.ValidationContext(validators).Validate(stage)
    assert [f"{e.GetName()}: {e.GetMessage()}" for e in found if not e.HasNoError()] == []


def test_units_are_isaac_sims(stage: Usd.Stage) -> None:
    assert UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.z
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1.0
    assert UsdPhysics.GetStageKilogramsPerUnit(stage) == 1.0
    assert stage.GetDefaultPrim().GetPath() == "/World"


def test_every_object_is_a_body_at_its_pose_with_its_mass_and_friction(stage: Usd.Stage) -> None:
    bodies = {p.GetCustomDataByKey("urbanverse:id"): p for p in stage.GetPrimAtPath("/World/Objects").GetChildren()}
    assert list(bodies) == list(SCENE.object_ids)
    for o, name in enumerate(SCENE.object_ids):
        prim = bodies[name]
        pose = np.array(UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(Usd.TimeCode.Default()))
        assert pose[3, :3] == pytest.approx(SCENE.object_position[o], abs=1e-6)
        assert pose[:3, :3].T == pytest.approx(rotations.matrix(SCENE.object_quaternion[o]), abs=1e-5)
        assert UsdPhysics.MassAPI(prim).GetMassAttr().Get() == pytest.approx(SCENE.object_mass[o], rel=1e-6)
        kinematic = bool(UsdPhysics.RigidBodyAPI(prim).GetKinematicEnabledAttr().Get())
        assert kinematic != bool(SCENE.object_movable[o])
        hulls = [p for p in Usd.PrimRange(prim) if p.HasAPI(UsdPhysics.CollisionAPI)]
        assert len(hulls) == (SCENE.inst_object == o).sum()
        contact, _ = UsdShade.MaterialBindingAPI(hulls[0]).ComputeBoundMaterial("physics")
        friction = UsdPhysics.MaterialAPI(contact.GetPrim()).GetDynamicFrictionAttr().Get()
        assert friction == pytest.approx(SCENE.object_friction[o], abs=1e-4)


def test_ground_has_the_friction_of_its_material_and_the_smaller_coefficient_counts(tmp_path: pathlib.Path) -> None:
    regions = len(SCENE.region_ids)
    friction = np.linspace(0.3, 0.9, regions)[SCENE.prism_region]
    scene = dataclasses.replace(SCENE, prism_material_friction=friction)
    stage = Usd.Stage.Open(str(export_usd(scene, SKY, tmp_path / "scene")))
    ground = list(stage.GetPrimAtPath("/World/Ground").GetChildren())
    assert len(ground) == regions > 1
    for region, prim in enumerate(ground):
        hulls = [p for p in Usd.PrimRange(prim) if p.HasAPI(UsdPhysics.CollisionAPI)]
        assert len(hulls) == (SCENE.prism_region == region).sum() > 0
        for hull in hulls:
            contact, _ = UsdShade.MaterialBindingAPI(hull).ComputeBoundMaterial("physics")
            api = UsdPhysics.MaterialAPI(contact.GetPrim())
            wanted = pytest.approx(np.linspace(0.3, 0.9, regions)[region], abs=1e-4)
            assert api.GetDynamicFrictionAttr().Get() == wanted
            assert api.GetStaticFrictionAttr().Get() == wanted
            assert "PhysxMaterialAPI" in contact.GetPrim().GetPrimTypeInfo().GetAppliedAPISchemas()
            assert contact.GetPrim().GetAttribute("physxMaterial:frictionCombineMode").Get() == "min"


def test_colliders_lie_where_the_hulls_are(stage: Usd.Stage) -> None:
    for prism in range(0, len(SCENE.prism_hull), 3):
        world = SCENE.hulls[SCENE.prism_hull[prism]] + SCENE.prism_position[prism]
        found = [
            np.array(UsdGeom.Mesh(p).GetPointsAttr().Get())
            for p in Usd.PrimRange(stage.GetPrimAtPath("/World/Ground"))
            if p.HasAPI(UsdPhysics.CollisionAPI)
        ]
        assert any(
            len(points) == len(world) and np.abs(points[:, None] - world[None]).max(-1).min(1).max() < 1e-4
            for points in found
        )


def test_the_sun_shines_from_where_the_sky_has_it(stage: Usd.Stage) -> None:
    light = UsdGeom.Xformable(stage.GetPrimAtPath("/World/Sun"))
    matrix = light.ComputeLocalToWorldTransform(Usd.TimeCode.Default())
    to_sun = np.array(matrix.TransformDir(Gf.Vec3d(0, 0, 1)))
    c, s = np.cos(SCENE.sky_yaw), np.sin(SCENE.sky_yaw)
    x, y, z = SKY.sun_direction
    assert to_sun == pytest.approx([c * x - s * y, s * x + c * y, z], abs=1e-5)


def test_the_domes_columns_look_where_ours_do(stage: Usd.Stage) -> None:
    """In a dome's image column u shows longitude pi (1 - 2u): +z in the middle, +x a quarter from the left."""
    dome = UsdGeom.Xformable(stage.GetPrimAtPath("/World/Sky"))
    matrix = dome.ComputeLocalToWorldTransform(Usd.TimeCode.Default())
    width = SKY.radiance.shape[1]
    for ours in (0, 10, 33):
        theirs = width - 1 - ours
        longitude = np.pi * (1 - 2 * (theirs + 0.5) / width)
        world = np.array(matrix.TransformDir(Gf.Vec3d(np.sin(longitude), 0.0, np.cos(longitude))))
        yaw = -np.pi + (ours + 0.5) / width * 2 * np.pi + SCENE.sky_yaw
        assert world == pytest.approx([np.cos(yaw), np.sin(yaw), 0.0], abs=1e-5)
    up = np.array(matrix.TransformDir(Gf.Vec3d(0, 1, 0)))
    assert up == pytest.approx([0, 0, 1], abs=1e-6)
    assert UsdLux.DomeLight(stage.GetPrimAtPath("/World/Sky")).GetTextureFileAttr().Get().resolvedPath


def test_radiance_is_kept_to_a_hundredth() -> None:
    radiance = np.random.default_rng(0).uniform(0.0, 5.0, (4, 8, 3))
    radiance[0, 0] = 0.0
    body = hdr_bytes(radiance).split(b"+X 8\n", 1)[1]
    pixels = np.frombuffer(body, np.uint8).reshape(4, 8, 4).astype(np.float64)
    again = pixels[..., :3] * np.ldexp(1.0, pixels[..., 3:].astype(int) - 136)
    assert np.abs(again - radiance).max() < 0.01 * radiance.max()
    assert not again[0, 0].any()
