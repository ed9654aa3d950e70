"""Measured data: the user's tables and series (docs/data.md), and the peaks and valleys stated in the paper."""

from .columns import Convention
from .compare import Difference, compared
from .compare_forces import ForceDifference, compared_forces
from .drive import read_amplitude
from .features import Feature, stated_features
from .measured import Measured
from .misfit import Misfit, model_minus_measured
from .question import Answers, Question, Unclear, answers_of
from .reader import read_data, read_experiment
from .sensors import Sensors
from .series import Series, Shaker

__all__ = ["Answers", "Convention", "Difference", "Feature", "ForceDifference", "Measured", "Misfit", "Question",
           "Sensors", "Series", "Shaker", "Unclear", "answers_of", "compared", "compared_forces",
           "model_minus_measured", "read_amplitude", "read_data", "read_experiment", "stated_features"]
