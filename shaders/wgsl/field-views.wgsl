// What a field does inside, for debugging; parameters are those of the light.
// needs: field

// The first three outputs before the head: raw numbers.
fn irradia_view_raw(position: vec3f, normal: vec3f) -> vec3f {
    irradia_run(position, normal);
    return irradia_output(0u).xyz;
}

// The first three units of the last hidden layer, from −∞ to ∞ squeezed into 0 to 1, so that 0 is mid-grey.
fn irradia_view_hidden(position: vec3f, normal: vec3f) -> vec3f {
    irradia_run(position, normal);
    let units = irradia_units[0].xyz;
    return 0.5 + 0.5 * units / (1.0 + abs(units));
}

// The place in the field's box, as a colour.
fn irradia_view_position(position: vec3f, normal: vec3f) -> vec3f {
    return irradia_unit_position(position);
}
