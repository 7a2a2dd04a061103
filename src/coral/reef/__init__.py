"""CORAL: a VLM-advised underwater robot surveys oyster reefs it has never seen.

What has no setting of its own goes with `planner.algorithm tour`; `paper` asks and checks as Alg. 2 does.

Departs from the paper: the prompts have neither its five points nor its order of priority rules; they ask for the dot
that has all that is left seen soonest.

Departs from the paper: a refusal names what would pass, so that a second answer need not guess.

Departs from the paper: an answer may name goals to go on with (`then`), expect what the map does not show (`expect`),
leave the rest to the robot (`explore_rest`) and end the survey (`end_survey`).

Departs from the paper: waypoints are measured from where the robot will be when the answer is needed, not from where it
was when it was asked.

Departs from the paper: the map also shows guesses beyond it (dots with `?`) and doubtful clusters (dots with `!`).

Departs from the paper: the clusters are joined by a tree with branches, where its chain is one path.

Departs from the paper: `planner.finished` refuses a way back by what was seen there, where it compares angles.
"""
