"""Neural irradiance fields: encodings, networks, training. Works from arrays, and needs no renderer."""
