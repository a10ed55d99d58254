"""Datasets: points of a scene and the light there, for fields to learn from and to be judged by."""

from irradia.bake.datasets.generate import sample_info, sample_rows
from irradia.bake.datasets.options import SampleOptions
from irradia.bake.datasets.setting import BakedPages, Setting, set_up

__all__ = ["BakedPages", "SampleOptions", "Setting", "sample_info", "sample_rows", "set_up"]
