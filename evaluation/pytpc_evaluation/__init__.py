"""How well TPC finds the wrong parameter: study, survey, the tables of the thesis, demo flights."""
