"""Cameras: the whole object in the picture, rooms from inside, and every way to name one."""

import math
from pathlib import Path

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.scene.builtin.mesh import Mesh
from irradia.scene.builtin.shapes import box, centred_box, cone, floor, sphere
from irradia.scene.framing import camera_from_spec, frame_scene, load_camera, look_at, save_camera
from irradia.scene.merge import merge
from irradia.scene.types import Camera, Instance, Material, Primitive, Scene


def _scene(*meshes: Mesh, cameras: tuple[Camera, ...] = ()) -> Scene:
    primitives = tuple(_primitive(mesh) for mesh in meshes)
    instances = tuple(Instance(index, np.eye(4), index) for index in range(len(meshes)))
    return Scene("test", primitives, instances, (Material(),), (), cameras=cameras)


def _primitive(mesh: Mesh) -> Primitive:
    positions, normals = mesh.positions.astype(np.float32), mesh.normals.astype(np.float32)
    source = np.arange(len(positions), dtype=np.uint32)
    return Primitive(positions, normals, (), None, mesh.indices.astype(np.uint32), 0, 0, 0, source)


def _screen(camera: Camera, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(N, 2) picture coordinates in [−1, 1], and (N,) distances along the view."""
    homogeneous = np.column_stack([points, np.ones(len(points))])
    seen = (np.linalg.inv(camera.world_from_camera) @ homogeneous.T).T
    slope = math.tan(camera.yfov_rad / 2)
    return seen[:, :2] / -seen[:, 2:3] / [slope * camera.aspect, slope], -seen[:, 2]


def _eye(camera: Camera) -> np.ndarray:
    return camera.world_from_camera[:3, 3]


def _forward(camera: Camera) -> np.ndarray:
    return -camera.world_from_camera[:3, 2]


OBJECTS = {
    "sphere": (sphere(0.3, 24, 12),),
    "needle": (box((-0.01, 0, -0.01), (0.01, 3, 0.01)),),
    "far from the origin": (box((500, 20, -80), (501, 21, -79)),),
    "cone on a ground": (cone(0.5, 1.0, 16), floor(5, 5)),
    "tiny": (centred_box((1e-3, 1e-3, 2e-3)),),
    "flat sheet": (floor(2, 3),),
}


@pytest.mark.parametrize("aspect", [16 / 9, 1.0, 0.5])
@pytest.mark.parametrize("name", OBJECTS)
def test_object_fills_the_picture_and_none_is_cut(name: str, aspect: float) -> None:
    scene = _scene(*OBJECTS[name])
    camera = frame_scene(scene, aspect)
    screen, distance = _screen(camera, merge(scene).positions.astype(float))
    assert distance.min() > 0.0
    assert 0.9 < np.abs(screen).max() < 1.0
    # Centred: what is left free is equal on both sides.
    np.testing.assert_allclose(screen.max(axis=0), -screen.min(axis=0), atol=1e-3)


def test_object_is_seen_from_its_front_right_and_above() -> None:
    eye = _eye(frame_scene(_scene(sphere(1.0, 24, 12))))
    assert eye[2] > eye[0] > 0.0
    assert eye[1] > 0.0


@pytest.mark.parametrize(
    "furniture",
    [
        (),
        (centred_box((1, 1, 1)),),
        (sphere(0.4, 16, 8), box((1, -1.25, 1), (1.5, 0, 1.5))),
        (box((-3.2, -1.3, -2.2), (3.2, 1.3, 2.2)),),
    ],
    ids=["empty", "block in the middle", "several things", "thick walls"],
)
def test_room_is_seen_from_inside_at_eye_height(furniture: tuple[Mesh, ...]) -> None:
    room = box((-3, -1.25, -2), (3, 1.25, 2)).inside_out()
    camera = frame_scene(_scene(room, *furniture))
    eye = _eye(camera)
    assert np.all(np.abs(eye) < [3, 1.25, 2])
    assert -0.35 < eye[1] <= 0.35
    assert abs(_forward(camera)[1]) < 0.3


def test_long_room_is_seen_along_its_length() -> None:
    camera = frame_scene(_scene(box((-10, 0, -1.5), (10, 3, 1.5)).inside_out()))
    forward = _forward(camera)
    assert abs(forward[0]) > 0.9
    assert _eye(camera)[0] * forward[0] < 0.0  # from one end toward the other
    assert _eye(camera)[1] == pytest.approx(1.5, abs=0.11)


def test_room_without_roof_is_still_a_room() -> None:
    walls = box((-3, 0, -3), (3, 3, 3)).inside_out()
    open_top = Mesh(
        walls.positions,
        walls.normals,
        walls.uv,
        np.array([t for t in walls.indices if walls.positions[t][:, 1].min() < 3.0]),
    )
    assert len(open_top.indices) == len(walls.indices) - 2
    assert np.all(np.abs(_eye(frame_scene(_scene(open_top)))) < 3.0)


def test_closed_object_is_seen_from_outside() -> None:
    eye = _eye(frame_scene(_scene(box((-3, 0, -3), (3, 3, 3)))))
    assert np.any(np.abs(eye) > 3.0)


def test_framing_is_repeatable() -> None:
    scene = _scene(box((-3, 0, -3), (3, 3, 3)).inside_out())
    np.testing.assert_array_equal(frame_scene(scene).world_from_camera, frame_scene(scene).world_from_camera)


def test_scene_without_triangles_is_an_input_error() -> None:
    with pytest.raises(InputError, match="no triangles"):
        frame_scene(_scene())


@pytest.mark.parametrize("target", [(0, 0, -1), (1, 0, 0), (0, -1, 0), (0, 5, 0), (1, 2, 3)])
def test_look_at_is_a_right_handed_pose_toward_the_target(target: tuple[int, int, int]) -> None:
    pose = look_at(np.zeros(3), np.array(target, float))
    np.testing.assert_allclose(pose[:3, :3] @ pose[:3, :3].T, np.eye(3), atol=1e-12)
    assert np.linalg.det(pose) == pytest.approx(1.0)
    np.testing.assert_allclose(-pose[:3, 2], np.array(target) / np.linalg.norm(target), atol=1e-12)


def test_look_straight_down_keeps_right_to_the_right() -> None:
    np.testing.assert_array_equal(look_at(np.array([0.0, 9, 0]), np.zeros(3))[:3, 0], [1, 0, 0])


FIRST = Camera(look_at(np.array([0.0, 0, 5]), np.zeros(3)), 0.7, 1.5, "first")
SECOND = Camera(look_at(np.array([5.0, 0, 0]), np.zeros(3)), 0.9, 1.0, "side view")


@pytest.mark.parametrize(
    ("spec", "expected"),
    [(None, "first"), ("0", "first"), ("1", "side view"), ("side view", "side view"), ("auto", "auto")],
)
def test_camera_is_found_by_index_name_or_default(spec: str | None, expected: str) -> None:
    scene = _scene(sphere(1.0, 8, 4), cameras=(FIRST, SECOND))
    assert camera_from_spec(scene, spec).name == expected


def test_scene_without_cameras_is_framed() -> None:
    assert camera_from_spec(_scene(sphere(1.0, 8, 4)), None).name == "auto"


def test_aspect_overrides_the_cameras() -> None:
    scene = _scene(sphere(1.0, 8, 4), cameras=(FIRST,))
    assert camera_from_spec(scene, "0").aspect == 1.5
    assert camera_from_spec(scene, "0", aspect=2.0).aspect == 2.0


@pytest.mark.parametrize("spec", ["2", "-1", "nowhere"])
def test_unknown_camera_is_an_input_error_that_lists_them(spec: str) -> None:
    scene = _scene(sphere(1.0, 8, 4), cameras=(FIRST, SECOND))
    with pytest.raises(InputError, match="side view"):
        camera_from_spec(scene, spec)


def test_saved_camera_comes_back(tmp_path: Path) -> None:
    file = tmp_path / "view.json"
    save_camera(SECOND, file)
    camera = camera_from_spec(_scene(), str(file))
    np.testing.assert_array_equal(camera.world_from_camera, SECOND.world_from_camera)
    assert camera.yfov_rad == pytest.approx(SECOND.yfov_rad)
    assert (camera.aspect, camera.name) == (SECOND.aspect, SECOND.name)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        '{"yfov_deg": 40}',
        '{"world_from_camera": [[1, 0], [0, 1]], "yfov_deg": 40}',
        '{"world_from_camera": [[0,0,0,0],[0,0,0,0],[0,0,0,0],[0,0,0,1]], "yfov_deg": 40}',
        '{"world_from_camera": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]], "yfov_deg": 180}',
        '{"world_from_camera": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]], "yfov_deg": 40, "aspect": 0}',
        '{"world_from_camera": [[NaN,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]], "yfov_deg": 40}',
    ],
)
def test_file_that_is_no_camera_is_an_input_error(text: str, tmp_path: Path) -> None:
    file = tmp_path / "view.json"
    file.write_text(text)
    with pytest.raises(InputError, match="expected a saved camera"):
        load_camera(file)


def test_absent_camera_file_is_an_input_error(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="expected a saved camera"):
        camera_from_spec(_scene(), str(tmp_path / "absent.json"))
