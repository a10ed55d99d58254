"""The report: one HTML file that shows a bake and proves it, without any request to the outside."""

from irradia.report.data import (
    Comparison,
    Convergence,
    LightmapSummary,
    MapPicture,
    Performance,
    ReportData,
)
from irradia.report.page import render_report, write_report

__all__ = [
    "Comparison",
    "Convergence",
    "LightmapSummary",
    "MapPicture",
    "Performance",
    "ReportData",
    "render_report",
    "write_report",
]
