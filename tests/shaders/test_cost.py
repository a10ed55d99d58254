"""What shaders of fields say that they cost is what the Python package counts."""

from __future__ import annotations

from irradia.field.cost import query_cost
from irradia.field.files import load_field


def test_operations_are_those_of_the_formulas(cases, shaders):
    fields = [case for case in cases if case.source == "field"]
    assert fields
    for case in fields:
        assert shaders[case.name].json["cost"]["flops"] == query_cost(load_field(case.file).spec).flops, (
            case.name
        )


def test_bytes_are_those_that_are_bound(cases, shaders):
    for case in cases:
        shader = shaders[case.name]
        bound = sum(len(shader.data(each)) for each in (*shader.textures, *shader.uniforms))
        assert shader.json["cost"]["bytes"] == bound, case.name
