"""--ies gives lights a measured distribution."""

from __future__ import annotations

import pytest

from irradia.core.errors import InputError
from irradia.scene.ies_option import apply_ies
from irradia.scene.types import Light, Scene

IES = "IESNA:LM-63-2002\nTILT={tilt}\n1 -1 1 2 1 1 2 0 0 0 1 1 0\n0 90\n0\n100 50\n"


@pytest.fixture
def ies(tmp_path):
    path = tmp_path / "lamp=1.ies"
    path.write_text(IES.format(tilt="NONE"))
    return path


def scene() -> Scene:
    lights = (
        Light("point", (20.0, 10.0, 5.0), name="desk"),
        Light("spot", (0.0, 0.0, 0.0), name="wall"),
        Light("directional", (1.0, 1.0, 1.0), name="sun"),
    )
    return Scene("s", (), (), (), (), lights=lights)


def test_one_light_by_name(ies):
    desk, wall, sun = apply_ies(scene(), [f"desk={ies}"]).lights
    assert desk.profile is not None
    assert desk.profile.candela[0, 0] == 100.0
    assert desk.intensity == (1.0, 0.5, 0.25)
    assert wall.profile is None
    assert sun.profile is None


def test_all_points_and_spots_without_a_name_and_files_may_hold_equals_signs(ies):
    desk, wall, sun = apply_ies(scene(), [str(ies)]).lights
    assert desk.profile is wall.profile is not None
    assert wall.intensity == (1.0, 1.0, 1.0)
    assert sun == scene().lights[2]


def test_what_the_file_asks_for_in_vain_is_noted(tmp_path):
    path = tmp_path / "lamp.ies"
    path.write_text(IES.format(tilt="other.tlt"))
    (note,) = apply_ies(scene(), [str(path)]).notes
    assert "TILT=other.tlt is ignored" in note


def test_unknown_lights_and_files_are_input_errors(ies, tmp_path):
    with pytest.raises(InputError, match="Did you mean 'desk'"):
        apply_ies(scene(), [f"dsk={ies}"])
    with pytest.raises(InputError, match="can't read"):
        apply_ies(scene(), [f"desk={tmp_path / 'none.ies'}"])
    with pytest.raises(InputError, match="no point or spot"):
        apply_ies(Scene("s", (), (), (), (), lights=scene().lights[2:]), [str(ies)])
