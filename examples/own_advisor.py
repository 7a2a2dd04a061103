"""An advisor of your own: it chooses the nearest new cluster. If it has no answer, the fallback's rules decide."""

import coral
from coral.advisor.question import AdvisorUnavailable, Reply


class Nearest:
    """Chooses by the numbers behind the pictures; a model would look at `question.images` instead."""

    name = "nearest"
    latency = "0"  # answers take no simulated time

    async def answer(self, question, rejections):
        refused = {rejection.details.get("index") for rejection in rejections}
        new = [c for c in question.facts.get("centroids", []) if not c["visited"] and c["index"] not in refused]
        if not new:
            raise AdvisorUnavailable("no-cluster", "nothing new in sight")
        best = min(new, key=lambda c: c["path_m"] or 1e9)
        return Reply(value=question.answer_type(selected_centroid_index=best["index"], reason="near"), raw="near")


result = coral.run_mission("s1", advisor=Nearest(), cfg={"time_limit_s": 15})
print(result)
print("who decided:", result.metrics["decided_by"])
