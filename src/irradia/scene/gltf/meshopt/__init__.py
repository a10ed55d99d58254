"""EXT_meshopt_compression and KHR_meshopt_compression: compressed buffer views."""

from irradia.scene.gltf.meshopt.buffer_view import decode_buffer_view

__all__ = ["decode_buffer_view"]
