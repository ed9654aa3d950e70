"""The tests in this folder that move the pointer to coordinates, where Playwright cannot check the element under it.

On two busy processors, Chromium occasionally loses such an event, which says nothing about the page. Only these tests
are run once more if they fail (conftest.py); any other failure counts at once.
`tests/architecture/test_browser_tests.py` compares the list with the tests.
"""

from __future__ import annotations

#: By module: the tests.
POINTER_TESTS: dict[str, tuple[str, ...]] = {
    "test_accuracy_page": (
        "test_points_appear_and_the_cheapest_setting_is_named",
    ),
    "test_branches_page": (
        "test_hovering_shows_an_orbit_and_a_click_loads_it",
    ),
    "test_connection": (
        "test_a_page_whose_server_was_silent_goes_on",
    ),
    "test_first_visit": (
        "test_a_first_visit_is_shown_round_once",
        "test_a_meaning_stays_when_the_tab_is_made_anew_under_the_pointer",
    ),
    "test_knobs": (
        "test_a_click_on_the_curve_turns_f",
        "test_a_phone_has_f_at_hand_and_the_pictures_in_view_while_a_knob_moves",
    ),
    "test_lesson": (
        "test_a_bead_that_is_pointed_at_is_joined_to_its_column_and_a_column_to_its_bead",
    ),
    "test_map_page": (
        "test_panning_the_map_needs_no_server",
        "test_hovering_shows_the_values_of_a_cell",
        "test_a_click_sets_f_and_A0",
    ),
    "test_probe_page": (
        "test_a_bead_of_the_chain_is_probed",
        "test_a_click_in_the_map_probes_the_bead_and_a_drag_moves_time",
    ),
    "test_stability_page": (
        "test_hovering_shows_a_multiplier_and_choosing_it_animates_its_mode",
    ),
    "test_stories": (
        "test_a_term_with_a_capital_has_its_definition",
    ),
    "test_time": (
        "test_the_chain_moves_is_paused_and_moved_by_a_dragged_cursor",
        "test_a_bead_glows_as_its_column_and_one_at_rest_is_steel",
        "test_a_line_with_values_goes_through_all_pictures_and_a_tape_measures_speed",
    ),
}
