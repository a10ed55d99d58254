"""Laws of the lightmap layout: everything has a place of its own, at the density that was asked for."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.core.progress import silent_progress
from irradia.scene.layout import LightmapLayout
from irradia.scene.lightmap_uv import LayoutOptions, layout_lightmap
from irradia.scene.merge import merge
from irradia.scene.types import Instance, Material, Primitive, Scene

SMALL = LayoutOptions(resolution=256, use_cache=False)


def primitive(
    positions: np.ndarray,
    indices: np.ndarray,
    uv1: np.ndarray | None = None,
    material: int = 0,
    index: int = 0,
) -> Primitive:
    """Triangles with flat normals where corners aren't shared."""
    positions = np.asarray(positions, np.float32)
    indices = np.asarray(indices, np.uint32)
    a, b, c = (positions[indices[:, k]] for k in range(3))
    face = np.cross(b - a, c - a)
    normals = np.zeros_like(positions)
    for k in range(3):
        np.add.at(normals, indices[:, k], face)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    empty = np.zeros((len(positions), 2), np.float32)
    return Primitive(
        positions=positions,
        normals=np.where(length > 0, normals / np.maximum(length, 1e-30), np.float32([0, 1, 0])).astype(
            np.float32
        ),
        texcoords=() if uv1 is None else (empty, np.asarray(uv1, np.float32)),
        colors=None,
        indices=indices,
        material=material,
        mesh_index=index,
        primitive_index=0,
        vertex_source=np.arange(len(positions), dtype=np.uint32),
        name=f"thing {index}",
    )


def cube_arrays() -> tuple[np.ndarray, np.ndarray]:
    """A unit cube of 24 vertices."""
    positions, indices = [], []
    for axis in range(3):
        for side in (-0.5, 0.5):
            corners = np.zeros((4, 3))
            corners[:, axis] = side
            corners[:, (axis + 1) % 3] = [-0.5, 0.5, 0.5, -0.5]
            corners[:, (axis + 2) % 3] = [-0.5, -0.5, 0.5, 0.5]
            base = 4 * len(positions)
            positions.append(corners)
            quad = np.array([[0, 1, 2], [0, 2, 3]]) + base
            indices.append(quad if side > 0 else quad[:, ::-1])
    return np.concatenate(positions), np.concatenate(indices)


def cube(**kwargs) -> Primitive:
    return primitive(*cube_arrays(), **kwargs)


def quad(uv1: np.ndarray | None = None) -> Primitive:
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]])
    return primitive(corners, np.array([[0, 1, 2], [0, 2, 3]]), uv1)


def placed(primitive_index: int, scale=1.0, at=(0, 0, 0), **kwargs) -> Instance:
    matrix = np.diag([*np.broadcast_to(np.asarray(scale, float), 3), 1.0])
    matrix[:3, 3] = at
    return Instance(primitive_index, matrix, node_index=0, **kwargs)


def scene(primitives: list[Primitive], instances: list[Instance], *materials: Material) -> Scene:
    return Scene("test", tuple(primitives), tuple(instances), materials or (Material(),), ())


def room() -> Scene:
    """A hall with a few boxes in it, each a primitive of its own."""
    sizes = [(10, 4, 8), (2, 1, 1), (1, 2, 0.7), (0.1, 0.1, 3)]
    return scene([cube(index=k) for k in range(4)], [placed(k, size) for k, size in enumerate(sizes)])


def lay_out(scene_: Scene, options: LayoutOptions = SMALL) -> LightmapLayout:
    return layout_lightmap(scene_, options, silent_progress())


def chart_pages(scene_: Scene, layout: LightmapLayout) -> np.ndarray:
    """(P, H, W) chart that a texel touches, or −1."""
    from irradia.bake.rasterise import rasterise

    texels = rasterise(merge(scene_, layout), layout)
    return texels.to_pages(texels.chart.astype(np.int64), fill=-1)


def smallest_gap_px(pages: np.ndarray) -> int:
    """Free texels between the two nearest charts, up to 3."""
    from scipy.ndimage import maximum_filter, minimum_filter

    for gap in range(4):
        size = (1, 2 * gap + 3, 2 * gap + 3)
        highest = maximum_filter(pages, size)
        lowest = minimum_filter(np.where(pages < 0, 1 << 40, pages), size)
        if ((pages >= 0) & (highest != lowest)).any():
            return gap
    return 3


def covered_share(scene_: Scene, layout: LightmapLayout) -> float:
    return float((chart_pages(scene_, layout) >= 0).mean())


