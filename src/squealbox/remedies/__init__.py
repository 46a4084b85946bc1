"""What would silence this brake? Depends on: countermeasures, control, stability, transient, studies, loops, result."""

from squealbox.remedies.candidates import Candidate, candidates_for
from squealbox.remedies.production import usual_scatter
from squealbox.remedies.ranking import Remedies, silence
from squealbox.remedies.settings import SilenceSettings

__all__ = ["Candidate", "Remedies", "SilenceSettings", "candidates_for", "silence", "usual_scatter"]
