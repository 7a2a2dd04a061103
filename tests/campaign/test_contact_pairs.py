from coral.campaign.contact_pairs import paired_table


def trial(variant, seed, success, time_s=5.0, calls=2):
    return {
        "variant": variant,
        "world": "pick-box",
        "seed": seed,
        "success": success,
        "sim_time_s": time_s,
        "advisor_calls": calls,
    }


def test_variants_are_compared_trial_by_trial_with_full():
    full = [trial("full", seed, seed != 3) for seed in range(4)]
    other = [trial("unified", 0, True, 9.0), trial("unified", 1, False), trial("unified", 3, True, calls=8)]
    table = paired_table([*full, *other], "World: hand.", ("where from",), str.upper)
    first, second = table.rows
    assert first == ("FULL", "3/4", "30–95", "–", "–", "–", "–", "2.0", "5.0")
    assert second[:2] == ("UNIFIED", "2/3")
    assert second[3:] == ("1 : 1", "1", "2 : 1", "1", "4.0", "7.0")
    assert table.notes[-1] == "where from"


def test_who_is_sooner_counts_a_failure_as_later_and_equal_times_not_at_all():
    full = [trial("full", seed, True, 5.0) for seed in range(8)]
    other = [trial("no-memory", seed, seed < 7, 6.0 if seed < 6 else 5.0) for seed in range(8)]
    table = paired_table([*full, *other], "", ())
    assert table.rows[1][3:7] == ("1 : 0", "1", "7 : 0", "0.016")


def test_two_failures_are_no_difference():
    rows = [trial(variant, 0, False) for variant in ("full", "unified")]
    assert paired_table(rows, "", ()).rows[1][3:] == ("0 : 0", "1", "0 : 0", "1", "2.0", "–")


def test_without_full_or_without_another_variant_there_is_nothing_to_compare():
    assert paired_table([trial("unified", 0, True), trial("unguided", 0, True)], "", ()) is None
    assert paired_table([trial("full", 0, True)], "", ()) is None
