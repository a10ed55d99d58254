"""How good a field is, as numbers: from arrays, whoever rendered or traced them."""

from irradia.field.evaluation.leaks import NEAR_WALL_M, LeakRatio, leak_ratio
from irradia.field.evaluation.pictures import Figure, PictureScores, score_picture
from irradia.field.evaluation.space import SpaceScores, score_in_space
from irradia.field.evaluation.speed import queries_per_second

__all__ = [
    "NEAR_WALL_M",
    "Figure",
    "LeakRatio",
    "PictureScores",
    "SpaceScores",
    "leak_ratio",
    "queries_per_second",
    "score_in_space",
    "score_picture",
]
