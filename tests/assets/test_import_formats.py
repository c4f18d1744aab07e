"""Formats that an import reads: vertex colours, URIs, Latin-1, STL, PLY, skins; broken files of each kind."""

import pathlib
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import trimesh
from PIL import Image
from trimesh.exchange import ply, stl
from trimesh.visual.color import ColorVisuals

from tests.assets.gltf_tree import CORNERS, FACES, Tree
from tests.assets.mesh_files import mesh_of
from urbanverse_mjx.assets import build_mesh, imported_index
from urbanverse_mjx.assets.importing.bake import bake
from urbanverse_mjx.assets.importing.corruption import NO_TEXTURE, find_in_shape
from urbanverse_mjx.assets.importing.reading import Source, read_source
from urbanverse_mjx.assets.importing.run import mesh_files
from urbanverse_mjx.assets.importing.screening import RefusedFileError
from urbanverse_mjx.assets.importing.shape import Shape
from urbanverse_mjx.cli.main import main

RED_TO_GREEN = np.array([[255, 0, 0, 255], [255, 0, 0, 255], [0, 255, 0, 255], [0, 255, 0, 255]], np.uint8)


def solid(colors: np.ndarray | None = None) -> trimesh.Trimesh:
    visual = None if colors is None else ColorVisuals(vertex_colors=colors)
    return trimesh.Trimesh(CORNERS, FACES, visual=visual, process=False)


def read(path: pathlib.Path, body: bytes | str) -> Source:
    path.write_bytes(body if isinstance(body, bytes) else body.encode())
    return read_source(path, path.parent)


# Colours, names and texts ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("material", [False, True])
def test_vertex_colours_of_gltf_are_linear_light_times_the_materials_colour(
    material: bool, tmp_path: pathlib.Path
) -> None:
    tree = Tree()
    tree.primitive["attributes"]["COLOR_0"] = tree.add(np.tile([[0.5, 1.0, 0.0]], (4, 1)).astype("<f4"), 5126, "VEC3")
    if material:
        tree.primitive["material"] = 0
        tree.body["materials"] = [{"pbrMetallicRoughness": {"baseColorFactor": [1.0, 0.2140411, 1.0, 1.0]}}]
    part = read_source(tree.write(tmp_path / "a.glb"), tmp_path).parts[0]
    assert part.colors is not None
    # Linear 0.5 is 188 in sRGB, and 0.214 is half of 255.
    np.testing.assert_allclose(part.colors, np.tile([188, 127.5 if material else 255, 0], (4, 1)), atol=1.0)
    texture = bake((part,))[3]
    assert np.abs(texture.reshape(-1, 3).astype(int) - [188, 128 if material else 255, 0]).max(1).min() <= 2


def test_vertex_colours_of_obj_and_ply_are_as_they_look(tmp_path: pathlib.Path) -> None:
    rows = [
        f"v {x:g} {y:g} {z:g} {r / 255:g} {g / 255:g} 0"
        for (x, y, z), (r, g, *_) in zip(CORNERS, RED_TO_GREEN, strict=True)
    ]
    text = "\n".join([*rows, *(f"f {a + 1} {b + 1} {c + 1}" for a, b, c in FACES)])
    for source in (
        read(tmp_path / "a.obj", text),
        read(tmp_path / "a.ply", ply.export_ply(solid(RED_TO_GREEN))),
        read(tmp_path / "b.ply", ply.export_ply(solid(RED_TO_GREEN), encoding="ascii")),
    ):
        assert source.parts[0].colors is not None
        np.testing.assert_allclose(source.parts[0].colors, RED_TO_GREEN[:, :3], atol=1.0)
        assert source.y_up is None


@pytest.mark.parametrize(
    ("factor", "faults"),
    [((0.8, 0.13, 0.01), []), ((0.2, 0.2, 0.2), [NO_TEXTURE]), ((0.21, 0.2, 0.19), [NO_TEXTURE]), (None, [NO_TEXTURE])],
)
def test_one_colour_is_an_appearance_unless_it_is_grey(
    factor: tuple[float, ...] | None, faults: list[str], tmp_path: pathlib.Path
) -> None:
    """An orange cone needs no texture; grey and white are what programs write for want of a material."""
    for by_vertex in (False, True):
        tree = Tree()
        if factor and by_vertex:
            tree.primitive["attributes"]["COLOR_0"] = tree.add(np.tile([factor], (4, 1)).astype("<f4"), 5126, "VEC3")
        elif factor:
            tree.primitive["material"] = 0
            tree.body["materials"] = [{"pbrMetallicRoughness": {"baseColorFactor": [*factor, 1.0]}}]
        source = read_source(tree.write(tmp_path / "a.glb"), tmp_path)
        found = find_in_shape(Shape.of(source.vertices, source.faces), source, None)
        assert [finding.name for finding in found if finding.name == NO_TEXTURE] == faults


