"""glTF 2.0: files to documents, documents to scenes."""

from irradia.scene.gltf.document import GltfDocument
from irradia.scene.gltf.read import make_document, read_document
from irradia.scene.gltf.to_scene import document_to_scene

__all__ = ["GltfDocument", "document_to_scene", "make_document", "read_document"]