def densities(scene_: Scene, layout: LightmapLayout) -> np.ndarray:
    """(T,) texels per metre of each triangle, 0 without area."""
    mesh = merge(scene_, layout)
    corners = mesh.positions[mesh.indices].astype(float)
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    uv = mesh.lightmap_uv[mesh.indices].astype(float) * layout.width_px
    first, second = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    texels = np.abs(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])
    return np.sqrt(texels / np.where(area > 0, area, np.inf))


# ---------------------------------------------------------------- places


def test_no_two_charts_come_closer_than_two_texels():
    assert smallest_gap_px(chart_pages(room(), lay_out(room()))) >= 2


def test_each_instance_has_its_own_place():
    row = [placed(0, 1.0, (2 * k, 0, 0)) for k in range(9)]
    repeated = scene([cube()], row)
    layout = lay_out(repeated)
    pages = chart_pages(repeated, layout)
    assert smallest_gap_px(pages) >= 2
    assert len(np.unique(pages[pages >= 0])) == 6 * 9
    assert len(np.unique(layout.offset, axis=0)) == 9


def test_instances_of_other_sizes_keep_their_charts_apart():
    sizes = np.geomspace(0.2, 3.0, 12)
    repeated = scene([cube()], [placed(0, s, (4 * k, 0, 0)) for k, s in enumerate(sizes)])
    assert smallest_gap_px(chart_pages(repeated, lay_out(repeated))) >= 2


def test_uv_stays_on_the_page():
    for one in (room(), scene([cube()], [placed(0), placed(0, 2.0)])):
        uv = merge(one, lay_out(one)).lightmap_uv
        assert uv.min() >= 0
        assert uv.max() <= 1


def test_rectangles_fill_whole_texels_from_border_to_border():
    from irradia.bake.rasterise import rasterise

    both = scene([quad(), cube()], [placed(0), placed(0, 2.0), placed(1)])
    layout = lay_out(both)
    texels = rasterise(merge(both, layout), layout)
    assert texels.coverage.min() > 0.9
    px = merge(both, layout).lightmap_uv * layout.width_px
    assert np.abs(px - np.rint(px)).max() < 0.05


def test_triangles_keep_their_order_and_corners():
    for unwrap, source in zip(lay_out(room()).unwraps, room().primitives, strict=True):
        assert np.array_equal(unwrap.vertex_source[unwrap.indices], source.indices)


def test_unlit_materials_and_scale_zero_take_no_lightmap():
    mixed = scene(
        [cube(), cube(material=1)],
        [placed(0), placed(0, lightmap_scale=0.0), placed(1)],
        Material(),
        Material(unlit=True),
    )
    layout = lay_out(mixed)
    assert layout.page.tolist() == [0, -1, -1]
    assert layout.unwraps[1] is None


def test_a_scene_where_nothing_takes_a_lightmap_has_no_page():
    layout = lay_out(scene([cube()], [placed(0, lightmap_scale=0.0)]))
    assert layout.n_pages == 0
    assert layout.notes


# ---------------------------------------------------------------- density


def test_density_is_even_over_surfaces_and_objects():
    found = densities(room(), lay_out(room(), LayoutOptions(resolution=1024, use_cache=False)))
    assert found.max() / found.min() < 1.25


def test_uneven_scales_are_unfolded_as_they_stand():
    slab = scene([cube()], [placed(0, (8.0, 4.0, 2.0))])
    found = densities(slab, lay_out(slab))
    assert found.max() / found.min() < 1.1


def test_asked_texels_per_metre_are_reached():
    layout = lay_out(room(), LayoutOptions(texels_per_metre=30.0, use_cache=False))
    assert layout.texels_per_metre == pytest.approx(30.0, rel=0.05)
    assert np.median(densities(room(), layout)) == pytest.approx(30.0, rel=0.1)
    assert layout.width_px % 4 == 0


def test_mirrored_and_moved_objects_get_the_same_density():
    matrix = np.diag([-2.0, 2.0, 2.0, 1.0])
    both = scene([cube(), cube()], [placed(0, 2.0), Instance(1, matrix, node_index=1)])
    found = densities(both, lay_out(both))
    assert found.max() / found.min() < 1.1


def test_lightmap_scale_multiplies_the_density():
    both = scene([cube(), cube()], [placed(0), placed(1, lightmap_scale=2.0)])
    found = densities(both, lay_out(both))
    assert found[12:].mean() / found[:12].mean() == pytest.approx(2.0, rel=0.05)