def test_spaces_in_uris_and_names(tmp_path: pathlib.Path) -> None:
    """glTF writes "my image.png" as "my%20image.png"; a file whose name holds %20 itself is found as well."""
    Image.new("RGB", (4, 4), (10, 200, 30)).save(tmp_path / "my image.png")
    Image.new("RGB", (4, 4), (200, 10, 30)).save(tmp_path / "a%20b.png")
    for name, color in (("my%20image.png", [10, 200, 30]), ("a%20b.png", [200, 10, 30])):
        tree = Tree()
        tree.primitive["attributes"]["TEXCOORD_0"] = tree.add(CORNERS[:, :2].copy(), 5126, "VEC2")
        tree.primitive["material"] = 0
        tree.body |= {
            "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
            "textures": [{"source": 0}],
            "images": [{"uri": name}],
        }
        source = read_source(tree.write(tmp_path / "a.gltf"), tmp_path)
        assert source.notes == ()
        texture = source.parts[0].texture
        assert texture is not None
        np.testing.assert_array_equal(texture[0, 0], color)
    inner = tmp_path / "inner"
    inner.mkdir()
    tree.body["images"] = [{"uri": "%2e%2e/my%20image.png"}]
    with pytest.raises(RefusedFileError, match="outside the imported folder"):
        read_source(tree.write(inner / "a.gltf"), inner)


def test_latin_1_obj_and_mtl(tmp_path: pathlib.Path) -> None:
    Image.new("RGB", (4, 4), (10, 200, 30)).save(tmp_path / "größe.png")
    (tmp_path / "weiß.mtl").write_bytes("newmtl grün\nmap_Kd größe.png\n".encode("latin-1"))
    rows = ["# Müllers Möbel", "mtllib weiß.mtl", "o Straßenlaterne", *(f"v {x:g} {y:g} {z:g}" for x, y, z in CORNERS)]
    rows += [*(f"vt {x:g} {y:g}" for x, y, _ in CORNERS), "usemtl grün"]
    rows += [" ".join(["f", *(f"{k + 1}/{k + 1}" for k in face)]) for face in FACES]
    source = read(tmp_path / "a.obj", "\n".join(rows).encode("latin-1"))
    assert source.names == ("Straßenlaterne",)
    assert source.notes == ()
    texture = source.parts[0].texture
    assert texture is not None
    np.testing.assert_array_equal(texture[0, 0], [10, 200, 30])


# Formats --------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("text", [False, True])
def test_stl_shares_its_corners_again(text: bool, tmp_path: pathlib.Path) -> None:
    body = stl.export_stl_ascii(solid()) if text else stl.export_stl(solid())
    source = read(tmp_path / "a.STL", body)
    assert source.vertices.shape == (4, 3)
    np.testing.assert_allclose(sorted(map(tuple, source.vertices)), sorted(map(tuple, CORNERS)))
    volume = trimesh.Trimesh(source.vertices, source.faces, process=False).volume
    assert volume == pytest.approx(1 / 6)
    assert source.y_up is None


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
def test_a_skinned_mesh_stands_in_its_rest_pose(suffix: str, tmp_path: pathlib.Path) -> None:
    """Two joints: one scales by 2 and moves by 10 along x, the other, its child, turns +x to +y. The mesh's own node
    does not count; a half-and-half vertex lies in the middle."""
    tree = Tree()
    bind = np.tile(np.identity(4, dtype="<f4"), (2, 1, 1))
    bind[1, 3, :3] = [-1, 0, 0]  # by columns: a translation stands in the last four numbers
    weights = np.array([[1, 0, 0, 0], [1, 0, 0, 0], [0, 1, 0, 0], [0.5, 0.5, 0, 0]], "<f4")
    tree.primitive["attributes"] |= {
        "JOINTS_0": tree.add(np.tile(np.array([[0, 1, 0, 0]], np.uint8), (4, 1)), 5121, "VEC4"),
        "WEIGHTS_0": tree.add(weights, 5126, "VEC4"),
    }
    half = np.sqrt(0.5)
    tree.body["nodes"] = [
        {"mesh": 0, "skin": 0, "translation": [500, 0, 0], "name": "bear"},
        {"translation": [10, 0, 0], "scale": [2, 2, 2], "children": [2]},
        {"rotation": [0, 0, half, half]},
    ]
    tree.body["scenes"] = [{"nodes": [0, 1]}]
    tree.body["skins"] = [{"joints": [1, 2], "inverseBindMatrices": tree.add(bind, 5126, "MAT4")}]
    source = read_source(tree.write(tmp_path / f"a{suffix}"), tmp_path)
    # Second joint: (x, y, z) -> (x - 1, y, z), turned (-y, x - 1, z), then times 2 and plus 10.
    wanted = [[10, 0, 0], [12, 0, 0], [10 - 2, -2, 0], [10, (0 - 2) / 2, 2]]
    np.testing.assert_allclose(source.vertices, wanted, atol=1e-5)
    assert source.names == ("bear",)
    tree.body["skins"][0]["joints"] = [1]
    with pytest.raises(RefusedFileError, match="joint beyond the skin's 1"):
        read_source(tree.write(tmp_path / f"a{suffix}"), tmp_path)


