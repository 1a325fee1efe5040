//! Trials by name; those in a browser are skipped where there is none.

mod browser;
mod client;
mod filmed;
mod harm;
mod page;
mod program;
mod tev;

use std::fmt::Debug;

use libtest_mimic::{Completion, Failed, Trial};

const INSTALL: &str = "no Chromium; install it with: apt-get install chromium";

pub fn trials() -> Vec<Trial> {
    let plain = |name: &str, test: fn() -> Result<(), Failed>| Trial::test(name, test);
    vec![
        plain("view_is_for_those_with_the_token", page::token),
        plain("view_tiles_hold_the_values_of_the_picture", page::tiles),
        plain("view_layers_on_demand_come_after_a_pass", page::on_demand),
        plain("view_pause_is_no_part_of_the_time", page::pause),
        plain("view_stop_saves_picture_and_checkpoint", page::stop),
        plain("view_curve_falls_and_ends_where_compare_says", page::curve),
        plain("view_shows_and_judges_early", page::early),
        plain("view_opens_the_browser_unless_told_not_to", program::opens),
        plain("view_refuses_a_reference_of_another_size", page::wrong_reference),
        plain("view_clients_change_nothing_and_do_no_harm", harm::clients),
        plain("view_cost_stays_within_its_share", harm::share),
        plain("display_gets_every_layer_in_packets_of_tev", tev::packets),
        plain("display_may_hang_or_be_absent", tev::absent),
        Trial::ignorable_test("view_in_chromium", || match browser::find() {
            Some(browser) => filmed::page(&browser).map(|()| Completion::Completed),
            None => Ok(Completion::ignored_with(INSTALL)),
        }),
    ]
}

pub fn check(what: &str, holds: bool) -> Result<(), Failed> {
    if holds { Ok(()) } else { Err(what.into()) }
}

pub fn equal<T: PartialEq + Debug>(what: &str, found: T, expected: T) -> Result<(), Failed> {
    if found == expected { Ok(()) } else { Err(format!("{what}: {found:?}, not {expected:?}").into()) }
}
