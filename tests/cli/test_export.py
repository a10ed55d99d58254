"""``irradia export``."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from irradia.cli import app
from irradia.export.container import glb_container
from irradia.export.field_extension import read_baked_field
from irradia.field.bin_conventions import BinConventions
from irradia.field.bin_reader import decode_bin
from irradia.field.files import load_field, read_field, save_field
from irradia.formats.samples import SampleFile, SampleInfo, SampleWriter
from irradia.formats.samples_bin import write_samples_bin
from irradia.scene.gltf import read_document

ROOT = Path(__file__).resolve().parents[2]
GRID = ROOT / "vectors" / "hash-fp32.safetensors"
PLANES_BIN = ROOT / "vectors" / "triplane-bin.bin"
BOX = ((-1.0, 0.0, 0.5), (1.0, 2.25, 4.5))


@pytest.fixture
def export(capfd):
    def run(*arguments: Any) -> tuple[int, dict[str, Any]]:
        code = app.run(["export", *map(str, arguments), "--json"])
        return code, json.loads(capfd.readouterr().out)

    return run


def places(n: int = 64) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(9)
    normals = rng.normal(size=(n, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return rng.uniform(*BOX, (n, 3)).astype(np.float32), normals.astype(np.float32)


def samples(path: Path, light: np.ndarray, quantity: str = "full") -> Path:
    rows = np.hstack([*places(len(light)), light, np.zeros((len(light), 1))]).astype(np.float32)
    with SampleWriter(path, SampleInfo("volume", BOX, quantity)) as writer:
        writer.append(rows)
    return path


@pytest.mark.parametrize("name", ["a.safetensors", "a.safetensors.zst", "a.bin"])
def test_formats_hold_the_same_field(export, tmp_path: Path, name: str) -> None:
    code, said = export(GRID, "-o", tmp_path / name)
    assert (code, said["bytes"]) == (0, (tmp_path / name).stat().st_size)
    same = load_field(tmp_path / name).irradiance(*places())
    np.testing.assert_allclose(same, load_field(GRID).irradiance(*places()), rtol=5e-3)


@pytest.mark.parametrize("bits", [4, 8])
def test_tables_are_rounded_and_taught(export, tmp_path: Path, bits: int) -> None:
    truth = 1.25 * load_field(GRID).irradiance(*places(4000))  # so there is something to learn
    data = samples(tmp_path / "d.samples", truth, load_field(GRID).frame.quantity)
    rounded, taught = tmp_path / "r.safetensors", tmp_path / "t.safetensors"
    assert export(GRID, "-o", rounded, "--finish", f"int{bits}")[0] == 0
    assert export(GRID, "-o", taught, "--finish", f"int{bits}", "--samples", data)[0] == 0
    errors = []
    for path in (rounded, taught):
        stored = read_field(path)
        assert stored.provenance["export"]["config"]["finish"] == f"int{bits}"
        assert stored.provenance["export"]["inputs"].keys() >= {GRID.name}
        assert {tensor.bits for tensor in stored.tensors.values()} == {bits}
        errors.append(np.abs(stored.field.irradiance(*places(4000)) - truth).mean())
    assert errors[1] < 0.5 * errors[0]


def test_conventions_are_named_or_found(export, tmp_path: Path) -> None:
    truth = decode_bin(PLANES_BIN.read_bytes(), BinConventions(bias="before", normal="unit"))
    light = truth.irradiance(*places(64))
    named, found = tmp_path / "named.safetensors", tmp_path / "found.safetensors"
    code, _ = export(PLANES_BIN, "-o", named, "--convention", "bias=before", "--convention", "normal=unit")
    assert code == 0
    np.testing.assert_allclose(load_field(named).irradiance(*places()), light, rtol=5e-3)
    code, said = export(PLANES_BIN, "-o", found, "--calibrate", samples(tmp_path / "d.samples", light))
    assert code == 0
    assert said["calibration"]["conventions"]["bias"] == "before"
    assert said["calibration"]["error"] < 1e-3
    np.testing.assert_allclose(load_field(found).irradiance(*places()), light, rtol=5e-3)


@pytest.mark.parametrize(
    "arguments",
    [
        ("-o", "x.glb"),
        ("-o", "x.pt"),
        ("-o", "x.bin", "--preset", "lamp"),
        ("-o", "x.bin", "--convention", "bias=lamp"),
        ("-o", "x.safetensors", "--calibrate", str(GRID)),
        ("-o", "x.safetensors", "--preset", "pytorch"),
        ("-o", "x.safetensors", "--convention", "bias=last"),
        ("-o", "x.safetensors", "--samples", str(GRID)),
        ("-o", "x.safetensors", "--quantity", "indirect"),
        ("-o", "x.bin", "--precision", "fp32"),
        ("-o", "x.bin", "--finish", "int8"),
    ],
)
def test_wrong_options_are_bad_input(capfd, tmp_path: Path, monkeypatch, arguments) -> None:
    monkeypatch.chdir(tmp_path)
    assert app.run(["export", str(GRID), *arguments]) == 2
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("out", [("-o", "x.glb"), ("-o", "x.glb", "--scene", str(GRID)), ("-o", "x.bin")])
def test_nothing_is_finished_that_cannot_be_written(tmp_path: Path, monkeypatch, out) -> None:
    def finish(*_: Any, **__: Any) -> None:
        raise AssertionError("finished before the check")

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("irradia.field.quantise.finish", finish)
    data = samples(tmp_path / "d.samples", np.ones((64, 3)))
    assert app.run(["export", str(GRID), *out, "--finish", "int8", "--samples", str(data)]) == 2


def test_samples_to_finish_by_are_of_the_fields_light(tmp_path: Path, capfd) -> None:
    quantity = {"full": "indirect", "indirect": "full"}[load_field(GRID).frame.quantity]
    data = samples(tmp_path / "d.samples", np.ones((64, 3)), quantity)
    out = tmp_path / "x.safetensors"
    assert app.run(["export", str(GRID), "-o", str(out), "--finish", "int8", "--samples", str(data)]) == 2
    assert "light as the field holds" in capfd.readouterr().err


def test_a_bin_of_samples_is_read_as_is_said(export, tmp_path: Path) -> None:
    field = load_field(ROOT / "vectors" / "hash-sh1.safetensors")
    save_field(tmp_path / "sh.bin", field)
    positions, _ = places(64)
    rows = np.hstack([positions, field.coefficients(positions).reshape(64, 12), np.zeros((64, 1))])
    source = SampleFile(
        tmp_path / "d.samples", SampleInfo("sh", BOX, n_coefficients=4), rows.astype(np.float32)
    )
    write_samples_bin(tmp_path / "d.bin", source, coefficients="irradiance")
    known = ("-o", tmp_path / "f.safetensors", "--calibrate", tmp_path / "d.bin")
    code, said = export(tmp_path / "sh.bin", *known, "--coefficients", "irradiance", "--quantity", "indirect")
    assert code == 0
    assert said["calibration"]["error"] < 5e-3
    assert load_field(tmp_path / "f.safetensors").frame.quantity == "indirect"
    code, said = export(tmp_path / "sh.bin", *known)
    assert code == 2 or said["calibration"]["error"] > 0.05


def test_samples_of_other_light_are_not_believed(capfd, tmp_path: Path) -> None:
    noise = np.random.default_rng(1).uniform(0, 50, (64, 3))
    data = samples(tmp_path / "d.samples", noise)
    out = tmp_path / "x.safetensors"
    assert app.run(["export", str(PLANES_BIN), "-o", str(out), "--calibrate", str(data)]) == 2
    assert "no conventions explain" in capfd.readouterr().err
    assert not out.exists()


def bare_scene(path: Path) -> Path:
    """A baked scene with nothing inside."""
    root = {"asset": {"version": "2.0"}, "extensions": {"IRRADIA_lighting": {"version": 1}}}
    path.write_bytes(glb_container(root, b""))
    return path


def test_field_goes_into_a_baked_scene(export, tmp_path: Path) -> None:
    scene = bare_scene(tmp_path / "scene.baked.glb")
    code, said = export(GRID, "-o", tmp_path / "out.glb", "--scene", scene, "--precision", "fp32")
    assert (code, said["bytes"]) == (0, (tmp_path / "out.glb").stat().st_size)
    stored = read_baked_field(read_document(tmp_path / "out.glb"))
    assert stored is not None
    same = stored.field.irradiance(*places())
    np.testing.assert_array_equal(same, load_field(GRID).irradiance(*places()))


def test_a_field_comes_out_of_a_baked_scene_as_it_went_in(export, tmp_path: Path) -> None:
    glb, small = bare_scene(tmp_path / "scene.baked.glb"), tmp_path / "small.safetensors"
    assert export(GRID, "-o", small, "--finish", "int8")[0] == 0
    assert export(small, "-o", tmp_path / "with.glb", "--scene", glb)[0] == 0
    code, said = export(tmp_path / "with.glb", "-o", tmp_path / "out.safetensors")
    assert code == 0
    assert said["bytes"] == (tmp_path / "out.safetensors").stat().st_size
    before, after = read_field(small), read_field(tmp_path / "out.safetensors")
    np.testing.assert_array_equal(before.field.irradiance(*places()), after.field.irradiance(*places()))
    assert after.tensors.keys() == before.tensors.keys()
    assert {tensor.bits for tensor in after.tensors.values()} == {8}
    assert after.provenance["export"]["inputs"].keys() == {"with.glb"}


def test_a_scene_without_a_field_has_none_to_read_out(tmp_path: Path, capfd) -> None:
    glb = bare_scene(tmp_path / "scene.baked.glb")
    assert app.run(["export", str(glb), "-o", str(tmp_path / "out.safetensors")]) == 2
    assert "no field inside" in capfd.readouterr().err
    assert not (tmp_path / "out.safetensors").exists()
