"""Assets as GLB, OBJ, MJCF and USD: read back by others' readers they have the same box, volume, mass and
appearance."""

import json
import pathlib
from typing import Any

import mujoco
import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull

from urbanverse_mjx.assets import build_mesh, load_hulls, load_index
from urbanverse_mjx.assets.collision.rigid_body import convex_surface, rigid_body
from urbanverse_mjx.assets.exporting.export import (
    FORMATS,
    export_asset,
    export_mjcf,
    export_obj,
    export_usd,
    record_to_export,
)
from urbanverse_mjx.assets.selection import search
from urbanverse_mjx.assets.selection.search import ObjectLibrary
from urbanverse_mjx.cli.main import main
from urbanverse_mjx.datatypes import AssetRecord, ValidationError

INDEX = load_index()
# Light and heavy, convex and hollow, tall and flat, free and fixed to the ground.
LEAVES = (
    "traffic cone",
    "bench",
    "bus shelter",
    "street light",
    "manhole cover",
    "picnic table",
    "sedan",
    "fire hydrant",
)
RECORDS = [INDEX.by_leaf(leaf)[0] for leaf in LEAVES]
every_record = pytest.mark.parametrize("record", RECORDS, ids=LEAVES)


def moment_of(record: AssetRecord) -> np.ndarray:
    return rigid_body(record, build_mesh(record), load_hulls(record).hulls).principal[0]


@every_record
def test_an_obj_is_read_back_by_trimesh(record: AssetRecord, tmp_path) -> None:
    mesh = build_mesh(record)
    path = export_obj(record, tmp_path / "asset.obj")
    again = trimesh.load_mesh(path, process=False, maintain_order=True)
    assert np.array_equal(again.vertices.astype(np.float32), mesh.vertices)
    assert np.array_equal(again.faces, mesh.faces)
    assert again.volume == pytest.approx(trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).volume, rel=1e-6)
    visual: Any = again.visual
    assert np.array_equal(np.asarray(visual.material.image.convert("RGB")), mesh.texture)
    assert np.abs(visual.uv - mesh.uv).max() < 1e-6


@every_record
def test_an_mjcf_model_has_the_records_mass_and_box(record: AssetRecord, tmp_path) -> None:
    model = mujoco.MjModel.from_xml_path(str(export_mjcf(record, tmp_path / "asset.xml")))
    body = model.body("asset").id
    assert model.body_mass[body] == pytest.approx(record.mass, rel=1e-6)
    assert np.sort(model.body_inertia[body]) == pytest.approx(moment_of(record), rel=1e-4)
    assert model.njnt == int(record.movable)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    hulls = load_hulls(record).hulls
    assert model.ngeom == len(hulls) + 1
    corners = points_of(model, data, model.geom("visual").id)
    assert np.ptp(corners, axis=0) == pytest.approx(record.extent_xyz, abs=1e-3)
    assert corners[:, 2].min() == pytest.approx(0.0, abs=1e-4)
    for k, hull in enumerate(hulls):
        geom = model.geom(f"hull_{k}").id
        assert model.geom_friction[geom][0] == pytest.approx(record.friction_coefficient)
        assert (model.geom_contype[geom], model.geom_conaffinity[geom]) == (1, 1)
        assert ConvexHull(points_of(model, data, geom)).volume == pytest.approx(
            ConvexHull(hull.astype(float)).volume, rel=1e-3
        )


def points_of(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> np.ndarray:
    mesh = model.geom_dataid[geom]
    first = model.mesh_vertadr[mesh]
    local = model.mesh_vert[first : first + model.mesh_vertnum[mesh]]
    return local @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]


