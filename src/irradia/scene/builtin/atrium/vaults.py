"""The ground floor's ceiling: brick groin vaults between stone ribs that spring from pilasters."""

from __future__ import annotations

from irradia.scene.builtin import profiles
from irradia.scene.builtin.arch import groin_vault
from irradia.scene.builtin.atrium import plan
from irradia.scene.builtin.atrium.materials import Materials
from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.mesh import Mesh
from irradia.scene.builtin.sweep import square_moulding, sweep_arc

RISE = 1.32
_WALL_FACE_X = plan.HALF_X + plan.LOWER_WALL / 2
_WALL_FACE_Z = plan.HALF_Z + plan.LOWER_WALL / 2
_DEPTH_X, _DEPTH_Z = plan.INNER_X - _WALL_FACE_X, plan.INNER_Z - _WALL_FACE_Z


def add_vaults(scene: SceneBuilder, materials: Materials) -> None:
    """Vaults, ribs and pilasters of the three arcades."""
    middle_x, middle_z = (_WALL_FACE_X + plan.INNER_X) / 2, (_WALL_FACE_Z + plan.INNER_Z) / 2
    bay = scene.mesh("vault", (_vault(plan.BAY / 2, _DEPTH_Z / 2), materials.brick))
    for k, (x, z, yaw) in enumerate(plan.arcade_spots(plan.BAY)):
        place = (x, 0.0, middle_z if z > 0 else -middle_z) if yaw != 90.0 else (-middle_x, 0.0, z)
        scene.node(f"vault {k}", mesh=bay, translation=place, yaw_deg=yaw)
    corner = scene.mesh("corner vault", (_vault(_DEPTH_X / 2, _DEPTH_Z / 2), materials.brick))
    for k, (x, z) in enumerate(plan.corners(middle_x, middle_z)):
        scene.node(f"corner vault {k}", mesh=corner, translation=(x, 0, z))
    _add_ribs(scene, materials, middle_x, middle_z)


def _add_ribs(scene: SceneBuilder, materials: Materials, middle_x: float, middle_z: float) -> None:
    """A rib across the arcade at each column, wider ones where the corners begin."""
    parts = {
        width: scene.mesh(f"rib {width}", (_rib(_DEPTH_Z / 2, width), materials.limestone))
        for width in (0.44, 0.62)
    }
    pilaster = scene.mesh("pilaster", (_pilaster(), materials.limestone))
    spots = [(x, z, yaw, 0.44) for x, z, yaw in plan.column_spots(plan.BAY)]
    nudge = plan.LOWER_WALL / 4
    for z, yaw in ((-plan.HALF_Z, 0.0), (plan.HALF_Z, 180.0)):
        spots += [(x, z, yaw, 0.62) for x in (-plan.HALF_X - nudge, plan.HALF_X + nudge)]
    spots += [(-plan.HALF_X, z, 90.0, 0.62) for z in (-plan.HALF_Z - nudge, plan.HALF_Z + nudge)]
    for k, (x, z, yaw, width) in enumerate(spots):
        across = yaw == 90.0
        place = (-middle_x, 0.0, z) if across else (x, 0.0, middle_z if z > 0 else -middle_z)
        foot = (-plan.INNER_X, 0.0, z) if across else (x, 0.0, plan.INNER_Z if z > 0 else -plan.INNER_Z)
        scene.node(f"rib {k}", mesh=parts[width], translation=place, yaw_deg=yaw + 90)
        scene.node(f"pilaster {k}", mesh=pilaster, translation=foot, yaw_deg=yaw)


def _vault(half_x: float, half_z: float) -> Mesh:
    return groin_vault(half_x, half_z, plan.SPRING_Y, RISE, 20)


def _rib(half_span: float, width: float) -> Mesh:
    """An arch band of ``width`` along z under the vault, spanning x: three faces, chamfered."""
    half, drop, cut = width / 2, 0.13, 0.04
    profile = [
        (-half, 0.10), (-half, -drop + cut), (-half + cut, -drop),
        (half - cut, -drop), (half, -drop + cut), (half, 0.10),
    ]  # fmt: skip
    return sweep_arc(profile, half_span, 16, rise=RISE).moved(y=plan.SPRING_Y)


def _pilaster() -> Mesh:
    """A flat pier on the outer wall under each rib, with base and cap; the wall is at z = 0, front +Z."""
    low, high = plan.ARCADE_Y, plan.SPRING_Y
    profile = profiles.chain(
        (0.06, low),
        (0.06, low + 0.24),
        profiles.scotia(0.05, 0.0, low + 0.26, 0.09, 0.008, 4),
        (0.0, high - 0.26),
        profiles.torus(0.0, high - 0.26, 0.04, 4),
        (0.0, high - 0.20),
        profiles.cyma(0.0, 0.075, high - 0.18, 0.10, 5),
        (0.085, high - 0.07),
        (0.085, high),
        (-0.1, high),
    )
    return square_moulding(profile, 0.29, 0.15)
