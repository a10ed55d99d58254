"""The bake: texels, epochs, denoise, dilation; arrays in, arrays out."""
