from .candidates import Candidate, candidates_for
from .production import usual_scatter
from .ranking import Remedies, silence
from .settings import SilenceSettings

__all__ = ["Candidate", "Remedies", "SilenceSettings", "candidates_for", "silence", "usual_scatter"]