def test_mujoco_shows_the_texture_the_right_way_up(tmp_path) -> None:
    """A vertex's texture coordinates after MuJoCo's reader count from the image's top row."""
    record = RECORDS[1]
    model = mujoco.MjModel.from_xml_path(str(export_mjcf(record, tmp_path / "asset.xml")))
    mesh = build_mesh(record)
    first = model.mesh_texcoordadr[0]
    ours = {(round(float(u), 5), round(1 - float(v), 5)) for u, v in mesh.uv}
    assert {(round(float(u), 5), round(float(v), 5)) for u, v in model.mesh_texcoord[first:]} == ours


@every_record
def test_a_usd_stage_holds_the_same_body(record: AssetRecord, tmp_path) -> None:
    from pxr import Usd, UsdGeom, UsdPhysics, UsdShade

    stage = Usd.Stage.Open(str(export_usd(record, tmp_path / "asset.usda")))
    root = stage.GetDefaultPrim()
    assert UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.z
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1.0
    assert UsdPhysics.MassAPI(root).GetMassAttr().Get() == pytest.approx(record.mass, rel=1e-6)
    assert sorted(UsdPhysics.MassAPI(root).GetDiagonalInertiaAttr().Get()) == pytest.approx(moment_of(record), rel=1e-4)
    kinematic = UsdPhysics.RigidBodyAPI(root).GetKinematicEnabledAttr().Get()
    assert kinematic is not record.movable
    mesh = build_mesh(record)
    seen = UsdGeom.Mesh.Get(stage, "/asset/visual")
    assert np.array_equal(np.asarray(seen.GetPointsAttr().Get()), mesh.vertices)
    assert np.array_equal(np.asarray(seen.GetFaceVertexIndicesAttr().Get()).reshape(-1, 3), mesh.faces)
    hulls = load_hulls(record).hulls
    shapes = [UsdGeom.Mesh(p) for p in stage.GetPrimAtPath("/asset/collision").GetChildren()]
    assert len(shapes) == len(hulls)
    for shape, hull in zip(shapes, hulls, strict=True):
        prim = shape.GetPrim()
        assert prim.HasAPI(UsdPhysics.CollisionAPI)
        assert UsdPhysics.MeshCollisionAPI(prim).GetApproximationAttr().Get() == "convexHull"
        points = np.asarray(shape.GetPointsAttr().Get(), float)
        assert ConvexHull(points).volume == pytest.approx(ConvexHull(hull.astype(float)).volume, rel=1e-5)
        bound, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial("physics")
        friction = UsdPhysics.MaterialAPI(bound.GetPrim()).GetDynamicFrictionAttr().Get()
        assert friction == pytest.approx(record.friction_coefficient)


def usd_errors(stage) -> list[str]:
    from pxr import UsdValidation

    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    assert len(validators) > 20
    found = UsdValidation.ValidationContext(validators).Validate(stage)
    return [f"{e.GetName()}: {e.GetMessage()}" for e in found if not e.HasNoError()]


@pytest.mark.parametrize("suffix", [".usda", ".usdc"])
def test_no_validator_of_usd_finds_anything(suffix: str, tmp_path) -> None:
    from pxr import Usd

    for record in RECORDS:
        stage = Usd.Stage.Open(str(export_usd(record, tmp_path / f"asset{suffix}")))
        assert usd_errors(stage) == [], record.uid


def test_the_validators_do_find_a_fault(tmp_path) -> None:
    from pxr import Usd, UsdPhysics

    stage = Usd.Stage.Open(str(export_usd(RECORDS[0], tmp_path / "asset.usda")))
    UsdPhysics.RigidBodyAPI.Apply(stage.GetPrimAtPath("/asset/looks"))
    (tmp_path / "asset.png").unlink()
    assert len(usd_errors(stage)) >= 2


