"""Reports: one HTML file that shows a bake or a field and proves it, without any request to the outside."""

from irradia.report.data import (
    Comparison,
    Convergence,
    EvaluationData,
    FieldSummary,
    LightmapSummary,
    LiveView,
    MapPicture,
    Performance,
    ReportData,
    Rival,
)
from irradia.report.neural_field import render_evaluation, write_evaluation
from irradia.report.page import render_report, write_report

__all__ = [
    "Comparison",
    "Convergence",
    "EvaluationData",
    "FieldSummary",
    "LightmapSummary",
    "LiveView",
    "MapPicture",
    "Performance",
    "ReportData",
    "Rival",
    "render_evaluation",
    "render_report",
    "write_evaluation",
    "write_report",
]