def test_a_resolution_gives_one_page_of_that_size_well_filled():
    layout = lay_out(room(), LayoutOptions(resolution=512, use_cache=False))
    assert (layout.n_pages, layout.width_px, layout.height_px) == (1, 512, 512)
    assert covered_share(room(), layout) > 0.6


def test_without_options_there_are_about_a_million_texels():
    layout = lay_out(room(), LayoutOptions(use_cache=False))
    total = layout.n_pages * layout.width_px * layout.height_px
    assert 0.9 < total / 1e6 < 1.2
    assert any("1 page" in note for note in layout.notes)


@pytest.mark.parametrize("model", ["flight-helmet/FlightHelmet.gltf", "antique-camera/AntiqueCamera.gltf"])
def test_scanned_models_fill_over_sixty_percent_of_the_page(shared_assets, model):
    from irradia.scene.load import load_scene

    loaded = load_scene(str(shared_assets / model))
    layout = lay_out(loaded, LayoutOptions())
    pages = chart_pages(loaded, layout)
    assert (pages >= 0).mean() > 0.6
    assert smallest_gap_px(pages) >= 1


def test_what_exceeds_a_page_is_spread_over_several():
    boxes = scene([cube(index=k) for k in range(12)], [placed(k) for k in range(12)])
    layout = lay_out(boxes, LayoutOptions(texels_per_metre=40.0, max_page_px=128, use_cache=False))
    assert layout.n_pages > 1
    assert layout.width_px <= 128
    assert np.unique(layout.page).tolist() == list(range(layout.n_pages))
    assert smallest_gap_px(chart_pages(boxes, layout)) >= 2
    assert np.median(densities(boxes, layout)) == pytest.approx(40.0, rel=0.1)


def test_an_object_larger_than_a_page_has_fewer_texels():
    layout = lay_out(scene([cube()], [placed(0)]), LayoutOptions(texels_per_metre=500.0, max_page_px=128))
    assert (layout.n_pages, layout.width_px) == (1, 128)
    assert any("larger than a page" in note for note in layout.notes)


def test_an_object_below_one_texel_is_noted_and_has_a_texel():
    both = scene([cube(), cube(index=1)], [placed(0, 10.0), placed(1, 1e-4, name="crumb")])
    layout = lay_out(both)
    pages = chart_pages(both, layout)
    assert any("crumb" in note for note in layout.notes)
    assert (pages >= 6).any()


@pytest.mark.parametrize(
    ("wrong", "where"),
    [
        ({"resolution": 0}, "--resolution"),
        ({"resolution": 10**6}, "--resolution"),
        ({"texels_per_metre": 0.0}, "--texels-per-metre"),
        ({"texels_per_metre": float("nan")}, "--texels-per-metre"),
    ],
)
def test_absurd_sizes_are_refused(wrong, where):
    with pytest.raises(InputError) as caught:
        LayoutOptions(**wrong)
    assert caught.value.where == where


def test_density_and_resolution_exclude_each_other():
    with pytest.raises(InputError, match="both"):
        LayoutOptions(texels_per_metre=1.0, resolution=64)


def test_a_density_that_no_machine_holds_is_refused():
    with pytest.raises(InputError, match="texels per metre"):
        lay_out(room(), LayoutOptions(texels_per_metre=1e5, use_cache=False))


def test_charts_that_cannot_fit_the_resolution_are_refused():
    crowd = scene([cube()], [placed(0, 1.0, (2 * k, 0, 0)) for k in range(40)])
    with pytest.raises(InputError, match="240 charts"):
        lay_out(crowd, LayoutOptions(resolution=16, use_cache=False))


# ---------------------------------------------------------------- uv of the file

UNIT = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float)


def test_valid_uv_of_the_file_is_kept():
    kept = quad(0.1 + 0.5 * UNIT)
    layout = lay_out(scene([kept], [placed(0)]))
    assert np.array_equal(layout.unwraps[0].uv, kept.texcoords[1])
    assert np.array_equal(layout.unwraps[0].indices, kept.indices)
    assert covered_share(scene([kept], [placed(0)]), layout) > 0.9