# Broken files and the command -----------------------------------------------------------------------------------------


def _nan(body: bytes) -> bytes:
    return body.replace(np.float32(1.0).tobytes(), np.float32(np.nan).tobytes())


def _ply(encoding: Any) -> bytes:
    return ply.export_ply(solid(), encoding=encoding)


def _ply_of_points(encoding: Any) -> bytes:
    return ply.export_ply(trimesh.PointCloud(CORNERS), encoding=encoding)


BINARY_STL: Callable[[], bytes] = lambda: stl.export_stl(solid())  # noqa: E731
HOSTILE: dict[str, tuple[Callable[[], bytes], str]] = {
    "short.stl": (lambda: BINARY_STL()[:-20], "needed 284 for its 4 triangles"),
    "head.stl": (lambda: BINARY_STL()[:50], "needed 84"),
    "nan.stl": (lambda: _nan(BINARY_STL()), "no finite numbers"),
    "none.stl": (lambda: b"\0" * 84, "holds no triangles"),
    "many.stl": (lambda: b"\0" * 80 + b"\xff" * 4 + b"\0" * 50, "4294967295 triangles"),
    "text.stl": (lambda: stl.export_stl_ascii(solid())[:200].encode(), "no end"),
    "short.ply": (lambda: _ply("binary")[:-20], "its header gives at least"),
    "text.ply": (lambda: _ply("ascii")[:-60], "truncated|malformed|cannot be read|gives"),
    "head.ply": (lambda: _ply("binary")[:40], "no end of its header"),
    "nan.ply": (lambda: _nan(_ply("binary")), "no finite numbers"),
    "points.ply": (lambda: _ply_of_points("binary"), "4 vertices and no face"),
    "other.ply": (lambda: b"hello\nend_header\n", "does not begin as a PLY file does"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_a_broken_file_is_one_sentence(name: str, tmp_path: pathlib.Path) -> None:
    make, needle = HOSTILE[name]
    with pytest.raises(RefusedFileError, match=needle):
        read(tmp_path / name, make())


def test_the_command_refuses_one_file_with_status_2_and_leaves_no_asset(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path / "cache"))
    path = tmp_path / "cone.stl"
    path.write_bytes(HOSTILE["short.stl"][0]())
    assert main(["assets", "import", str(path), "--licence", "CC0-1.0", "--no-pictures"]) == 2
    assert capsys.readouterr().err == (
        f"error: {path}: refused, truncated: holds 264 bytes, needed 284 for its 4 triangles.\n"
    )
    assert not list((tmp_path / "cache").rglob("*.glb"))
    assert len(imported_index().records) == 0
    assert main(["assets", "import", str(path), "--leaf", "zqxv"]) == 2
    assert "zqxv" in capsys.readouterr().err


def test_the_user_says_what_a_file_is(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """An STL file in millimetres whose name says nothing; z is up, as CAD programs write it."""
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path / "cache"))
    record, mesh = mesh_of("traffic cone")
    body = trimesh.Trimesh(mesh.vertices * 1000.0, mesh.faces, process=False)
    (tmp_path / "part_0815.stl").write_bytes(stl.export_stl(body))
    (tmp_path / "other.stl").write_bytes(b"")
    command = ["assets", "import", str(tmp_path / "part_0815.stl"), "--licence", "CC0-1.0", "--no-pictures"]
    assert main(command) == 2
    assert capsys.readouterr().err.count("name it with --leaf") == 1
    assert main([*command, "--leaf", "traffic cones"]) == 0
    (made,) = imported_index().records
    assert made.leaf == "traffic cone"
    np.testing.assert_allclose(made.extent_xyz, record.extent_xyz, rtol=0.02)
    grey = build_mesh(made)
    column, row = (grey.uv * np.array(grey.texture.shape[1::-1])).astype(int).T
    np.testing.assert_array_equal(grey.texture[len(grey.texture) - 1 - row, column], np.full((len(row), 3), 150))
    assert list(mesh_files(tmp_path / "part_0815.stl")) == [tmp_path / "part_0815.stl"]
