"""Light from outside the file: options first, then what the file asks for, then a default sky."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from irradia.core.errors import InputError
from irradia.scene.gltf.extras import irradia_extras
from irradia.scene.gltf.view import JsonView
from irradia.scene.types import Environment, Light, Rgb, Scene

DEFAULT_SKY_NOTE = (
    "The scene has no light of its own, so sun and sky were added; --env, --env-color or --sky choose, "
    "--no-default-light leaves it black."
)


@dataclass(frozen=True)
class LightOptions:
    """What the command line asked for; at most one of ``env``, ``env_color`` and ``sky``.

    Attributes:
        env: Equirectangular image.
        env_rotation_deg: Turns it about +Y.
        env_strength: Factor on its radiance, also on ``env_color``'s and the sky's.
        env_color: Uniform linear radiance.
        sky: Sun and sky.
        default_light: Whether a scene without any light gets a sky.
    """

    env: Path | None = None
    env_rotation_deg: float = 0.0
    env_strength: float = 1.0
    env_color: Rgb | None = None
    sky: bool = False
    default_light: bool = True

    def __post_init__(self) -> None:
        named = {"--env": self.env, "--env-color": self.env_color, "--sky": self.sky or None}
        given = [name for name, value in named.items() if value is not None]
        if len(given) > 1:
            raise InputError(f"only one of these can light the scene: {', '.join(given)}", where=given[0])


def light_scene(scene: Scene, options: LightOptions) -> Scene:
    """The scene under the light that options, or else the file, or else the default give it.

    Raises:
        InputError: The image can't be used, or the file's wishes are malformed.
    """
    from irradia.scene.environment import environment_from_color, load_environment

    if options.env is not None:
        return replace(
            scene,
            environment=load_environment(
                options.env, rotation_deg=options.env_rotation_deg, strength=options.env_strength
            ),
        )
    if options.env_color is not None:
        return replace(scene, environment=_scaled(environment_from_color(options.env_color), options))
    if options.sky:
        return _under_sky(scene, options)
    wishes = _wishes(scene)
    if wishes.has("environmentColor"):
        red, green, blue = wishes.numbers("environmentColor", (0.0, 0.0, 0.0))
        return replace(scene, environment=_scaled(environment_from_color((red, green, blue)), options))
    if wishes.has("sky"):
        sky = wishes.object("sky")
        return _under_sky(scene, options, _sky_arguments(sky), with_sun=sky.boolean("sun", True))
    if options.default_light and not has_light(scene):
        return _with_note(_under_sky(scene, options), DEFAULT_SKY_NOTE)
    return scene


def has_light(scene: Scene) -> bool:
    """Whether lights, emitting surfaces in use, or an environment are in the scene."""
    used = {scene.primitives[instance.primitive].material for instance in scene.instances}
    emits = any(max(scene.materials[index].emission) > 0.0 for index in used)
    return bool(scene.lights) or emits or scene.environment is not None


def _under_sky(
    scene: Scene, options: LightOptions, arguments: Mapping[str, float] | None = None, with_sun: bool = True
) -> Scene:
    from irradia.scene.sky import sky

    environment, sun = sky(**(arguments or {}))
    lights = (*scene.lights, _dimmed(sun, options.env_strength)) if with_sun else scene.lights
    return replace(scene, environment=_scaled(environment, options), lights=lights)


def _scaled(environment: Environment, options: LightOptions) -> Environment:
    return replace(environment, radiance=environment.radiance * options.env_strength)


def _dimmed(light: Light, strength: float) -> Light:
    red, green, blue = light.intensity
    return replace(light, intensity=(red * strength, green * strength, blue * strength))


def _wishes(scene: Scene) -> JsonView:
    """``extras.irradia`` at the document's root."""
    return irradia_extras(JsonView(scene.document.json)) if scene.document else JsonView({})


def _sky_arguments(view: JsonView) -> dict[str, float]:
    names = {
        "sunElevationDeg": "sun_elevation_deg",
        "sunAzimuthDeg": "sun_azimuth_deg",
        "turbidity": "turbidity",
    }
    return {argument: view.number(key, 0.0) for key, argument in names.items() if view.has(key)}


def _with_note(scene: Scene, note: str) -> Scene:
    return replace(scene, notes=(*scene.notes, note))