def test_charts_of_the_file_are_its_connected_parts():
    positions, indices = cube_arrays()
    uv1 = np.concatenate([UNIT * 0.28 + [0.33 * (k % 3), 0.5 * (k // 3)] for k in range(6)])
    layout = lay_out(scene([primitive(positions, indices, uv1)], [placed(0)]))
    halves = layout.unwraps[0].chart.reshape(6, 2)
    assert np.array_equal(halves[:, 0], halves[:, 1])
    assert sorted(halves[:, 0]) == list(range(6))


@pytest.mark.parametrize(
    ("uv1", "reason"),
    [
        (UNIT + 0.5, "unit square"),
        (np.where(UNIT > 0, np.nan, 0.2), "finite"),
        (np.array([[0, 0], [1, 0], [1, 1], [0.9, 0.1]]), "overlaps"),
        (np.zeros((4, 2)), "nothing"),
    ],
)
def test_unfit_uv_is_replaced_and_the_reason_told(uv1, reason):
    one = scene([quad(uv1)], [placed(0)])
    layout = lay_out(one)
    assert any(reason in note for note in layout.notes)
    assert covered_share(one, layout) > 0.9


# ---------------------------------------------------------------- trouble


def test_triangles_without_area_stay_with_their_neighbours():
    positions, indices = cube_arrays()
    positions = np.concatenate([positions, [[0.5, 0.5, 0.5]] * 3])
    indices = np.concatenate([indices[:5], [[24, 25, 26]], indices[5:]])
    broken = scene([primitive(positions, indices)], [placed(0)])
    layout = lay_out(broken)
    unwrap = layout.unwraps[0]
    assert np.array_equal(unwrap.vertex_source[unwrap.indices], indices)
    assert len(np.unique(unwrap.uv[unwrap.indices[5]], axis=0)) == 1
    assert smallest_gap_px(chart_pages(broken, layout)) >= 2


def test_a_primitive_without_area_gets_one_texel():
    nothing = primitive(np.zeros((3, 3)), [[0, 1, 2]])
    both = scene([cube(), nothing], [placed(0), placed(1)])
    layout = lay_out(both)
    assert (chart_pages(both, layout) == 6).sum() == 1


def test_sizes_far_from_a_metre_unwrap_alike():
    reference = lay_out(scene([cube()], [placed(0)]))
    for scale in (1e-5, 1e5):
        other = lay_out(scene([cube()], [placed(0, scale)]))
        assert np.allclose(other.unwraps[0].uv, reference.unwraps[0].uv, atol=2e-2)
        assert other.texels_per_metre * scale == pytest.approx(reference.texels_per_metre, rel=0.02)


def test_the_same_scene_gives_the_same_bytes():
    def once() -> list[bytes]:
        layout = lay_out(room())
        return [layout.scale.tobytes(), layout.offset.tobytes(), *(u.uv.tobytes() for u in layout.unwraps)]

    assert once() == once()


# ---------------------------------------------------------------- cache


@pytest.fixture
def sphere() -> Scene:
    """A thousand triangles, enough to be kept."""
    n = 24
    theta, phi = np.meshgrid(np.linspace(0, np.pi, n + 1), np.linspace(0, 2 * np.pi, n + 1), indexing="ij")
    points = np.stack([np.sin(theta) * np.cos(phi), np.cos(theta), np.sin(theta) * np.sin(phi)], -1).reshape(
        -1, 3
    )
    corner = np.arange(n * (n + 1)).reshape(n, n + 1)[:, :-1].ravel()
    quads = np.stack([corner, corner + 1, corner + n + 2, corner + n + 1], 1)
    return scene([primitive(points, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]))], [placed(0)])


@pytest.fixture
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("IRRADIA_CACHE", str(tmp_path))
    return tmp_path / "unwrap"


def uv_bytes(scene_: Scene, **options) -> bytes:
    return lay_out(scene_, LayoutOptions(resolution=256, **options)).unwraps[0].uv.tobytes()


def test_a_kept_unwrap_gives_the_same_bytes(sphere, own_cache, monkeypatch):
    fresh = uv_bytes(sphere)
    assert len(list(own_cache.iterdir())) == 1
    from irradia.scene.lightmap_uv import unwrap

    monkeypatch.setattr(unwrap, "_cut", None)  # a second unwrap would call this
    assert uv_bytes(sphere) == fresh


def test_other_geometry_is_unwrapped_anew(sphere, own_cache):
    uv_bytes(sphere)
    stretched = dataclasses.replace(sphere, instances=(placed(0, (1, 2, 1)),))
    uv_bytes(stretched)
    assert len(list(own_cache.iterdir())) == 2


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04 cut off"])
def test_a_broken_cache_file_is_replaced(sphere, own_cache, content):
    fresh = uv_bytes(sphere)
    (kept,) = own_cache.iterdir()
    kept.write_bytes(content)
    assert uv_bytes(sphere) == fresh
    assert kept.stat().st_size > len(content)


def test_without_the_cache_nothing_is_written(sphere, own_cache):
    uv_bytes(sphere, use_cache=False)
    assert not own_cache.exists()
