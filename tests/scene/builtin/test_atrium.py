"""The showcase keeps to its budget, is sealed like a building, and stands under its own sky."""

from __future__ import annotations

import json

import numpy as np
import pytest

from irradia.scene.builtin.atrium import SUN_AZIMUTH_DEG, SUN_ELEVATION_DEG, SUN_LUX, TURBIDITY, plan

# Where people stand: the court, each arcade and gallery, the landing, the hall's corners.
STANDPOINTS_M = [
    (0.0, 1.7, 2.5),
    (-8.0, 1.7, -6.8),
    (5.0, 1.7, 6.8),
    (-13.0, 1.7, 0.0),
    (13.0, 1.6, -7.2),
    (-4.0, 6.9, -6.5),
    (3.0, 6.9, 6.5),
    (-13.0, 6.9, 1.0),
    (13.0, 4.3, 0.0),
    (13.0, 6.9, -7.0),
    (13.0, 6.9, 7.0),
]
N_RAYS = 50_000


def test_atrium_has_some_175_000_triangles_in_shared_meshes(parts, document):
    assert 150_000 < sum(len(p.indices) for p in parts("atrium")) < 185_000
    entry = document("atrium").json
    assert len(entry["meshes"]) < 0.5 * len([n for n in entry["nodes"] if "mesh" in n])


def test_document_leaves_most_of_25_mb_to_the_lightmap(document):
    built = document("atrium")
    assert len(built.buffers[0]) + len(json.dumps(built.json)) < 6 << 20


def test_no_back_face_shows_from_inside(parts, document, cpu_device):
    from irradia.transport.backend import mi

    single_sided = {m["name"] for m in document("atrium").json["materials"] if not m.get("doubleSided")}
    corners = np.concatenate([p.positions[p.indices] for p in parts("atrium")])
    one_sided = np.concatenate([[p.material in single_sided] * len(p.indices) for p in parts("atrium")])
    geometric = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    mesh = mi.Mesh("atrium", 3 * len(corners), len(corners))
    params = mi.traverse(mesh)
    params["vertex_positions"] = corners.astype(np.float32).ravel()
    params["faces"] = np.arange(3 * len(corners), dtype=np.uint32)
    params.update()
    scene = mi.load_dict({"type": "scene", "mesh": mesh})
    rng = np.random.default_rng(1)
    n_back = n_hit = 0
    for standpoint in STANDPOINTS_M:
        direction = rng.normal(size=(N_RAYS, 3)).astype(np.float32)
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        ray = mi.Ray3f(mi.Point3f(*standpoint), mi.Vector3f(direction.T.copy()))
        hit = scene.ray_intersect_preliminary(ray)
        valid = np.array(hit.is_valid())
        triangle = np.array(hit.prim_index)[valid]
        backward = np.einsum("nc,nc->n", direction[valid], geometric[triangle]) > 0
        n_back += int((backward & one_sided[triangle]).sum())
        n_hit += len(triangle)
    # A ray in 10⁵ may slip between two stones that only touch.
    assert n_hit > 0.8 * N_RAYS * len(STANDPOINTS_M)
    assert n_back <= 1e-5 * n_hit


def test_sun_is_that_of_the_sky_it_asks_for(document):
    from irradia.scene.sky import sky

    _, sun = sky(SUN_ELEVATION_DEG, SUN_AZIMUTH_DEG, TURBIDITY)
    np.testing.assert_allclose(SUN_LUX, sun.intensity, rtol=1e-3)
    (light,) = document("atrium").json["extensions"]["KHR_lights_punctual"]["lights"]
    assert light["extras"]["irradia"]["angleDeg"] == sun.angle_deg
    node = next(n for n in document("atrium").json["nodes"] if n["name"] == "sun")
    x, y, z, w = node["rotation"]
    minus_z_turned = -np.array([2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)])
    np.testing.assert_allclose(minus_z_turned, sun.direction, atol=1e-6)


def test_first_camera_stands_in_the_court_at_eye_height_in_16_to_9(document):
    entry = document("atrium").json
    node = next(n for n in entry["nodes"] if n.get("camera") == 0)
    x, y, z = node["matrix"][12:15]
    assert abs(x) < plan.STEP_X
    assert abs(z) < plan.STEP_Z
    assert y == pytest.approx(1.7, abs=0.1)
    assert entry["cameras"][0]["perspective"]["aspectRatio"] == pytest.approx(16 / 9)


def test_colour_bleeds_from_saturated_cloth(document):
    cloths = [m for m in document("atrium").json["materials"] if m["name"].endswith("cloth")]
    assert len(cloths) >= 4
    for material in cloths:
        red_green_blue = material["pbrMetallicRoughness"]["baseColorFactor"][:3]
        assert max(red_green_blue) > 5 * min(red_green_blue)
