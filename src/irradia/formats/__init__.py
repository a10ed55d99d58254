"""What is on disk: images, textures and lightmaps, read and written with NumPy arrays."""
