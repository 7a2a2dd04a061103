"""The configurations that `coral config` lists, by name."""

CONFIGURATIONS = {
    "reef": ("coral.reef.mission.mission_cfg:MissionCfg", "--cfg", "a survey"),
    "contact": ("coral.contact.episode.cfg:EpisodeCfg", "--cfg", "an attempt at a contact task"),
    "model": ("coral.advisor.model_cfg:ModelCfg", "--model", "the calls of a real model"),
    "safety": ("coral.reef.sea.safety:SafetyCfg", "--safety", "the limits of a vehicle at sea"),
    "products": ("coral.reef.products.survey_products:ProductsCfg", "--cfg", "maps and tables for an ecologist"),
}
"""Place, flag and subject of each."""


def configuration_at(place: str) -> str | None:
    """Return the name of the configuration whose class is at `module:class`."""
    return next((name for name, (known, _, _) in CONFIGURATIONS.items() if known == place), None)
