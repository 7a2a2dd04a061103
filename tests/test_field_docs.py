from dataclasses import dataclass

from coral.field_docs import class_doc, field_docs


@dataclass
class Reef:
    """A reef
    of coral.

    It is long.
    """

    depth_m: float
    """Depth of the
    water (m)."""
    wide: bool = True
    length_m: float = 3.0
    """Along the spine."""


@dataclass
class Atoll(Reef):
    length_m: float = 5.0
    """Around."""


def test_the_text_below_a_field_is_found_in_one_line():
    assert field_docs(Reef) == {"depth_m": "Depth of the water (m).", "length_m": "Along the spine."}


def test_a_class_has_the_texts_of_the_one_it_extends():
    assert field_docs(Atoll) == {"depth_m": "Depth of the water (m).", "length_m": "Around."}


def test_a_class_is_described_by_its_first_paragraph():
    assert class_doc(Reef) == "A reef of coral."
