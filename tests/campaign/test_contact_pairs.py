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
    assert first == ("FULL", "3/4", "30–95", "–", "–", "–", "–", "2.0")
    assert second[:2] == ("UNIFIED", "2/3")
    assert second[3:] == ("1 : 1", "1", "1 of 1", "1", "4.0")
    assert table.notes[-1] == "where from"


def test_times_are_compared_in_the_trials_that_both_solved_and_equal_ones_do_not_count():
    full = [trial("full", seed, True, 5.0) for seed in range(8)]
    other = [trial("no-memory", seed, seed < 7, 6.0 if seed < 6 else 5.0) for seed in range(8)]
    table = paired_table([*full, *other], "", ())
    assert table.rows[1][3:7] == ("1 : 0", "1", "6 of 7", "0.031")


def test_without_full_or_without_another_variant_there_is_nothing_to_compare():
    assert paired_table([trial("unified", 0, True), trial("unguided", 0, True)], "", ()) is None
    assert paired_table([trial("full", 0, True)], "", ()) is None
