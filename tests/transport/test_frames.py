"""Tangent frames are square and finite, whatever the tangents are."""

from __future__ import annotations

import numpy as np
import pytest

pytestmark = pytest.mark.usefixtures("cpu_device")

NORMAL = np.array([0.36, 0.48, 0.8])


def frame_of(tangents):
    """The frame in the middle of one triangle with these three tangents, as rows."""
    from irradia.transport.backend import mi
    from irradia.transport.frames import TangentFrames

    frames = TangentFrames(np.asarray(tangents, np.float32)[None])
    normal = mi.Vector3f(*map(float, NORMAL))
    frame = frames.at(mi.UInt32(0), mi.Point2f(1 / 3, 1 / 3), normal, mi.Bool(True))
    return np.array([np.array(axis).ravel() for axis in (frame.tangent, frame.bitangent, frame.normal)])


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    "tangents",
    [
        [[0.8, -0.6, 0.0]] * 3,
        [[0.8, -0.6, 0.3], [0.9, 0.0, 0.1], [0.5, -0.6, 0.0]],
        [[0.0, 0.0, 0.0]] * 3,
        [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 0.0]],
        [NORMAL] * 3,
    ],
    ids=["square", "askew", "none", "opposite", "along the normal"],
)
def test_frames_are_orthonormal_and_of_the_handedness_that_the_sign_says(tangents, sign):
    frame = frame_of([[*tangent, sign] for tangent in tangents])
    np.testing.assert_allclose(frame @ frame.T, np.eye(3), atol=1e-5)
    assert np.linalg.det(frame) == pytest.approx(sign, abs=1e-5)


def test_tangent_points_where_the_corners_say():
    np.testing.assert_allclose(frame_of([[0.8, -0.6, 0.0, 1.0]] * 3)[0], [0.8, -0.6, 0.0], atol=1e-6)
