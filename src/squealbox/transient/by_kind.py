"""Names in the march that its writer, `_engine`, fills in: laws and schedules by their kinds, with events or not."""

from squealbox.compiled import FLOAT, OfAnotherText

WITH_EVENTS = False
law_mu, law_slope = OfAnotherText("law_mu", FLOAT), OfAnotherText("law_slope", FLOAT)
law_creep, law_grip = OfAnotherText("law_creep", FLOAT), OfAnotherText("law_grip", FLOAT)
schedule_value, schedule_rate = OfAnotherText("schedule_value", FLOAT), OfAnotherText("schedule_rate", FLOAT)