def test_inertia_of_a_box_by_hand() -> None:
    """A cone's stand-in: one hull of 2 x 1 x 3 m and 12 kg; I = m / 12 (b^2 + c^2)."""
    record = RECORDS[0]
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-0.5, 0.5) for z in (0, 3)], np.float32)
    assert convex_surface(corners).volume == pytest.approx(6.0)
    twelve = AssetRecord(**{**vars(record), "mass": 12.0})
    solid = rigid_body(twelve, build_mesh(record), [corners])
    assert solid.centre == pytest.approx([0, 0, 1.5])
    assert np.diag(solid.inertia) == pytest.approx([1 + 9, 4 + 9, 4 + 1])
    halves = [np.clip(corners, None, (np.inf, np.inf, 1.5)), np.clip(corners, (-np.inf, -np.inf, 1.5), None)]
    assert rigid_body(twelve, build_mesh(record), halves).inertia == pytest.approx(solid.inertia, abs=1e-5)


@pytest.mark.parametrize("form", FORMATS)
def test_every_format_carries_the_annotation(form: str, tmp_path) -> None:
    record = RECORDS[0]
    path = export_asset(record, tmp_path, form)
    annotation = json.loads(path.with_suffix(".json").read_text(encoding="utf-8"))
    assert (annotation["category"], annotation["mass"], annotation["length"]) == (
        "traffic cone",
        record.mass,
        record.length,
    )
    assert annotation["license_info"]["license"] == "Apache-2.0"
    assert not [p for p in path.parent.iterdir() if p.name.startswith(".")]


def test_a_glb_says_what_it_is(tmp_path) -> None:
    record, mesh = RECORDS[1], build_mesh(RECORDS[1])
    body = export_asset(record, tmp_path, "glb").read_bytes()
    annotation = json.loads(body[20 : 20 + int.from_bytes(body[12:16], "little")])["asset"]
    assert annotation["copyright"] == record.licence
    assert (annotation["extras"]["mass"], annotation["extras"]["category"]) == (record.mass, "bench")
    again = trimesh.load_mesh(tmp_path / f"{record.uid.replace('/', '--')}.glb", process=False)
    volume = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).volume
    assert again.volume == pytest.approx(volume, rel=1e-5)


def test_an_unknown_format_is_refused(tmp_path) -> None:
    with pytest.raises(ValidationError, match="'fbx', needed one of glb, obj, mjcf, usd"):
        export_asset(RECORDS[0], tmp_path, "fbx")


def test_base_shapes_are_listed_and_exported_as_the_catalogue_has_them(
    objects: ObjectLibrary, tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A recipe's own estimate of the mass, 7 kg for this cone of 2.9 kg, only chooses its make."""
    uid = "traffic-cone/barriers-traffic-cone/000"
    assert load_index().get(uid).mass == pytest.approx(7.0)
    assert record_to_export(uid) == objects.record(uid)
    assert main(["assets", "export", "--leaf", "traffic cone", "--out", str(tmp_path)]) == 0
    written = {row["uid"]: row["mass"] for row in (json.loads(p.read_text()) for p in tmp_path.glob("*.json"))}
    assert written[uid] == objects.record(uid).mass == pytest.approx(2.9, abs=0.2)
    capsys.readouterr()
    assert main(["assets", "list", "--leaf", "traffic cone"]) == 0
    (line,) = (line for line in capsys.readouterr().out.splitlines() if line.startswith(uid))
    assert " 2.9 " in line


def test_what_search_returns_can_be_exported(objects: ObjectLibrary, tmp_path, monkeypatch, capsys) -> None:
    """Records of the catalogue that are no base shapes, by the command."""
    monkeypatch.setattr(search, "library", lambda: objects)
    found = objects.get_uids_conditioned(query="a red wooden chair", top_k=20)
    (uid, *_) = [u for u in found if u not in load_index()]
    assert main(["assets", "export", "--uid", uid, "--out", str(tmp_path)]) == 0
    (path,) = tmp_path.glob("*.glb")
    size = trimesh.load(path, force="scene").extents
    assert sorted(size) == pytest.approx(sorted(objects.record(uid).extent_xyz), abs=2e-3)
    assert main(["assets", "export", "--uid", "no/such", "--out", str(tmp_path)]) == 2
    assert "asset uid: found 'no/such'" in capsys.readouterr().err
