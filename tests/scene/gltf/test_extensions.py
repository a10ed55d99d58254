"""Extensions that aren't read stop the import or are noted, by what the file says of them."""

from __future__ import annotations

import pytest

from irradia.core.errors import InputError
from irradia.scene.gltf import document_to_scene


def test_required_ktx2_textures_name_the_tool_that_removes_them(gltf):
    gltf.triangle()
    gltf.use("KHR_texture_basisu", required=True)
    with pytest.raises(InputError, match=r"/extensionsRequired/0: .*KHR_texture_basisu.*\n.*ktxdecompress"):
        document_to_scene(gltf.document())


def test_required_unknown_extension_is_named(gltf):
    gltf.triangle()
    gltf.use("KHR_mesh_quantization", "ACME_voxels", required=True)
    with pytest.raises(InputError, match=r"/extensionsRequired/1: .*ACME_voxels"):
        document_to_scene(gltf.document())


def test_optional_unknown_extension_is_a_note(gltf):
    gltf.triangle()
    gltf.use("KHR_materials_clearcoat", "KHR_materials_ior", "KHR_xmp_json_ld")
    notes = document_to_scene(gltf.document()).notes
    assert notes == ("KHR_materials_clearcoat is optional here and not read: the bake goes without it",)


@pytest.mark.parametrize("names", ["KHR", [1], {"a": 1}])
def test_malformed_extension_lists_are_input_errors(gltf, names):
    gltf.triangle()
    gltf.json["extensionsUsed"] = names
    with pytest.raises(InputError, match="/extensionsUsed"):
        document_to_scene(gltf.document())
